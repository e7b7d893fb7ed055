//! UNIT = factors joined by `*`, `·`, `/`, left to right; a factor is SYMBOL[^EXPONENT] or a product in parentheses.

use super::Exponents;
use super::dimension::Dimension;
use super::error::UnitError;
use super::symbols::{self, Meaning};
use super::twofold::Twofold;
use springpot::signal::expression;
use std::ops::Range;

const MAX_DEPTH: usize = 32;
const MAX_EXPONENT: f64 = 99.0;

/// Factor and dimension of a product: SI = number·up/down·10^decimal.
#[derive(Debug, Clone, Copy)]
pub(super) struct Product {
    pub(super) dimension: Dimension,
    pub(super) up: Twofold,
    pub(super) down: Twofold,
    pub(super) decimal: i32,
    /// Of a temperature scale that stands alone.
    pub(super) offset: Option<Twofold>,
}

impl Product {
    pub(super) const ONE: Self =
        Self { dimension: Dimension::NONE, up: Twofold::ONE, down: Twofold::ONE, decimal: 0, offset: None };

    fn times(self, other: Self) -> Self {
        Self {
            dimension: self.dimension.times(other.dimension, 1.0),
            up: self.up.mul(other.up),
            down: self.down.mul(other.down),
            decimal: self.decimal.saturating_add(other.decimal),
            offset: None,
        }
    }

    fn pow(self, exponent: f64) -> Self {
        let dimension = self.dimension.pow(exponent);
        let (above, below) = if exponent < 0.0 { (self.down, self.up) } else { (self.up, self.down) };
        let size = exponent.abs();
        // 3·(1/3) is 1 in floating point too, and so for 6, 9 and 12: a root that is a power of ten stays one.
        let ten = f64::from(self.decimal) * exponent;
        let whole = ten.round();
        let left = ten - whole;
        let (up, down) = if size.fract() == 0.0 {
            (above.powi(size as u32), below.powi(size as u32))
        } else {
            let root = |base: Twofold| if base == Twofold::ONE { base } else { power(base, size) };
            (root(above), root(below))
        };
        let up = if left == 0.0 { up } else { up.mul(power(Twofold::TEN, left)) };
        Self { dimension, up, down, decimal: whole as i32, offset: None }
    }
}

fn power(base: Twofold, exponent: f64) -> Twofold {
    Twofold::from_f64(base.to_f64().powf(exponent))
}

pub(super) struct Parser<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
    exponents: Exponents<'a>,
}

impl<'a> Parser<'a> {
    /// The unit that `text` is from byte `start` to its end; byte ranges of errors count in `text`.
    pub(super) fn parse(text: &'a str, start: usize, exponents: Exponents<'a>) -> Result<Product, UnitError> {
        let mut parser = Self { text, at: start, depth: 0, exponents };
        let product = parser.product()?;
        match parser.peek() {
            None => Ok(product),
            Some(_) => Err(parser.unexpected("one of * · / or the end")),
        }
    }

    fn product(&mut self) -> Result<Product, UnitError> {
        let mut product = self.factor()?;
        loop {
            match self.peek() {
                Some(c @ ('*' | '\u{b7}' | '\u{22c5}' | '/')) => {
                    self.at += c.len_utf8();
                    let factor = self.factor()?;
                    product = product.times(if c == '/' { factor.pow(-1.0) } else { factor });
                }
                None | Some(')') => return Ok(product),
                Some(_) => return Err(self.unexpected("one of * · / or the end")),
            }
        }
    }

    fn factor(&mut self) -> Result<Product, UnitError> {
        let base = match self.peek() {
            Some('(') => {
                if self.depth == MAX_DEPTH {
                    return Err(UnitError::TooDeep { limit: MAX_DEPTH, at: self.at..self.at + 1 });
                }
                self.depth += 1;
                self.at += 1;
                let inside = self.product()?;
                self.close("a closing parenthesis")?;
                self.depth -= 1;
                inside
            }
            Some('%' | '1') => self.symbol(self.at..self.at + 1)?,
            Some(c) if starts_symbol(c) => {
                let rest = &self.text[self.at..];
                let len = rest.find(|c: char| !(starts_symbol(c) || c.is_alphanumeric())).unwrap_or(rest.len());
                self.symbol(self.at..self.at + len)?
            }
            Some(',') => return Err(self.unexpected("a unit (decimals are written with a point)")),
            _ => return Err(self.unexpected("a unit")),
        };
        match self.peek() {
            Some('^') => {
                self.at += 1;
                let exponent = self.exponent()?;
                Ok(base.pow(exponent))
            }
            _ => Ok(base),
        }
    }

