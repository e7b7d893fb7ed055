//! The Atanacković–Stanković expansion: the derivative as a sum over moments of the function.
//!
//! With u = τ/t, (1−u)^−alpha is expanded in powers of u, which turns the memory integral into the moments
//!
//! ```text
//! μ_q(t) = t^−(q+1) ∫₀ᵗ τ^q y(τ) dτ,      q = 0, 1, …
//! ```
//!
//! scaled so that none overflows (V_p of the papers is μ times a power of t). Both forms have the same coefficients
//! C_q = Γ(q+1+alpha)/(Γ(alpha) Γ(1−alpha) q!):
//!
//! ```text
//! 2008   D y = t^−alpha (A_N y − Σ_{q=0}^{N−1} C_q μ_q),                       A_N = (alpha+1)_N/(N! Γ(1−alpha))
//! 2004   D y = t^−alpha (A_{N−1} y + B_N t y' − Σ_{q=0}^{N−2} C_q μ_q),         B_N = (alpha)_N/(N! Γ(2−alpha))
//! ```
//!
//! so the 2004 form is the 2008 form with one moment less and a term in y'. Constants are exact in both, straight lines
//! in the 2004 form. What the cut after N terms leaves is, for N ≫ ωt,
//!
//! ```text
//! 2008   |y'(t)| t^{1−alpha} N^{alpha−1} / ((1−alpha) Γ(alpha) Γ(1−alpha))
//! 2004   |y''(t)| t^{2−alpha} N^{alpha−2} / ((2−alpha) Γ(2−alpha) |Γ(alpha−1)|)
//! ```
//!
//! and of the size of the derivative itself for N < ωt: the expansion reproduces the literature, it measures nothing.
//!
//! T. M. Atanacković, B. Stanković, Fract. Calc. Appl. Anal. 7 (2004) 365 and Mech. Res. Commun. 35 (2008) 429.

use super::rates::differenced_rates;
use super::samples::Samples;
use crate::fractional::gamma::reciprocal_gamma;
use std::borrow::Cow;

/// Which of the two expansions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    /// With y'.
    Y2004,
    /// Without y'.
    Y2008,
}

/// Caputo derivative, 0 < alpha ≤ 1, on any grid: the expansion of y = x − x(0).
///
/// The moments are exact for the cubic Hermite interpolation of the samples (the rates given, else five-point
/// differences). Work: rows × terms. At alpha = 1 all coefficients vanish but B_N = 1: the 2004 form is y'; the 2008
/// form tends to 0, because its remainder no longer shrinks with N, and y' is given instead.
pub(super) fn caputo(form: Form, terms: usize, samples: &Samples, alpha: f64) -> Vec<f64> {
    let rates = samples.rate.map_or_else(|| Cow::from(differenced_rates(samples.t, samples.x)), Cow::from);
    if alpha == 1.0 {
        return rates.into_owned();
    }
    let count = match form {
        Form::Y2004 => terms - 1,
        Form::Y2008 => terms,
    };
    let coefficients = Coefficients::new(form, count, alpha);
    let mut moments = Moments::new(count);
    let (t, start) = (samples.t, samples.x[0]);
    let mut y = vec![0.0; t.len()];
    for n in 1..t.len() {
        let (before, now) = (samples.x[n - 1] - start, samples.x[n] - start);
        moments.advance([t[n - 1], t[n]], [before, now], [rates[n - 1], rates[n]]);
        y[n] = t[n].powf(-alpha) * coefficients.sum(now, t[n] * rates[n], &moments.scaled);
    }
    y
}

struct Coefficients {
    /// A: factor of y.
    value: f64,
    /// B: factor of t y'; 0 in the 2008 form.
    rate: f64,
    /// C_q: factors of the moments.
    moments: Vec<f64>,
}

impl Coefficients {
    fn new(form: Form, count: usize, alpha: f64) -> Self {
        // (a)_n/n! = Π (a+j)/(j+1)
        let rising = |a: f64, n: usize| (0..n).fold(1.0, |product, j| product * (a + j as f64) / (j + 1) as f64);
        let mut next = alpha * reciprocal_gamma(1.0 - alpha);
        let moments = (0..count)
            .map(|q| {
                let current = next;
                next *= (q as f64 + 1.0 + alpha) / (q + 1) as f64;
                current
            })
            .collect();
        let rate = match form {
            Form::Y2004 => rising(alpha, count + 1) * reciprocal_gamma(2.0 - alpha),
            Form::Y2008 => 0.0,
        };
        Self { value: rising(alpha + 1.0, count) * reciprocal_gamma(1.0 - alpha), rate, moments }
    }

    fn sum(&self, y: f64, t_rate: f64, moments: &[f64]) -> f64 {
        let known: f64 = self.moments.iter().zip(moments).map(|(c, m)| c * m).sum();
        self.value * y + self.rate * t_rate - known
    }
}

/// The scaled moments μ_q(t), q = 0 … count − 1.
struct Moments {
    scaled: Vec<f64>,
}

/// Eight-point Gauss–Legendre rule on [0, 1]: exact to degree 15.
const NODES: [f64; 8] = [
    0.019_855_071_751_231_884,
    0.101_666_761_293_186_63,
    0.237_233_795_041_835_5,
    0.408_282_678_752_175_1,
    0.591_717_321_247_825,
    0.762_766_204_958_164_5,
    0.898_333_238_706_813_4,
    0.980_144_928_248_768_1,
];
const WEIGHTS: [f64; 8] = [
    0.050_614_268_145_188_13,
    0.111_190_517_226_687_24,
    0.156_853_322_938_943_64,
    0.181_341_891_689_181,
    0.181_341_891_689_181,
    0.156_853_322_938_943_64,
    0.111_190_517_226_687_24,
    0.050_614_268_145_188_13,
];

