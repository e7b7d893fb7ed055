//! Rules that keep a law passive.

use std::borrow::Cow;

/// A rule between parameters that a law needs to be passive.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{rule}")]
pub struct RuleError {
    /// The rule, in words.
    pub rule: String,
    /// The parameter to change.
    pub parameter: Cow<'static, str>,
}
