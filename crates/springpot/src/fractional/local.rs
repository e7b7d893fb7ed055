//! The share of the step under way in D^alpha x: the exact kernel against the step's polynomial.

use super::step::{RatePolynomial, SEXTIC, local_factors};
use crate::collocation::inner;
use crate::collocation::{Gaps, MAX_NODES, Nodes, Places, RADAU_NODES, TABLEAU};
use serde::{Deserialize, Serialize};
use std::sync::OnceLock;

/// What the order says of every step, and h^{1−alpha} of the last one.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(from = "f64", into = "f64")]
pub(super) struct Local {
    alpha: f64,
    /// p!/Γ(p+2−alpha).
    pub(super) factors: [f64; SEXTIC],
    /// Factors of x' at 0 and at the nodes, for each Radau node, of a step of h = 1.
    rates: [[f64; 4]; 3],
    /// Those of the strokes x_j − x_0.
    strokes: [[f64; 3]; 3],
    /// Both of the polynomial that has strokes and rates, once it is asked for.
    both: OnceLock<Both>,
    /// Those of the strokes at the nodes inside a series.
    inner: [[f64; 4]; 4],
    /// A lag and its power 1−alpha.
    power: [f64; 2],
}

/// In how many places of a step an estimate is looked at.
const SAMPLES: u8 = 20;

/// D^alpha x at the three nodes of a step of h = 1 whose polynomial has strokes and rates.
#[derive(Debug, Clone, Copy)]
pub(super) struct Both {
    /// Factors of x' at 0 and at the nodes, for each node.
    rates: [[f64; 4]; 3],
    /// Those of the strokes x_j − x_0.
    strokes: [[f64; 3]; 3],
    /// The most that what x at the first node tells does anywhere in the step, in units of the highest coefficient.
    defect: f64,
}

impl Both {
    fn of(factors: &[f64; SEXTIC], alpha: f64, places: Option<&Places>) -> Self {
        let at = |polynomial: &[f64], theta: f64| {
            let terms = polynomial.iter().zip(factors).map(|(u, factor)| u * factor);
            theta.powf(1.0 - alpha) * terms.rev().fold(0.0, |sum, term| sum * theta + term)
        };
        let gaps = Gaps::at(places);
        let through = |known: [&[f64]; 2]| RatePolynomial::through_both(1.0, (places, &gaps), known).u;
        let unit = |k: usize| std::array::from_fn::<f64, 4, _>(|j| f64::from(u8::from(j == k)));
        let by_rate = [0, 1, 2, 3].map(|k| through([&[0.0; 4], &unit(k)]));
        let by_stroke = [1, 2, 3].map(|k| through([&unit(k), &[0.0; 4]]));
        let [first, ..] = &by_stroke;
        let samples = (1..=SAMPLES).map(|k| at(first, f64::from(k) / f64::from(SAMPLES)).abs());
        let nodes = places.map_or(RADAU_NODES, |places| *places.positions());
        Self {
            rates: nodes.map(|theta| by_rate.map(|u| at(&u, theta))),
            strokes: nodes.map(|theta| by_stroke.map(|u| at(&u, theta))),
            defect: samples.fold(0.0, f64::max) / first[SEXTIC - 1].abs(),
        }
    }
}

impl From<f64> for Local {
    fn from(alpha: f64) -> Self {
        let factors = local_factors(alpha);
        let rates = RADAU_NODES.map(|c| {
            let scale = c.powf(1.0 - alpha);
            let term = |p: usize, k: usize| factors[p] * TABLEAU.rates[p][k];
            std::array::from_fn(|k| scale * (0..4).rev().fold(0.0, |sum, p| sum * c + term(p, k)))
        });
        let strokes = RADAU_NODES.map(|c| {
            let scale = c.powf(1.0 - alpha);
            let term = |p: usize, j: usize| factors[p] * (p + 1) as f64 * TABLEAU.strokes[p][j];
            std::array::from_fn(|j| scale * (0..3).rev().fold(0.0, |sum, p| sum * c + term(p, j)))
        });
        let inner = inner::NODES.map(|c| {
            let scale = c.powf(1.0 - alpha);
            let term = |p: usize, j: usize| factors[p] * (p + 1) as f64 * inner::TABLEAU_OF_FOUR.values[p + 1][j + 1];
            std::array::from_fn(|j| scale * (0..4).rev().fold(0.0, |sum, p| sum * c + term(p, j)))
        });
        Self { alpha, factors, rates, strokes, both: OnceLock::new(), inner, power: [1.0; 2] }
    }
}

impl From<Local> for f64 {
    fn from(local: Local) -> Self {
        local.alpha
    }
}

impl Local {
    /// Keeps the power of a lag ready.
    pub(super) fn prepare(&mut self, lag: f64) {
        self.power = [lag, self.power(lag)];
    }

