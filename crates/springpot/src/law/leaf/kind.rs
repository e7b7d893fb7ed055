//! The kinds of leaves that networks may name.

use crate::fractional::Kind as Derivative;
use crate::law::catalog::Param;
use crate::law::network::Network;
use crate::law::rule::RuleError;

/// A kind of leaf: what networks that are written as text know about it.
#[derive(Debug, Clone)]
pub struct LeafKind {
    /// Name.
    pub name: &'static str,
    /// Its force in one line.
    pub equation: &'static str,
    /// Parameters, in the order of its arguments.
    pub params: Vec<Param>,
    /// Builds the leaf: from values (SI, in the order of the parameters, each within its range), and the derivative that springpots take.
    pub build: fn(&[f64], Derivative) -> Result<Network, RuleError>,
}

impl LeafKind {
    /// All of them.
    pub fn all() -> Vec<Self> {
        vec![super::spring::kind(), super::dashpot::kind(), super::springpot::kind()]
    }
}
