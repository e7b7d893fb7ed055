//! Singular values of a small wide matrix, and its pseudo-inverse.

use super::{dot, norm};

/// Singular values below this share of the largest count as 0.
const RANK_TOLERANCE: f64 = 1e-9;

/// Singular value decomposition of an m × n matrix J with few rows: Jᵀ v_k = w_k, the w_k orthogonal with norms σ_k.
#[derive(Debug, Clone)]
pub(super) struct Svd {
    /// w_k, n values each.
    w: Vec<Vec<f64>>,
    /// v_k, m values each, orthonormal.
    v: Vec<Vec<f64>>,
    sigma: Vec<f64>,
}

/// Singular values of a matrix of m columns, each with its right singular vector, m numbers; the columns follow one another.
pub(crate) fn column_singular_values(columns: &[f64], m: usize) -> Vec<(f64, Vec<f64>)> {
    if m == 0 {
        return Vec::new();
    }
    let Svd { v, sigma, .. } = Svd::new(columns, columns.len() / m);
    sigma.into_iter().zip(v).collect()
}

impl Svd {
    /// One-sided Jacobi rotations on the rows of J, m × `n` (M. R. Hestenes, J. SIAM 6 (1958) 51–90).
    pub(super) fn new(matrix: &[f64], n: usize) -> Self {
        let mut w: Vec<Vec<f64>> = matrix.chunks(n).map(<[f64]>::to_vec).collect();
        let m = w.len();
        let mut v: Vec<Vec<f64>> = (0..m).map(|k| (0..m).map(|i| if i == k { 1.0 } else { 0.0 }).collect()).collect();
        for _ in 0..40 {
            let mut turned = false;
            for p in 0..m {
                for q in p + 1..m {
                    let (pp, qq, pq) = (dot(&w[p], &w[p]), dot(&w[q], &w[q]), dot(&w[p], &w[q]));
                    if pq.abs() <= 1e-16 * (pp * qq).sqrt() {
                        continue;
                    }
                    turned = true;
                    let zeta = (qq - pp) / (2.0 * pq);
                    let t = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
                    let c = 1.0 / t.hypot(1.0);
                    rotate(&mut w, p, q, c, c * t);
                    rotate(&mut v, p, q, c, c * t);
                }
            }
            if !turned {
                break;
            }
        }
        let sigma = w.iter().map(|w| norm(w)).collect();
        Self { w, v, sigma }
    }

    /// Number of singular values that count.
    pub(super) fn rank(&self) -> usize {
        self.regular(0.0).count()
    }

    /// (Σσ² Σσ⁻²)^−½ over the `rank` largest singular values; 0 where one of them is 0.
    pub(super) fn conditioning(&self, rank: usize) -> f64 {
        let mut sigma = self.sigma.clone();
        sigma.sort_by(|a, b| b.total_cmp(a));
        let used = &sigma[..rank.min(sigma.len())];
        let squares: f64 = used.iter().map(|s| s * s).sum();
        let inverses: f64 = used.iter().map(|s| 1.0 / (s * s)).sum();
        let product = (squares * inverses).sqrt();
        if product.is_finite() && product > 0.0 { 1.0 / product } else { 0.0 }
    }

    /// The x of least norm with J x = r as nearly as can be; `damping` (relative to the largest σ) bounds x near singularities.
    pub(super) fn solve_into(&self, r: &[f64], damping: f64, x: &mut [f64]) {
        x.fill(0.0);
        for (k, inverse) in self.regular(damping) {
            let share = dot(&self.v[k], r) * inverse;
            x.iter_mut().zip(&self.w[k]).for_each(|(x, w)| *x += share * w);
        }
    }

    /// y with x = Jᵀ y for x in the row space of J.
    pub(super) fn transpose_solve_into(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for (k, inverse) in self.regular(0.0) {
            let share = dot(&self.w[k], x) * inverse;
            y.iter_mut().zip(&self.v[k]).for_each(|(y, v)| *y += share * v);
        }
    }

    /// Takes away from x what J sees of it.
    pub(super) fn project_to_null_space(&self, x: &mut [f64]) {
        for (k, inverse) in self.regular(0.0) {
            let share = dot(&self.w[k], x) * inverse;
            x.iter_mut().zip(&self.w[k]).for_each(|(x, w)| *x -= share * w);
        }
    }

    fn largest(&self) -> f64 {
        self.sigma.iter().copied().fold(0.0, f64::max)
    }

    /// The singular triples that count, with 1/(σ² + damping²).
    fn regular(&self, damping: f64) -> impl Iterator<Item = (usize, f64)> + '_ {
        let largest = self.largest();
        let floor = RANK_TOLERANCE * largest;
        let damping = damping * largest;
        let triples = self.sigma.iter().enumerate().filter(move |(_, s)| **s > floor);
        triples.map(move |(k, s)| (k, 1.0 / (s * s + damping * damping)))
    }
}

fn rotate(columns: &mut [Vec<f64>], p: usize, q: usize, c: f64, s: f64) {
    for i in 0..columns[p].len() {
        let (x, y) = (columns[p][i], columns[q][i]);
        columns[p][i] = c * x - s * y;
        columns[q][i] = s * x + c * y;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solved(inverse: &Svd, r: &[f64], n: usize) -> Vec<f64> {
        let mut x = vec![f64::NAN; n];
        inverse.solve_into(r, 0.0, &mut x);
        x
    }

    #[test]
    fn solves_wide_square_and_deficient_systems() {
        let wide = [1.0, 2.0, 3.0, 0.5, 0.0, -1.0, 1.0, 2.0];
        let inverse = Svd::new(&wide, 4);
        let x = solved(&inverse, &[1.0, -2.0], 4);
        assert!((dot(&wide[..4], &x) - 1.0).abs() < 1e-14 && (dot(&wide[4..], &x) + 2.0).abs() < 1e-14);
        // Least norm: nothing of x lies in the null space.
        let mut rest = x.clone();
        inverse.project_to_null_space(&mut rest);
        assert!(norm(&rest) < 1e-14);
        let mut y = [f64::NAN; 2];
        inverse.transpose_solve_into(&x, &mut y);
        for j in 0..4 {
            assert!((wide[j] * y[0] + wide[4 + j] * y[1] - x[j]).abs() < 1e-14);
        }
        // The third row is the sum of the first two: consistent right-hand sides are met.
        let inverse = Svd::new(&[1.0, 0.0, 0.0, 2.0, 1.0, 2.0], 2);
        assert_eq!(inverse.rank(), 2);
        assert!(inverse.conditioning(3) < 1e-15 && inverse.conditioning(2) > 0.1 && inverse.conditioning(0) == 0.0);
        let x = solved(&inverse, &[3.0, 4.0, 7.0], 2);
        assert!((x[0] - 3.0).abs() < 1e-14 && (x[1] - 2.0).abs() < 1e-14);
    }
}
