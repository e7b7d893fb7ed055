//! One zero of the determinant to the last digits.

use super::pencil::Pencil;
use crate::linalg::ComplexLu;
use num_complex::Complex64;

const MOST_STEPS: usize = 60;
/// Nearer to the branch point there is no zero of its own.
const NEAREST: f64 = 1e-9;

/// A zero with its vector.
#[derive(Debug, Clone)]
pub(super) struct Root {
    pub(super) s: Complex64,
    /// T(s) x = 0, |x| = 1.
    pub(super) x: Vec<Complex64>,
}

/// The zero near `start`, on the sheet that goes on from the upper half of the plane; `None` where the iteration finds none.
///
/// s ← s − yᵀTx/yᵀT'x with x ← T⁻¹T'x, y ← T⁻ᵀT'ᵀy (A. Ruhe, SIAM J. Numer. Anal. 10 (1973) 674): of third order at simple and
/// semisimple zeros.
pub(super) fn refine(pencil: &Pencil, start: Complex64) -> Option<Root> {
    let n = pencil.size;
    let mut s = start;
    let spread = |k: usize| Complex64::from(1.0 + 0.5 * (1.0 + 2.3 * k as f64).sin());
    let mut x: Vec<Complex64> = (0..n).map(spread).collect();
    let mut y = x.clone();
    let mut before = f64::INFINITY;
    for step in 0..MOST_STEPS {
        if !(s.norm() > NEAREST && s.is_finite()) {
            return None;
        }
        let [value, slope] = pencil.at(s);
        let lu = ComplexLu::new(n, value.clone());
        x = unit(lu.solve(&times(&slope, n, &x)))?;
        y = unit(lu.solve_transposed(&transposed_times(&slope, n, &y)))?;
        let along = |matrix: &[Complex64]| y.iter().zip(times(matrix, n, &x)).map(|(y, m)| y * m).sum::<Complex64>();
        let change = along(&value) / along(&slope);
        if !change.is_finite() {
            return None;
        }
        let longest = 0.5 * s.norm();
        let change = if change.norm() > longest { change * (longest / change.norm()) } else { change };
        s -= change;
        let share = change.norm() / s.norm();
        // What no longer shrinks is rounding.
        if share <= 2.0 * f64::EPSILON || (step > 3 && share < 1e-11 && share >= 0.5 * before) {
            let residual = times(&pencil.at(s)[0], n, &x).iter().map(Complex64::norm_sqr).sum::<f64>().sqrt();
            return (residual <= 1e-9 * pencil.shares(s, &x)[1]).then_some(Root { s, x });
        }
        before = share;
    }
    None
}

/// The dimension of the null space of T(s), by complete pivoting.
pub(super) fn nullity(pencil: &Pencil, s: Complex64) -> usize {
    let n = pencil.size;
    let mut m = pencil.at(s).into_iter().next().unwrap_or_default();
    let mut first = 0.0;
    for k in 0..n {
        let places = (k..n).flat_map(|r| (k..n).map(move |c| (r, c)));
        let size = |(r, c): (usize, usize)| m[r * n + c].norm();
        let Some((row, column)) = places.max_by(|&a, &b| size(a).total_cmp(&size(b))) else { return 0 };
        let pivot = size((row, column));
        if k == 0 {
            first = pivot;
        }
        if pivot <= 1e-9 * first {
            return n - k;
        }
        for j in 0..n {
            m.swap(k * n + j, row * n + j);
        }
        for i in 0..n {
            m.swap(i * n + k, i * n + column);
        }
        for r in k + 1..n {
            let factor = m[r * n + k] / m[k * n + k];
            for c in k..n {
                let entry = factor * m[k * n + c];
                m[r * n + c] -= entry;
            }
        }
    }
    0
}

fn unit(mut x: Vec<Complex64>) -> Option<Vec<Complex64>> {
    let largest = x.iter().fold(0.0, |most: f64, x| most.max(x.norm()));
    if !(largest > 0.0 && largest.is_finite()) {
        return None;
    }
    x.iter_mut().for_each(|x| *x /= largest);
    let size = x.iter().map(Complex64::norm_sqr).sum::<f64>().sqrt();
    x.iter_mut().for_each(|x| *x /= size);
    Some(x)
}

fn times(matrix: &[Complex64], n: usize, x: &[Complex64]) -> Vec<Complex64> {
    matrix.chunks_exact(n).map(|row| row.iter().zip(x).map(|(m, x)| m * x).sum()).collect()
}

fn transposed_times(matrix: &[Complex64], n: usize, x: &[Complex64]) -> Vec<Complex64> {
    (0..n).map(|c| (0..n).map(|r| matrix[r * n + c] * x[r]).sum()).collect()
}
