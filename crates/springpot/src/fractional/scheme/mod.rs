//! Named schemes for D^a of samples, −2 ≤ a ≤ 2, for comparison with the literature and for those who need one of them.
//!
//! | name | orders a | accuracy on smooth x | grid |
//! |---|---|---|---|
//! | `grunwald-letnikov` | −2 … 2 | 1 | equal steps |
//! | `grunwald-letnikov(N)` | 0 … 2 | 1, and what the cut memory leaves | equal steps |
//! | `l1` | −2 … 1 | 2 − a, integrals 2 | any |
//! | `l1-2` | −2 … 2 | 3 − a, integrals 3 | any |
//! | `fbdf-1` … `fbdf-6` | −2 … 2 | 1 … 6 | equal steps |
//! | `expansion-2004(N)` | 0 … 1 | 2 − a in 1/N | any |
//! | `expansion-2008(N)` | 0 … 1 | 1 − a in 1/N | any |
//!
//! With a < 0, D^a is the Riemann–Liouville integral of order −a. On equal steps all but the expansions take O(N log N)
//! operations by FFT. All start at t = 0 and know nothing of what was before.
//!
//! # Which one
//!
//! For smooth samples none: [`derivative`](super::derivative) with its splines errs less in the same time. `l1` is exact for
//! the broken line through the samples, so it stays right where x has kinks at samples. `l1-2` puts a parabola through three of
//! them and gains an order where x is smooth. `grunwald-letnikov` is the limit of the definition stopped at the step h.
//! `fbdf-p` is the convolution that solvers of fractional differential equations step with, here with the starting weights
//! that keep its order from the first row on. The expansions are those of the papers: moments of x in place of its past,
//! wrong until they have many more terms than the motion has had radians.
//!
//! Halving the step divides the error by 2 to the order:
//!
//! ```
//! use springpot::fractional::Kind;
//! use springpot::fractional::scheme::{Samples, Scheme};
//!
//! // D^½ t⁴ at t = 1 is Γ(5)/Γ(9/2).
//! let exact = 24.0 / 11.631_728_396_567_448;
//! let error = |scheme: Scheme, steps: usize| -> f64 {
//!     let t: Vec<f64> = (0..=steps).map(|k| k as f64 / steps as f64).collect();
//!     let x: Vec<f64> = t.iter().map(|t| t.powi(4)).collect();
//!     let y = scheme.differentiate(&Samples { t: &t, x: &x, rate: None }, 0.5, Kind::Caputo).unwrap();
//!     (y[steps] - exact).abs()
//! };
//! for scheme in [Scheme::GrunwaldLetnikov, Scheme::L1, Scheme::L12, Scheme::Fbdf(3)] {
//!     let measured = (error(scheme, 500) / error(scheme, 1000)).log2();
//!     assert!((measured - scheme.order(0.5)).abs() < 0.1, "{scheme}: {measured}");
//! }
//! ```

mod convolution;
mod error;
mod expansion;
mod fbdf;
mod grunwald_letnikov;
mod l1;
mod l12;
mod name;
mod rates;
mod samples;
mod weights;

pub(super) use convolution::sum_of_convolutions;
pub use convolution::{causal_convolution, direct_convolution};
pub use error::{SchemeError, SchemeNameError};
pub use rates::differenced_rates;
pub use samples::{Samples, UniformPrefix};

