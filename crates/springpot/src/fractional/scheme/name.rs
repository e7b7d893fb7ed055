//! Names of the schemes, as scenario files and the command line write them.

use super::Scheme;
use super::error::SchemeNameError;
use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

impl Scheme {
    /// All names, for lists and suggestions; N stands for a number of samples or of terms.
    pub const NAMES: [&str; 12] = [
        "grunwald-letnikov",
        "grunwald-letnikov(N)",
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

    /// Checks the numbers that the type leaves open.
    ///
    /// # Errors
    /// `Order`, `Memory` and `Terms`.
    pub fn check(self) -> Result<Self, SchemeNameError> {
        let terms_in = |form, terms, range: RangeInclusive<u32>| {
            let (min, max) = (*range.start(), *range.end());
            if range.contains(&terms) { Ok(self) } else { Err(SchemeNameError::Terms { form, terms, min, max }) }
        };
        match self {
            Self::Fbdf(order) if !Self::FBDF_ORDERS.contains(&order) => Err(SchemeNameError::Order(order.into())),
            Self::ShortGrunwaldLetnikov(samples) if !Self::MEMORY.contains(&samples) => {
                Err(SchemeNameError::Memory(samples))
            }
            Self::Expansion2004(terms) => terms_in(2004, terms, Self::TERMS_2004),
            Self::Expansion2008(terms) => terms_in(2008, terms, Self::TERMS_2008),
            _ => Ok(self),
        }
    }
}

impl fmt::Display for Scheme {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::GrunwaldLetnikov => f.pad("grunwald-letnikov"),
            Self::ShortGrunwaldLetnikov(samples) => f.pad(&format!("grunwald-letnikov({samples})")),
            Self::L1 => f.pad("l1"),
            Self::L12 => f.pad("l1-2"),
            Self::Fbdf(order) => f.pad(&format!("fbdf-{order}")),
            Self::Expansion2004(terms) => f.pad(&format!("expansion-2004({terms})")),
            Self::Expansion2008(terms) => f.pad(&format!("expansion-2008({terms})")),
        }
    }
}

impl FromStr for Scheme {
    type Err = SchemeNameError;

    fn from_str(name: &str) -> Result<Self, SchemeNameError> {
        let unknown = || SchemeNameError::Unknown(name.to_owned());
        // Digits alone: no sign, no blank.
        let number = |text: &str| {
            if text.is_empty() || !text.bytes().all(|b| b.is_ascii_digit()) {
                return Err(unknown());
            }
            Ok(text.parse().unwrap_or(u32::MAX))
        };
        let argument = |form: &str| name.strip_prefix(form).and_then(|rest| rest.strip_prefix('(')?.strip_suffix(')'));
        let scheme = match name {
            "grunwald-letnikov" => Self::GrunwaldLetnikov,
            "l1" => Self::L1,
            "l1-2" => Self::L12,
            _ => {
                if let Some(order) = name.strip_prefix("fbdf-") {
                    let order = number(order)?;
                    Self::Fbdf(u8::try_from(order).map_err(|_| SchemeNameError::Order(order))?)
                } else if let Some(samples) = argument("grunwald-letnikov") {
                    Self::ShortGrunwaldLetnikov(number(samples)?)
                } else if let Some(terms) = argument("expansion-2004") {
                    Self::Expansion2004(number(terms)?)
                } else if let Some(terms) = argument("expansion-2008") {
                    Self::Expansion2008(number(terms)?)
                } else {
                    return Err(unknown());
                }
            }
        };
        scheme.check()
    }
}

impl TryFrom<String> for Scheme {
    type Error = SchemeNameError;

    fn try_from(name: String) -> Result<Self, SchemeNameError> {
        name.parse()
    }
}

impl From<Scheme> for String {
    fn from(scheme: Scheme) -> Self {
        scheme.to_string()
    }
}
