//! Results: columns with units, numbers as text, statistics.

#[cfg(feature = "scenario")]
pub mod disk;
#[cfg(feature = "scenario")]
pub mod folder;
#[cfg(feature = "scenario")]
mod format;
#[cfg(feature = "scenario")]
mod npz;
pub mod number;
pub mod ordered;
#[cfg(feature = "scenario")]
mod parquet;
#[cfg(feature = "scenario")]
pub(crate) mod sealed;
pub mod statistics;
pub mod text;

#[cfg(feature = "scenario")]
pub use format::Format;
pub use number::{push_fields, push_number};
pub use statistics::Statistics;
pub use text::{push_text, quoted};

use serde::Serialize;

/// One column of the results.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Column {
    /// Name, such as `strut.Q.q2`.
    pub name: String,
    /// SI unit; empty for a pure number.
    pub unit: String,
    /// What it holds, in a few words.
    pub meaning: String,
}

impl Column {
    /// A column.
    pub fn new(name: impl Into<String>, unit: impl Into<String>, meaning: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into(), meaning: meaning.into() }
    }
}

/// Whether `name` matches a pattern in which `*` stands for any run of characters and `?` for one.
pub fn matches(pattern: &str, name: &str) -> bool {
    let (pattern, name): (Vec<char>, Vec<char>) = (pattern.chars().collect(), name.chars().collect());
    let (mut p, mut n) = (0, 0);
    // The last star, and how much of the name it has taken.
    let mut star: Option<(usize, usize)> = None;
    while n < name.len() {
        match pattern.get(p) {
            Some('*') => {
                star = Some((p, n));
                p += 1;
            }
            Some(c) if *c == '?' || *c == name[n] => {
                p += 1;
                n += 1;
            }
            _ => {
                let Some((at, taken)) = star else { return false };
                star = Some((at, taken + 1));
                p = at + 1;
                n = taken + 1;
            }
        }
    }
    pattern[p..].iter().all(|c| *c == '*')
}

#[cfg(test)]
mod tests {
    use super::matches;

    #[test]
    fn globs() {
        for (pattern, name, expected) in [
            ("strut.*", "strut.Q.q2", true),
            ("*.q2", "strut.Q.q2", true),
            ("strut.Q.q?", "strut.Q.q2", true),
            ("*", "", true),
            ("**a*b", "xxaxxb", true),
            ("strut", "strut.Q", false),
            ("", "t", false),
            ("a*b*c", "abcbd", false),
        ] {
            assert_eq!(matches(pattern, name), expected, "{pattern} {name}");
        }
    }
}
