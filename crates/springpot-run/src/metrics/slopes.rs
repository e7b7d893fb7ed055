//! What a metric changes by with its rows: a linear form of them, sparse, so that any number of parameters share it.

use std::ops::{Add, Mul, Neg, Sub};

/// ∂m/∂y of the rows of a series, by their places; a place that is not there has none, one that is there twice has the sum.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Slopes(Vec<(usize, f64)>);

impl Slopes {
    /// Of the value of row `k` itself.
    pub(super) fn of_row(k: usize) -> Self {
        Self(vec![(k, 1.0)])
    }

    /// Of a sum of rows.
    pub(super) fn of_rows(weights: impl Iterator<Item = (usize, f64)>) -> Self {
        Self(weights.collect())
    }

    /// Places and slopes.
    pub(super) fn of_places(&self) -> impl Iterator<Item = (usize, f64)> {
        self.0.iter().copied()
    }

    /// What the metric changes by where the rows change by `change`. A row that does not change adds nothing, whatever its slope.
    pub(super) fn along(&self, change: impl Fn(usize) -> f64) -> f64 {
        let changes = self.0.iter().map(|(k, slope)| (slope, change(*k)));
        changes
            .filter(|(_, change)| *change != 0.0)
            .map(|(slope, change)| slope * change)
            .fold(0.0, |sum, term| sum + term)
    }
}

impl Add for Slopes {
    type Output = Self;

    fn add(mut self, other: Self) -> Self {
        self.0.extend(other.0);
        self
    }
}

impl Sub for Slopes {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Slopes {
    type Output = Self;

    fn neg(self) -> Self {
        self * -1.0
    }
}

impl Mul<f64> for Slopes {
    type Output = Self;

    fn mul(mut self, factor: f64) -> Self {
        self.0.iter_mut().for_each(|(_, slope)| *slope *= factor);
        self
    }
}
