//! Numbers in blocks of eight, each worked on at once in registers as wide as the machine has.
//!
//! Products and sums are never joined into one rounding, and the numbers of a block are added in one order, so that every machine
//! finds the same bits.

pub(super) use crate::linalg::columns::{Block, LANES};
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x8};

/// Numbers in whole blocks, the rest 0.
pub(super) fn blocks(values: &[f64]) -> Vec<Block> {
    let mut blocks = vec![[0.0; LANES]; values.len().div_ceil(LANES)];
    blocks.as_flattened_mut()[..values.len()].copy_from_slice(values);
    blocks
}

#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, block: &Block) -> f64x8<S> {
    f64x8::load_array_ref(simd, block)
}

/// The sum of the numbers of a block.
#[inline(always)]
pub(super) fn sum<S: Simd>(block: f64x8<S>) -> f64 {
    let (low, high) = block.split();
    let (low, high) = (low + high).split();
    let pair = low + high;
    pair[0] + pair[1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};

    #[test]
    fn sums_have_one_order() {
        let numbers: Block = std::array::from_fn(|l| 1.0 / (3.0 * l as f64 + 1.0));
        let [a, b, c, d, e, f, g, h] = numbers;
        for level in [Level::baseline(), Level::new()] {
            let found = dispatch!(level, simd => sum(load(simd, &numbers)));
            assert_eq!(found, ((a + e) + (c + g)) + ((b + f) + (d + h)));
        }
    }
}
