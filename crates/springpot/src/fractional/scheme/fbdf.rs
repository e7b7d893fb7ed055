//! Fractional backward differences of order 1 to 6 (Lubich's convolution quadrature) with starting corrections.

use super::convolution::{causal_convolution, direct_convolution, from_start};
use super::rates::start_polynomial;
use super::weights::{
    MAX_ORDER, SERIES_FROM, SERIES_TERMS, alternating_reciprocal_factorial, evaluate, power_of_generator, weights,
    zeta_at_negative,
};
use crate::fractional::gamma::{gamma, reciprocal_gamma};

/// Highest degree of a polynomial on which the formula of order p is exact at every row: p − 1 for integrals, p up to
/// alpha = 1, p + 1 up to 2.
///
/// A power t^k left out costs h^{k−alpha} n^{−alpha−1} in row n, which is O(h^p) in every row from this degree on.
pub(super) fn degree(order: usize, alpha: f64) -> usize {
    order - 1 + alpha.ceil().max(0.0) as usize
}

/// Riemann–Liouville derivative or integral of x − x(0) on equal steps, for x.len() > [`degree`]:
///
/// y(t_n) = h^−alpha ( Σ_k w_k x̃_{n−k} + Σ_{k=1}^d c_k e_{n,k} ), x̃ = x − x(0), Σ w_k z^k = (Σ_{m=1}^p
/// (1−z)^m/m)^alpha.
///
/// c_k are the coefficients, in powers of t/h, of the polynomial through the first d + 1 samples, d the [`degree`], and
/// e_{n,k} = D^alpha n^k − Σ_j w_{n−j} j^k is what the convolution misses on a power. So polynomials up to degree d are
/// exact, and smooth functions err by O(h^p) in every row, whatever their derivatives at 0 are. As a side effect noise
/// in the first samples is passed on, multiplied by up to 2^d and fading like t^−alpha (integrals: t^{−alpha−1}).
///
/// e_{n,k} is a difference of numbers of size n^{k−alpha} up to row 256, which c_k makes (256 h)^k x^(k)/k!; its
/// rounding is: always far less than
/// the error h^p x^(p) of the formula itself.
pub(super) fn differentiate(order: usize, step: f64, x: &[f64], alpha: f64) -> Vec<f64> {
    let degree = degree(order, alpha);
    let weights = weights(order, alpha, u8::from(alpha > 0.0), x.len());
    let mut y = causal_convolution(&weights, &from_start(x, alpha));
    let nodes: [f64; MAX_ORDER + 2] = std::array::from_fn(|n| n as f64);
    let coefficients = start_polynomial(&nodes[..=degree], &x[..=degree]);
    let corrections: Vec<Correction> =
        (1..=degree).map(|power| Correction::new(order, power, alpha, &weights)).collect();
    let scale = step.powf(-alpha);
    for (n, y) in y.iter_mut().enumerate().skip(1) {
        let missed: f64 = corrections.iter().zip(&coefficients[1..]).map(|(e, c)| c * e.at(n)).sum();
        *y = scale * (*y + missed);
    }
    y
}

/// e_{n,k} of one power k for every n ≥ 1.
struct Correction {
    alpha: f64,
    power: usize,
    /// n = 0 … SERIES_FROM − 1, as defined.
    start: Vec<f64>,
    /// Coefficients of n^{k−alpha−r}, r = 0, 1, …
    series: Vec<f64>,
}

impl Correction {
    fn new(order: usize, power: usize, alpha: f64, weights: &[f64]) -> Self {
        let rows = weights.len().min(SERIES_FROM);
        let powers: Vec<f64> = (0..rows).map(|n| (n as f64).powi(power as i32)).collect();
        let convolved = direct_convolution(weights, &from_start(&powers, alpha));
        let factor = gamma(power as f64 + 1.0) * reciprocal_gamma(power as f64 + 1.0 - alpha);
        let start =
            (0..rows).map(|n| if n == 0 { 0.0 } else { factor * (n as f64).powf(power as f64 - alpha) - convolved[n] });
        Self { alpha, power, start: start.collect(), series: asymptotic_series(order, power, alpha) }
    }

    fn at(&self, n: usize) -> f64 {
        if let Some(value) = self.start.get(n) {
            return *value;
        }
        evaluate(&self.series, n) * (n as f64).powf(self.power as f64 - self.alpha)
    }
}

/// Coefficients of n^{k−alpha−r}, r = 0, 1, …, in e_{n,k} as n → ∞.
///
/// With z = e^−u, Σ n^k z^n = k! u^{−k−1} + Σ_i ζ(−k−i) (−u)^i/i!, δ(z)^alpha = u^alpha Σ_r d_r u^r (d_0 = 1, then 0 up
/// to r = p), and u^β is the generating function of n^{−β−1}/Γ(−β) near z = 1. The exact derivative is k! u^{alpha−k−1}
/// and analytic terms, so
///
/// e_{n,k} ~ −Σ_{r≥p} k! d_r n^{k−alpha−r}/Γ(k+1−alpha−r) − Σ_{m≥0} Σ_{i+r=m} d_r ζ(−k−i) (−1)^i/i!
/// n^{−alpha−m−1}/Γ(−alpha−m).
fn asymptotic_series(order: usize, power: usize, alpha: f64) -> Vec<f64> {
    let leading = order.min(power + 1);
    let count = leading + SERIES_TERMS + 1;
    let d = power_of_generator(order, alpha, count);
    let k = power as f64;
    (0..count)
        .map(|r| {
            let pole = reciprocal_gamma(k + 1.0 - alpha - r as f64);
            let order_term = if r >= order { gamma(k + 1.0) * d[r] } else { 0.0 };
            // n^{k−alpha−r} = n^{−alpha−m−1} at m = r − k − 1.
            let start_term = r.checked_sub(power + 1).map_or(0.0, |m| {
                (0..=m).map(|i| d[m - i] * zeta_at_negative(power + i) * alternating_reciprocal_factorial(i)).sum()
            });
            -pole * (order_term + start_term)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn asymptotic_corrections_continue_the_defined_ones() {
        for order in 1..=MAX_ORDER {
            for alpha in [-2.0, -1.5, -1.0, -0.5, -0.1, 0.1, 0.5, 0.9, 0.99, 1.1, 1.5, 1.9, 2.0] {
                for power in 1..=degree(order, alpha) {
                    let weights = weights(order, alpha, u8::from(alpha > 0.0), SERIES_FROM);
                    let correction = Correction::new(order, power, alpha, &weights);
                    let defined = correction.start[SERIES_FROM - 1];
                    let n = SERIES_FROM - 1;
                    let series = Correction { start: Vec::new(), ..correction }.at(n);
                    // What the definition sums: powers and their weights, or differences of powers times w_0 and less.
                    let (n, k) = (n as f64, power as f64);
                    let largest =
                        if alpha < 0.0 { n.powf(k - alpha) } else { weights[0] * k * n.powf(k - alpha.min(1.0)) };
                    let rounding = 2e-13 * largest;
                    assert!(
                        (defined - series).abs() < rounding + 1e-13 * defined.abs(),
                        "{order} {power} {alpha}: {defined} {series}"
                    );
                }
            }
        }
    }
}
