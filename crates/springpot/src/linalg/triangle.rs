//! The triangle R of a QR factorisation whose rows come in blocks: memory n² whatever the number of rows.
//!
//! Each block is reflected into R (Householder; G. H. Golub, C. F. Van Loan, Matrix Computations, 4th ed. 2013, 5.2): R ← qr([R; block]).

/// The upper triangle of what it was given, n columns.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Triangle {
    n: usize,
    entries: Vec<f64>,
    work: Vec<f64>,
}

impl Triangle {
    pub(crate) fn new(n: usize) -> Self {
        Self { n, entries: vec![0.0; n * n], work: vec![0.0; n] }
    }

    /// R_ij; 0 below the diagonal.
    pub(crate) fn at(&self, i: usize, j: usize) -> f64 {
        self.entries[i * self.n + j]
    }

    /// Takes up rows of n numbers, which are destroyed.
    pub(crate) fn absorb(&mut self, rows: &mut [f64]) {
        let n = self.n;
        for k in 0..n {
            let below: f64 = rows.chunks_exact(n).map(|row| row[k] * row[k]).sum();
            if below == 0.0 {
                continue;
            }
            let own = &mut self.entries[k * n..(k + 1) * n];
            let (before, after) = (own[k], -(own[k] * own[k] + below).sqrt().copysign(own[k]));
            let head = before - after;
            let factor = -head / after;
            // w = (own row + Σ v_i row_i)·factor, v_i = row_i[k]/head.
            self.work[k + 1..].copy_from_slice(&own[k + 1..]);
            for row in rows.chunks_exact(n) {
                let share = row[k] / head;
                self.work[k + 1..].iter_mut().zip(&row[k + 1..]).for_each(|(w, x)| *w += share * x);
            }
            self.work[k + 1..].iter_mut().for_each(|w| *w *= factor);
            own[k] = after;
            own[k + 1..].iter_mut().zip(&self.work[k + 1..]).for_each(|(x, w)| *x -= w);
            for row in rows.chunks_exact_mut(n) {
                let share = row[k] / head;
                row[k] = 0.0;
                row[k + 1..].iter_mut().zip(&self.work[k + 1..]).for_each(|(x, w)| *x -= share * w);
            }
        }
    }

    /// Norm of column j, that of the same column of all rows.
    pub(crate) fn norm(&self, j: usize) -> f64 {
        (0..=j).map(|i| self.at(i, j).powi(2)).sum::<f64>().sqrt()
    }

    /// The product of columns i and j of all rows.
    pub(crate) fn product(&self, i: usize, j: usize) -> f64 {
        (0..=i.min(j)).map(|k| self.at(k, i) * self.at(k, j)).sum()
    }

    /// x of R₁ x = y, R₁ the first `y.len()` rows and columns; a row whose diagonal is 0 gives 0.
    pub(crate) fn solve(&self, y: &mut [f64]) {
        for i in (0..y.len()).rev() {
            let rest = y[i] - (i + 1..y.len()).map(|j| self.at(i, j) * y[j]).sum::<f64>();
            y[i] = if self.at(i, i) == 0.0 { 0.0 } else { rest / self.at(i, i) };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_of_any_size_give_one_triangle() {
        let rows: Vec<f64> = (0..40).map(|k| ((k * k + 3 * k + 1) as f64).sin()).collect();
        let mut whole = Triangle::new(4);
        whole.absorb(&mut rows.clone());
        for size in [1, 3, 7] {
            let mut parts = Triangle::new(4);
            rows.clone().chunks_mut(4 * size).for_each(|block| parts.absorb(block));
            for i in 0..4 {
                for j in 0..4 {
                    let exact: f64 = rows.chunks(4).map(|row| row[i] * row[j]).sum();
                    assert!((whole.product(i, j) - exact).abs() < 1e-14 && (parts.product(i, j) - exact).abs() < 1e-14);
                    assert!(i <= j || whole.at(i, j) == 0.0);
                }
            }
        }
        let mut x = [1.0, -2.0, 0.5];
        let y = x;
        whole.solve(&mut x);
        for i in 0..3 {
            assert!(((i..3).map(|j| whole.at(i, j) * x[j]).sum::<f64>() - y[i]).abs() < 1e-13);
        }
    }

    #[test]
    fn empty_columns_stay_empty() {
        let mut triangle = Triangle::new(3);
        triangle.absorb(&mut [1.0, 0.0, 2.0, 3.0, 0.0, 4.0]);
        assert_eq!((triangle.norm(1), triangle.at(1, 1)), (0.0, 0.0));
        let mut x = [1.0, 1.0];
        triangle.solve(&mut x);
        assert!(x[1] == 0.0 && x[0].is_finite());
    }
}
