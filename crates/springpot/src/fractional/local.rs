//! The share of the step under way in D^alpha x: the exact kernel against the step's polynomial.

use super::step::{RatePolynomial, local_factors};
use crate::collocation::inner;
use crate::collocation::{MAX_NODES, Nodes, Places, RADAU_NODES, TABLEAU};
use serde::{Deserialize, Serialize};

/// What the order says of every step, and h^{1−alpha} of the last one.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(from = "f64", into = "f64")]
pub(super) struct Local {
    alpha: f64,
    /// p!/Γ(p+2−alpha).
    pub(super) factors: [f64; 5],
    /// Factors of x' at 0 and at the nodes, for each Radau node, of a step of h = 1.
    rates: [[f64; 4]; 3],
    /// Those of the strokes x_j − x_0.
    strokes: [[f64; 3]; 3],
    /// Those of the strokes at the nodes inside a series.
    inner: [[f64; 4]; 4],
    /// A lag and its power 1−alpha.
    power: [f64; 2],
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
        Self { alpha, factors, rates, strokes, inner, power: [1.0; 2] }
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
        let sum = (0..4).rev().fold(0.0, |sum, p| sum * theta + step.u[p] * self.factors[p]);
        self.power(theta * step.h) * sum
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
