//! Weights of convolution quadrature: powers of the backward difference formulas of order 1 to 6.

use super::convolution::direct_convolution;
use crate::fractional::gamma::reciprocal_gamma;

/// Rows up to which weights and corrections are computed as they are defined; later ones come from asymptotic series.
///
/// The parasitic roots of the sixth-order formula have modulus 0.863, and 0.863^256 is below one ulp.
pub(super) const SERIES_FROM: usize = 256;
/// Terms of the asymptotic series kept beyond its leading one: 256^−8 is below one ulp.
pub(super) const SERIES_TERMS: usize = 8;

/// Highest order of the backward difference.
pub(super) const MAX_ORDER: usize = 6;

/// First `count` coefficients of δ(z)^alpha (1−z)^−sums, δ(z) = Σ_{m=1}^p (1−z)^m/m with p = `order`: the weights w_k,
/// their running sums W_k with `sums` = 1, the sums of these with 2.
///
/// Miller's recurrence for powers of polynomials, applied to the quotient so that nothing cancels. Its rounding error
/// grows like k, so the later weights come from their asymptotic series.
pub(super) fn weights(order: usize, alpha: f64, sums: u8, count: usize) -> Vec<f64> {
    let (delta, quotient) = generator(order);
    let sums = f64::from(sums);
    let mut weights = vec![0.0; count];
    weights[0] = delta[0].powf(alpha);
    for n in 1..count.min(SERIES_FROM) {
        let terms = (1..=order.min(n)).map(|i| {
            let factor = alpha * i as f64 * delta[i] + sums * quotient[i - 1] - delta[i] * (n - i) as f64;
            factor * weights[n - i]
        });
        weights[n] = terms.sum::<f64>() / (n as f64 * delta[0]);
    }
    let series = weight_series(order, alpha, sums as usize);
    for (n, weight) in weights.iter_mut().enumerate().skip(SERIES_FROM) {
        *weight = evaluate(&series, n) * (n as f64).powf(sums - 1.0 - alpha);
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

/// Coefficients of n^{sums−1−alpha−r}, r = 0, 1, …, in the weights as n → ∞: of u^alpha Σ d_r u^r/(1 − e^−u)^sums,
/// where 1/(1 − e^−u) is 1/u + 1/2 + Σ_{i≥2} ζ(1−i) (−u)^{i−1}/(i−1)!.
fn weight_series(order: usize, alpha: f64, sums: usize) -> Vec<f64> {
    let count = SERIES_TERMS + 1;
    let quotient: Vec<f64> = (0..count)
        .map(|i| match i {
            0 => 1.0,
            1 => 0.5,
            _ => zeta_at_negative(i - 1) * alternating_reciprocal_factorial(i - 1),
        })
        .collect();
    let power = power_of_generator(order, alpha, count);
    let product = (0..sums).fold(power, |product, _| direct_convolution(&product, &quotient));
    product.iter().enumerate().map(|(r, c)| c * reciprocal_gamma(sums as f64 - alpha - r as f64)).collect()
}

/// Σ_r c_r n^−r
pub(super) fn evaluate(series: &[f64], n: usize) -> f64 {
    let small = 1.0 / n as f64;
    series.iter().rev().fold(0.0, |sum, c| sum * small + c)
}

/// Coefficients d_0 … of (δ(e^−u)/u)^alpha in powers of u.
pub(super) fn power_of_generator(order: usize, alpha: f64, count: usize) -> Vec<f64> {
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
pub(super) fn alternating_reciprocal_factorial(i: usize) -> f64 {
    (1..=i).fold(1.0, |product, m| -product / m as f64)
}

/// ζ(−m) = −B_{m+1}/(m+1) for m ≥ 1 (DLMF 25.6.3).
pub(super) fn zeta_at_negative(m: usize) -> f64 {
    const BERNOULLI_EVEN: [f64; 9] =
        [1.0, 1.0 / 6.0, -1.0 / 30.0, 1.0 / 42.0, -1.0 / 30.0, 5.0 / 66.0, -691.0 / 2730.0, 7.0 / 6.0, -3617.0 / 510.0];
    if m.is_multiple_of(2) { 0.0 } else { -BERNOULLI_EVEN[m.div_ceil(2)] / (m + 1) as f64 }
}

#[cfg(test)]
mod tests {
    use super::super::convolution::differences;
    use super::*;

    #[test]
    fn weights_are_those_of_the_defining_power() {
        // alpha = 1: the classical backward differences, 3/2 − 2z + z²/2 at order 2; alpha = 2: its square.
        for (alpha, sums, expected) in [
            (1.0, 0, [1.5, -2.0, 0.5, 0.0, 0.0, 0.0]),
            (1.0, 1, [1.5, -0.5, 0.0, 0.0, 0.0, 0.0]),
            (2.0, 0, [2.25, -6.0, 5.5, -2.0, 0.25, 0.0]),
        ] {
            for (weight, expected) in weights(2, alpha, sums, 6).iter().zip(expected) {
                assert!((weight - expected).abs() < 1e-14, "{alpha} {sums}: {weight} {expected}");
            }
        }
        // δ^alpha/(1−z) · δ^beta = δ^{alpha+beta}/(1−z).
        for order in 1..=MAX_ORDER {
            for (alpha, beta) in [(0.3, 0.4), (0.9, 0.8), (-0.3, -0.9), (-1.5, 1.5), (2.0, -1.3)] {
                let product = direct_convolution(&weights(order, alpha, 1, 200), &weights(order, beta, 0, 200));
                let expected = weights(order, alpha + beta, 1, 200);
                let largest = |w: &[f64]| w.iter().fold(1.0f64, |m, w| m.max(w.abs()));
                let factors = largest(&weights(order, alpha, 1, 200)) * largest(&weights(order, beta, 0, 200));
                let size = factors.max(largest(&expected));
                let error = product.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(error < 5e-14 * size, "order {order}, {alpha} + {beta}: {error:.1e} of {size:.1e}");
            }
        }
    }

    #[test]
    fn sums_are_running_sums() {
        for order in 1..=MAX_ORDER {
            for alpha in [-2.0, -0.4, 0.5, 1.7] {
                for sums in [1, 2] {
                    let differenced = differences(&weights(order, alpha, sums, 250), 0.0);
                    let plain = weights(order, alpha, sums - 1, 250);
                    let largest = weights(order, alpha, sums, 250).iter().fold(1.0f64, |m, w| m.max(w.abs()));
                    let error = differenced.iter().zip(&plain).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                    assert!(error < 3e-14 * largest, "order {order}, alpha {alpha}, sums {sums}: {error:.1e}");
                }
            }
        }
    }

    #[test]
    fn the_weight_series_continues_the_recurrence() {
        let cases = [(0u8, vec![-2.0, -1.3, -1.0, -0.05]), (1, vec![0.05, 0.5, 0.95, 1.05, 1.6, 1.95])];
        for order in 1..=MAX_ORDER {
            for (sums, alphas) in &cases {
                for &alpha in alphas {
                    let recurrence = weights(order, alpha, *sums, SERIES_FROM);
                    let n = SERIES_FROM - 1;
                    let power = f64::from(*sums) - 1.0 - alpha;
                    let series = evaluate(&weight_series(order, alpha, usize::from(*sums)), n) * (n as f64).powf(power);
                    // To the last digits, or where the weights fade fast to far below one ulp of the first.
                    let rounding = 3e-13 * recurrence[n].abs() + 0.1 * f64::EPSILON * recurrence[0];
                    assert!((series - recurrence[n]).abs() < rounding, "{order} {alpha}: {series} {}", recurrence[n]);
                }
            }
        }
        let line = weights(1, 1.4, 2, SERIES_FROM + 1);
        let step = line[SERIES_FROM] - line[SERIES_FROM - 1];
        assert!((step / weights(1, 1.4, 1, SERIES_FROM + 1)[SERIES_FROM] - 1.0).abs() < 1e-10);
        // Whole numbers: the classical difference quotients have no tail.
        assert!(weights(6, 1.0, 1, 1000)[6..].iter().all(|w| w.abs() < 1e-14));
        assert!(weights(6, 2.0, 0, 1000)[13..].iter().all(|w| w.abs() < 1e-13));
    }
}
