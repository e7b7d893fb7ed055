//! The linear spring.

use super::contract::Holds;
use super::elastic::Elastic;
use super::kind::{LeafBuild, LeafKind};
use crate::dual::Dual;
use crate::law::catalog::{Param, Range};
use std::sync::Arc;

/// F = k·x. Stores ½k·x².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spring {
    /// Stiffness k ≥ 0, N/m.
    pub stiffness: Dual,
}

impl Elastic for Spring {
    fn name(&self) -> &'static str {
        "spring"
    }

    fn force(&self, x: f64) -> f64 {
        self.stiffness.value * x
    }

    fn slope(&self, _: f64) -> f64 {
        self.stiffness.value
    }

    fn energy(&self, x: f64) -> f64 {
        0.5 * self.stiffness.value * x * x
    }

    fn numbers(&self, take: &mut dyn FnMut(Dual)) -> bool {
        take(self.stiffness);
        true
    }

    fn by_numbers(&self, x: f64, take: &mut dyn FnMut([f64; 2])) {
        take([x, 0.5 * x * x]);
    }

    fn holds(&self) -> Holds {
        if self.stiffness.value == 0.0 { Holds::Never } else { Holds::Always }
    }

    fn is_linear(&self) -> bool {
        true
    }
}

/// What networks know of it.
pub(super) fn kind() -> LeafKind {
    LeafKind {
        name: "spring",
        equation: "F = k·x",
        params: vec![Param::new("k", "N/m", "stiffness", Range::NOT_NEGATIVE)],
        build: LeafBuild::Values(|values, _| Ok(Arc::new(Spring { stiffness: values[0] }))),
    }
}
