//! x' and x'' at samples from their neighbours.

/// Points whose polynomial gives x' and x'' for the quintic spline: both then err by O(h⁵) or less.
pub(in crate::fractional::differintegral) const QUINTIC_POINTS: usize = 7;
/// Points whose polynomial gives x' for the cubic: O(h⁴).
pub(in crate::fractional::differintegral) const CUBIC_POINTS: usize = 5;

/// Weights of x_j in x' and x'' at one of the points.
pub(in crate::fractional::differintegral) type Weights = [[f64; 2]; QUINTIC_POINTS];

/// First row of the `width` points nearest to `row` among `rows`.
pub(in crate::fractional::differintegral) fn first_point(row: usize, width: usize, rows: usize) -> usize {
    row.saturating_sub(width / 2).min(rows - width)
}

/// Weights of the derivatives at `at` of the polynomial through `points`, by recursion over the points.
///
/// B. Fornberg, Math. Comp. 51 (1988) 699.
pub(in crate::fractional::differintegral) fn weights(points: &[f64], at: usize) -> Weights {
    let z = points[at];
    let mut c = [[0.0; 3]; QUINTIC_POINTS];
    c[0][0] = 1.0;
    let (mut product, mut here) = (1.0, points[0] - z);
    for i in 1..points.len() {
        let (mut next, before) = (1.0, here);
        here = points[i] - z;
        for j in 0..i {
            let gap = points[i] - points[j];
            next *= gap;
            if j == i - 1 {
                let [w0, w1, w2] = c[i - 1];
                c[i] = [-before * w0, w0 - before * w1, 2.0 * w1 - before * w2].map(|w| product * w / next);
            }
            let [w0, w1, w2] = c[j];
            c[j] = [here * w0, here * w1 - w0, here * w2 - 2.0 * w1].map(|w| w / gap);
        }
        product = next;
    }
    c.map(|[_, first, second]| [first, second])
}

/// x' and x'' at point `at`; the weights of either sum to 0, so differences alone are summed.
pub(in crate::fractional::differintegral) fn apply(weights: &Weights, x: &[f64], at: usize) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for (w, value) in weights.iter().zip(x) {
        sums[0] += w[0] * (value - x[at]);
        sums[1] += w[1] * (value - x[at]);
    }
    sums
}

/// Weights on equal steps of 1, for every position among `width` points.
#[derive(Debug, Clone)]
pub(in crate::fractional::differintegral) struct Equal(Vec<Weights>);

impl Equal {
    pub(in crate::fractional::differintegral) fn new(width: usize) -> Self {
        let points: Vec<f64> = (0..width).map(|j| j as f64).collect();
        Self((0..width).map(|at| weights(&points, at)).collect())
    }

    /// Number of points.
    pub(in crate::fractional::differintegral) fn width(&self) -> usize {
        self.0.len()
    }

    /// x' and x'' at point `at` of points with this step.
    pub(in crate::fractional::differintegral) fn derivatives(&self, step: f64, x: &[f64], at: usize) -> [f64; 2] {
        let [first, second] = apply(&self.0[at], x, at);
        [first / step, second / (step * step)]
    }

    /// The same for any times; equal ones take the ready weights.
    pub(in crate::fractional::differintegral) fn derivatives_at(&self, t: &[f64], x: &[f64], at: usize) -> [f64; 2] {
        let last = self.width() - 1;
        let step = (t[last] - t[0]) / last as f64;
        let slack = 1e-12 * step + 4.0 * f64::EPSILON * t[last].abs();
        if (0..=last).all(|j| (t[j] - t[0] - j as f64 * step).abs() <= slack) {
            return self.derivatives(step, x, at);
        }
        let scaled: [f64; QUINTIC_POINTS] =
            std::array::from_fn(|j| if j <= last { (t[j] - t[at]) / step } else { 0.0 });
        let [first, second] = apply(&weights(&scaled[..=last], at), x, at);
        [first / step, second / (step * step)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_differentiated_exactly() {
        let points: [f64; 7] = [0.0, 0.3, 0.35, 1.0, 1.8, 2.0, 2.6];
        for at in 0..7 {
            let t = points[at];
            for degree in 0..7 {
                let n = degree as f64;
                let x: Vec<f64> = points.iter().map(|t: &f64| t.powi(degree)).collect();
                let [first, second] = apply(&weights(&points, at), &x, at);
                let exact = [n * t.powi(degree - 1), n * (n - 1.0) * t.powi(degree - 2)];
                let exact = exact.map(|value| if value.is_nan() { 0.0 } else { value });
                assert!((first - exact[0]).abs() < 1e-10 && (second - exact[1]).abs() < 1e-9, "{at} {degree}");
            }
        }
        // The classical formulas of sixth order.
        let middle = Equal::new(7).0[3].map(|w| w.map(|w| w * 180.0));
        for (w, first, second) in [(middle[0], -3.0, 2.0), (middle[1], 27.0, -27.0), (middle[2], -135.0, 270.0)] {
            assert!((w[0] - first).abs() < 1e-12 && (w[1] - second).abs() < 1e-12);
        }
    }
}
