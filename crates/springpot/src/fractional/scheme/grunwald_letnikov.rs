//! Grünwald–Letnikov: the difference quotient of order alpha.

use super::convolution::causal_convolution;
use super::fbdf::cumulated_weights;

/// h^−alpha Σ_k w_k x_{n−k} with (1−z)^alpha = Σ w_k z^k, on equal steps.
///
/// Summed by parts, Σ_k W_k (x_{n−k} − x_{n−k−1}) with W_k = w_0 + … + w_k and x_{−1} = `before`: the same numbers, but
/// the rounding error is that of the small differences. `before` = 0 is Riemann–Liouville, x\[0\] is Caputo.
pub(super) fn differentiate(step: f64, x: &[f64], before: f64, alpha: f64) -> Vec<f64> {
    let scale = step.powf(-alpha);
    let weights = cumulated_weights(1, alpha, x.len());
    let mut y = causal_convolution(&weights, &differences(x, before));
    for y in &mut y {
        *y *= scale;
    }
    y
}

/// x_n − x_{n−1} with x_{−1} = `before`.
pub(super) fn differences(x: &[f64], before: f64) -> Vec<f64> {
    let previous = std::iter::once(&before).chain(x);
    x.iter().zip(previous).map(|(x, p)| x - p).collect()
}
