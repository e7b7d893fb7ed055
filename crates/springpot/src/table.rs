//! What the rows of a run hold: named columns with units.

use serde::Serialize;

/// One column of the results.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Column {
    /// Name, such as `strut.Q.q2`.
    pub name: String,
    /// SI unit; empty for a pure number.
    pub unit: String,
    /// What it holds, in a few words.
    pub meaning: String,
}

impl Column {
    /// A column.
    pub fn new(name: impl Into<String>, unit: impl Into<String>, meaning: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into(), meaning: meaning.into() }
    }
}