    /// lag^{1−alpha}.
    pub(super) fn power(&self, lag: f64) -> f64 {
        if lag == self.power[0] { self.power[1] } else { lag.powf(1.0 - self.alpha) }
    }

    /// h^{1−alpha} Σ_p u_p p!/Γ(p+2−alpha) θ^{p+1−alpha}.
    pub(super) fn part(&self, step: &RatePolynomial, theta: f64) -> f64 {
        let sum = (0..SEXTIC).rev().fold(0.0, |sum, p| sum * theta + step.u[p] * self.factors[p]);
        self.power(theta * step.h) * sum
    }

    /// Of steps whose three nodes are at `places`, else those of Radau.
    pub(super) fn both(&self, places: Option<&Places>) -> Both {
        let of = || Both::of(&self.factors, self.alpha, places);
        if places.is_some() { of() } else { *self.both.get_or_init(of) }
    }

    /// The most that x at the first node tells of D^alpha x in a step whose polynomial has strokes and rates, of which the highest coefficient is
    /// `highest`; order 7 − alpha.
    pub(super) fn defect_of_both(&self, h: f64, places: Option<&Places>, highest: f64) -> f64 {
        self.power(h) * self.both(places).defect * highest
    }

    /// Factors of x' at 0 and at the nodes, and of the strokes x_j − x_0, for node i of a step whose polynomial has both.
    pub(super) fn rows_of_both(&self, both: &Both, h: f64, i: usize) -> ([f64; MAX_NODES + 1], [f64; MAX_NODES]) {
        let scale = self.power(h);
        (padded(both.rates[i].map(|row| scale * row)), padded(both.strokes[i].map(|row| scale * row / h)))
    }

    /// Factors of x' at 0 and at the nodes, for node i.
    pub(super) fn rate_row(&self, h: f64, i: usize, nodes: Nodes) -> [f64; MAX_NODES + 1] {
        let [first, second, ..] = self.factors;
        let row = match nodes {
            Nodes::One => [first - second, second, 0.0, 0.0, 0.0],
            Nodes::Midpoint => [0.0, self.mean_factor(), 0.0, 0.0, 0.0],
            Nodes::Radau => padded(self.rates[i]),
            Nodes::Inner => {
                let by_node = |j: usize| (0..4).map(|k| self.inner[i][k] * nodes.matrix()[k][j]).sum();
                [0.0, by_node(0), by_node(1), by_node(2), by_node(3)]
            }
        };
        let scale = self.power(h);
        row.map(|factor| scale * factor)
    }

    /// Factors of the strokes x_j − x_0, for node i.
    pub(super) fn stroke_row(&self, h: f64, i: usize, nodes: Nodes) -> [f64; MAX_NODES] {
        let row = match nodes {
            Nodes::One => [self.factors[0], 0.0, 0.0, 0.0],
            Nodes::Midpoint => [2.0 * self.mean_factor(), 0.0, 0.0, 0.0],
            Nodes::Radau => padded(self.strokes[i]),
            Nodes::Inner => self.inner[i],
        };
        let scale = self.power(h) / h;
        row.map(|factor| scale * factor)
    }

    /// As [`Self::rate_row`] of a step with three nodes at `places`.
    pub(super) fn rate_row_at(&self, h: f64, i: usize, places: &Places) -> [f64; MAX_NODES + 1] {
        let theta = places.positions()[i];
        let scale = self.power(theta * h);
        let term = |p: usize, k: usize| self.factors[p] * places.values[p][k];
        let factor = |k: usize| (0..4).rev().fold(0.0, |sum, p| sum * theta + term(p, k));
        std::array::from_fn(|k| if k < 4 { scale * factor(k) } else { 0.0 })
    }

    /// As [`Self::stroke_row`] of a step with three nodes at `places`.
    pub(super) fn stroke_row_at(&self, h: f64, i: usize, places: &Places) -> [f64; MAX_NODES] {
        let theta = places.positions()[i];
        let scale = self.power(theta * h) / h;
        let term = |p: usize, j: usize| self.factors[p] * (p + 1) as f64 * places.values[p + 1][j + 1];
        let factor = |j: usize| (0..3).rev().fold(0.0, |sum, p| sum * theta + term(p, j));
        std::array::from_fn(|j| if j < 3 { scale * factor(j) } else { 0.0 })
    }

    /// 1/Γ(3−alpha): the mean over a step of h = 1 of D^alpha x under the rate 1.
    fn mean_factor(&self) -> f64 {
        self.factors[0] / (2.0 - self.alpha)
    }
}

/// A row with room for one node more.
fn padded<const N: usize, const M: usize>(row: [f64; N]) -> [f64; M] {
    std::array::from_fn(|k| row.get(k).copied().unwrap_or(0.0))
}
