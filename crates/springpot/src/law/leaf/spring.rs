//! The linear spring.

use super::contract::Leaf;
use super::kind::{LeafBuild, LeafKind};
use crate::law::catalog::{Param, Range};
use crate::law::network::Network;
use crate::law::state::StateRef;
use crate::law::step::{Observation, Point, Response, Step, Term};

/// F = k·x. Stores ½k·x².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spring {
    /// Stiffness k ≥ 0, N/m.
    pub stiffness: f64,
}

impl Leaf for Spring {
    fn name(&self) -> &'static str {
        "spring"
    }

    fn evaluate(&self, step: &Step, _: StateRef, response: &mut Response) {
        for i in 0..step.nodes.count() {
            response.force[i] += self.stiffness * step.stroke[i + 1];
            response.d_stroke[i][i] += self.stiffness;
        }
    }

    fn now(&self, at: &Point, _: StateRef) -> Observation {
        let x = at.stroke;
        Observation {
            derivative: x,
            regular: self.stiffness * x,
            singular: 0.0,
            stored: Some(0.5 * self.stiffness * x * x),
        }
    }

    fn linearised(&self, _: &Point) -> Term {
        Term { coefficient: self.stiffness, order: 0.0 }
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
