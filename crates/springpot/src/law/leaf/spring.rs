//! The linear spring.

use super::elastic::Elastic;
use super::kind::{LeafBuild, LeafKind};
use crate::law::catalog::{Param, Range};
use crate::law::network::{Holds, Network};

/// F = k·x. Stores ½k·x².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spring {
    /// Stiffness k ≥ 0, N/m.
    pub stiffness: f64,
}

impl Elastic for Spring {
    fn name(&self) -> &'static str {
        "spring"
    }

    fn force(&self, x: f64) -> f64 {
        self.stiffness * x
    }

    fn slope(&self, _: f64) -> f64 {
        self.stiffness
    }

    fn energy(&self, x: f64) -> f64 {
        0.5 * self.stiffness * x * x
    }

    fn holds(&self) -> Holds {
        if self.stiffness == 0.0 { Holds::Never } else { Holds::Always }
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
        build: LeafBuild::Values(|values, _| Ok(Network::spring(values[0]))),
    }
}
