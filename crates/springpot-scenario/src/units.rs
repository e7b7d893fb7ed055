//! Units and quantities: `"70 cm"`, `"50 N*s^alpha/m"`, `"25 degC"`.
//!
//! A quantity is `NUMBER UNIT`. UNIT is factors joined by `*`, `·` and `/`, left to right (`N/m*s` is (N/m)·s), with
//! parentheses; a factor is SYMBOL[^EXPONENT], and EXPONENT an integer, a decimal, a fraction (`1/2`, also in
//! parentheses) or the name of a parameter of the same law.
//!
//! | | symbols |
//! |---|---|
//! | with prefixes p n u µ m c k M G | m g s rad N J W Pa Hz V A C F ohm K mol |
//! | without | min h deg degC degF % 1 |
//!
//! A whole symbol wins over prefix + symbol: `min` is a minute. rad, deg, % and 1 have no dimension. `degC` and `degF`
//! are temperature scales with their own zero where they stand alone, and differences inside a compound: `20 degC` is
//! 293.15 K, `0.7 mm/degC` is 0.0007 m/K.
//!
//! **Factors are exact.** A factor is a power of ten times a ratio of two numbers of 106 bits. Where it is a power of ten,
//! the number's text is read once with its decimal exponent shifted, so 70 cm is 70/100, correctly rounded. Every other
//! factor (min, h, deg, degF and their powers) is applied to the number in 106 bits and rounded once; only fractional
//! powers of units that are not SI base units (`ms^0.3`) round twice.

mod dimension;
mod error;
mod grammar;
mod number;
mod symbols;
mod twofold;

pub use dimension::Dimension;
pub use error::UnitError;

use grammar::{Parser, Product};
use number::Decimal;
use std::fmt;
use twofold::Twofold;

/// Longest text of a quantity or unit, in bytes.
pub const MAX_LENGTH: usize = 1000;

/// Values of the parameters that an exponent may name.
pub type Exponents<'a> = &'a dyn Fn(&str) -> Option<f64>;

/// A unit: dimension, factor and, for temperature scales, zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    text: String,
    dimension: Dimension,
    /// SI = (number + offset)·up/down.
    up: Twofold,
    down: Twofold,
    offset: Option<Twofold>,
    /// Exponent where the factor is a power of ten.
    decimal: Option<i32>,
}

impl Unit {
    /// Reads a unit; the empty text is the unit of pure numbers. `exponents` gives the values of named exponents.
    pub fn parse(text: &str, exponents: &dyn Fn(&str) -> Option<f64>) -> Result<Self, UnitError> {
        Self::parse_from(text, 0, exponents)
    }

    fn parse_from(text: &str, start: usize, exponents: Exponents<'_>) -> Result<Self, UnitError> {
        check_length(text)?;
        let written = text[start..].trim();
        let blanks = text[start..].len() - text[start..].trim_start().len();
        let at = start + blanks..start + blanks + written.len();
        let Product { dimension, up, down, decimal, offset } =
            if written.is_empty() { Product::ONE } else { Parser::parse(text, start, exponents)? };
        let power = Twofold::ONE.scaled_by_ten(decimal.abs());
        let only_ten = up == down && offset.is_none();
        let (up, down) = if decimal < 0 { (up, down.mul(power)) } else { (up.mul(power), down) };
        let usable = |x: Twofold| x.to_f64().is_normal();
        let finite = dimension.exponents().iter().all(|e| e.is_finite());
        if !(finite && usable(up) && usable(down) && usable(up.div(down))) {
            return Err(UnitError::NotFinite { text: written.to_owned(), at });
        }
        let text = written.to_owned();
        Ok(Self { text, dimension, up, down, offset, decimal: only_ten.then_some(decimal) })
    }

    /// The unit's dimension.
    pub fn dimension(&self) -> Dimension {
        self.dimension
    }

    /// Whether its zero is not the zero of SI: degC and degF standing alone.
    pub fn is_affine(&self) -> bool {
        self.offset.is_some()
    }

    /// SI = scale·number + shift; the factor, rounded once.
    pub fn scale(&self) -> f64 {
        self.up.div(self.down).to_f64()
    }

    /// SI = scale·number + shift; the SI value of the unit's zero: 273.15 for degC, 0 for all that is not affine.
    pub fn shift(&self) -> f64 {
        self.offset.map_or(0.0, |offset| offset.mul(self.up).div(self.down).to_f64())
    }

    /// The SI unit of its values: as written where that is one, else that of its dimension; angles are in rad, pure numbers have none.
    pub fn si_name(&self) -> String {
        let plain = self.dimension.to_string();
        if self.text == "1" || self.text == "%" {
            return String::new();
        }
        if self.scale() == 1.0 && !self.is_affine() {
            return self.text.clone();
        }
        let ends = |name: &str| self.text.ends_with(name);
        match plain.as_str() {
            "1" if ends("deg") || ends("rad") => "rad".to_owned(),
            "1" => String::new(),
            "1/s" if ends("Hz") => "Hz".to_owned(),
            _ => plain,
        }
    }

