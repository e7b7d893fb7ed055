//! The kinds of leaves that networks may name.

use super::contract::Leaf;
use super::table::Table;
use super::{bouc_wen, dashpot, expression, friction, jenkins, polynomial, preload, spring, springpot, stop, table};
use crate::dual::Dual;
use crate::fractional::Kind as Derivative;
use crate::law::catalog::Param;
use crate::law::rule::RuleError;
use crate::signal::StrokeExpression;
use std::sync::Arc;

/// A kind of leaf: what networks that are written as text know about it.
#[derive(Debug, Clone)]
pub struct LeafKind {
    /// Name.
    pub name: &'static str,
    /// Its force in one line.
    pub equation: &'static str,
    /// Parameters, in the order of its arguments.
    pub params: Vec<Param>,
    /// Builds the leaf.
    pub build: LeafBuild,
}

/// A leaf that others may hold too.
pub type SharedLeaf = Arc<dyn Leaf>;

/// What a leaf is built from.
#[derive(Debug, Clone, Copy)]
pub enum LeafBuild {
    /// Values (SI, in the order of the parameters, each within its range), and the derivative that springpots take.
    Values(fn(&[Dual], Derivative) -> Result<SharedLeaf, RuleError>),
    /// The table in the file that its argument stands for.
    Table(fn(&Arc<Table>) -> SharedLeaf),
    /// The expression that its first argument stands for or is, and the values of its parameters.
    Expression(fn(&Arc<StrokeExpression>, Vec<Dual>) -> SharedLeaf),
}

impl LeafKind {
    /// All of them.
    pub fn all() -> Vec<Self> {
        vec![
            spring::kind(),
            dashpot::kind(),
            springpot::kind(),
            polynomial::kind(),
            table::kind(),
            stop::tension(),
            stop::compression(),
            stop::kind(),
            friction::kind(),
            preload::kind(),
            bouc_wen::kind(),
            jenkins::kind(),
            expression::kind(),
        ]
    }
}