    fn symbol(&mut self, at: Range<usize>) -> Result<Product, UnitError> {
        let symbol = &self.text[at.clone()];
        self.at = at.end;
        match symbols::lookup(symbol) {
            Some(Meaning { dimension, up, down, decimal, offset }) => {
                Ok(Product { dimension, up, down, decimal, offset })
            }
            None if expression::is_name(symbol) => Err(UnitError::ExpressionName { name: symbol.to_owned(), at }),
            None => {
                let suggestion = if symbol.len() <= 40 { symbols::suggest(symbol) } else { None };
                Err(UnitError::UnknownSymbol { symbol: symbol.to_owned(), suggestion, at })
            }
        }
    }

    /// `2`, `-0.5`, `1/2`, `alpha`, each also in parentheses.
    fn exponent(&mut self) -> Result<f64, UnitError> {
        let opened = self.peek() == Some('(');
        if opened {
            self.at += 1;
        }
        let first = self.peek();
        let start = self.at;
        let sign = if first == Some('-') { -1.0 } else { 1.0 };
        if matches!(first, Some('+' | '-')) {
            self.at += 1;
        }
        let size = match self.peek() {
            Some(c) if c.is_ascii_digit() || c == '.' => self.plain_exponent(start)?,
            Some(c) if c.is_ascii_alphabetic() || c == '_' => {
                let name = self.take_while(|c| c.is_ascii_alphanumeric() || c == '_');
                let at = self.at - name.len()..self.at;
                (self.exponents)(name).ok_or_else(|| UnitError::UnknownExponent { name: name.to_owned(), at })?
            }
            _ => return Err(self.unexpected("an exponent")),
        };
        let end = self.at;
        if opened {
            self.close("a closing parenthesis after the exponent")?;
        }
        // Also false for NaN.
        if size.abs() <= MAX_EXPONENT { Ok(sign * size) } else { Err(self.bad_exponent(start..end)) }
    }

    fn plain_exponent(&mut self, start: usize) -> Result<f64, UnitError> {
        let above = self.take_while(|c| c.is_ascii_digit() || c == '.');
        let mut size: f64 = above.parse().map_err(|_| self.bad_exponent(start..self.at))?;
        let after = self.text[self.at..].trim_start();
        let fraction = after.strip_prefix('/').map(str::trim_start);
        if let Some(below) = fraction.filter(|rest| rest.starts_with(|c: char| c.is_ascii_digit())) {
            self.at = self.text.len() - below.len();
            let below = self.take_while(|c| c.is_ascii_digit() || c == '.');
            size /= below.parse::<f64>().map_err(|_| self.bad_exponent(start..self.at))?;
        }
        Ok(size)
    }

    fn bad_exponent(&self, at: Range<usize>) -> UnitError {
        UnitError::BadExponent { text: self.text[at.clone()].to_owned(), at }
    }

    fn close(&mut self, wanted: &'static str) -> Result<(), UnitError> {
        if self.peek() != Some(')') {
            return Err(self.unexpected(wanted));
        }
        self.at += 1;
        Ok(())
    }

    /// The next character that is not blank.
    fn peek(&mut self) -> Option<char> {
        let rest = self.text[self.at..].trim_start();
        self.at = self.text.len() - rest.len();
        rest.chars().next()
    }

    fn take_while(&mut self, belongs: impl Fn(char) -> bool) -> &'a str {
        let rest = &self.text[self.at..];
        let taken = &rest[..rest.find(|c| !belongs(c)).unwrap_or(rest.len())];
        self.at += taken.len();
        taken
    }

    fn unexpected(&self, wanted: &'static str) -> UnitError {
        let text: String = self.text[self.at..].chars().take(1).collect();
        UnitError::Syntax { at: self.at..self.at + text.len(), text, wanted }
    }
}

/// Letters, and the signs that stand for letters in names of units.
pub(super) fn starts_symbol(c: char) -> bool {
    c.is_alphabetic() || matches!(c, '_' | '\u{b0}' | '\u{ba}')
}
