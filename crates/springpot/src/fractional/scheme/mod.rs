//! Named schemes for D^alpha of samples, for comparison with the literature and for those who need one of them.
//!
//! | name | order on smooth x | grid |
//! |---|---|---|
//! | `grunwald-letnikov` | 1 | equal steps |
//! | `l1` | 2 − alpha | any |
//! | `l1-2` | 3 − alpha | any |
//! | `fbdf-1` … `fbdf-6` | 1 … 6 | equal steps |
//! | `expansion-2004(N)` | 2 − alpha in 1/N | any |
//! | `expansion-2008(N)` | 1 − alpha in 1/N | any |
//!
//! On equal steps all but the expansions take O(N log N) operations by FFT. All start at t = 0 and know nothing of what
//! was before.

mod convolution;
mod error;
mod expansion;
mod fbdf;
mod grunwald_letnikov;
mod l1;
mod l12;
mod rates;
mod samples;

pub use convolution::{causal_convolution, direct_convolution};
pub use error::{SchemeError, SchemeNameError};
pub use rates::differenced_rates;
pub use samples::{Samples, UniformPrefix};

use super::Kind;
use super::gamma::reciprocal_gamma;
use expansion::Form;
use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

/// A scheme for the fractional derivative of samples.
///
/// Its name, by [`FromStr`] and [`Display`](fmt::Display), is that of scenario files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Scheme {
    /// `grunwald-letnikov`: h^−alpha Σ w_k x_{n−k}, (1−z)^alpha = Σ w_k z^k; order 1 at fixed t > 0, equal steps.
    ///
    /// Riemann–Liouville sums x itself, so a constant is exact only to O(h/t); Caputo sums x − x(0).
    /// I. Podlubny, *Fractional Differential Equations*, 1999, §7.
    GrunwaldLetnikov,
    /// `l1`: exact for the broken line through the samples; order 2 − alpha, any grid.
    ///
    /// Y. Lin, C. Xu, J. Comput. Phys. 225 (2007) 1533.
    L1,
    /// `l1-2`: exact for the parabolas through three samples each, a straight line in the first step; order 3 − alpha at
    /// fixed t > 0 (2 − alpha in the first rows), any grid.
    ///
    /// G. Gao, Z. Sun, H. Zhang, J. Comput. Phys. 259 (2014) 33.
    L12,
    /// `fbdf-p`, p = 1 … 6: convolution quadrature of the backward difference formula of order p, equal steps.
    ///
    /// Starting weights make polynomials up to degree p exact, so the order p holds in every row whatever x(0), x'(0), …
    /// are, as long as x is smooth. C. Lubich, SIAM J. Math. Anal. 17 (1986) 704.
    Fbdf(u8),
    /// `expansion-2004(N)`: the Atanacković–Stanković expansion with y', cut after N terms; any grid.
    ///
    /// Converges like N^{alpha−2} once N ≫ ωt and is useless before. Fract. Calc. Appl. Anal. 7 (2004) 365.
    Expansion2004(u32),
    /// `expansion-2008(N)`: the Atanacković–Stanković expansion without y', cut after N terms; any grid.
    ///
    /// Converges like N^{alpha−1} once N ≫ ωt and is useless before. Mech. Res. Commun. 35 (2008) 429.
    Expansion2008(u32),
}

