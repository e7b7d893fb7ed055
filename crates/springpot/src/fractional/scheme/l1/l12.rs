//! L1-2: the exact derivative or integral of parabolas through three samples each.

use super::{self as l1, check_direct_terms, pieces, row_sum};
use crate::fractional::gamma::reciprocal_gamma;
use crate::fractional::scheme::convolution::{causal_convolution, differences, from_start};
use crate::fractional::scheme::error::SchemeError;
use crate::fractional::scheme::samples::Samples;

/// Derivative or integral of x − x(0): L1 plus, for every step but the first, the parabola through its ends and the
/// sample before:
///
/// y(t_n) = L1 + 1/Γ(3−alpha) Σ_{j=2}^n 2 x\[t_{j−2}, t_{j−1}, t_j\] h_j^{2−alpha} b(k_j), x\[·,·,·\] the second
/// divided difference. On equal steps both sums are one convolution.
///
/// Above alpha = 1 the integrals are finite parts: y is the Riemann–Liouville derivative of the chain of parabolas, the
/// jumps of its slope at the samples before t_n included. (Without them the order would fall to 1.) At alpha = 2 only
/// the second difference at t_n is left.
pub(in crate::fractional::scheme) fn differentiate(samples: &Samples, alpha: f64) -> Result<Vec<f64>, SchemeError> {
    let prefix = samples.uniform_prefix();
    check_direct_terms(samples, prefix)?;
    let x = &samples.x[..prefix.rows];
    let skews: Vec<f64> = (0..prefix.rows).map(|k| skew(k as f64, alpha)).collect();
    let mut changes = differences(&skews, 0.0);
    if alpha < 0.0 {
        changes = differences(&changes, 0.0);
    }
    let lines = l1::weights(prefix.rows, alpha);
    let weights: Vec<f64> = lines.iter().zip(changes).map(|(line, change)| (2.0 - alpha) * line + change).collect();
    let mut y = causal_convolution(&weights, &from_start(x, alpha));
    let scale = prefix.step.powf(-alpha) * reciprocal_gamma(3.0 - alpha);
    // The first step has no sample before it and stays a straight line.
    for n in 1..prefix.rows {
        y[n] = scale * (y[n] - skews[n - 1] * (x[1] - x[0]));
    }
    if prefix.rows < samples.t.len() {
        let (t, pieces, bends) = (samples.t, pieces(samples, alpha), bends(samples, alpha));
        let row = |n| (2.0 - alpha) * row_sum(t, &pieces, n, alpha) + bend_sum(t, &bends, n, alpha);
        y.extend((prefix.rows..t.len()).map(|n| reciprocal_gamma(3.0 - alpha) * row(n)));
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

/// b(k) = (2−alpha) (1−alpha) ∫ −ψ (k+½+ψ)^−alpha dψ over −½ ≤ ψ ≤ ½ (its finite part above alpha = 1); α/2 at k = 0.
///
/// = (k+1)^{2−alpha} − k^{2−alpha} − (1−alpha/2) ((k+1)^{1−alpha} + k^{1−alpha}), which loses digits like k³, so from
/// k = 4 on by the binomial series in 1/(2k+1).
fn skew(k: f64, alpha: f64) -> f64 {
    if k == 0.0 {
        return 0.5 * alpha;
    }
    if k < 4.0 {
        return direct_skew(k, alpha);
    }
    // Two terms at a time: Σ C(−alpha, i) small^i/(i+2) over odd i.
    let small = 1.0 / (2.0 * k + 1.0);
    let mut term = -alpha * small;
    let mut sum = term / 3.0;
    for i in (3..=17).step_by(2) {
        let i = f64::from(i);
        term *= (alpha + i - 2.0) * (alpha + i - 1.0) / ((i - 1.0) * i) * (small * small);
        sum += term / (i + 2.0);
        if term.abs() <= 1e-17 * sum.abs() {
            break;
        }
    }
    -0.5 * (2.0 - alpha) * (1.0 - alpha) * (k + 0.5).powf(-alpha) * sum
}

fn direct_skew(k: f64, alpha: f64) -> f64 {
    let (near, far) = (k.powf(1.0 - alpha), (k + 1.0).powf(1.0 - alpha));
    (k + 1.0) * far - k * near - (1.0 - 0.5 * alpha) * (far + near)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_branches_of_the_skew_meet() {
        for alpha in [-2.0, -1.4, -1.0, -0.3, 0.0, 0.05, 0.3, 0.5, 0.9, 1.0, 1.2, 1.5, 1.9, 2.0] {
            for k in [4.0f64, 5.5, 9.0] {
                let rounding = 4.0 * f64::EPSILON * (k + 1.0) * (k + 1.0).powf(1.0 - alpha);
                assert!((skew(k, alpha) - direct_skew(k, alpha)).abs() < rounding, "alpha {alpha}, k {k}");
            }
        }
    }
}
