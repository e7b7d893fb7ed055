//! Dense linear systems by Gaussian elimination: P A = L U with partial pivoting (G. H. Golub, C. F. Van Loan, Matrix
//! Computations, 4th ed. 2013, 3.4).

use super::columns::{Block, LANES, put_block, take_block};
use super::row_lu::RowLu;
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f64x8};

/// An n × n matrix factorised by rows with partial pivoting.
#[derive(Debug, Clone, Default)]
pub(crate) struct Lu {
    n: usize,
    entries: Vec<f64>,
    order: Vec<usize>,
    scratch: Vec<f64>,
    /// Room for blocks of columns.
    rows: [Vec<Block>; 2],
    /// The factors of matrices of [`WIDE`] rows and more.
    wide: RowLu<1>,
}

/// From so many rows on, whole rows go through wide registers.
const WIDE: usize = 16;

impl Lu {
    /// Factors the n × n matrix that `fill` writes row by row into zeros; `false` where it is singular or not finite.
    pub(crate) fn factor(&mut self, n: usize, fill: impl FnOnce(&mut [f64])) -> bool {
        self.n = n;
        self.entries.clear();
        self.entries.resize(n * n, 0.0);
        self.scratch.resize(n, 0.0);
        self.order.clear();
        self.order.extend(0..n);
        fill(&mut self.entries);
        if n >= WIDE {
            return self.wide.factor(n, |r, [row]| row.copy_from_slice(&self.entries[r * n..][..n]));
        }
        let m = &mut self.entries;
        for k in 0..n {
            let size = |row: usize, m: &[f64]| m[row * n + k].abs();
            let best = (k + 1..n).fold(k, |best, row| if size(row, m) > size(best, m) { row } else { best });
            if !(size(best, m) > 0.0 && size(best, m).is_finite()) {
                return false;
            }
            if best != k {
                let (upper, lower) = m.split_at_mut(best * n);
                upper[k * n..k * n + n].swap_with_slice(&mut lower[..n]);
                self.order.swap(k, best);
            }
            let (upper, lower) = m.split_at_mut((k + 1) * n);
            let pivot_row = &upper[k * n..];
            let inverse = 1.0 / pivot_row[k];
            for row in lower.chunks_exact_mut(n) {
                let factor = row[k] * inverse;
                row[k] = factor;
                if factor != 0.0 {
                    for (entry, pivot) in row[k + 1..].iter_mut().zip(&pivot_row[k + 1..]) {
                        *entry -= factor * pivot;
                    }
                }
            }
        }
        true
    }

    /// Factors the rows and columns `part` of a full n × n matrix; `false` as for [`Lu::factor`], of an empty part `true`.
    pub(crate) fn factor_part(&mut self, n: usize, full: &[f64], part: &[usize]) -> bool {
        self.factor(part.len(), |matrix| {
            for (line, &row) in matrix.chunks_exact_mut(part.len().max(1)).zip(part) {
                for (entry, &column) in line.iter_mut().zip(part) {
                    *entry = full[row * n + column];
                }
            }
        })
    }

    /// Solves in place: `x` holds the right-hand side before and the solution after.
    pub(crate) fn solve(&mut self, x: &mut [f64]) {
        let n = self.n;
        if n >= WIDE {
            return self.wide.solve([x]);
        }
        for (slot, &source) in self.scratch.iter_mut().zip(&self.order) {
            *slot = x[source];
        }
        let y = &mut self.scratch;
        for k in 0..n {
            let sum: f64 = self.entries[k * n..k * n + k].iter().zip(y.iter()).map(|(l, y)| l * y).sum();
            y[k] -= sum;
        }
        for k in (0..n).rev() {
            let row = &self.entries[k * n..(k + 1) * n];
            let sum: f64 = row[k + 1..].iter().zip(&y[k + 1..]).map(|(u, y)| u * y).sum();
            y[k] = (y[k] - sum) / row[k];
        }
        x.copy_from_slice(y);
    }