    /// The SI value of `number` of this unit, rounded once. NaN and infinities pass through.
    pub fn to_si(&self, number: f64) -> f64 {
        if !number.is_finite() {
            return number;
        }
        self.convert(Twofold::from_f64(number)).unwrap_or_else(|| number * self.scale() + self.shift())
    }

    /// The number of this unit that an SI value is, rounded once. NaN and infinities pass through.
    pub fn from_si(&self, value: f64) -> f64 {
        if !value.is_finite() {
            return value;
        }
        let scaled = Twofold::from_f64(value).mul(self.down).div(self.up);
        let number = self.offset.map_or(scaled, |offset| scaled.add(offset.negated())).to_f64();
        if number.is_finite() { number } else { (value - self.shift()) / self.scale() }
    }

    /// `None` where an intermediate result leaves the range of numbers.
    fn convert(&self, number: Twofold) -> Option<f64> {
        let number = self.offset.map_or(number, |offset| number.add(offset));
        let value = number.mul(self.up).div(self.down).to_f64();
        value.is_finite().then_some(value)
    }

    fn read(&self, number: Decimal<'_>) -> f64 {
        match self.decimal {
            Some(shift) => number.to_f64(shift),
            None => self.convert(number.to_twofold()).unwrap_or_else(|| self.to_si(number.to_f64(0))),
        }
    }
}

/// The unit as it was written.
impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// Number and unit of a text that is a quantity; `None` where it is not one, and may be an expression.
///
/// A text is a quantity when it starts with a number, and then
/// - ends: `60`, `-1e-3` (the unit is empty);
/// - or goes on, after any blanks, with a letter, `%`, `°`, `_` or `(`: `5 mm`, `3kg`, `20 (N*s)/m`; also `5 t`, `2e` and
///   `2 sin(t)`, which are quantities of unknown unit and not expressions, because a product is always written out;
/// - or goes on, after at least one blank, with `1`: `5 1/s`.
///
/// Everything else is none: `0.1*t`, `1/2`, `2 - t`, `t`, `-t`. An `e` that no digits follow does not belong to the number.
/// Blanks around the text do not count. The number may start with `−` (U+2212); [`parse_quantity`] reads it.
pub fn split_quantity(text: &str) -> Option<(&str, &str)> {
    let text = text.trim();
    let (number, rest) = text.split_at(Decimal::scan(text)?.len);
    let unit = rest.trim_start();
    let is_unit = match unit.chars().next() {
        None => true,
        Some('1') => unit.len() < rest.len(),
        Some(c) => grammar::starts_symbol(c) || matches!(c, '%' | '('),
    };
    is_unit.then_some((number, unit))
}

/// The SI unit of a quantity in whatever unit it is written ([`Unit::si_name`]); empty where it has none, and of what is no quantity.
///
/// # Errors
/// [`UnitError`] of the unit.
pub fn si_unit(text: &str) -> Result<String, UnitError> {
    let unit = split_quantity(text).map_or("", |(_, unit)| unit);
    Unit::parse(unit, &|_| None).map(|unit| unit.si_name())
}

/// The SI value of a quantity.
///
/// `expected` is a unit of the dimension that is wanted; empty for a pure number, which also takes rad, deg and %. A number
/// without unit is taken as SI. Where a temperature is expected, `25 degC` is 298.15 K. Byte ranges of errors count in
/// `text`.
///
/// ```
/// use springpot_scenario::units::parse_quantity;
/// let alpha = |name: &str| (name == "alpha").then_some(0.3);
/// assert_eq!(parse_quantity("70 cm", "m", &alpha), Ok(0.7));
/// assert_eq!(parse_quantity("0.5 N*s^alpha/cm", "N*s^alpha/m", &alpha), Ok(50.0));
/// assert!(parse_quantity("50 N/m", "N*s^alpha/m", &alpha).is_err());
/// ```
pub fn parse_quantity(text: &str, expected: &str, exponents: &dyn Fn(&str) -> Option<f64>) -> Result<f64, UnitError> {
    check_length(text)?;
    let start = text.len() - text.trim_start().len();
    let written = text.trim();
    let at = start..start + written.len();
    let Some(number) = Decimal::scan(written) else {
        return Err(UnitError::NotANumber { text: written.to_owned(), at });
    };
    let number_end = start + number.len;
    let value = if written.len() == number.len {
        number.to_f64(0)
    } else {
        let unit = Unit::parse_from(text, number_end, exponents)?;
        let wanted = Unit::parse(expected, exponents)
            .map_err(|source| UnitError::Expected { unit: expected.to_owned(), source: Box::new(source) })?;
        if !unit.dimension.agrees_with(&wanted.dimension) {
            return Err(UnitError::WrongDimension {
                at: at.end - unit.text.len()..at.end,
                unit: unit.text,
                given: Box::new(unit.dimension),
                expected: expected.to_owned(),
                expected_dimension: Box::new(wanted.dimension),
            });
        }
        unit.read(number)
    };
    if value.is_finite() { Ok(value) } else { Err(UnitError::NotFinite { text: written.to_owned(), at }) }
}

fn check_length(text: &str) -> Result<(), UnitError> {
    let length = text.len();
    if length > MAX_LENGTH { Err(UnitError::TooLong { length, limit: MAX_LENGTH }) } else { Ok(()) }
}
