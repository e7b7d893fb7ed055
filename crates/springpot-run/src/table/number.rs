//! Numbers as the shortest text that reads back to the same bits.

use std::fmt::Write;

/// Appends `value`; nothing for NaN and infinities, which stand for "no value here".
pub fn push_number(text: &mut String, value: f64) {
    if !value.is_finite() {
        return;
    }
    let magnitude = value.abs();
    // Rust prints the shortest digits in either notation; plain notation only where it is not longer.
    let plain = magnitude == 0.0 || (1e-4..1e16).contains(&magnitude);
    let written = if plain { write!(text, "{value}") } else { write!(text, "{value:e}") };
    written.expect("writing to a string cannot fail");
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

    proptest! {
        #![proptest_config(ProptestConfig { cases: 5000, failure_persistence: None, ..ProptestConfig::default() })]
        #[test]
        fn reads_back_to_the_same_bits(bits in any::<u64>()) {
            let value = f64::from_bits(bits);
            prop_assume!(value.is_finite());
            let mut text = String::new();
            push_number(&mut text, value);
            prop_assert_eq!(text.parse::<f64>().unwrap().to_bits(), bits);
            prop_assert!(text.len() <= 24);
        }
    }
}