    /// Solves for `count` right-hand sides at once, which stand side by side: row k of `x` has component k of all of them.
    pub(crate) fn solve_rows(&mut self, x: &mut [f64], count: usize) {
        let mut rows = std::mem::take(&mut self.rows);
        self.solve_rows_within(&mut rows, x, count);
        self.rows = rows;
    }

    /// The same in room of the caller's.
    pub(crate) fn solve_rows_within(&self, [given, found]: &mut [Vec<Block>; 2], x: &mut [f64], count: usize) {
        if self.n >= WIDE {
            return self.wide.solve_rows_within([given, found], x, count);
        }
        let Self { n, entries, order, .. } = self;
        for rows in [&mut *given, &mut *found] {
            rows.resize(*n, [0.0; LANES]);
        }
        for first in (0..count).step_by(LANES) {
            take_block(x, count, first, given);
            dispatch!(Level::new(), simd => solve_block(simd, (entries, order), given, found));
            put_block(found, x, count, first);
        }
    }
}

/// Solves for one block of right-hand sides.
#[inline(always)]
fn solve_block<S: Simd>(simd: S, (entries, order): (&[f64], &[usize]), given: &[Block], found: &mut [Block]) {
    let n = found.len();
    for k in 0..n {
        let mut sum = f64x8::load_array_ref(simd, &given[order[k]]);
        let factors = &entries[k * n..(k + 1) * n];
        for j in 0..k {
            sum -= f64x8::load_array_ref(simd, &found[j]) * factors[j];
        }
        sum.store_array(&mut found[k]);
    }
    for k in (0..n).rev() {
        let (mut sum, factors) = (f64x8::load_array_ref(simd, &found[k]), &entries[k * n..(k + 1) * n]);
        for j in k + 1..n {
            sum -= f64x8::load_array_ref(simd, &found[j]) * factors[j];
        }
        (sum / f64x8::splat(simd, factors[k])).store_array(&mut found[k]);
    }
}

#[cfg(test)]
mod tests {
    use super::{Lu, WIDE};

    #[test]
    fn solves_and_tells_singular_matrices() {
        solves(7);
        solves(WIDE + 3);
        let mut lu = Lu::default();
        assert!(!lu.factor(2, |m| m.copy_from_slice(&[1.0, 2.0, 2.0, 4.0])));
        assert!(!lu.factor(1, |m| m[0] = f64::NAN));
        assert!(!lu.factor(WIDE, |m| m.fill(1.0)));
    }

    fn solves(n: usize) {
        let entry = |r: usize, c: usize| ((3 * r + 5 * c * c) as f64).sin() + if r == (c + 3) % n { 4.0 } else { 0.0 };
        let x: Vec<f64> = (0..n).map(|k| (k as f64).cos()).collect();
        let mut y: Vec<f64> = (0..n).map(|r| (0..n).map(|c| entry(r, c) * x[c]).sum()).collect();
        let mut lu = Lu::default();
        assert!(lu.factor(n, |m| (0..n * n).for_each(|k| m[k] = entry(k / n, k % n))));
        lu.solve(&mut y);
        assert!(x.iter().zip(&y).all(|(x, y)| (x - y).abs() < 1e-14), "{y:?}");
        // More columns than a block has, and not whole ones.
        for count in [2, 11] {
            let mut rows: Vec<f64> = (0..count * n).map(|k| ((k * k) as f64).sin()).collect();
            let each: Vec<Vec<f64>> = (0..count)
                .map(|side| {
                    let mut one: Vec<f64> = (0..n).map(|k| rows[count * k + side]).collect();
                    lu.solve(&mut one);
                    one
                })
                .collect();
            lu.solve_rows(&mut rows, count);
            let is_same = |k: usize| (rows[k] - each[k % count][k / count]).abs() < 1e-14;
            assert!((0..count * n).all(is_same), "{rows:?}");
        }
    }
}
