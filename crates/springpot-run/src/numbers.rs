//! Numbers and counts as a reader wants them.

/// Six significant digits, without trailing zeros.
pub fn short(value: f64) -> String {
    digits(value, 5)
}

/// Five significant digits, for tables.
pub fn brief(value: f64) -> String {
    digits(value, 4)
}

/// Two significant digits, for shares and errors.
pub fn rough(value: f64) -> String {
    digits(value, 1)
}

/// One digit before the point and `behind` it, without trailing zeros.
fn digits(value: f64, behind: usize) -> String {
    let rounded: f64 = format!("{value:.behind$e}").parse().unwrap_or(value);
    if rounded == 0.0 || (1e-3..1e6).contains(&rounded.abs()) { format!("{rounded}") } else { format!("{rounded:e}") }
}

/// `1 row`, `2 rows`.
pub fn count(number: impl TryInto<u64>, one: &str, many: &str) -> String {
    match number.try_into().unwrap_or(u64::MAX) {
        1 => format!("1 {one}"),
        number => format!("{number} {many}"),
    }
}

/// A number with four digits.
pub fn four(value: f64) -> String {
    short(format!("{value:.3e}").parse().unwrap_or(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(short(-0.342_857_142), "-0.342857");
        assert_eq!(short(1.000_000_000_000_000_1e-11), "1e-11");
        assert_eq!(short(0.0), "0");
        assert_eq!(short(0.1 + 0.2), "0.3");
        assert_eq!(rough(1.76e-9), "1.8e-9");
        assert_eq!(count(1u64, "row", "rows"), "1 row");
        assert_eq!(count(0usize, "row", "rows"), "0 rows");
    }
}
