//! A constant force.

use super::contract::Holds;
use super::elastic::Elastic;
use super::kind::{LeafBuild, LeafKind};
use crate::dual::Dual;
use crate::law::catalog::{Param, Range};
use std::sync::Arc;

/// F = f. Stores f·x, so that the energy closes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Preload {
    /// Force f of any sign, N.
    pub force: Dual,
}

impl Elastic for Preload {
    fn name(&self) -> &'static str {
        "preload"
    }

    fn force(&self, _: f64) -> f64 {
        self.force.value
    }

    fn slope(&self, _: f64) -> f64 {
        0.0
    }

    fn energy(&self, x: f64) -> f64 {
        self.force.value * x
    }

    fn numbers(&self, take: &mut dyn FnMut(Dual)) -> bool {
        take(self.force);
        true
    }

    fn by_numbers(&self, x: f64, take: &mut dyn FnMut([f64; 2])) {
        take([1.0, x]);
    }

    fn holds(&self) -> Holds {
        if self.force.value == 0.0 { Holds::Never } else { Holds::AtTimes }
    }

    fn is_linear(&self) -> bool {
        true
    }
}

/// What networks know of it.
pub(super) fn kind() -> LeafKind {
    LeafKind {
        name: "preload",
        equation: "F = f",
        params: vec![Param::new("f", "N", "constant force", Range::ANY)],
        build: LeafBuild::Values(|values, _| Ok(Arc::new(Preload { force: values[0] }))),
    }
}
