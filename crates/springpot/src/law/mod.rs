//! Material laws: stroke history (and inputs) → force. A law knows no bodies and chooses no step.

pub mod catalog;

pub use catalog::{Catalog, Entry, Input, Param, Range, RuleError};

/// Where the fractional derivative's memory starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Derivative {
    /// The element was held at x(0) for t < 0.
    #[default]
    Caputo,
    /// The element was unloaded, x = 0, and jumped to x(0) at t = 0.
    RiemannLiouville,
}

/// A material law (the contract is laid out in this module's files).
pub trait Law: Send + Sync + std::fmt::Debug {}
