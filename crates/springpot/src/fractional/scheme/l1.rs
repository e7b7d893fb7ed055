//! L1: the exact Caputo derivative of the broken line through the samples.

use super::convolution::causal_convolution;
use super::samples::{Samples, UniformPrefix};
use super::{SchemeError, grunwald_letnikov::differences};
use crate::fractional::gamma::reciprocal_gamma;

/// Longest direct sum over the rows off the uniform grid, in terms (some seconds of work).
pub(super) const DIRECT_TERMS: u64 = 200_000_000;

/// C(t_n) = 1/Γ(2−alpha) Σ_{j=1}^n D_j h_j^{1−alpha} a(k_j), D_j = (x_j − x_{j−1})/h_j, k_j = (t_n − t_j)/h_j.
pub(super) fn caputo(samples: &Samples, alpha: f64) -> Result<Vec<f64>, SchemeError> {
    let prefix = samples.uniform_prefix();
    check_direct_terms(samples, prefix)?;
    let weights: Vec<f64> = (0..prefix.rows).map(|k| mean(k as f64, alpha)).collect();
    let mut y = causal_convolution(&weights, &differences(&samples.x[..prefix.rows], samples.x[0]));
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

/// D_j h_j^{1−alpha}, at index j − 1.
pub(super) fn pieces(samples: &Samples, alpha: f64) -> Vec<f64> {
    let Samples { t, x, .. } = samples;
    (1..t.len()).map(|j| (x[j] - x[j - 1]) * (t[j] - t[j - 1]).powf(-alpha)).collect()
}

/// Γ(2−alpha) C(t_n), term by term.
pub(super) fn row_sum(t: &[f64], pieces: &[f64], n: usize, alpha: f64) -> f64 {
    (1..=n).map(|j| pieces[j - 1] * mean((t[n] - t[j]) / (t[j] - t[j - 1]), alpha)).sum()
}

/// a(k) = (1−alpha) ∫₀¹ (k+φ)^−alpha dφ = (k+1)^{1−alpha} − k^{1−alpha}, without cancellation; 1 and 0, 0, … at alpha = 1.
pub(super) fn mean(k: f64, alpha: f64) -> f64 {
    if k == 0.0 {
        return 1.0;
    }
    k.powf(1.0 - alpha) * ((1.0 - alpha) * k.recip().ln_1p()).exp_m1()
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