use super::gamma::reciprocal_gamma;
use super::kind::Kind;
use expansion::Form;
use std::ops::RangeInclusive;

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

    /// D^a x at every sample, a = `order` in [`Scheme::orders`].
    ///
    /// - a < 0: the integral 1/Γ(−a) ∫₀ᵗ (t−s)^{−a−1} x(s) ds for both kinds. Row 0 is 0.
    /// - a = 0: x (Riemann–Liouville) or x − x(0) (Caputo), exactly.
    /// - 0 < a < 1: Caputo is the integral of order 1 − a of x'; Riemann–Liouville adds x(0) t^−a/Γ(1−a).
    /// - a = 1: x' as the formula gives it: backward differences of the scheme's order, for the expansions the rate
    ///   itself. Row 0 is the rate where it is given, else a one-sided difference of matching order.
    /// - 1 < a < 2: Caputo is the integral of order 2 − a of x''; Riemann–Liouville adds
    ///   x(0) t^−a/Γ(1−a) + x'(0) t^{1−a}/Γ(2−a). x'(0) is the rate where it is given, else a one-sided difference of
    ///   matching order.
    /// - a = 2: x'' by backward differences of the scheme's order, one-sided in row 0 and, of Grünwald–Letnikov and L1-2,
    ///   in row 1.
    ///
    /// Row 0 of a derivative that is no whole one is 0 with Caputo. With Riemann–Liouville it is NaN where the
    /// derivative is singular: x(0) ≠ 0 or, above a = 1, x'(0) ≠ 0. The test is to the bit: round what counts as 0
    /// before. All schemes but Grünwald–Letnikov have the singular terms in closed form.
    ///
    /// `l1` and `l1-2` sum rows off the leading uniform grid directly, in O(rows) each, up to 2·10⁸ terms in all:
    /// 20 000 rows at random times, or any number of equal steps and one shorter last step.
    ///
    /// Rounding: samples that are right to ε leave errors of some ε h^−a in a derivative and of some ε t^−a in an
    /// integral; the sums themselves add less.
    ///
    /// # Errors
    /// Every variant of [`SchemeError`]; each names the row to mend.
    pub fn differentiate(self, samples: &Samples, order: f64, kind: Kind) -> Result<Vec<f64>, SchemeError> {
        self.check()?;
        if !(-2.0..=2.0).contains(&order) {
            return Err(SchemeError::Order(order));
        }
        if !self.orders().contains(&order) {
            let (min, max) = self.orders().into_inner();
            return Err(SchemeError::OrderOfScheme { scheme: self, order, min, max });
        }
        samples.check(self, order)?;
        let Samples { t, x, rate } = *samples;
        let riemann = kind == Kind::RiemannLiouville;
        if order == 0.0 {
            let before = if riemann { 0.0 } else { x[0] };
            return Ok(x.iter().map(|x| x - before).collect());
        }

        let start = if order < 1.0 { vec![x[0], 0.0] } else { self.start(samples, order) };
        let initial_rate = rate.map_or(start[1], |rate| rate[0]);
        let mut y = match self {
            Self::GrunwaldLetnikov | Self::ShortGrunwaldLetnikov(_) => {
                let memory =
                    if let Self::ShortGrunwaldLetnikov(samples) = self { Some(samples as usize) } else { None };
                let step = self.uniform_step(samples)?;
                grunwald_letnikov::differentiate(step, x, initial_rate, order, kind, memory)
            }
            Self::L1 => l1::differentiate(samples, order)?,
            Self::L12 => l12::differentiate(samples, order)?,
            Self::Fbdf(p) => fbdf::differentiate(p.into(), self.uniform_step(samples)?, x, order),
            Self::Expansion2004(terms) => expansion::caputo(Form::Y2004, terms as usize, samples, order),
            Self::Expansion2008(terms) => expansion::caputo(Form::Y2008, terms as usize, samples, order),
        };
        // The others give the Riemann–Liouville derivative or integral of x − x(0).
        if !matches!(self, Self::GrunwaldLetnikov | Self::ShortGrunwaldLetnikov(_)) {
            if order < 0.0 || riemann {
                add_power(&mut y, t, x[0] * reciprocal_gamma(1.0 - order), -order);
            }
            if order > 1.0 && !riemann {
                add_power(&mut y, t, -initial_rate * reciprocal_gamma(2.0 - order), 1.0 - order);
            }
        }
        y[0] = if order == 1.0 {
            initial_rate
        } else if order == 2.0 {
            2.0 * start[2]
        } else if riemann && order > 0.0 && (x[0] != 0.0 || order > 1.0 && initial_rate != 0.0) {
            f64::NAN
        } else {
            0.0
        };
        if order == 2.0 && !matches!(self, Self::Fbdf(_)) {
            y[1] = y[0];
        }
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

    /// Coefficients, in powers of t, of a polynomial through the first samples: so many that x'(0) at order 1 and above
    /// and x''(0) at order 2 err like the scheme.
    fn start(self, samples: &Samples, order: f64) -> Vec<f64> {
        let points = match self {
            Self::Fbdf(_) => self.min_rows(order),
            Self::L12 => 3,
            Self::Expansion2004(_) | Self::Expansion2008(_) => 5,
            _ if order > 1.0 => 3,
            _ => 2,
        };
        let points = points.min(samples.t.len());
        rates::start_polynomial(&samples.t[..points], &samples.x[..points])
    }
}

/// Adds factor·t^power to every row but the first.
fn add_power(y: &mut [f64], t: &[f64], factor: f64, power: f64) {
    if factor != 0.0 {
        for (y, t) in y.iter_mut().zip(t).skip(1) {
            *y += factor * t.powf(power);
        }
    }
}
