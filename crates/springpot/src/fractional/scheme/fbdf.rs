//! Fractional backward differences of order 1 to 6 (Lubich's convolution quadrature) with starting corrections.

use super::convolution::{causal_convolution, direct_convolution};
use super::grunwald_letnikov::differences;
use crate::fractional::gamma::{gamma, reciprocal_gamma};

/// Rows up to which weights and corrections are computed as they are defined; later ones come from asymptotic series.
///
/// The parasitic roots of the sixth-order formula have modulus 0.863, and 0.863^256 is below one ulp.
const SERIES_FROM: usize = 256;
/// Terms of the asymptotic series kept beyond its leading one: 256^−8 is below one ulp.
const SERIES_TERMS: usize = 8;

/// Highest order of the backward difference.
const MAX_ORDER: usize = 6;

/// Caputo derivative on equal steps, for x.len() > order:
///
/// C(t_n) = h^−alpha ( Σ_k w_k x̃_{n−k} + Σ_{k=1}^p c_k e_{n,k} ), x̃ = x − x(0), Σ w_k z^k = (Σ_{m=1}^p (1−z)^m/m)^alpha.
///
/// c_k are the coefficients, in powers of t/h, of the polynomial through the first p + 1 samples, and
/// e_{n,k} = D^alpha n^k − Σ_j w_{n−j} j^k is what the convolution misses on a power. So polynomials up to degree p are
/// exact, and smooth functions err by O(h^p) in every row, whatever their derivatives at 0 are. As a side effect noise
/// in the first samples is passed on, multiplied by up to 2^p and fading like t^−alpha.
pub(super) fn caputo(order: usize, step: f64, x: &[f64], alpha: f64) -> Vec<f64> {
    let weights = cumulated_weights(order, alpha, x.len());
    let mut y = causal_convolution(&weights, &differences(x, x[0]));
    let coefficients = start_polynomial(&x[..=order]);
    let corrections: Vec<Correction> =
        (1..=order).map(|power| Correction::new(order, power, alpha, &weights)).collect();
    let scale = step.powf(-alpha);
    for (n, y) in y.iter_mut().enumerate().skip(1) {
        let missed: f64 = corrections.iter().zip(&coefficients[1..]).map(|(e, c)| c * e.at(n)).sum();
        *y = scale * (*y + missed);
    }
    y
}

/// Coefficients W_k of δ(z)^alpha/(1−z), δ(z) = Σ_{m=1}^p (1−z)^m/m: the running sums of the weights w_k.
///
/// Miller's recurrence for powers of polynomials, applied to the quotient so that nothing cancels. Its rounding error
/// grows like k, so the later weights come from their asymptotic series.
pub(super) fn cumulated_weights(order: usize, alpha: f64, count: usize) -> Vec<f64> {
    let (delta, quotient) = generator(order);
    let mut weights = vec![0.0; count];
    weights[0] = delta[0].powf(alpha);
    for n in 1..count.min(SERIES_FROM) {
        let terms = (1..=order.min(n)).map(|i| {
            let factor = alpha * i as f64 * delta[i] + quotient[i - 1] - delta[i] * (n - i) as f64;
            factor * weights[n - i]
        });
        weights[n] = terms.sum::<f64>() / (n as f64 * delta[0]);
    }
    let series = weight_series(order, alpha);
    for (n, weight) in weights.iter_mut().enumerate().skip(SERIES_FROM) {
        *weight = evaluate(&series, n) * (n as f64).powf(-alpha);
    }
    weights
}

