//! What can be wrong with a quantity, and what would be right.

use super::dimension::Dimension;
use super::symbols;
use std::ops::Range;

/// Why a text is not a quantity of the wanted dimension. Byte ranges count in the text that was given.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UnitError {
    /// The text does not start with a number.
    #[error("`{text}` does not start with a number; write a number and a unit, such as \"70 cm\"")]
    NotANumber {
        /// The text.
        text: String,
        /// Where.
        at: Range<usize>,
    },
    /// The number, the unit's factor or their product is not a finite number.
    #[error("`{text}` is beyond the range of numbers")]
    NotFinite {
        /// The number or unit.
        text: String,
        /// Where.
        at: Range<usize>,
    },
    /// No unit has this symbol.
    #[error("unknown unit `{symbol}`{}", hint(symbol, suggestion))]
    UnknownSymbol {
        /// The symbol.
        symbol: String,
        /// What was probably meant.
        suggestion: Option<String>,
        /// Where.
        at: Range<usize>,
    },
    /// A number followed by a name that belongs to expressions, such as `2 t`.
    #[error("`{name}` is no unit; in an expression write every product out, as in `2*{name}`")]
    ExpressionName {
        /// The name.
        name: String,
        /// Where.
        at: Range<usize>,
    },
    /// The unit is one of another dimension.
    #[error("{} does not fit: this place takes {}", written(unit, given), wanted(expected, expected_dimension))]
    WrongDimension {
        /// The unit as written.
        unit: String,
        /// Its dimension.
        given: Box<Dimension>,
        /// A unit that would be right; empty for a pure number.
        expected: String,
        /// Its dimension.
        expected_dimension: Box<Dimension>,
        /// Where.
        at: Range<usize>,
    },
    /// An exponent names a parameter that the law does not have, or that has no value yet.
    #[error("`{name}` is not a known exponent; an exponent is a number or the name of a parameter of the same law")]
    UnknownExponent {
        /// The name.
        name: String,
        /// Where.
        at: Range<usize>,
    },
    /// An exponent that is not a number within −99 … 99.
    #[error("`{text}` cannot be an exponent; write an integer, a decimal or a fraction between -99 and 99")]
    BadExponent {
        /// The exponent as written.
        text: String,
        /// Where.
        at: Range<usize>,
    },
    /// Something else belongs here.
    #[error("{} where {wanted} belongs", found(text))]
    Syntax {
        /// What stands there; empty at the end.
        text: String,
        /// What would be right.
        wanted: &'static str,
        /// Where.
        at: Range<usize>,
    },
    /// Longer than [`MAX_LENGTH`](super::MAX_LENGTH).
    #[error("a quantity of {length} bytes; the limit is {limit}")]
    TooLong {
        /// Length in bytes.
        length: usize,
        /// The limit.
        limit: usize,
    },
    /// Parentheses nested too deeply.
    #[error("more than {limit} parentheses inside one another")]
    TooDeep {
        /// The limit.
        limit: usize,
        /// Where.
        at: Range<usize>,
    },
    /// The unit that the place expects cannot be read: a mistake in the table that names it, or an exponent without value.
    #[error("the expected unit `{unit}` cannot be read: {source}")]
    Expected {
        /// The expected unit.
        unit: String,
        /// Why.
        source: Box<UnitError>,
    },
}

impl UnitError {
    /// Bytes of the given text that the message is about; `None` where it is about the whole.
    pub fn span(&self) -> Option<Range<usize>> {
        match self {
            Self::NotANumber { at, .. }
            | Self::NotFinite { at, .. }
            | Self::UnknownSymbol { at, .. }
            | Self::ExpressionName { at, .. }
            | Self::WrongDimension { at, .. }
            | Self::UnknownExponent { at, .. }
            | Self::BadExponent { at, .. }
            | Self::Syntax { at, .. }
            | Self::TooDeep { at, .. } => Some(at.clone()),
            Self::TooLong { .. } | Self::Expected { .. } => None,
        }
    }
}

fn hint(symbol: &str, suggestion: &Option<String>) -> String {
    match suggestion {
        Some(meant) => format!("; did you mean `{meant}`?"),
        None if symbol.len() <= 40 => format!("; units are {}, most with a prefix p n u m c k M G", symbols::LIST),
        None => String::new(),
    }
}

/// The unit as written, and its dimension where that says more.
fn written(unit: &str, dimension: &Dimension) -> String {
    let plain = dimension.to_string();
    if plain == unit { format!("`{unit}`") } else { format!("`{unit}` (that is {plain})") }
}

fn wanted(expected: &str, dimension: &Dimension) -> String {
    let plain = dimension.to_string();
    match expected {
        "" => "a pure number".to_owned(),
        _ if plain == expected => format!("`{expected}`"),
        _ if expected.contains('^') => format!("`{expected}` (that is {plain})"),
        _ => format!("`{expected}` or another unit of {plain}"),
    }
}

fn found(text: &str) -> String {
    if text.is_empty() { "the text ends".to_owned() } else { format!("`{text}` stands") }
}
