//! The number of a quantity: sign, digits, decimal point, exponent.

use super::twofold::Twofold;
use springpot::signal::expression::number_length;

/// A decimal number taken apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Decimal<'a> {
    negative: bool,
    whole: &'a str,
    fraction: &'a str,
    /// Power of ten as written, held within ±1e6.
    exponent: i32,
    /// Bytes of the text that belong to it.
    pub(super) len: usize,
}

const MINUS_SIGN: char = '\u{2212}';

impl<'a> Decimal<'a> {
    /// The number that `text` starts with: `[+-]digits[.digits][e[+-]digits]`, at least one digit before the exponent.
    pub(super) fn scan(text: &'a str) -> Option<Self> {
        let (negative, start) = match text.chars().next()? {
            '+' => (false, 1),
            '-' => (true, 1),
            MINUS_SIGN => (true, MINUS_SIGN.len_utf8()),
            _ => (false, 0),
        };
        let len = start + number_length(&text[start..])?;
        let (digits, power) = text[start..len].split_once(['e', 'E']).unwrap_or((&text[start..len], "0"));
        let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
        let (sign, size) = match power.strip_prefix('-') {
            Some(size) => (-1, size),
            None => (1, power.trim_start_matches('+')),
        };
        // Saturates: what is beyond 1e±400 is zero or infinite however far beyond.
        let size = size.bytes().fold(0_i32, |n, b| (10 * n + i32::from(b - b'0')).min(1_000_000));
        let exponent = sign * size;
        Some(Self { negative, whole, fraction, exponent, len })
    }

    /// number·10^shift, correctly rounded.
    pub(super) fn to_f64(self, shift: i32) -> f64 {
        let sign = if self.negative { "-" } else { "" };
        let Self { whole, fraction, exponent, .. } = self;
        format!("{sign}0{whole}.{fraction}0e{}", exponent.saturating_add(shift)).parse().unwrap_or(f64::NAN)
    }

    /// The number to 106 bits where it has at most 31 digits, otherwise correctly rounded to 53.
    pub(super) fn to_twofold(self) -> Twofold {
        let rounded = self.to_f64(0);
        let whole = self.whole.trim_start_matches('0');
        let power = self.exponent - self.fraction.len() as i32;
        if whole.len() + self.fraction.len() > 31 || power.abs() > 250 || !rounded.is_normal() {
            return Twofold::from_f64(rounded);
        }
        let digits = whole.bytes().chain(self.fraction.bytes());
        let integer = digits.fold(0_u128, |n, b| 10 * n + u128::from(b - b'0'));
        let size = Twofold::from_integer(integer).scaled_by_ten(power);
        if self.negative { size.negated() } else { size }
    }
}

#[cfg(test)]
mod tests {
    use super::Decimal;

    #[test]
    fn scans_the_longest_number() {
        for (text, len, value) in [
            ("60", 2, 60.0),
            ("5e-3 m", 4, 0.005),
            ("5e", 1, 5.0),
            ("5e+", 1, 5.0),
            ("-.5x", 3, -0.5),
            ("5.", 2, 5.0),
            ("\u{2212}3 mm", 4, -3.0),
            ("1e999999999999", 14, f64::INFINITY),
            ("1e-999999999999", 15, 0.0),
            ("007.250", 7, 7.25),
        ] {
            let number = Decimal::scan(text).unwrap();
            assert_eq!((number.len, number.to_f64(0), number.to_twofold().to_f64()), (len, value, value), "{text}");
        }
        for text in ["", "-", ".", "+.e3", "e5", "t", "- 3", "nan", "inf"] {
            assert_eq!(Decimal::scan(text), None, "{text}");
        }
    }
}
