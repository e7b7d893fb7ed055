//! Dense complex linear systems by Gaussian elimination with partial pivoting.

use num_complex::Complex64;

/// P A = L U of an n × n complex matrix.
#[derive(Debug, Clone)]
pub(crate) struct ComplexLu {
    n: usize,
    entries: Vec<Complex64>,
    order: Vec<usize>,
    is_odd: bool,
}

impl ComplexLu {
    /// Factors a row-major matrix. Pivots that vanish are as small as rounding, so that singular matrices can be solved along their null
    /// space.
    pub(crate) fn new(n: usize, mut entries: Vec<Complex64>) -> Self {
        let mut order: Vec<usize> = (0..n).collect();
        let mut is_odd = false;
        let largest = entries.iter().fold(0.0, |most: f64, entry| most.max(entry.norm()));
        let least = f64::EPSILON * largest.max(f64::MIN_POSITIVE);
        for k in 0..n {
            let sizes: Vec<f64> = (k..n).map(|row| entries[row * n + k].norm_sqr()).collect();
            let best = k + (0..n - k).fold(0, |best, row| if sizes[row] > sizes[best] { row } else { best });
            if best != k {
                for column in 0..n {
                    entries.swap(k * n + column, best * n + column);
                }
                order.swap(k, best);
                is_odd = !is_odd;
            }
            if entries[k * n + k].norm() < least * f64::EPSILON {
                entries[k * n + k] = least.into();
            }
            let inverse = entries[k * n + k].inv();
            let (upper, lower) = entries.split_at_mut((k + 1) * n);
            let pivot = &upper[k * n..];
            for row in lower.chunks_exact_mut(n) {
                let factor = row[k] * inverse;
                row[k] = factor;
                if factor != Complex64::ZERO {
                    row[k + 1..].iter_mut().zip(&pivot[k + 1..]).for_each(|(entry, pivot)| *entry -= factor * pivot);
                }
            }
        }
        Self { n, entries, order, is_odd }
    }

    /// x of A x = b.
    pub(crate) fn solve(&self, b: &[Complex64]) -> Vec<Complex64> {
        let (n, m) = (self.n, &self.entries);
        let mut x: Vec<Complex64> = self.order.iter().map(|&source| b[source]).collect();
        for k in 0..n {
            let sum: Complex64 = (0..k).map(|j| m[k * n + j] * x[j]).sum();
            x[k] -= sum;
        }
        for k in (0..n).rev() {
            let sum: Complex64 = (k + 1..n).map(|j| m[k * n + j] * x[j]).sum();
            x[k] = (x[k] - sum) / m[k * n + k];
        }
        x
    }

    /// x of Aᵀ x = b.
    pub(crate) fn solve_transposed(&self, b: &[Complex64]) -> Vec<Complex64> {
        let (n, m) = (self.n, &self.entries);
        let mut y = b.to_vec();
        for k in 0..n {
            let sum: Complex64 = (0..k).map(|j| m[j * n + k] * y[j]).sum();
            y[k] = (y[k] - sum) / m[k * n + k];
        }
        for k in (0..n).rev() {
            let sum: Complex64 = (k + 1..n).map(|j| m[j * n + k] * y[j]).sum();
            y[k] -= sum;
        }
        let mut x = vec![Complex64::ZERO; n];
        self.order.iter().zip(y).for_each(|(&target, y)| x[target] = y);
        x
    }

    /// arg det A, within a whole number of turns.
    pub(crate) fn phase(&self) -> f64 {
        let turned = if self.is_odd { std::f64::consts::PI } else { 0.0 };
        (0..self.n).map(|k| self.entries[k * (self.n + 1)].arg()).sum::<f64>() + turned
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_both_ways_and_knows_the_phase() {
        let n = 5;
        let entry = |r: usize, c: usize| {
            Complex64::new(((3 * r + 5 * c * c + r * c) as f64).sin(), ((r * r * c + 1) as f64).cos())
        };
        let matrix: Vec<Complex64> = (0..n * n).map(|k| entry(k / n, k % n)).collect();
        let x: Vec<Complex64> = (0..n).map(|k| Complex64::new(k as f64, 1.0 - k as f64)).collect();
        let lu = ComplexLu::new(n, matrix.clone());
        let product = |at: &dyn Fn(usize, usize) -> Complex64| -> Vec<Complex64> {
            (0..n).map(|r| (0..n).map(|c| at(r, c) * x[c]).sum()).collect()
        };
        let near = |y: Vec<Complex64>| y.iter().zip(&x).all(|(a, b)| (a - b).norm() < 1e-12);
        assert!(near(lu.solve(&product(&entry))));
        assert!(near(lu.solve_transposed(&product(&|r, c| entry(c, r)))));
        // The determinant by minors of 2 × 2.
        let two =
            [Complex64::new(1.0, 2.0), Complex64::new(0.0, 3.0), Complex64::new(-4.0, 1.0), Complex64::new(2.0, 2.0)];
        let phase = ComplexLu::new(2, two.to_vec()).phase() - (two[0] * two[3] - two[1] * two[2]).arg();
        assert!((phase.sin().abs() < 1e-14) && phase.cos() > 0.0, "{phase}");
    }
}
