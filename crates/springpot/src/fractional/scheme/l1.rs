//! L1: the exact derivative or integral of the broken line through the samples.

pub(super) mod l12;

use super::convolution::{causal_convolution, from_start};
use super::error::SchemeError;
use super::samples::{Samples, UniformPrefix};
use crate::fractional::gamma::reciprocal_gamma;

/// Longest direct sum over the rows off the uniform grid, in terms (some seconds of work).
pub(super) const DIRECT_TERMS: u64 = 200_000_000;

/// Derivative or integral of x − x(0), −2 ≤ alpha ≤ 1:
///
/// y(t_n) = 1/Γ(2−alpha) Σ_{j=1}^n D_j h_j^{1−alpha} a(k_j), D_j = (x_j − x_{j−1})/h_j, k_j = (t_n − t_j)/h_j.
pub(super) fn differentiate(samples: &Samples, alpha: f64) -> Result<Vec<f64>, SchemeError> {
    let prefix = samples.uniform_prefix();
    check_direct_terms(samples, prefix)?;
    let mut y = causal_convolution(&weights(prefix.rows, alpha), &from_start(&samples.x[..prefix.rows], alpha));
    let scale = prefix.step.powf(-alpha) * reciprocal_gamma(2.0 - alpha);
    for y in &mut y {
        *y *= scale;
    }
    if prefix.rows < samples.t.len() {
        let pieces = pieces(samples, alpha);
        let row = |n| reciprocal_gamma(2.0 - alpha) * row_sum(samples.t, &pieces, n, alpha);
        y.extend((prefix.rows..samples.t.len()).map(row));
    }
    Ok(y)
}

/// Weights of equal steps on [`from_start`]: a(k), for integrals a(k) − a(k−1).
pub(super) fn weights(count: usize, alpha: f64) -> Vec<f64> {
    let weight = if alpha > 0.0 { mean } else { change_of_mean };
    (0..count).map(|k| weight(k as f64, alpha)).collect()
}

/// D_j h_j^{1−alpha}, at index j − 1.
pub(super) fn pieces(samples: &Samples, alpha: f64) -> Vec<f64> {
    let Samples { t, x, .. } = samples;
    (1..t.len()).map(|j| (x[j] - x[j - 1]) * (t[j] - t[j - 1]).powf(-alpha)).collect()
}

/// Γ(2−alpha) y(t_n), term by term.
pub(super) fn row_sum(t: &[f64], pieces: &[f64], n: usize, alpha: f64) -> f64 {
    (1..=n).map(|j| pieces[j - 1] * mean((t[n] - t[j]) / (t[j] - t[j - 1]), alpha)).sum()
}

/// a(k) = (1−alpha) ∫₀¹ (k+φ)^−alpha dφ = (k+1)^{1−alpha} − k^{1−alpha}, without cancellation; 1 and 0, 0, … at alpha =
/// 1.
///
/// Above alpha = 1 it is the integral's finite part, which is 1 at k = 0.
pub(super) fn mean(k: f64, alpha: f64) -> f64 {
    if k == 0.0 {
        return 1.0;
    }
    k.powf(1.0 - alpha) * ((1.0 - alpha) * k.recip().ln_1p()).exp_m1()
}

/// a(k) − a(k−1) = (k+1)^p − 2k^p + (k−1)^p for whole k ≥ 1 and p = 1 − alpha, a(0) at k = 0.
///
/// The difference loses digits like k², so from k = 8 on by the binomial series in 1/k².
fn change_of_mean(k: f64, alpha: f64) -> f64 {
    let p = 1.0 - alpha;
    if k == 0.0 {
        return 1.0;
    }
    if k < 8.0 {
        return (k + 1.0).powf(p) - 2.0 * k.powf(p) + (k - 1.0).powf(p);
    }
    let small = 1.0 / (k * k);
    let (mut term, mut sum) = (1.0, 0.0);
    for i in 1..=9 {
        let j = f64::from(2 * i);
        term *= (p - j + 2.0) * (p - j + 1.0) / ((j - 1.0) * j) * small;
        sum += term;
        if term.abs() <= 1e-17 * sum.abs() {
            break;
        }
    }
    2.0 * k.powf(p) * sum
}

/// Refuses direct sums that would take minutes.
pub(super) fn check_direct_terms(samples: &Samples, prefix: UniformPrefix) -> Result<(), SchemeError> {
    let terms: u64 = (prefix.rows as u64..samples.t.len() as u64).sum();
    if terms > DIRECT_TERMS {
        let rows = samples.t.len() - prefix.rows;
        return Err(SchemeError::TooManyIrregularRows { rows, terms, limit: DIRECT_TERMS });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_branches_of_the_change_meet() {
        for alpha in [-2.0, -1.5, -1.0, -0.5, -0.01] {
            for k in [8.0f64, 9.0, 12.0] {
                let direct = mean(k, alpha) - mean(k - 1.0, alpha);
                let error = (change_of_mean(k, alpha) - direct).abs();
                assert!(error < 1e-15 * mean(k, alpha) * 8.0, "alpha {alpha}, k {k}: {error:.1e}");
            }
        }
        // Far away: p (p − 1) k^{p−2} to the last digits.
        let (k, p): (f64, f64) = (1e6, 1.3);
        assert!((change_of_mean(k, 1.0 - p) / (p * (p - 1.0) * k.powf(p - 2.0)) - 1.0).abs() < 2e-13);
    }
}
