//! The spring whose force is a polynomial of its stroke.

use super::contract::Holds;
use super::elastic::Elastic;
use super::kind::{LeafBuild, LeafKind};
use crate::dual::Dual;
use crate::law::catalog::{Param, Range};
use std::sync::Arc;

/// F = k1·x + k2·x² + k3·x³. Stores ½k1·x² + ⅓k2·x³ + ¼k3·x⁴.
///
/// Coefficients of any sign: where F falls with x it gives back what it stores, and creates nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polynomial {
    /// k1, k2, k3 in N/m, N/m², N/m³.
    pub coefficients: [Dual; 3],
}

impl Polynomial {
    /// Of these k1, k2, k3.
    pub fn new(coefficients: [impl Into<Dual>; 3]) -> Self {
        Self { coefficients: coefficients.map(Into::into) }
    }

    fn values(&self) -> [f64; 3] {
        self.coefficients.map(|k| k.value)
    }
}

impl Elastic for Polynomial {
    fn name(&self) -> &'static str {
        "polynomial"
    }

    fn force(&self, x: f64) -> f64 {
        let [k1, k2, k3] = self.values();
        x * (k1 + x * (k2 + x * k3))
    }

    fn slope(&self, x: f64) -> f64 {
        let [k1, k2, k3] = self.values();
        k1 + x * (2.0 * k2 + x * 3.0 * k3)
    }

    fn energy(&self, x: f64) -> f64 {
        let [k1, k2, k3] = self.values();
        x * x * (k1 / 2.0 + x * (k2 / 3.0 + x * k3 / 4.0))
    }

    fn numbers(&self, take: &mut dyn FnMut(Dual)) -> bool {
        self.coefficients.into_iter().for_each(take);
        true
    }

    fn by_numbers(&self, x: f64, take: &mut dyn FnMut([f64; 2])) {
        let mut power = 1.0;
        for n in 1..=self.coefficients.len() {
            power *= x;
            take([power, power * x / (n + 1) as f64]);
        }
    }

    fn holds(&self) -> Holds {
        match self.values() {
            [0.0, 0.0, 0.0] => Holds::Never,
            // The slope is positive everywhere.
            [k1, 0.0, 0.0] if k1 > 0.0 => Holds::Always,
            [k1, k2, k3] if k3 > 0.0 && k2 * k2 < 3.0 * k1 * k3 => Holds::Always,
            _ => Holds::AtTimes,
        }
    }

    fn is_linear(&self) -> bool {
        self.values()[1..] == [0.0, 0.0]
    }
}

/// What networks know of it.
pub(super) fn kind() -> LeafKind {
    LeafKind {
        name: "polynomial",
        equation: "F = k1·x + k2·x² + k3·x³",
        params: vec![
            Param::new("k1", "N/m", "coefficient of x", Range::ANY),
            Param::new("k2", "N/m^2", "coefficient of x²", Range::ANY),
            Param::new("k3", "N/m^3", "coefficient of x³", Range::ANY),
        ],
        build: LeafBuild::Values(|values, _| {
            Ok(Arc::new(Polynomial { coefficients: std::array::from_fn(|k| values[k]) }))
        }),
    }
}
