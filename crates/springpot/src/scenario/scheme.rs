//! Names of the schemes that evaluate an element's memory.

use std::fmt;

/// Most terms of an expansion.
pub const MAX_TERMS: u32 = 10_000;

/// How an element's D^alpha is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scheme {
    /// `exact`: the memory of the library, which chooses its own steps to meet `rtol`.
    #[default]
    Exact,
    /// `grunwald-letnikov`, order 1, on the output grid.
    GrunwaldLetnikov,
    /// `l1`, order 2 − alpha, on the output grid.
    L1,
    /// `l1-2`, order 3 − alpha, on the output grid.
    L12,
    /// `fbdf-1` … `fbdf-6`: fractional backward differences of that order, on the output grid.
    Fbdf(u8),
    /// `expansion-2004(N)`: the expansion of Atanacković and Stanković with N terms.
    Expansion2004(u32),
    /// `expansion-2008(N)`: its later form with N terms.
    Expansion2008(u32),
}

/// Why a text names no scheme.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SchemeError {
    /// No such scheme.
    #[error("{name:?} is not a scheme")]
    Unknown {
        /// The name as written.
        name: String,
    },
    /// An expansion without its number of terms.
    #[error("{name} needs its number of terms, as in {name}(30)")]
    NoTerms {
        /// Name of the expansion.
        name: &'static str,
    },
    /// A number of terms that is none, too small or too large.
    #[error("{terms:?} is not a number of terms from 1 to {MAX_TERMS}")]
    BadTerms {
        /// The text between the parentheses.
        terms: String,
    },
}

impl Scheme {
    /// The names that [`Scheme::parse`] reads.
    pub const NAMES: [&str; 12] = [
        "exact",
        "grunwald-letnikov",
        "l1",
        "l1-2",
        "fbdf-1",
        "fbdf-2",
        "fbdf-3",
        "fbdf-4",
        "fbdf-5",
        "fbdf-6",
        "expansion-2004(N)",
        "expansion-2008(N)",
    ];

    /// Reads a scheme's name.
    ///
    /// # Errors
    /// [`SchemeError`] for unknown names and for numbers of terms outside 1 … [`MAX_TERMS`].
    pub fn parse(text: &str) -> Result<Self, SchemeError> {
        for (name, make) in
            [("expansion-2004", Self::Expansion2004 as fn(u32) -> Self), ("expansion-2008", Self::Expansion2008)]
        {
            let Some(rest) = text.strip_prefix(name) else { continue };
            if rest.is_empty() {
                return Err(SchemeError::NoTerms { name });
            }
            let Some(terms) = rest.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')) else { break };
            return match terms.trim().parse() {
                Ok(n) if (1..=MAX_TERMS).contains(&n) => Ok(make(n)),
                _ => Err(SchemeError::BadTerms { terms: terms.chars().take(30).collect() }),
            };
        }
        Ok(match text {
            "exact" => Self::Exact,
            "grunwald-letnikov" => Self::GrunwaldLetnikov,
            "l1" => Self::L1,
            "l1-2" => Self::L12,
            "fbdf-1" => Self::Fbdf(1),
            "fbdf-2" => Self::Fbdf(2),
            "fbdf-3" => Self::Fbdf(3),
            "fbdf-4" => Self::Fbdf(4),
            "fbdf-5" => Self::Fbdf(5),
            "fbdf-6" => Self::Fbdf(6),
            _ => return Err(SchemeError::Unknown { name: text.chars().take(60).collect() }),
        })
    }
}

impl fmt::Display for Scheme {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Exact => f.write_str("exact"),
            Self::GrunwaldLetnikov => f.write_str("grunwald-letnikov"),
            Self::L1 => f.write_str("l1"),
            Self::L12 => f.write_str("l1-2"),
            Self::Fbdf(order) => write!(f, "fbdf-{order}"),
            Self::Expansion2004(terms) => write!(f, "expansion-2004({terms})"),
            Self::Expansion2008(terms) => write!(f, "expansion-2008({terms})"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_reads_back() {
        for name in Scheme::NAMES {
            let name = name.replace('N', "30");
            assert_eq!(Scheme::parse(&name).unwrap().to_string(), name);
        }
    }

    #[test]
    fn wrong_names_are_refused() {
        for (text, message) in [
            ("fbdf-7", "\"fbdf-7\" is not a scheme"),
            ("", "\"\" is not a scheme"),
            ("expansion-2004", "needs its number of terms, as in expansion-2004(30)"),
            ("expansion-2004(0)", "\"0\" is not a number of terms from 1 to 10000"),
            ("expansion-2008(10001)", "is not a number of terms"),
            ("expansion-2008(-1)", "is not a number of terms"),
            ("expansion-2008(7", "is not a scheme"),
        ] {
            let error = Scheme::parse(text).unwrap_err().to_string();
            assert!(error.contains(message), "{text}: {error}");
        }
    }
}
