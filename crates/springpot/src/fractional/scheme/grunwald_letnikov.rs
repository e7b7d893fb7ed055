//! Grünwald–Letnikov: the difference quotient of order alpha.

use super::convolution::{causal_convolution, differences};
use super::weights::weights;
use crate::fractional::kind::Kind;

/// h^−alpha Σ_k w_k x̃_{n−k} with (1−z)^alpha = Σ w_k z^k, on equal steps; k runs to `memory` where there is one.
///
/// x̃ is x with Riemann–Liouville or in an integral; Caputo takes x − x(0) and, above alpha = 1, subtracts what the
/// whole sum makes of x'(0) t, x'(0) = `rate`.
///
/// Derivatives are summed by parts, Σ_k W_k (x̃_{n−k} − x̃_{n−k−1}) with W_k = w_0 + … + w_k: the same numbers, but the
/// rounding error is that of the small differences. A sum cut after w_m leaves W_m x̃_{n−m−1}.
pub(super) fn differentiate(
    step: f64,
    x: &[f64],
    rate: f64,
    alpha: f64,
    kind: Kind,
    memory: Option<usize>,
) -> Vec<f64> {
    let scale = step.powf(-alpha);
    let count = memory.map_or(x.len(), |memory| x.len().min(memory + 1));
    let mut y = if alpha < 0.0 {
        causal_convolution(&weights(1, alpha, 0, count), x)
    } else {
        let before = if kind == Kind::Caputo { x[0] } else { 0.0 };
        let weights = weights(1, alpha, 1, count);
        let mut y = causal_convolution(&weights, &differences(x, before));
        for (y, x) in y.iter_mut().skip(count).zip(x) {
            *y += weights[count - 1] * (x - before);
        }
        y
    };
    for y in &mut y {
        *y *= scale;
    }
    if alpha > 1.0 && kind == Kind::Caputo {
        // Σ_k w_k (n−k) is the coefficient of z^n in z (1−z)^{alpha−2}.
        let line = weights(1, alpha, 2, x.len());
        for (y, line) in y.iter_mut().skip(1).zip(line) {
            *y -= rate * step * scale * line;
        }
    }
    y
}
