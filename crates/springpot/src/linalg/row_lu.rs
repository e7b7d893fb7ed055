//! P A = L U of real and of complex matrices, whose rows go through registers eight numbers at a time: Gaussian elimination with partial pivoting
//! (G. H. Golub, C. F. Van Loan, Matrix Computations, 4th ed. 2013, 3.4).
//!
//! Rows are filled up with zeros to whole blocks, real parts in front of imaginary ones, so that no loop has a rest. Products and sums are never joined
//! into one rounding: every machine finds the same bits.

use super::columns::{Block, LANES, put_block, take_block};
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f64x8};

/// The factors of an n × n matrix of numbers with so many parts: 1 where they are real, 2 where they are complex.
#[derive(Debug, Clone, Default)]
pub(crate) struct RowLu<const PARTS: usize> {
    n: usize,
    /// Blocks of a part of a row.
    width: usize,
    /// Right and left of the diagonal, zero elsewhere.
    upper: Vec<Block>,
    lower: Vec<Block>,
    /// Inverses of the pivots.
    inverse: Vec<[f64; PARTS]>,
    order: Vec<usize>,
    /// Room for a right-hand side, and for blocks of several.
    y: Vec<Block>,
    rows: [Vec<Block>; 2],
}

impl<const PARTS: usize> RowLu<PARTS> {
    /// Factors the matrix whose row r, n zeros for each part, `fill(r, …)` writes; `false` where it is singular or not finite.
    pub(crate) fn factor(&mut self, n: usize, fill: impl FnMut(usize, [&mut [f64]; PARTS])) -> bool {
        self.factor_at(Level::new(), n, fill)
    }

    fn factor_at(&mut self, level: Level, n: usize, mut fill: impl FnMut(usize, [&mut [f64]; PARTS])) -> bool {
        let width = n.div_ceil(LANES);
        (self.n, self.width) = (n, width);
        for rows in [&mut self.upper, &mut self.lower] {
            rows.clear();
            rows.resize(n * PARTS * width, [0.0; LANES]);
        }
        self.inverse.clear();
        self.order.clear();
        self.order.extend(0..n);
        for (r, row) in self.upper.chunks_exact_mut((PARTS * width).max(1)).enumerate() {
            let mut parts = row.as_flattened_mut().chunks_exact_mut(width * LANES);
            fill(r, std::array::from_fn(|_| &mut parts.next().expect("a part")[..n]));
        }
        dispatch!(level, simd => self.eliminate(simd))
    }

    // Closures cannot be made to be inlined, and what is not would be compiled without the wide registers: here are loops and functions alone.
    #[inline(always)]
    fn eliminate<S: Simd>(&mut self, simd: S) -> bool {
        let (n, width, long) = (self.n, self.width, PARTS * self.width);
        for k in 0..n {
            let at = (k / LANES, k % LANES);
            let (mut best, mut largest) = (k, square::<PARTS>(entry(&self.upper[k * long..][..long], width, at)));
            for r in k + 1..n {
                let size = square::<PARTS>(entry(&self.upper[r * long..][..long], width, at));
                if size > largest {
                    (best, largest) = (r, size);
                }
            }
            if !(largest > 0.0 && largest.is_finite()) {
                return false;
            }
            if best != k {
                for rows in [&mut self.upper, &mut self.lower] {
                    let (above, below) = rows.split_at_mut(best * long);
                    above[k * long..][..long].swap_with_slice(&mut below[..long]);
                }
                self.order.swap(k, best);
            }
            let (above, below) = self.upper.split_at_mut((k + 1) * long);
            let pivot = &mut above[k * long..];
            let inverse = invert::<PARTS>(entry(pivot, width, at));
            self.inverse.push(inverse);
            for r in k + 1..n {
                let row = &mut below[(r - k - 1) * long..][..long];
                let factor = times(entry(row, width, at), inverse);
                if square::<PARTS>(factor) > 0.0 {
                    set(&mut self.lower[r * long..][..long], width, at, factor);
                    subtract(simd, row, pivot, factor, (at.0, width));
                    set(row, width, at, [0.0; PARTS]);
                }
            }
            set(pivot, width, at, [0.0; PARTS]);
        }
        true
    }

    /// Solves in place: the parts of `x` hold the right-hand side before and the solution after.
    pub(crate) fn solve(&mut self, x: [&mut [f64]; PARTS]) {
        self.solve_at(Level::new(), x);
    }

    fn solve_at(&mut self, level: Level, x: [&mut [f64]; PARTS]) {
        dispatch!(level, simd => self.substitute(simd, x));
    }

