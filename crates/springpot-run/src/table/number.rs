//! Numbers as the shortest text that reads back to the same bits.

use std::fmt::Write;

/// Appends `value`; nothing for NaN and infinities, which stand for "no value here".
///
/// The digits are the fewest that read back to `value`, and of those the nearest to it. From 1e-4 up to 1e16, and for ±0, they stand without an
/// exponent: `0.1`, `10`, `-0`, but `-2.5e-7`, `1e300`.
pub fn push_number(text: &mut String, value: f64) {
    if !value.is_finite() {
        return;
    }
    if is_between_digits(value) {
        let written = match has_plain_notation(value) {
            true => write!(text, "{value}"),
            false => write!(text, "{value:e}"),
        };
        return written.expect("writing to a string cannot fail");
    }
    let mut buffer = zmij::Buffer::new();
    // Without an exponent from 1e-5 up to 1e16, and then always with a point; above with `e+`.
    let written = buffer.format_finite(value);
    let magnitude = value.abs();
    if has_plain_notation(value) {
        text.push_str(written.strip_suffix(".0").unwrap_or(written));
    } else if magnitude < 1e-5 {
        text.push_str(written);
    } else if let Some((digits, exponent)) = written.split_once('+') {
        text.push_str(digits);
        text.push_str(exponent);
    } else if let Some((sign, digits)) = written.split_once("0.0000") {
        let (first, others) = digits.split_at(1);
        text.push_str(sign);
        text.push_str(first);
        if !others.is_empty() {
            text.push('.');
            text.push_str(others);
        }
        text.push_str("e-5");
    }
}

fn has_plain_notation(value: f64) -> bool {
    value == 0.0 || (1e-4..1e16).contains(&value.abs())
}

/// Whether `value` may lie in the middle between two numbers of 16 or 17 digits, of which the standard library takes the larger and others the even one.
///
/// m 2^e with m odd is there in units of 10^−k only where 2 m 2^e 10^k is odd: e + k + 1 = 0.
fn is_between_digits(value: f64) -> bool {
    let (bits, magnitude) = (value.to_bits(), value.abs());
    let significand = bits & ((1 << 52) - 1) | 1 << 52;
    let exponent = (bits >> 52 & 0x7ff) as i32 - 1075 + significand.trailing_zeros() as i32;
    let k = -exponent - 1;
    // 5^k divides m, or is below 2e17.
    (-22..=24).contains(&k) && (0.9e15..1.1e17).contains(&(magnitude * 10f64.powi(k)))
}

/// Appends numbers as fields, each with its comma in front.
pub fn push_fields(line: &mut String, values: impl Iterator<Item = f64>) {
    for value in values {
        line.push(',');
        push_number(line, value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn shortest_text() {
        let text = |value: f64| {
            let mut text = String::new();
            push_number(&mut text, value);
            text
        };
        assert_eq!(text(0.1), "0.1");
        assert_eq!(text(10.0), "10");
        assert_eq!(text(-2.5e-7), "-2.5e-7");
        assert_eq!(text(1e300), "1e300");
        assert_eq!(text(f64::NAN), "");
        assert_eq!(text(f64::NEG_INFINITY), "");
    }

    /// What the standard library writes in the same notation: an oracle of another algorithm.
    fn of_the_standard_library(value: f64) -> String {
        match value.abs() {
            magnitude if !magnitude.is_finite() => String::new(),
            magnitude if magnitude == 0.0 || (1e-4..1e16).contains(&magnitude) => format!("{value}"),
            _ => format!("{value:e}"),
        }
    }

    #[test]
    fn borders_of_notations_and_of_numbers() {
        let powers = (-324..=308).map(|power| format!("1e{power}").parse::<f64>().unwrap());
        let twos = (0..=2046u64).map(|exponent| f64::from_bits(exponent << 52));
        let subnormals = (0..64).map(|bit| f64::from_bits(1 << bit)).chain([4.94e-322, 1.5e-310]);
        let others = [
            0.0,
            0.5,
            1e21,
            123_456_789_012_345_680.0,
            9_007_199_254_740_993.0,
            2.5e-5,
            f64::MAX,
            f64::INFINITY,
            f64::NAN,
        ];
        for value in powers.chain(twos).chain(subnormals).chain(others) {
            for value in [value, value.next_up(), value.next_down()] {
                for value in [value, -value] {
                    let mut text = String::new();
                    push_number(&mut text, value);
                    assert_eq!(text, of_the_standard_library(value), "{:#x}", value.to_bits());
                }
            }
        }
    }

    #[test]
    fn halves_of_the_last_digit_go_up() {
        let mut halves = 0;
        for k in -22..=24i32 {
            for share in 1..400 {
                let wanted = 1e15 * 1.011f64.powi(share);
                let m = (wanted * 2.0 / 10f64.powi(k) * 2f64.powi(k)).round();
                let value = m * 2f64.powi(-k - 1);
                halves += usize::from(is_between_digits(value));
                for value in [value, -value] {
                    let mut text = String::new();
                    push_number(&mut text, value);
                    assert_eq!(text, of_the_standard_library(value), "{:#x}", value.to_bits());
                }
            }
        }
        assert!(halves > 3000, "{halves}");
        let mut text = String::new();
        push_number(&mut text, "1.03855133056640625".parse().unwrap());
        assert_eq!(text, "1.0385513305664063");
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 5000, failure_persistence: None, ..ProptestConfig::default() })]
        #[test]
        fn reads_back_to_the_same_bits(bits in prop_oneof![any::<u64>(), any::<f64>().prop_map(f64::to_bits), (-2e5..2e5).prop_map(f64::to_bits)]) {
            let value = f64::from_bits(bits);
            prop_assume!(value.is_finite());
            let mut text = String::new();
            push_number(&mut text, value);
            prop_assert_eq!(text.parse::<f64>().unwrap().to_bits(), bits);
            prop_assert_eq!(&text, &of_the_standard_library(value));
            prop_assert!(text.len() <= 24);
        }
    }
}
