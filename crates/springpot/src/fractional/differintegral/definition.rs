//! The three definitions of a derivative of any order.

use crate::fractional::kind::Kind;
use std::fmt;
use std::str::FromStr;

/// Definition of D^a for −2 ≤ a ≤ 2 with lower terminal 0.
///
/// With n = ⌈a⌉ and I^b x(t) = 1/Γ(b) ∫₀ᵗ (t−s)^{b−1} x(s) ds:
///
/// | | 0 < a < 2 | a = 0 |
/// |---|---|---|
/// | Caputo | I^{n−a} x⁽ⁿ⁾ | x − x(0), the limit from above |
/// | Riemann–Liouville | (I^{n−a} x)⁽ⁿ⁾ = Caputo + Σ_{k<n} x⁽ᵏ⁾(0) t^{k−a}/Γ(k+1−a) | x |
/// | Grünwald–Letnikov | lim h^−a Σ_k (−1)^k binom(a, k) x(t−kh), x = 0 before t = 0 | x |
///
/// For a < 0 all three are I^{−a} x; at a = 1 and 2 they are x' and x''. The Grünwald–Letnikov limit is the
/// Riemann–Liouville derivative wherever x is as often differentiable as the order asks (I. Podlubny, *Fractional
/// Differential Equations*, 1999, §2.2), so the two share their numbers; only the scheme of this name stops before the
/// limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Definition {
    /// x was held at x(0), for a > 1 moved on along x(0) + x'(0)·t, before t = 0: never singular.
    #[default]
    Caputo,
    /// x was 0 before t = 0 and jumped to x(0): singular at 0+ like t^−a where x(0) ≠ 0.
    RiemannLiouville,
    /// The limit of the difference quotients, equal to Riemann–Liouville for smooth x.
    GrunwaldLetnikov,
}

impl Definition {
    /// All definitions, for lists and suggestions.
    pub const ALL: [Self; 3] = [Self::Caputo, Self::RiemannLiouville, Self::GrunwaldLetnikov];

    /// `caputo`, `riemann-liouville` or `grunwald-letnikov`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Caputo => "caputo",
            Self::RiemannLiouville => "riemann-liouville",
            Self::GrunwaldLetnikov => "grunwald-letnikov",
        }
    }

    /// What the named schemes make of it.
    pub fn kind(self) -> Kind {
        match self {
            Self::Caputo => Kind::Caputo,
            Self::RiemannLiouville | Self::GrunwaldLetnikov => Kind::RiemannLiouville,
        }
    }
}

impl fmt::Display for Definition {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A definition of this name does not exist.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("unknown definition \"{0}\": right are caputo, riemann-liouville and grunwald-letnikov")]
pub struct DefinitionNameError(pub String);

impl FromStr for Definition {
    type Err = DefinitionNameError;

    fn from_str(name: &str) -> Result<Self, DefinitionNameError> {
        let found = Self::ALL.into_iter().find(|definition| definition.name() == name);
        found.ok_or_else(|| DefinitionNameError(name.to_owned()))
    }
}
