//! Minima of functions of a few numbers within bounds and under constraints, by their gradients.
//!
//! Sequential quadratic programming: at each point the Lagrangian's curvature is that which BFGS has learned of it (damped as M. J. D. Powell,
//! Math. Programming 14 (1978) 224–248), the step is the exact solution of the quadratic problem within bounds whose constraints are linear and may be
//! broken at a price ([`quadratic`]), and it is shortened until the merit function f + ρ Σ max(0, c) falls. The variables go from 0 to 1.
//!
//! A function may be the largest of several ([`Value::of`]): the problem has one more unknown then, and stays smooth where two are equal.

mod descent;
pub mod quadratic;

pub use descent::{Descent, Settings, Status, descend};

use crate::random::Random;

/// Share of the range between its ends and the outermost start.
const MARGIN: f64 = 0.02;

/// A function and its constraints at a point, with their gradients.
#[derive(Debug, Clone, PartialEq)]
pub struct Value {
    /// What is to be small: the largest of these; at least one.
    pub of: Vec<Slope>,
    /// What must not be above 0.
    pub constraints: Vec<Slope>,
}

/// A number and its gradient.
#[derive(Debug, Clone, PartialEq)]
pub struct Slope {
    /// The number.
    pub value: f64,
    /// Its derivatives by the variables.
    pub gradient: Vec<f64>,
}

impl Value {
    /// The largest of what is to be small.
    pub fn largest(&self) -> f64 {
        self.of.iter().map(|one| one.value).fold(f64::NEG_INFINITY, f64::max)
    }

    /// By how much the constraints are broken at most.
    pub fn broken(&self) -> f64 {
        self.constraints.iter().map(|one| one.value).fold(0.0, f64::max)
    }

    /// Whether all numbers are finite.
    pub fn is_finite(&self) -> bool {
        let all = self.of.iter().chain(&self.constraints);
        all.clone().all(|one| one.value.is_finite() && one.gradient.iter().all(|slope| slope.is_finite()))
    }
}

/// `count` points in the unit cube of n variables: each axis is cut into as many equal parts, and each part is used once (M. D. McKay,
/// R. J. Beckman, W. J. Conover, Technometrics 21 (1979) 239–245).
pub fn hypercube(n: usize, count: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut random = Random::new(seed, 0);
    let columns: Vec<Vec<f64>> = (0..n)
        .map(|_| {
            let parts = random.permutation(count);
            let share = |part: usize, random: &mut Random| (part as f64 + random.share()) / count as f64;
            parts.into_iter().map(|part| MARGIN + (1.0 - 2.0 * MARGIN) * share(part, &mut random)).collect()
        })
        .collect();
    (0..count).map(|k| columns.iter().map(|column| column[k]).collect()).collect()
}
