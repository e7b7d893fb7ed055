//! Least-norm solutions of J x = r, many of them with one small J.
//!
//! Away from singular configurations x = Jᵀ(JJᵀ)⁻¹r by Cholesky, which squares the condition number; one step of refinement takes
//! that back where digits count. Near them, and for ranks below the number of rows, by singular values.

use super::dot;
use super::svd::Svd;

/// Where (Σσ² Σσ⁻²)^−½ is above this, JJᵀ is well enough conditioned.
const REGULAR: f64 = 3e-3;

/// Rows whose square is below this share of the largest one's say nothing: a plane arm cannot leave its plane.
const EMPTY_ROW: f64 = 1e-24;

/// A matrix J, m × n with m ≤ M, and what solves J x = r.
#[derive(Debug, Clone)]
pub(crate) struct LeastNorm<const M: usize> {
    n: usize,
    jacobian: Vec<f64>,
    /// Inverse of the lower Cholesky factor of JJᵀ; rows and columns of 0 for empty rows of J.
    inverse: [[f64; M]; M],
    rank: usize,
    /// (Σσ² Σσ⁻²)^−½, at most the ratio of the smallest to the largest singular value; 0 where nothing is known.
    conditioning: f64,
    exact: Option<Svd>,
}

impl<const M: usize> LeastNorm<M> {
    pub(crate) fn new(m: usize, n: usize) -> Self {
        let jacobian = vec![0.0; m * n];
        Self { n, jacobian, inverse: [[0.0; M]; M], rank: 0, conditioning: 0.0, exact: None }
    }

    /// Takes J as `fill` writes it, m × n, row-major.
    pub(crate) fn take(&mut self, fill: impl FnOnce(&mut [f64])) {
        fill(&mut self.jacobian);
        self.exact = None;
        self.factor();
        if !self.is_regular() {
            let exact = Svd::new(&self.jacobian, self.n);
            self.rank = exact.rank();
            self.exact = Some(exact);
        }
    }

    /// Whether J is far from losing rank.
    pub(crate) fn is_regular(&self) -> bool {
        self.conditioning > REGULAR
    }

    /// Singular values that count.
    pub(crate) fn rank(&self) -> usize {
        self.rank
    }

    /// (Σσ² Σσ⁻²)^−½ over the `rank` largest singular values: 0 at singular configurations, at most 1/rank.
    pub(crate) fn conditioning(&self, rank: usize) -> f64 {
        // A row may be empty in this configuration alone.
        if self.rank < rank {
            return 0.0;
        }
        self.exact.as_ref().map_or(self.conditioning, |exact| exact.conditioning(rank))
    }

    fn row(&self, i: usize) -> &[f64] {
        &self.jacobian[i * self.n..(i + 1) * self.n]
    }

    fn rows(&self) -> usize {
        self.jacobian.len() / self.n.max(1)
    }

    /// L⁻¹ of JJᵀ = LLᵀ, and with it 1/σ_min² ≤ tr (JJᵀ)⁻¹, σ_max² ≤ tr JJᵀ.
    fn factor(&mut self) {
        let m = self.rows();
        let mut gram = [[0.0; M]; M];
        for i in 0..m {
            for j in 0..=i {
                gram[i][j] = dot(self.row(i), self.row(j));
            }
        }
        let largest = (0..m).map(|i| gram[i][i]).fold(0.0, f64::max);
        self.inverse = [[0.0; M]; M];
        (self.rank, self.conditioning) = (0, 0.0);
        let (mut lower, mut empty) = ([[0.0; M]; M], [false; M]);
        for i in 0..m {
            empty[i] = gram[i][i] <= EMPTY_ROW * largest;
            if empty[i] {
                continue;
            }
            for j in (0..i).filter(|j| !empty[*j]) {
                let sum: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
                lower[i][j] = (gram[i][j] - sum) / lower[j][j];
            }
            let pivot = gram[i][i] - (0..i).map(|k| lower[i][k] * lower[i][k]).sum::<f64>();
            // Not positive, or no number: nothing is known.
            if pivot.is_nan() || pivot <= 0.1 * REGULAR * REGULAR * largest {
                return;
            }
            lower[i][i] = pivot.sqrt();
            self.inverse[i][i] = 1.0 / lower[i][i];
            for j in (0..i).rev() {
                let sum: f64 = (j..i).map(|k| lower[i][k] * self.inverse[k][j]).sum();
                self.inverse[i][j] = -sum * self.inverse[i][i];
            }
            self.rank += 1;
        }
        let squares: f64 = self.inverse.iter().flatten().map(|x| x * x).sum();
        let trace: f64 = (0..m).map(|i| gram[i][i]).sum();
        self.conditioning = (1.0 / (squares * trace)).sqrt();
    }

    /// (JJᵀ)⁻¹ r.
    fn gram_solve(&self, r: &[f64; M]) -> [f64; M] {
        let m = self.rows();
        let (mut z, mut y) = ([0.0; M], [0.0; M]);
        for i in 0..m {
            z[i] = (0..=i).map(|k| self.inverse[i][k] * r[k]).sum();
        }
        for i in 0..m {
            y[i] = (i..m).map(|k| self.inverse[k][i] * z[k]).sum();
        }
        y
    }

