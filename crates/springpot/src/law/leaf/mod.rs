//! The leaves of every law: what gives a force by itself.

mod contract;
mod dashpot;
mod kind;
mod source;
mod spring;
mod springpot;

pub use contract::Leaf;
pub use dashpot::Dashpot;
pub use kind::LeafKind;
pub use source::Source;
pub use spring::Spring;
pub use springpot::{Coefficient, Springpot};
