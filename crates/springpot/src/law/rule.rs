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

impl RuleError {
    /// The error where a rule does not hold.
    pub(super) fn unless(holds: bool, rule: &'static str, parameter: &'static str) -> Result<(), Self> {
        if holds { Ok(()) } else { Err(Self { rule: rule.into(), parameter: parameter.into() }) }
    }
}