    /// x += Jᵀ y.
    fn add_transposed(&self, y: &[f64; M], x: &mut [f64]) {
        for (i, y) in y.iter().enumerate().take(self.rows()) {
            x.iter_mut().zip(self.row(i)).for_each(|(x, j)| *x += y * j);
        }
    }

    /// J x.
    fn times(&self, x: &[f64]) -> [f64; M] {
        let mut r = [0.0; M];
        for (i, r) in r.iter_mut().enumerate().take(self.rows()) {
            *r = dot(self.row(i), x);
        }
        r
    }

    /// The x of least norm with J x = r as nearly as can be, to a relative error of 1e-10.
    pub(crate) fn solve_roughly_into(&self, r: &[f64; M], x: &mut [f64]) {
        match &self.exact {
            Some(exact) => exact.solve_into(r, 0.0, x),
            None => {
                x.fill(0.0);
                self.add_transposed(&self.gram_solve(r), x);
            }
        }
    }

    /// The x of least norm with J x = r as nearly as can be, to rounding.
    pub(crate) fn solve_into(&self, r: &[f64; M], x: &mut [f64]) {
        self.solve_roughly_into(r, x);
        if self.exact.is_none() {
            let mut rest = self.times(x);
            rest.iter_mut().zip(r).for_each(|(rest, r)| *rest = r - *rest);
            self.add_transposed(&self.gram_solve(&rest), x);
        }
    }

    /// Jᵀ(JJᵀ + (damping·σ_max)²)⁻¹ r.
    pub(crate) fn solve_damped_into(&self, r: &[f64; M], damping: f64, x: &mut [f64]) {
        match &self.exact {
            Some(exact) => exact.solve_into(r, damping, x),
            None => Svd::new(&self.jacobian, self.n).solve_into(r, damping, x),
        }
    }

    /// y with x = Jᵀ y for x in the row space of J.
    pub(crate) fn transpose_solve(&self, x: &[f64]) -> [f64; M] {
        match &self.exact {
            Some(exact) => {
                let mut y = [0.0; M];
                exact.transpose_solve_into(x, &mut y);
                y
            }
            None => self.gram_solve(&self.times(x)),
        }
    }

    /// Takes away from x what J sees of it.
    pub(crate) fn project_to_null_space(&self, x: &mut [f64]) {
        match &self.exact {
            Some(exact) => exact.project_to_null_space(x),
            // Twice is enough.
            None => {
                for _ in 0..2 {
                    let y = self.gram_solve(&self.times(x));
                    self.add_transposed(&y.map(|y| -y), x);
                }
            }
        }
    }

    /// Columns that are not 0.
    pub(crate) fn moving(&self) -> impl Iterator<Item = bool> + '_ {
        let largest = self.jacobian.iter().map(|x| x.abs()).fold(0.0, f64::max);
        (0..self.n).map(move |j| (0..self.rows()).any(|i| self.row(i)[j].abs() > 1e-12 * largest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROWS: usize = 6;

    /// A matrix of numbers between −1 and 1, the same in every run.
    fn matrix(m: usize, n: usize, seed: u64) -> Vec<f64> {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        (0..m * n).map(|_| next()).collect()
    }

    fn gap(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn both_ways_agree() {
        let mut regular = 0;
        for seed in 0..400 {
            let (m, n) = ([3, 6][seed as usize % 2], [6, 7, 9][seed as usize % 3]);
            let mut jacobian = matrix(m, n, seed);
            if seed % 5 == 0 {
                jacobian[n..2 * n].fill(0.0);
            }
            let exact = Svd::new(&jacobian, n);
            let mut solver = LeastNorm::<ROWS>::new(m, n);
            solver.take(|rows| rows.copy_from_slice(&jacobian));
            assert_eq!(solver.rank(), exact.rank());
            let conditioning = exact.conditioning(exact.rank());
            assert!((solver.conditioning(exact.rank()) / conditioning - 1.0).abs() < 1e-9);
            if !solver.is_regular() {
                continue;
            }
            regular += 1;
            let r: [f64; ROWS] = std::array::from_fn(|i| if i < m { (i as f64 + 1.3).sin() } else { 0.0 });
            let (mut x, mut y) = (vec![0.0; n], vec![0.0; n]);
            solver.solve_into(&r, &mut x);
            exact.solve_into(&r, 0.0, &mut y);
            assert!(gap(&x, &y) < 1e-12 / conditioning, "{:.1e}", gap(&x, &y));
            let mut multipliers = [0.0; ROWS];
            exact.transpose_solve_into(&x, &mut multipliers);
            assert!(gap(&solver.transpose_solve(&x), &multipliers) < 1e-9 / conditioning);
            solver.solve_damped_into(&r, 0.1, &mut x);
            exact.solve_into(&r, 0.1, &mut y);
            assert_eq!(x, y);
            let (mut x, mut y) = (vec![1.0; n], vec![1.0; n]);
            solver.project_to_null_space(&mut x);
            exact.project_to_null_space(&mut y);
            assert!(gap(&x, &y) < 1e-12 / conditioning, "{:.1e}", gap(&x, &y));
        }
        assert!(regular > 300, "{regular}");
    }

    #[test]
    fn what_is_no_number_is_no_solution() {
        let mut solver = LeastNorm::<ROWS>::new(3, 4);
        solver.take(|rows| rows.fill(f64::NAN));
        assert!(!solver.is_regular());
    }
}
