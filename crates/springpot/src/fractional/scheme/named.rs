//! Which schemes there are: their names, their numbers, and where they work.

use super::fbdf;
use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

/// A scheme for the fractional derivative or integral of samples.
///
/// Its name, by [`FromStr`](std::str::FromStr) and [`Display`](std::fmt::Display), is that of scenario files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Scheme {
    /// `grunwald-letnikov`: h^−a Σ w_k x_{n−k}, (1−z)^a = Σ w_k z^k; order 1 at fixed t > 0, equal steps.
    ///
    /// Riemann–Liouville sums x itself, so a constant is exact only to O(h/t); Caputo sums x − x(0), above a = 1
    /// x − x(0) − x'(0) t. I. Podlubny, *Fractional Differential Equations*, 1999, §7.
    GrunwaldLetnikov,
    /// `grunwald-letnikov(N)`: the sum cut after w_N, derivatives only; N from [`Scheme::MEMORY`].
    ///
    /// This is the derivative with the lower terminal t − L, L = N h. What was before costs up to max|x| L^−a/|Γ(1−a)|
    /// where Caputo counts x from x(0); 0 at a = 1 and 2. Work: rows × log rows, less for short memories. The principle
    /// of short memory: I. Podlubny, *Fractional Differential Equations*, 1999, §7.3. Integrals have no such limit:
    /// what is long past does not fade in them.
    ShortGrunwaldLetnikov(u32),
    /// `l1`: exact for the broken line through the samples; order 2 − a, integrals (the product trapezoidal rule) 2;
    /// any grid.
    ///
    /// Above a = 1 a broken line has no derivative at its kinks. Y. Lin, C. Xu, J. Comput. Phys. 225 (2007) 1533.
    L1,
    /// `l1-2`: exact for the parabolas through three samples each, a straight line in the first step; order 3 − a at
    /// fixed t > 0 (in the first rows 2 − a), integrals 3; any grid.
    ///
    /// G. Gao, Z. Sun, H. Zhang, J. Comput. Phys. 259 (2014) 33, for 0 < a < 1. The other orders take the same
    /// parabolas: above a = 1 the finite part of the integral, which counts the jumps of their slopes.
    L12,
    /// `fbdf-p`, p = 1 … 6: convolution quadrature of the backward difference formula of order p, equal steps.
    ///
    /// Starting weights make polynomials exact up to degree p (p − 1 for integrals, p + 1 above a = 1), so the order p
    /// holds in every row whatever x(0), x'(0), … are, as long as x is smooth. C. Lubich, SIAM J. Math. Anal. 17 (1986)
    /// 704.
    Fbdf(u8),
    /// `expansion-2004(N)`: the Atanacković–Stanković expansion with y', cut after N terms; any grid.
    ///
    /// Converges like N^{a−2} once N ≫ ωt and is useless before. Fract. Calc. Appl. Anal. 7 (2004) 365.
    Expansion2004(u32),
    /// `expansion-2008(N)`: the Atanacković–Stanković expansion without y', cut after N terms; any grid.
    ///
    /// Converges like N^{a−1} once N ≫ ωt and is useless before. Mech. Res. Commun. 35 (2008) 429.
    Expansion2008(u32),
}

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

    /// Admissible numbers of terms of the expansion with y'.
    pub const TERMS_2004: RangeInclusive<u32> = 2..=5000;
    /// Admissible numbers of terms of the expansion without y'.
    pub const TERMS_2008: RangeInclusive<u32> = 1..=5000;
    /// Admissible memories of the short Grünwald–Letnikov sum, in samples.
    pub const MEMORY: RangeInclusive<u32> = 2..=1_000_000_000;
    /// Orders of the fractional backward differences.
    pub const FBDF_ORDERS: RangeInclusive<u8> = 1..=6;

    /// Orders a of D^a that the scheme has.
    pub fn orders(self) -> RangeInclusive<f64> {
        match self {
            Self::GrunwaldLetnikov | Self::L12 | Self::Fbdf(_) => -2.0..=2.0,
            Self::ShortGrunwaldLetnikov(_) => 0.0..=2.0,
            Self::L1 => -2.0..=1.0,
            Self::Expansion2004(_) | Self::Expansion2008(_) => 0.0..=1.0,
        }
    }

    /// Theoretical order of convergence of D^a, a = `order`, for smooth x at fixed t > 0: in the step, for the
    /// expansions in 1/N; NaN outside [`Scheme::orders`].
    ///
    /// The error of the short memory does not fall with the step and is not counted. At a = 0 every scheme is exact. At
    /// a = 1 the expansions no longer expand: they are x', to order 4 in the step where no rates are given, while this
    /// number stays their limit.
    pub fn order(self, order: f64) -> f64 {
        if !self.orders().contains(&order) {
            return f64::NAN;
        }
        match self {
            Self::GrunwaldLetnikov | Self::ShortGrunwaldLetnikov(_) => 1.0,
            Self::L1 | Self::Expansion2004(_) => 2.0 - order.max(0.0),
            Self::L12 => 3.0 - order.max(0.0),
            Self::Fbdf(p) => f64::from(p),
            Self::Expansion2008(_) => 1.0 - order,
        }
    }

    /// Whether the rows must lie at k·step.
    pub fn needs_uniform_grid(self) -> bool {
        matches!(self, Self::GrunwaldLetnikov | Self::ShortGrunwaldLetnikov(_) | Self::Fbdf(_))
    }

    /// Fewest rows the scheme can work on: 2 for most, 3 above order 1, one more than the degree of the polynomial that
    /// the fractional backward difference starts with.
    pub fn min_rows(self, order: f64) -> usize {
        let any = if order > 1.0 { 3 } else { 2 };
        match self {
            Self::Fbdf(p) => any.max(fbdf::degree(p.into(), order) + 1),
            _ => any,
        }
    }

    /// Rows of the polynomial that x'(0) is taken from at order 1 and above, and x''(0) at order 2, so that they err like the scheme.
    pub(super) fn start_rows(self, order: f64) -> usize {
        match self {
            Self::Fbdf(_) => self.min_rows(order),
            Self::L12 => 3,
            Self::Expansion2004(_) | Self::Expansion2008(_) => 5,
            _ if order > 1.0 => 3,
            _ => 2,
        }
    }

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
        let number = |text: &str, (min, max): (u32, u32)| {
            if text.is_empty() || !text.bytes().all(|b| b.is_ascii_digit()) {
                return Err(unknown());
            }
            text.parse::<u32>().map_err(|_| SchemeNameError::Large { name: name.to_owned(), min, max })
        };
        let ends = |range: RangeInclusive<u32>| (*range.start(), *range.end());
        let argument = |form: &str| name.strip_prefix(form).and_then(|rest| rest.strip_prefix('(')?.strip_suffix(')'));
        let scheme = match name {
            "grunwald-letnikov" => Self::GrunwaldLetnikov,
            "l1" => Self::L1,
            "l1-2" => Self::L12,
            _ => {
                if let Some(order) = name.strip_prefix("fbdf-") {
                    let orders = Self::FBDF_ORDERS;
                    let order = number(order, ((*orders.start()).into(), (*orders.end()).into()))?;
                    Self::Fbdf(u8::try_from(order).map_err(|_| SchemeNameError::Order(order))?)
                } else if let Some(samples) = argument("grunwald-letnikov") {
                    Self::ShortGrunwaldLetnikov(number(samples, ends(Self::MEMORY))?)
                } else if let Some(terms) = argument("expansion-2004") {
                    Self::Expansion2004(number(terms, ends(Self::TERMS_2004))?)
                } else if let Some(terms) = argument("expansion-2008") {
                    Self::Expansion2008(number(terms, ends(Self::TERMS_2008))?)
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

/// A scheme's name or number that does not exist.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SchemeNameError {
    /// No scheme has this name.
    #[error(
        "unknown scheme \"{0}\": right are grunwald-letnikov, grunwald-letnikov(N) with N ≥ {memory}, l1, l1-2, \
         fbdf-1 to fbdf-6, expansion-2004(N) with N from {min_2004} to {max} and expansion-2008(N) with N from \
         {min_2008} to {max}",
        memory = Scheme::MEMORY.start(),
        min_2004 = Scheme::TERMS_2004.start(), min_2008 = Scheme::TERMS_2008.start(), max = Scheme::TERMS_2008.end()
    )]
    Unknown(String),
    /// Fractional backward differences have order 1 to 6.
    #[error("fbdf-{0} does not exist: the order of the fractional backward difference is 1 to 6")]
    Order(u32),
    /// The short memory's number of samples is out of range.
    #[error(
        "grunwald-letnikov({0}): the memory must have {min} to {max} samples",
        min = Scheme::MEMORY.start(), max = Scheme::MEMORY.end()
    )]
    Memory(u32),
    /// A number that is too large to be told as one.
    #[error("{name} does not exist: its number must lie between {min} and {max}")]
    Large {
        /// As it was asked for.
        name: String,
        /// The smallest that exists.
        min: u32,
        /// The largest.
        max: u32,
    },
    /// The expansion's number of terms is out of range.
    #[error("expansion-{form}({terms}): the number of terms must lie between {min} and {max}")]
    Terms {
        /// Year of the form: 2004 or 2008.
        form: u16,
        /// What was asked for.
        terms: u32,
        /// Fewest terms.
        min: u32,
        /// Most terms.
        max: u32,
    },
}
