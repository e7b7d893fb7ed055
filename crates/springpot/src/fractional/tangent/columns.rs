//! P derivatives side by side for every mode of a history.

use super::super::history::Lag;
use super::super::lanes::{Block, LANES, load};
use super::super::step::{CUBIC, SEXTIC};
use crate::linalg::columns;
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f64x8};
use serde::{Deserialize, Serialize};

/// Blocks of parameters whose sums are kept at hand.
const TILE: usize = 8;

/// Rows of P numbers, each in whole blocks of eight whose rest is 0.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Columns {
    parameters: usize,
    values: Vec<Block>,
}

impl Columns {
    /// This many rows of zeros.
    pub(super) fn new(parameters: usize, rows: usize) -> Self {
        Self { parameters, values: vec![[0.0; LANES]; rows * parameters.div_ceil(LANES)] }
    }

    pub(super) fn rows(&self) -> usize {
        self.values.len().checked_div(self.width()).unwrap_or(0)
    }

    /// Blocks in a row.
    fn width(&self) -> usize {
        self.parameters.div_ceil(LANES)
    }

    /// A row; what stands behind its P numbers is 0.
    pub(super) fn row(&self, k: usize) -> &[f64] {
        let width = LANES * self.width();
        &self.values.as_flattened()[k * width..][..self.parameters]
    }

    pub(super) fn row_mut(&mut self, k: usize) -> &mut [f64] {
        let width = LANES * self.width();
        &mut self.values.as_flattened_mut()[k * width..][..self.parameters]
    }

    /// Puts these rows in front.
    pub(super) fn put_in_front(&mut self, rows: Self) {
        self.values.splice(0..0, rows.values);
    }

    /// Takes rows away in front.
    pub(super) fn drop_front(&mut self, rows: usize) {
        let width = self.width();
        self.values.drain(..rows * width);
    }

    /// Adds Σ_k f_qk row_k to `out[q]`; `factors` hands over those of a block of rows.
    #[inline(always)]
    pub(super) fn contract<S: Simd, const Q: usize>(
        &self,
        simd: S,
        mut factors: impl FnMut(usize) -> [f64x8<S>; Q],
        mut out: [&mut [f64]; Q],
    ) {
        let width = self.width();
        for tile in (0..width).step_by(TILE) {
            let wide = (width - tile).min(TILE);
            let mut sums = [[[0.0; LANES]; Q]; TILE];
            for (k, rows) in self.values.chunks(LANES * width).enumerate() {
                let blocks: [f64x8<S>; Q] = factors(k);
                let mut factors = [[0.0; LANES]; Q];
                for q in 0..Q {
                    blocks[q].store_array(&mut factors[q]);
                }
                for (b, sums) in sums[..wide].iter_mut().enumerate() {
                    let mut totals = [f64x8::splat(simd, 0.0); Q];
                    for q in 0..Q {
                        totals[q] = load(simd, &sums[q]);
                    }
                    for (l, row) in rows.chunks_exact(width).enumerate().take(LANES) {
                        let value = load(simd, &row[tile + b]);
                        for q in 0..Q {
                            totals[q] += value * factors[q][l];
                        }
                    }
                    for q in 0..Q {
                        totals[q].store_array(&mut sums[q]);
                    }
                }
            }
            let first = tile * LANES;
            let count = (self.parameters - first).min(wide * LANES);
            for (q, out) in out.iter_mut().enumerate() {
                for (j, out) in out[first..][..count].iter_mut().enumerate() {
                    *out += sums[j / LANES][q][j % LANES];
                }
            }
        }
    }

    /// Takes every row z to e^{−X} z + h Σ_p y_p ψ_p(X), where the rows of `piece`, as many as the lag is ready for, are the y_p.
    pub(super) fn advance(&mut self, lag: Lag, h: f64, piece: &Self) {
        dispatch!(Level::new(), simd => match piece.rows() {
            CUBIC => self.advance_with::<_, CUBIC>(simd, lag, h, piece),
            _ => self.advance_with::<_, SEXTIC>(simd, lag, h, piece),
        });
    }

    #[inline(always)]
    fn advance_with<S: Simd, const N: usize>(&mut self, simd: S, lag: Lag, h: f64, piece: &Self) {
        let width = self.width();
        if width == 0 {
            return;
        }
        for (k, rows) in self.values.chunks_mut(LANES * width).enumerate() {
            let (decay, psi): (_, [_; N]) = lag.moments(simd, k);
            let mut shares = [[0.0; LANES]; N];
            for p in 0..N {
                (psi[p] * h).store_array(&mut shares[p]);
            }
            let mut decays = [0.0; LANES];
            decay.store_array(&mut decays);
            for b in 0..width {
                let mut y = [f64x8::splat(simd, 0.0); N];
                for p in 0..N {
                    y[p] = load(simd, &piece.values[p * width + b]);
                }
                for (l, row) in rows.chunks_exact_mut(width).enumerate().take(LANES) {
                    let mut next = load(simd, &row[b]) * decays[l] + y[0] * shares[0][l];
                    for p in 1..N {
                        next += y[p] * shares[p][l];
                    }
                    next.store_array(&mut row[b]);
                }
            }
        }
    }
}

/// Q rows of a matrix.
pub(super) fn rows<const Q: usize>(mut matrix: &mut [f64]) -> [&mut [f64]; Q] {
    let count = matrix.len() / Q;
    std::array::from_fn(|_| matrix.split_off_mut(..count).unwrap_or_default())
}

/// out += factor·values.
pub(super) fn add(out: &mut [f64], factor: f64, values: &[f64]) {
    let count = out.len().min(values.len());
    columns::add(&mut out[..count], [factor], [values]);
}
