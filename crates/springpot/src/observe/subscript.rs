//! Names of joints as indices.

/// `q2` becomes ₂, other names " at NAME".
pub(super) fn at_joint(label: &str) -> String {
    match label.strip_prefix('q').filter(|rest| !rest.is_empty() && rest.chars().all(|c| c.is_ascii_digit())) {
        Some(digits) => subscript(digits),
        None => format!(" at {label}"),
    }
}

/// Digits as an index: `12` becomes ₁₂; other characters stay.
pub fn subscript(digits: &str) -> String {
    digits.chars().map(|c| c.to_digit(10).and_then(|d| char::from_u32('₀' as u32 + d)).unwrap_or(c)).collect()
}
