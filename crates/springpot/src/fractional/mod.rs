//! Fractional calculus on its own: no robot, no law.

pub mod gamma;
pub mod kind;
pub mod scheme;

pub use kind::Kind;
