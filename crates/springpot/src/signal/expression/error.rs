//! What can be wrong with an expression, and what would be right.

use std::ops::Range;

/// Why a text is not an expression of t. Byte ranges count in the text that was given.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ExpressionError {
    /// Something else belongs here.
    #[error("`{found}` stands where {wanted} belongs")]
    Unexpected {
        /// The character or name that stands there.
        found: String,
        /// What would be right.
        wanted: &'static str,
        /// Where.
        at: Range<usize>,
    },
    /// A comparison or a condition.
    #[error("`{found}`: an expression has no conditions; step(t - 1) is 0 before t = 1 and 1 from then on")]
    Condition {
        /// The sign or word that stands there.
        found: String,
        /// Where.
        at: Range<usize>,
    },
    /// The text ends too early.
    #[error("the expression ends where {wanted} belongs")]
    UnexpectedEnd {
        /// What would be right.
        wanted: &'static str,
        /// Where.
        at: Range<usize>,
    },
    /// A parenthesis that is never closed.
    #[error("this parenthesis is never closed")]
    Unclosed {
        /// The opening parenthesis.
        at: Range<usize>,
    },
    /// No variable, constant or function has this name.
    #[error("unknown name `{name}`{}", hint(suggestion))]
    UnknownName {
        /// The name.
        name: String,
        /// What was probably meant.
        suggestion: Option<String>,
        /// Where.
        at: Range<usize>,
    },
    /// t, where a force follows from stroke and rate alone.
    #[error("`t` has no place here: a force follows from the stroke x, its rate v and parameters")]
    Time {
        /// Where.
        at: Range<usize>,
    },
    /// A function without parentheses.
    #[error("`{function}` takes its argument in parentheses, as in `{function}(t)`")]
    NeedsParentheses {
        /// The function.
        function: String,
        /// Where.
        at: Range<usize>,
    },
    /// Too many or too few arguments.
    #[error("`{function}` takes {wanted}, not {given}")]
    ArgumentCount {
        /// The function.
        function: String,
        /// How many it takes.
        wanted: &'static str,
        /// How many there are.
        given: usize,
        /// The call.
        at: Range<usize>,
    },
    /// A number beyond the range of numbers.
    #[error("`{number}` is beyond the range of numbers")]
    NotFinite {
        /// The number.
        number: String,
        /// Where.
        at: Range<usize>,
    },
    /// Longer than [`MAX_LENGTH`](super::MAX_LENGTH).
    #[error("an expression of {length} bytes; the limit is {limit}")]
    TooLong {
        /// Length in bytes.
        length: usize,
        /// The limit.
        limit: usize,
    },
    /// Nested more deeply than [`MAX_DEPTH`](super::MAX_DEPTH), or with too many open intermediate results.
    #[error("the expression is nested too deeply here")]
    TooDeep {
        /// Where.
        at: Range<usize>,
    },
    /// More kinks than [`MAX_KINKS`](super::MAX_KINKS).
    #[error("{given} calls of abs, sign, step, min, max and atan2; the limit is {limit}")]
    TooManyKinks {
        /// How many there are.
        given: usize,
        /// The limit.
        limit: usize,
    },
}

impl ExpressionError {
    /// Bytes of the given text that the message is about; `None` where it is about the whole.
    pub fn span(&self) -> Option<Range<usize>> {
        match self {
            Self::Unexpected { at, .. }
            | Self::UnexpectedEnd { at, .. }
            | Self::Unclosed { at }
            | Self::Time { at }
            | Self::Condition { at, .. }
            | Self::UnknownName { at, .. }
            | Self::NeedsParentheses { at, .. }
            | Self::ArgumentCount { at, .. }
            | Self::NotFinite { at, .. }
            | Self::TooDeep { at } => Some(at.clone()),
            Self::TooLong { .. } | Self::TooManyKinks { .. } => None,
        }
    }
}

fn hint(suggestion: &Option<String>) -> String {
    match suggestion {
        Some(meant) => format!("; did you mean `{meant}`?"),
        None => "; an expression knows t, pi, e and functions such as sin".to_owned(),
    }
}
