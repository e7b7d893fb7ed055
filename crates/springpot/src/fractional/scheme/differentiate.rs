//! D^a of samples by the scheme's formula, and what all of them share: kinds, starts and whole orders.

use super::error::SchemeError;
use super::expansion::Form;
use super::l1::{self, l12};
use super::named::Scheme;
use super::samples::{Samples, UniformPrefix};
use super::{expansion, fbdf, grunwald_letnikov, rates};
use crate::fractional::gamma::reciprocal_gamma;
use crate::fractional::kind::Kind;

impl Scheme {
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

    /// Coefficients, in powers of t, of a polynomial through the first samples.
    fn start(self, samples: &Samples, order: f64) -> Vec<f64> {
        let rows = self.start_rows(order).min(samples.t.len());
        rates::start_polynomial(&samples.t[..rows], &samples.x[..rows])
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