impl Scheme {
    /// Admissible numbers of terms of the expansion with y'.
    pub const TERMS_2004: RangeInclusive<u32> = 2..=5000;
    /// Admissible numbers of terms of the expansion without y'.
    pub const TERMS_2008: RangeInclusive<u32> = 1..=5000;
    /// All names, for lists and suggestions; N stands for a number of terms.
    pub const NAMES: [&str; 11] = [
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
    /// Orders of the fractional backward differences.
    pub const FBDF_ORDERS: RangeInclusive<u8> = 1..=6;

    /// Theoretical order of convergence for smooth x at 0 < alpha ≤ 1: in the step, for the expansions in 1/N.
    ///
    /// At alpha = 0 every scheme is exact. At alpha = 1 the expansions no longer expand: they are x', to order 4 in the
    /// step where no rates are given, while this number stays their limit.
    pub fn order(self, alpha: f64) -> f64 {
        match self {
            Self::GrunwaldLetnikov => 1.0,
            Self::L1 | Self::Expansion2004(_) => 2.0 - alpha,
            Self::L12 => 3.0 - alpha,
            Self::Fbdf(order) => f64::from(order),
            Self::Expansion2008(_) => 1.0 - alpha,
        }
    }

    /// Whether the rows must lie at k·step.
    pub fn needs_uniform_grid(self) -> bool {
        matches!(self, Self::GrunwaldLetnikov | Self::Fbdf(_))
    }

    /// Fewest rows the scheme can work on.
    pub fn min_rows(self) -> usize {
        match self {
            Self::Fbdf(order) => usize::from(order) + 1,
            _ => 2,
        }
    }

    /// Checks the numbers that the type leaves open.
    ///
    /// # Errors
    /// `Order` and `Terms`.
    pub fn check(self) -> Result<Self, SchemeNameError> {
        let terms_in = |form, terms, range: RangeInclusive<u32>| {
            let (min, max) = (*range.start(), *range.end());
            if range.contains(&terms) { Ok(self) } else { Err(SchemeNameError::Terms { form, terms, min, max }) }
        };
        match self {
            Self::Fbdf(order) if !Self::FBDF_ORDERS.contains(&order) => Err(SchemeNameError::Order(order.into())),
            Self::Expansion2004(terms) => terms_in(2004, terms, Self::TERMS_2004),
            Self::Expansion2008(terms) => terms_in(2008, terms, Self::TERMS_2008),
            _ => Ok(self),
        }
    }

    /// D^alpha x at every sample, 0 ≤ alpha ≤ 1.
    ///
    /// - alpha = 0: x (Riemann–Liouville) or x − x(0) (Caputo), exactly.
    /// - 0 < alpha < 1: row 0 is 0; with Riemann–Liouville and x(0) ≠ 0 the derivative is singular there and the row is
    ///   NaN. All schemes but Grünwald–Letnikov add the singular term x(0) t^−alpha/Γ(1−alpha) in closed form. The test
    ///   is x(0) ≠ 0 to the bit: round what counts as 0 before.
    /// - alpha = 1: x' as the formula gives it: backward differences of the scheme's order, for the expansions the rate
    ///   itself. Row 0 is the rate where it is given, else a one-sided difference of matching order.
    ///
    /// `l1` and `l1-2` sum rows off the leading uniform grid directly, in O(rows) each, up to 2·10⁸ terms in all: 20 000
    /// rows at random times, or any number of equal steps and one shorter last step.
    ///
    /// # Errors
    /// Every variant of [`SchemeError`]; each names the row to mend.
    pub fn differentiate(self, samples: &Samples, alpha: f64, kind: Kind) -> Result<Vec<f64>, SchemeError> {
        self.check()?;
        if !(0.0..=1.0).contains(&alpha) {
            return Err(SchemeError::Alpha(alpha));
        }
        samples.check(self)?;
        let Samples { t, x, rate } = *samples;
        let start = x[0];
        if alpha == 0.0 {
            return Ok(match kind {
                Kind::Caputo => x.iter().map(|x| x - start).collect(),
                Kind::RiemannLiouville => x.to_vec(),
            });
        }

        let mut y = match self {
            Self::GrunwaldLetnikov => {
                let before = if kind == Kind::Caputo { start } else { 0.0 };
                grunwald_letnikov::differentiate(self.uniform_step(samples)?, x, before, alpha)
            }
            Self::L1 => l1::caputo(samples, alpha)?,
            Self::L12 => l12::caputo(samples, alpha)?,
            Self::Fbdf(order) => fbdf::caputo(order.into(), self.uniform_step(samples)?, x, alpha),
            Self::Expansion2004(terms) => expansion::caputo(Form::Y2004, terms as usize, samples, alpha),
            Self::Expansion2008(terms) => expansion::caputo(Form::Y2008, terms as usize, samples, alpha),
        };
        if kind == Kind::RiemannLiouville && self != Self::GrunwaldLetnikov && alpha < 1.0 {
            let jump = start * reciprocal_gamma(1.0 - alpha);
            for (y, t) in y.iter_mut().zip(t).skip(1) {
                *y += jump * t.powf(-alpha);
            }
        }
        y[0] = if alpha == 1.0 {
            rate.map_or_else(|| rates::initial_rate(t, x, self.rate_points()), |rate| rate[0])
        } else if kind == Kind::RiemannLiouville && start != 0.0 {
            f64::NAN
        } else {
            0.0
        };
        Ok(y)
    }

    /// The common step, or the first row off the grid.
    fn uniform_step(self, samples: &Samples) -> Result<f64, SchemeError> {
        let UniformPrefix { step, rows } = samples.uniform_prefix();
        match samples.t.get(rows) {
            None => Ok(step),
            Some(&t) => Err(SchemeError::NotUniform { scheme: self, row: rows, t, expected: rows as f64 * step, step }),
        }
    }

    /// Samples in the one-sided difference whose order is the scheme's at alpha = 1.
    fn rate_points(self) -> usize {
        match self {
            Self::GrunwaldLetnikov | Self::L1 => 2,
            Self::L12 => 3,
            Self::Fbdf(order) => usize::from(order) + 1,
            Self::Expansion2004(_) | Self::Expansion2008(_) => 5,
        }
    }
}

impl fmt::Display for Scheme {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::GrunwaldLetnikov => f.pad("grunwald-letnikov"),
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
        let terms = |form: &str| name.strip_prefix(form).and_then(|rest| rest.strip_prefix('(')?.strip_suffix(')'));
        let scheme = match name {
            "grunwald-letnikov" => Self::GrunwaldLetnikov,
            "l1" => Self::L1,
            "l1-2" => Self::L12,
            _ => {
                if let Some(order) = name.strip_prefix("fbdf-") {
                    let order = number(order)?;
                    Self::Fbdf(u8::try_from(order).map_err(|_| SchemeNameError::Order(order))?)
                } else if let Some(terms) = terms("expansion-2004") {
                    Self::Expansion2004(number(terms)?)
                } else if let Some(terms) = terms("expansion-2008") {
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