    #[inline(always)]
    fn substitute<S: Simd>(&mut self, simd: S, x: [&mut [f64]; PARTS]) {
        let (n, width, long) = (self.n, self.width, PARTS * self.width);
        let y = &mut self.y;
        y.clear();
        y.resize(long, [0.0; LANES]);
        for part in 0..PARTS {
            for k in 0..n {
                y[part * width + k / LANES][k % LANES] = x[part][self.order[k]];
            }
        }
        for k in 0..n {
            let (at, row) = ((k / LANES, k % LANES), &self.lower[k * long..][..long]);
            let left: [f64; PARTS] = without(entry(y, width, at), dot(simd, row, y, (0, k.div_ceil(LANES), width)));
            set(y, width, at, left);
        }
        for k in (0..n).rev() {
            let (at, row) = ((k / LANES, k % LANES), &self.upper[k * long..][..long]);
            let left: [f64; PARTS] = without(entry(y, width, at), dot(simd, row, y, (k / LANES, width, width)));
            set(y, width, at, times(left, self.inverse[k]));
        }
        for part in 0..PARTS {
            for k in 0..n {
                x[part][k] = y[part * width + k / LANES][k % LANES];
            }
        }
    }
}

impl RowLu<1> {
    /// Solves for `count` right-hand sides at once, which stand side by side: row k of `x` has component k of all of them.
    pub(crate) fn solve_rows(&mut self, x: &mut [f64], count: usize) {
        let mut rows = std::mem::take(&mut self.rows);
        self.solve_rows_within(rows.each_mut(), x, count);
        self.rows = rows;
    }

    /// The same in room of the caller's.
    pub(super) fn solve_rows_within(&self, [given, found]: [&mut Vec<Block>; 2], x: &mut [f64], count: usize) {
        for rows in [&mut *given, &mut *found] {
            rows.resize(self.n, [0.0; LANES]);
        }
        for first in (0..count).step_by(LANES) {
            take_block(x, count, first, given);
            dispatch!(Level::new(), simd => self.substitute_block(simd, given, found));
            put_block(found, x, count, first);
        }
    }

    #[inline(always)]
    fn substitute_block<S: Simd>(&self, simd: S, given: &[Block], found: &mut [Block]) {
        let (n, long) = (self.n, self.width * LANES);
        let (lower, upper) = (self.lower.as_flattened(), self.upper.as_flattened());
        for k in 0..n {
            let (mut sum, row) = (f64x8::load_array_ref(simd, &given[self.order[k]]), &lower[k * long..][..k]);
            for j in 0..k {
                sum -= f64x8::load_array_ref(simd, &found[j]) * row[j];
            }
            sum.store_array(&mut found[k]);
        }
        for k in (0..n).rev() {
            let (mut sum, row) = (f64x8::load_array_ref(simd, &found[k]), &upper[k * long..][..n]);
            for j in k + 1..n {
                sum -= f64x8::load_array_ref(simd, &found[j]) * row[j];
            }
            (sum * self.inverse[k][0]).store_array(&mut found[k]);
        }
    }
}

/// A number of a row: its block and its lane.
#[inline(always)]
fn entry<const PARTS: usize>(row: &[Block], width: usize, (block, lane): (usize, usize)) -> [f64; PARTS] {
    let mut parts = [0.0; PARTS];
    for part in 0..PARTS {
        parts[part] = row[part * width + block][lane];
    }
    parts
}

#[inline(always)]
fn set<const PARTS: usize>(row: &mut [Block], width: usize, (block, lane): (usize, usize), parts: [f64; PARTS]) {
    for part in 0..PARTS {
        row[part * width + block][lane] = parts[part];
    }
}

#[inline(always)]
fn without<const PARTS: usize>(x: [f64; PARTS], y: [f64; PARTS]) -> [f64; PARTS] {
    let mut left = x;
    for part in 0..PARTS {
        left[part] -= y[part];
    }
    left
}

/// row −= factor·pivot from a block on.
#[inline(always)]
fn subtract<S: Simd, const PARTS: usize>(
    simd: S,
    row: &mut [Block],
    pivot: &[Block],
    factor: [f64; PARTS],
    (from, width): (usize, usize),
) {
    if PARTS == 1 {
        for b in from..width {
            let left = f64x8::load_array_ref(simd, &row[b]) - f64x8::load_array_ref(simd, &pivot[b]) * factor[0];
            left.store_array(&mut row[b]);
        }
        return;
    }
    let (re, im) = row.split_at_mut(width);
    let (pivot_re, pivot_im) = pivot.split_at(width);
    for b in from..width {
        let (p, q) = (f64x8::load_array_ref(simd, &pivot_re[b]), f64x8::load_array_ref(simd, &pivot_im[b]));
        let left = f64x8::load_array_ref(simd, &re[b]) - (p * factor[0] - q * factor[1]);
        left.store_array(&mut re[b]);
        let left = f64x8::load_array_ref(simd, &im[b]) - (p * factor[1] + q * factor[0]);
        left.store_array(&mut im[b]);
    }
}

