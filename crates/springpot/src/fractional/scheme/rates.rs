//! Rates of sampled functions by differences.

/// Points of the difference stencil; the rate then errs by O(h⁴).
const STENCIL: usize = 5;

/// x' at every sample: derivative of the polynomial through the five nearest samples, one-sided at the ends.
///
/// Order 4 on any grid whose neighbouring steps are of similar size; exact for polynomials up to degree 4. With fewer
/// than five samples it takes the polynomial through all of them. `t` increases strictly and is as long as `x`.
pub fn differenced_rates(t: &[f64], x: &[f64]) -> Vec<f64> {
    let width = STENCIL.min(t.len());
    (0..t.len())
        .map(|row| {
            let first = row.saturating_sub(width / 2).min(t.len() - width);
            slope_at(row - first, &t[first..first + width], &x[first..first + width])
        })
        .collect()
}

/// x'(t\[0\]) of the polynomial through the first `points` samples (all, when there are fewer).
pub(crate) fn initial_rate(t: &[f64], x: &[f64], points: usize) -> f64 {
    let width = points.min(t.len());
    slope_at(0, &t[..width], &x[..width])
}

/// Slope at node i of the polynomial through all of (t, x): Σ_{j≠i} r_j (x_j − x_i)/(t_j − t_i) with
/// r_j = Π_{m≠i,j} (t_i − t_m)/(t_j − t_m).
fn slope_at(node: usize, t: &[f64], x: &[f64]) -> f64 {
    let ratio = |j: usize| -> f64 {
        (0..t.len()).filter(|&m| m != j && m != node).map(|m| (t[node] - t[m]) / (t[j] - t[m])).product()
    };
    (0..t.len()).filter(|&j| j != node).map(|j| ratio(j) * (x[j] - x[node]) / (t[j] - t[node])).sum()
}
