//! Reduced time within a step.

use super::Values;
use crate::collocation::{Nodes, Places, RADAU_NODES, STAGES, lagrange_row};
use crate::law::heat::{Heat, Shift};
use crate::law::step::Step;

/// Gauss's rule with five points on −1 … 1: half of its nodes, and their weights.
const GAUSS: [[f64; 2]; 3] = [
    [0.0, 0.568_888_888_888_888_9],
    [0.538_469_310_105_683_1, 0.478_628_670_499_366_47],
    [0.906_179_845_938_664, 0.236_926_885_056_189_08],
];

/// How ξ goes on in a step: Δξ = ∫ dt/a_T by five points of Gauss between each two nodes, T the cubic through its values at the start and at the nodes.
pub(super) struct Clock {
    /// Δξ, s.
    pub(super) h: f64,
    /// a_T at the start and at the nodes.
    pub(super) factor: Values,
    /// Where the nodes are in ξ; `None`: where they are in t.
    pub(super) places: Option<Places>,
    bent: Option<Bent>,
}

/// A clock whose pace changes.
struct Bent {
    shift: Shift,
    /// T at the start and at the nodes.
    temperature: [f64; STAGES + 1],
    /// ξ/h at the start and at the nodes.
    passed: [f64; STAGES + 1],
}

impl Clock {
    pub(super) fn new(heat: &Heat, step: &Step, temperature: &Values) -> Self {
        let Some(shift) = heat.shift else {
            return Self { h: step.h, factor: [1.0; 5], places: None, bent: None };
        };
        let count = step.nodes.count();
        let mut factor = temperature.map(|temperature| shift.factor(temperature));
        let is_even = temperature[1..=count].iter().all(|t| *t == temperature[0]);
        match step.nodes {
            _ if is_even => Self { h: step.h / factor[0], factor, places: None, bent: None },
            Nodes::Radau => {
                let bent = Bent::new(shift, *temperature.first_chunk().expect("a value for each node"));
                let whole = bent.passed[STAGES];
                let places = Places::new([bent.passed[1] / whole, bent.passed[2] / whole, 1.0]);
                Self { h: whole * step.h, factor, places: Some(places), bent: Some(bent) }
            }
            // One node stands for the whole step, as its rate does.
            Nodes::One | Nodes::Midpoint | Nodes::Inner => {
                let pace = match step.nodes {
                    Nodes::One => 0.5 * (factor[0].recip() + factor[1].recip()),
                    _ => factor[1].recip(),
                };
                factor[1..=count].fill(pace.recip());
                Self { h: pace * step.h, factor, places: None, bent: None }
            }
        }
    }

    /// (ξ − ξ_n)/Δξ at θ.
    pub(super) fn share(&self, theta: f64) -> f64 {
        match &self.bent {
            Some(bent) if theta < 1.0 => bent.until(theta) / bent.passed[STAGES],
            _ => theta,
        }
    }
}

impl Bent {
    fn new(shift: Shift, temperature: [f64; STAGES + 1]) -> Self {
        let mut bent = Self { shift, temperature, passed: [0.0; STAGES + 1] };
        let ends = [0.0, RADAU_NODES[0], RADAU_NODES[1], RADAU_NODES[2]];
        for k in 0..STAGES {
            bent.passed[k + 1] = bent.passed[k] + bent.between(ends[k], ends[k + 1]);
        }
        bent
    }

    /// ξ/h at θ.
    fn until(&self, theta: f64) -> f64 {
        let behind = RADAU_NODES.iter().filter(|c| **c <= theta).count();
        let from = if behind == 0 { 0.0 } else { RADAU_NODES[behind - 1] };
        self.passed[behind] + self.between(from, theta)
    }

    fn between(&self, from: f64, to: f64) -> f64 {
        integral(from, to, |theta| (-self.shift.ln_factor(self.temperature(theta))).exp())
    }

    fn temperature(&self, theta: f64) -> f64 {
        let at = |k: usize| lagrange_row(k).iter().rev().fold(0.0, |sum, c| sum * theta + c);
        // The weights add up to 1: no digits are lost where the temperature hardly moves.
        let start = self.temperature[0];
        start + (1..=STAGES).map(|k| at(k) * (self.temperature[k] - start)).sum::<f64>()
    }
}

/// ∫ f dθ by five points of Gauss.
pub(super) fn integral(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let sum: f64 = GAUSS
        .iter()
        .map(|&[node, weight]| match node {
            0.0 => weight * f(middle),
            _ => weight * (f(middle - node * half) + f(middle + node * half)),
        })
        .sum();
    half * sum
}