/// Σ of row times y over the blocks from one to another.
#[inline(always)]
fn dot<S: Simd, const PARTS: usize>(
    simd: S,
    row: &[Block],
    y: &[Block],
    (from, to, width): (usize, usize, usize),
) -> [f64; PARTS] {
    let mut sums = [f64x8::splat(simd, 0.0); PARTS];
    for b in from..to {
        let (re, x) = (f64x8::load_array_ref(simd, &row[b]), f64x8::load_array_ref(simd, &y[b]));
        if PARTS == 1 {
            sums[0] += re * x;
        } else {
            let im = f64x8::load_array_ref(simd, &row[width + b]);
            let z = f64x8::load_array_ref(simd, &y[width + b]);
            sums[0] += re * x - im * z;
            sums[1] += re * z + im * x;
        }
    }
    let mut total = [0.0; PARTS];
    for part in 0..PARTS {
        let mut each: Block = [0.0; LANES];
        sums[part].store_array(&mut each);
        total[part] = ((each[0] + each[4]) + (each[1] + each[5])) + ((each[2] + each[6]) + (each[3] + each[7]));
    }
    total
}

#[inline(always)]
fn square<const PARTS: usize>(x: [f64; PARTS]) -> f64 {
    let mut sum = x[0] * x[0];
    for part in 1..PARTS {
        sum += x[part] * x[part];
    }
    sum
}

#[inline(always)]
fn times<const PARTS: usize>(x: [f64; PARTS], y: [f64; PARTS]) -> [f64; PARTS] {
    let mut product = [x[0] * y[0]; PARTS];
    if PARTS == 2 {
        (product[0], product[1]) = (x[0] * y[0] - x[1] * y[1], x[0] * y[1] + x[1] * y[0]);
    }
    product
}

#[inline(always)]
fn invert<const PARTS: usize>(x: [f64; PARTS]) -> [f64; PARTS] {
    let mut turned = [1.0 / x[0]; PARTS];
    if PARTS == 2 {
        let size = square::<PARTS>(x);
        (turned[0], turned[1]) = (x[0] / size, -x[1] / size);
    }
    turned
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::{ComplexLu, Lu};
    use num_complex::Complex64;

    fn number(r: usize, c: usize) -> [f64; 2] {
        [((3 * r + 5 * c * c + r * c + 1) as f64).sin(), ((r * r * c + 1) as f64).cos()]
    }

    #[test]
    fn real_and_complex_systems_are_solved() {
        for n in [1, 2, 7, 8, 9, 20, 33] {
            let (mut real, mut complex, mut plain) = (RowLu::<1>::default(), RowLu::<2>::default(), Lu::default());
            assert!(real.factor(n, |r, [row]| (0..n).for_each(|c| row[c] = number(r, c)[0])));
            assert!(complex.factor(n, |r, rows| {
                rows.into_iter().enumerate().for_each(|(part, row)| (0..n).for_each(|c| row[c] = number(r, c)[part]));
            }));
            assert!(plain.factor(n, |m| (0..n * n).for_each(|k| m[k] = number(k / n, k % n)[0])));
            let given: Vec<f64> = (0..n).map(|k| (k as f64 + 0.5).sin()).collect();
            let (mut x, mut y) = (given.clone(), given.clone());
            real.solve([&mut x]);
            plain.solve(&mut y);
            let size = y.iter().fold(1.0, |most: f64, y| most.max(y.abs()));
            assert!(x.iter().zip(&y).all(|(x, y)| (x - y).abs() < 1e-11 * size), "{n}");
            let [mut re, mut im] = [given.clone(), vec![0.25; n]];
            complex.solve([&mut re, &mut im]);
            let numbers = (0..n * n).map(|k| number(k / n, k % n)).map(|[re, im]| Complex64::new(re, im)).collect();
            let b: Vec<Complex64> = given.iter().map(|re| Complex64::new(*re, 0.25)).collect();
            let expected = ComplexLu::new(n, numbers).solve(&b);
            let size = expected.iter().fold(1.0, |most: f64, z| most.max(z.norm()));
            for (k, z) in expected.iter().enumerate() {
                assert!((Complex64::new(re[k], im[k]) - z).norm() < 1e-11 * size, "{n}");
            }
        }
    }

    #[test]
    fn singular_matrices_are_told() {
        let mut lu = RowLu::<1>::default();
        assert!(!lu.factor(2, |_, [row]| row.copy_from_slice(&[1.0, 2.0])));
        assert!(!lu.factor(1, |_, [row]| row[0] = f64::NAN));
        assert!(lu.factor(0, |_, _| ()));
        lu.solve([&mut []]);
        let mut lu = RowLu::<2>::default();
        assert!(!lu.factor(3, |r, [re, im]| {
            (0..3).for_each(|c| (re[c], im[c]) = ((r * c) as f64, (r * c) as f64));
        }));
    }

    #[test]
    fn every_level_finds_the_same_bits() {
        let n = 19;
        let [found, base] = [Level::new(), Level::baseline()].map(|level| {
            let mut lu = RowLu::<2>::default();
            assert!(lu.factor_at(level, n, |r, rows| {
                rows.into_iter().enumerate().for_each(|(part, row)| (0..n).for_each(|c| row[c] = number(r, c)[part]));
            }));
            let [mut re, mut im]: [Vec<f64>; 2] = std::array::from_fn(|_| vec![0.7; n]);
            lu.solve_at(level, [&mut re, &mut im]);
            [re, im]
        });
        assert_eq!(found, base);
    }
}
