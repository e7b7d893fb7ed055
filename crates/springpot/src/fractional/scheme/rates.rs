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

/// Coefficients in powers of t − t\[0\] of the polynomial through all of (t, x).
pub(super) fn start_polynomial(t: &[f64], x: &[f64]) -> Vec<f64> {
    let mut table = x.to_vec();
    // Newton's divided differences …
    for j in 1..x.len() {
        for i in (j..x.len()).rev() {
            table[i] = (table[i] - table[i - 1]) / (t[i] - t[i - j]);
        }
    }
    // … and Horner's rule from the factors (t − t_j) to powers.
    for j in (0..x.len().saturating_sub(1)).rev() {
        for i in j..x.len() - 1 {
            table[i] -= (t[j] - t[0]) * table[i + 1];
        }
    }
    table
}

/// Slope at node i of the polynomial through all of (t, x): Σ_{j≠i} r_j (x_j − x_i)/(t_j − t_i) with
/// r_j = Π_{m≠i,j} (t_i − t_m)/(t_j − t_m).
fn slope_at(node: usize, t: &[f64], x: &[f64]) -> f64 {
    let ratio = |j: usize| -> f64 {
        (0..t.len()).filter(|&m| m != j && m != node).map(|m| (t[node] - t[m]) / (t[j] - t[m])).product()
    };
    (0..t.len()).filter(|&j| j != node).map(|j| ratio(j) * (x[j] - x[node]) / (t[j] - t[node])).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn start_polynomial_recovers_coefficients() {
        let wanted = [0.3, -1.0, 2.0, 0.5, -0.25, 0.125, -0.0625, 0.03125];
        for warp in [0.0, 0.3] {
            let t: Vec<f64> = (0..8).map(|n| f64::from(n) + warp * f64::from(n).sin()).collect();
            let x: Vec<f64> = t.iter().map(|t| wanted.iter().rev().fold(0.0, |s, c| s * t + c)).collect();
            for (got, wanted) in start_polynomial(&t, &x).iter().zip(wanted) {
                assert!((got - wanted).abs() < 1e-10, "{got} {wanted}");
            }
        }
    }
}
