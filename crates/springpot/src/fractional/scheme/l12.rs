//! L1-2: the exact Caputo derivative of parabolas through three samples each.

use super::convolution::causal_convolution;
use super::l1::{check_direct_terms, mean, pieces, row_sum};
use super::samples::Samples;
use super::{SchemeError, grunwald_letnikov::differences};
use crate::fractional::gamma::reciprocal_gamma;

/// L1 plus, for every step but the first, the parabola through its ends and the sample before:
///
/// C(t_n) = L1 + 1/Γ(2−alpha) Σ_{j=2}^n 2 x\[t_{j−2}, t_{j−1}, t_j\] h_j^{2−alpha} b(k_j), x\[·,·,·\] the second divided
/// difference. On equal steps both sums are one convolution.
pub(super) fn caputo(samples: &Samples, alpha: f64) -> Result<Vec<f64>, SchemeError> {
    let prefix = samples.uniform_prefix();
    check_direct_terms(samples, prefix)?;
    let x = &samples.x[..prefix.rows];
    let skews: Vec<f64> = (0..prefix.rows).map(|k| skew(k as f64, alpha)).collect();
    let weights: Vec<f64> =
        (0..prefix.rows).map(|k| mean(k as f64, alpha) + skews[k] - if k == 0 { 0.0 } else { skews[k - 1] }).collect();
    let mut y = causal_convolution(&weights, &differences(x, x[0]));
    let scale = prefix.step.powf(-alpha) * reciprocal_gamma(2.0 - alpha);
    // The first step has no sample before it and stays a straight line.
    for n in 1..prefix.rows {
        y[n] = scale * (y[n] - skews[n - 1] * (x[1] - x[0]));
    }
    if prefix.rows < samples.t.len() {
        let (t, pieces, bends) = (samples.t, pieces(samples, alpha), bends(samples, alpha));
        let row = |n| row_sum(t, &pieces, n, alpha) + bend_sum(t, &bends, n, alpha);
        y.extend((prefix.rows..t.len()).map(|n| reciprocal_gamma(2.0 - alpha) * row(n)));
    }
    Ok(y)
}

/// 2 x\[t_{j−2}, t_{j−1}, t_j\] h_j^{2−alpha}, at index j − 2.
fn bends(samples: &Samples, alpha: f64) -> Vec<f64> {
    let Samples { t, x, .. } = samples;
    (2..t.len())
        .map(|j| {
            let (step, before) = (t[j] - t[j - 1], t[j - 1] - t[j - 2]);
            let slopes = (x[j] - x[j - 1]) / step - (x[j - 1] - x[j - 2]) / before;
            2.0 * slopes / (step + before) * step.powf(2.0 - alpha)
        })
        .collect()
}

fn bend_sum(t: &[f64], bends: &[f64], n: usize, alpha: f64) -> f64 {
    (2..=n).map(|j| bends[j - 2] * skew((t[n] - t[j]) / (t[j] - t[j - 1]), alpha)).sum()
}

/// b(k) = (1−alpha) ∫ −ψ (k+½+ψ)^−alpha dψ over −½ ≤ ψ ≤ ½; α/(2(2−α)) at k = 0.
///
/// = ((k+1)^{2−alpha} − k^{2−alpha})/(2−alpha) − ((k+1)^{1−alpha} + k^{1−alpha})/2, which loses digits like k³, so from
/// k = 4 on by the binomial series in 1/(2k+1).
fn skew(k: f64, alpha: f64) -> f64 {
    if k == 0.0 {
        return 0.5 * alpha / (2.0 - alpha);
    }
    if k < 4.0 {
        let (near, far) = (k.powf(1.0 - alpha), (k + 1.0).powf(1.0 - alpha));
        return ((k + 1.0) * far - k * near) / (2.0 - alpha) - 0.5 * (far + near);
    }
    let small = 1.0 / (2.0 * k + 1.0);
    let (mut term, mut sum) = (1.0, 0.0);
    for i in 1..=17 {
        term *= -(alpha + (i - 1) as f64) / i as f64 * small;
        if i % 2 == 1 {
            sum += term / (i + 2) as f64;
        }
    }
    -0.5 * (1.0 - alpha) * (k + 0.5).powf(-alpha) * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_branches_of_the_skew_meet() {
        for alpha in [0.0, 0.05, 0.3, 0.5, 0.9, 1.0] {
            for k in [4.0f64, 5.5, 9.0] {
                let (near, far) = (k.powf(1.0 - alpha), (k + 1.0).powf(1.0 - alpha));
                let direct = ((k + 1.0) * far - k * near) / (2.0 - alpha) - 0.5 * (far + near);
                assert!((skew(k, alpha) - direct).abs() < 4e-14, "alpha {alpha}, k {k}");
            }
        }
    }
}