impl Moments {
    fn new(count: usize) -> Self {
        Self { scaled: vec![0.0; count] }
    }

    /// μ_q(t₁) = ρ^{q+1} μ_q(t₀) + r ∫₀¹ (1−rφ)^q y(t₁−φh) dφ with r = h/t₁ = 1 − ρ, exact for the cubic through values
    /// and rates at both ends.
    fn advance(&mut self, t: [f64; 2], y: [f64; 2], rate: [f64; 2]) {
        let step = t[1] - t[0];
        let r = step / t[1];
        let rho = t[0] / t[1];
        let (late, early) = (-step * rate[1], -step * rate[0]);
        let rise = y[0] - y[1];
        let cubic = [y[1], late, 3.0 * rise - 2.0 * late - early, late + early - 2.0 * rise];

        // (1−rφ)^q varies by less than e² for q r < 2, where Gauss' rule is exact to rounding.
        let smooth = self.scaled.len().min((2.0 / r).ceil() as usize);
        let (head, tail) = self.scaled.split_at_mut(smooth);
        let base = NODES.map(|node| 1.0 - r * node);
        let mut powers: [f64; 8] = std::array::from_fn(|g| {
            let value = cubic.iter().rev().fold(0.0, |sum, c| sum * NODES[g] + c);
            r * WEIGHTS[g] * value
        });
        let mut carried = rho;
        for moment in head {
            *moment = carried * *moment + powers.iter().sum::<f64>();
            carried *= rho;
            for (power, base) in powers.iter_mut().zip(base) {
                *power *= base;
            }
        }
        // Beyond, K_i(q) = ∫₀¹ (1−rφ)^q φ^i dφ = (i K_{i−1}(q+1) − ρ^{q+1})/((q+1) r), for i = 0 (1 − ρ^{q+1})/((q+1) r).
        for (q, moment) in (smooth + 1..).zip(tail) {
            // Keep powers out of the slow subnormal range.
            if carried < 1e-290 {
                carried = 0.0;
            }
            let rest = [carried, carried * rho, carried * rho * rho, carried * rho * rho * rho];
            let inverse: [f64; 4] = std::array::from_fn(|i| 1.0 / ((q + i) as f64 * r));
            let mut integral = 0.0;
            for (i, c) in cubic.iter().enumerate() {
                // K_i(q) from K_0(q+i) down.
                let mut k = (1.0 - rest[i]) * inverse[i];
                for j in 1..=i {
                    k = (j as f64 * k - rest[i - j]) * inverse[i - j];
                }
                integral += c * k;
            }
            *moment = carried * *moment + r * integral;
            carried *= rho;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_a_cubic_are_exact_on_any_grid() {
        // μ_q of Σ a_i t^i is Σ a_i t^i/(q+i+1).
        let a = [0.7, -1.3, 0.4, 0.2];
        let value = |t: f64| a.iter().rev().fold(0.0, |s, c| s * t + c);
        let rate = |t: f64| a[1] + t * (2.0 * a[2] + 3.0 * t * a[3]);
        let count = 5000;
        for steps in [1usize, 7, 300, 5000] {
            let mut moments = Moments::new(count);
            let grid: Vec<f64> = (0..=steps).map(|n| 3.0 * (n as f64 / steps as f64).powf(1.2)).collect();
            for w in grid.windows(2) {
                moments.advance([w[0], w[1]], [value(w[0]), value(w[1])], [rate(w[0]), rate(w[1])]);
            }
            let t = grid[steps];
            for (q, moment) in moments.scaled.iter().enumerate() {
                let exact: f64 = a.iter().enumerate().map(|(i, a)| a * t.powi(i as i32) / (q + i + 1) as f64).sum();
                let largest = value(t).abs().max(1.0) / (q + 1) as f64;
                assert!((moment - exact).abs() < 2e-13 * largest, "{steps} steps, q = {q}: {moment} {exact}");
            }
        }
    }

    #[test]
    fn coefficients_agree_with_the_papers_gamma_quotients() {
        use crate::fractional::gamma::gamma;
        let (alpha, terms) = (0.3, 9usize);
        let n = terms as f64;
        let form2008 = Coefficients::new(Form::Y2008, terms, alpha);
        let common = gamma(alpha) * gamma(1.0 - alpha);
        let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-13;
        assert!(close(form2008.value, gamma(n + 1.0 + alpha) / (alpha * common * gamma(n + 1.0))));
        for (q, c) in form2008.moments.iter().enumerate() {
            assert!(close(*c, gamma(q as f64 + 1.0 + alpha) / (common * gamma(q as f64 + 1.0))));
        }
        let form2004 = Coefficients::new(Form::Y2004, terms - 1, alpha);
        let a: f64 = (2..=terms).map(|p| gamma(p as f64 - 1.0 + alpha) / (gamma(alpha) * gamma(p as f64))).sum();
        let b: f64 =
            (1..=terms).map(|p| gamma(p as f64 - 1.0 + alpha) / (gamma(alpha - 1.0) * gamma(p as f64 + 1.0))).sum();
        assert!(close(form2004.value, (1.0 + a) / gamma(1.0 - alpha)));
        assert!(close(form2004.rate, (1.0 + b) / gamma(2.0 - alpha)));
        for (q, c) in form2004.moments.iter().enumerate() {
            // C_p (1 − p) of the 2004 layout, p = q + 2, against −V_p = (p−1)∫…: the sign is taken into the sum.
            let p = q as f64 + 2.0;
            let papers = gamma(p - 1.0 + alpha) / (gamma(2.0 - alpha) * gamma(alpha - 1.0) * gamma(p)) * (1.0 - p);
            assert!(close(*c, papers));
        }
    }
}
