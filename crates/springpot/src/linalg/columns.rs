//! Numbers of many columns side by side, row by row: what is done to all of them alike, in registers as wide as the machine has.
//!
//! Products and sums are never joined into one rounding, and every column has its own, so that every machine finds the same bits, and a column the same
//! whatever stands beside it.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f64x4, f64x8};

/// Columns of a block.
pub(crate) const LANES: usize = 8;

/// As many numbers.
pub(crate) type Block = [f64; LANES];

/// out += Σ factor·row.
pub(crate) fn add<const N: usize>(out: &mut [f64], factors: [f64; N], rows: [&[f64]; N]) {
    dispatch!(Level::new(), simd => combine(simd, (out, true), &factors, &rows));
}

/// out = Σ factor·row.
pub(crate) fn put<const N: usize>(out: &mut [f64], factors: [f64; N], rows: [&[f64]; N]) {
    dispatch!(Level::new(), simd => combine(simd, (out, false), &factors, &rows));
}

#[inline(always)]
fn combine<S: Simd, const N: usize>(simd: S, (out, keeps): (&mut [f64], bool), factors: &[f64; N], rows: &[&[f64]; N]) {
    let (blocks, rest) = out.as_chunks_mut::<LANES>();
    let whole = blocks.len();
    let mut of_blocks = [&[][..]; N];
    for n in 0..N {
        of_blocks[n] = &rows[n].as_chunks::<LANES>().0[..whole];
    }
    for (b, out) in blocks.iter_mut().enumerate() {
        let mut sum = f64x8::load_array_ref(simd, &of_blocks[0][b]) * factors[0];
        for n in 1..N {
            sum += f64x8::load_array_ref(simd, &of_blocks[n][b]) * factors[n];
        }
        if keeps {
            sum = f64x8::load_array_ref(simd, out) + sum;
        }
        sum.store_array(out);
    }
    let (mut from, (halves, rest)) = (whole * LANES, rest.as_chunks_mut::<4>());
    if let [out] = halves {
        let half = |n: usize| rows[n][from..].first_chunk().expect("rows as long as the first");
        let mut sum = f64x4::load_array_ref(simd, half(0)) * factors[0];
        for n in 1..N {
            sum += f64x4::load_array_ref(simd, half(n)) * factors[n];
        }
        if keeps {
            sum = f64x4::load_array_ref(simd, out) + sum;
        }
        sum.store_array(out);
        from += 4;
    }
    for (l, out) in rest.iter_mut().enumerate() {
        let mut sum = rows[0][from + l] * factors[0];
        for n in 1..N {
            sum += rows[n][from + l] * factors[n];
        }
        *out = if keeps { *out + sum } else { sum };
    }
}

/// The columns from `first` on of the rows of `x`, `count` long, as rows of one block, whose rest stays.
#[inline(always)]
pub(super) fn take_block(x: &[f64], count: usize, first: usize, rows: &mut [Block]) {
    for (block, row) in rows.iter_mut().zip(x.chunks_exact(count)) {
        match row[first..].first_chunk() {
            Some(whole) => *block = *whole,
            None => {
                let rest = &row[first..];
                block[..rest.len()].copy_from_slice(rest);
            }
        }
    }
}

/// Puts such rows back.
#[inline(always)]
pub(super) fn put_block(rows: &[Block], x: &mut [f64], count: usize, first: usize) {
    for (block, row) in rows.iter().zip(x.chunks_exact_mut(count)) {
        match row[first..].first_chunk_mut() {
            Some(whole) => *whole = *block,
            None => {
                let rest = &mut row[first..];
                rest.copy_from_slice(&block[..rest.len()]);
            }
        }
    }
}
