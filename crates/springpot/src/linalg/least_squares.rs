//! Nonlinear least squares within bounds by the method of Levenberg and Marquardt.
//!
//! K. Levenberg, Q. Appl. Math. 2 (1944) 164–168; D. W. Marquardt, J. SIAM 11 (1963) 431–441.

use super::{dot, norm};

const ITERATIONS: usize = 200;
/// A column of which this share or less lies outside the span of the others depends on them.
const DEPENDENT: f64 = 1e-7;

/// One of N unknowns.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Unknown {
    /// Whether it may change.
    pub(crate) free: bool,
    /// Least and largest value.
    pub(crate) bounds: [f64; 2],
}

/// From `start` downhill to a minimum of Σ r_i(x)², i < `count`: that sum and x. `residual` gives r_i at x and its N derivatives.
///
/// A sum that is no number counts as infinite, and is not left.
pub(crate) fn levenberg_marquardt<const N: usize>(
    unknowns: &[Unknown; N],
    start: [f64; N],
    count: usize,
    residual: impl Fn(usize, &[f64; N]) -> (f64, [f64; N]),
) -> (f64, [f64; N]) {
    let cost_at = |x: &[f64; N]| {
        let cost: f64 = (0..count).map(|i| residual(i, x).0.powi(2)).sum();
        if cost.is_nan() { f64::INFINITY } else { cost }
    };
    let (mut at, mut cost, mut damping) = (start, cost_at(&start), 1e-3);
    for _ in 0..ITERATIONS {
        if !cost.is_finite() || cost == 0.0 {
            break;
        }
        let (mut normal, mut gradient) = ([[0.0; N]; N], [0.0; N]);
        for row in 0..count {
            let (value, slopes) = residual(row, &at);
            for i in 0..N {
                gradient[i] += slopes[i] * value;
                for j in 0..N {
                    normal[i][j] += slopes[i] * slopes[j];
                }
            }
        }
        let moves: [bool; N] = std::array::from_fn(|i| {
            let Unknown { free, bounds: [least, largest] } = unknowns[i];
            let leaves_below = at[i] <= least && gradient[i] > 0.0;
            let leaves_above = at[i] >= largest && gradient[i] < 0.0;
            free && !leaves_below && !leaves_above
        });
        for i in 0..N {
            for j in 0..N {
                if !(moves[i] && moves[j]) {
                    normal[i][j] = 0.0;
                }
            }
            normal[i][i] = if moves[i] { normal[i][i] * (1.0 + damping) } else { 1.0 };
            gradient[i] = if moves[i] { gradient[i] } else { 0.0 };
        }
        let Some(step) = cholesky_solve(normal, gradient) else { break };
        let next: [f64; N] = std::array::from_fn(|i| {
            let [least, largest] = unknowns[i].bounds;
            (at[i] - step[i]).max(least).min(largest)
        });
        let next_cost = cost_at(&next);
        if next_cost < cost {
            (at, cost, damping) = (next, next_cost, (damping / 10.0).max(1e-15));
        } else {
            damping *= 10.0;
            if damping > 1e12 {
                break;
            }
        }
    }
    (cost, at)
}

/// Whether no column is a linear combination of the others, to rounding: Gram and Schmidt.
pub(crate) fn are_independent(columns: impl IntoIterator<Item = Vec<f64>>) -> bool {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for mut column in columns {
        let size = norm(&column);
        for other in &basis {
            let along = dot(&column, other);
            column.iter_mut().zip(other).for_each(|(a, b)| *a -= along * b);
        }
        let rest = norm(&column);
        if !rest.is_finite() || rest <= DEPENDENT * size {
            return false;
        }
        basis.push(column.iter().map(|a| a / rest).collect());
    }
    true
}

/// x with A x = b, A positive definite, by Cholesky; `None` where A is singular.
pub(crate) fn cholesky_solve<const N: usize>(a: [[f64; N]; N], b: [f64; N]) -> Option<[f64; N]> {
    let mut l = [[0.0; N]; N];
    for i in 0..N {
        for j in 0..=i {
            let rest = a[i][j] - dot(&l[i][..j], &l[j][..j]);
            l[i][j] = if i == j { rest.sqrt() } else { rest / l[j][j] };
        }
        if l[i][i].is_nan() || l[i][i] <= 0.0 {
            return None;
        }
    }
    let mut x = b;
    for i in 0..N {
        x[i] = (x[i] - dot(&l[i][..i], &x[..i])) / l[i][i];
    }
    for i in (0..N).rev() {
        x[i] = (x[i] - (i + 1..N).map(|k| l[k][i] * x[k]).sum::<f64>()) / l[i][i];
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FREE: Unknown = Unknown { free: true, bounds: [f64::NEG_INFINITY, f64::INFINITY] };

    /// Rosenbrock's valley: r = (10(y − x²), 1 − x).
    fn valley(row: usize, &[x, y]: &[f64; 2]) -> (f64, [f64; 2]) {
        [(10.0 * (y - x * x), [-20.0 * x, 10.0]), (1.0 - x, [-1.0, 0.0])][row]
    }

    #[test]
    fn finds_minima_inside_and_on_bounds() {
        let (cost, [x, y]) = levenberg_marquardt(&[FREE; 2], [-1.2, 1.0], 2, valley);
        assert!(cost < 1e-25 && (x - 1.0).abs() < 1e-12 && (y - 1.0).abs() < 1e-12, "{cost} {x} {y}");
        // y = 4 held: the nearest minimum along x obeys 200 x (x² − 4) = 1 − x.
        let held = [FREE, Unknown { free: false, ..FREE }];
        let (_, [x, y]) = levenberg_marquardt(&held, [1.5, 4.0], 2, valley);
        assert!(y == 4.0 && (200.0 * x * (x * x - 4.0) - (1.0 - x)).abs() < 1e-4, "{x}");
        let bound = [Unknown { bounds: [-1.0, 0.5], ..FREE }, FREE];
        let (_, [x, y]) = levenberg_marquardt(&bound, [-0.5, 1.0], 2, valley);
        assert!(x == 0.5 && (y - 0.25).abs() < 1e-7, "{x} {y}");
    }

    #[test]
    fn what_is_no_number_is_not_left() {
        let (cost, at) = levenberg_marquardt(&[FREE], [2.0], 1, |_, _| (f64::NAN, [1.0]));
        assert_eq!((cost, at), (f64::INFINITY, [2.0]));
    }

    #[test]
    fn columns_that_depend() {
        assert!(are_independent([vec![1.0, 0.0, 1.0], vec![1.0, 1e-6, 1.0]]));
        assert!(!are_independent([vec![1.0, 2.0, 3.0], vec![0.0, 1.0, 0.0], vec![2.0, 7.0, 6.0]]));
        assert!(!are_independent([vec![0.0, 0.0]]));
    }
}