/// Coefficients of δ(z) and of δ(z)/(1−z).
fn generator(order: usize) -> ([f64; MAX_ORDER + 1], [f64; MAX_ORDER + 1]) {
    let (mut delta, mut quotient) = ([0.0; MAX_ORDER + 1], [0.0; MAX_ORDER + 1]);
    let mut power = [0.0; MAX_ORDER + 2];
    power[0] = 1.0;
    for m in 1..=order {
        for (q, c) in quotient.iter_mut().zip(power) {
            *q += c / m as f64;
        }
        // power ← power·(1−z)
        for i in (1..power.len()).rev() {
            power[i] -= power[i - 1];
        }
        for (d, c) in delta.iter_mut().zip(power) {
            *d += c / m as f64;
        }
    }
    (delta, quotient)
}

/// Coefficients in powers of n of the polynomial through x_0, x_1, … at n = 0, 1, … (seven samples at most).
fn start_polynomial(x: &[f64]) -> [f64; MAX_ORDER + 1] {
    let mut table = [0.0; MAX_ORDER + 1];
    table[..x.len()].copy_from_slice(x);
    // Newton's forward differences Δ^j x_0 / j! …
    for j in 1..x.len() {
        for i in (j..x.len()).rev() {
            table[i] = (table[i] - table[i - 1]) / j as f64;
        }
    }
    // … and Horner's rule from the factors (n − j) to powers.
    for j in (0..x.len().saturating_sub(1)).rev() {
        for i in j..x.len() - 1 {
            table[i] -= j as f64 * table[i + 1];
        }
    }
    table
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
        let convolved = direct_convolution(weights, &differences(&powers, 0.0));
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
/// e_{n,k} ~ −Σ_{r≥p} k! d_r n^{k−alpha−r}/Γ(k+1−alpha−r) − Σ_{m≥0} Σ_{i+r=m} d_r ζ(−k−i) (−1)^i/i! n^{−alpha−m−1}/Γ(−alpha−m).
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

/// Coefficients of n^{−alpha−m}, m = 0, 1, …, in W_n as n → ∞: of u^alpha Σ d_r u^r/(1 − e^−u), where 1/(1 − e^−u) is
/// 1/u + 1/2 + Σ_{i≥2} ζ(1−i) (−u)^{i−1}/(i−1)!.
fn weight_series(order: usize, alpha: f64) -> Vec<f64> {
    let count = SERIES_TERMS + 1;
    let quotient: Vec<f64> = (0..count)
        .map(|i| match i {
            0 => 1.0,
            1 => 0.5,
            _ => zeta_at_negative(i - 1) * alternating_reciprocal_factorial(i - 1),
        })
        .collect();
    let product = direct_convolution(&power_of_generator(order, alpha, count), &quotient);
    product.iter().enumerate().map(|(m, c)| c * reciprocal_gamma(1.0 - alpha - m as f64)).collect()
}

/// Σ_r c_r n^−r
fn evaluate(series: &[f64], n: usize) -> f64 {
    let small = 1.0 / n as f64;
    series.iter().rev().fold(0.0, |sum, c| sum * small + c)
}

/// Coefficients d_0 … of (δ(e^−u)/u)^alpha in powers of u.
fn power_of_generator(order: usize, alpha: f64, count: usize) -> Vec<f64> {
    // δ = u − Σ_{m>p} v^m/m with v = 1 − e^−u, because u = −ln(1−v); v/u has the coefficients (−1)^i/(i+1)!.
    let ratio: Vec<f64> = (0..count).map(|i| alternating_reciprocal_factorial(i) / (i + 1) as f64).collect();
    let multiply = |a: &[f64], b: &[f64]| direct_convolution(a, b);
    let mut base = vec![0.0; count];
    base[0] = 1.0;
    let mut powers = base.clone();
    for m in 1..=count {
        powers = multiply(&powers, &ratio);
        if m > order {
            // v^m/u = u^{m−1} (v/u)^m
            for i in m - 1..count {
                base[i] -= powers[i + 1 - m] / m as f64;
            }
        }
    }
    let mut result = vec![0.0; count];
    result[0] = 1.0;
    for n in 1..count {
        let sum: f64 = (1..=n).map(|i| (alpha * i as f64 - (n - i) as f64) * base[i] * result[n - i]).sum();
        result[n] = sum / n as f64;
    }
    result
}

/// (−1)^i / i!
fn alternating_reciprocal_factorial(i: usize) -> f64 {
    (1..=i).fold(1.0, |product, m| -product / m as f64)
}

/// ζ(−m) = −B_{m+1}/(m+1) for m ≥ 1 (DLMF 25.6.3).
fn zeta_at_negative(m: usize) -> f64 {
    const BERNOULLI_EVEN: [f64; 9] =
        [1.0, 1.0 / 6.0, -1.0 / 30.0, 1.0 / 42.0, -1.0 / 30.0, 5.0 / 66.0, -691.0 / 2730.0, 7.0 / 6.0, -3617.0 / 510.0];
    if m.is_multiple_of(2) { 0.0 } else { -BERNOULLI_EVEN[m.div_ceil(2)] / (m + 1) as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_the_running_sums_of_the_defining_power() {
        // alpha = 1: the classical backward differences, 3/2 − 2z + z²/2 at order 2.
        let weights = cumulated_weights(2, 1.0, 6);
        for (weight, expected) in weights.iter().zip([1.5, -0.5, 0.0, 0.0, 0.0, 0.0]) {
            assert!((weight - expected).abs() < 1e-15);
        }
        // (W(1/2) with alpha) · (W(1/2) with beta) · (1−z) = W with alpha + beta.
        for order in 1..=MAX_ORDER {
            let product = direct_convolution(
                &cumulated_weights(order, 0.3, 200),
                &differences(&cumulated_weights(order, 0.4, 200), 0.0),
            );
            let expected = cumulated_weights(order, 0.7, 200);
            assert!(product.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 2e-14), "order {order}");
        }
    }

    #[test]
    fn the_weight_series_continues_the_recurrence() {
        for order in 1..=MAX_ORDER {
            for alpha in [0.05, 0.5, 0.95] {
                let weights = cumulated_weights(order, alpha, SERIES_FROM);
                let n = SERIES_FROM - 1;
                let series = evaluate(&weight_series(order, alpha), n) * (n as f64).powf(-alpha);
                assert!((series / weights[n] - 1.0).abs() < 3e-13, "{order} {alpha}: {series} {}", weights[n]);
            }
        }
        // Alpha = 1: the classical difference quotients have no tail.
        assert!(cumulated_weights(6, 1.0, 1000)[6..].iter().all(|w| w.abs() < 1e-14));
    }

    #[test]
    fn start_polynomial_recovers_coefficients() {
        let wanted = [0.3, -1.0, 2.0, 0.5, -0.25, 0.125, -0.0625];
        let x: Vec<f64> = (0..7).map(|n| wanted.iter().rev().fold(0.0, |s, c| s * n as f64 + c)).collect();
        for (got, wanted) in start_polynomial(&x).iter().zip(wanted) {
            assert!((got - wanted).abs() < 1e-11);
        }
    }

    #[test]
    fn asymptotic_corrections_continue_the_defined_ones() {
        for order in 1..=MAX_ORDER {
            for power in 1..=order {
                for alpha in [0.1, 0.5, 0.9, 0.99] {
                    let weights = cumulated_weights(order, alpha, SERIES_FROM);
                    let correction = Correction::new(order, power, alpha, &weights);
                    let defined = correction.start[SERIES_FROM - 1];
                    let n = SERIES_FROM - 1;
                    let series = Correction { start: Vec::new(), ..correction }.at(n);
                    // The definition subtracts numbers of size n^{k−alpha}; their rounding is the only difference.
                    let rounding = 2e-13 * (n as f64).powf(power as f64 - alpha);
                    assert!(
                        (defined - series).abs() < rounding + 1e-13 * defined.abs(),
                        "{order} {power} {alpha}: {defined} {series}"
                    );
                }
            }
        }
    }
}
