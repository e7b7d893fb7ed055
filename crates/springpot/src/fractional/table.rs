//! What the exponentials make of one lag, kept for as long as it is asked for.

use super::exponentials::{decay, lane_moments, moments};
use super::lanes::{Block, LANES, load, sum};
use super::step::{CUBIC, SEXTIC};
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f64x8};

/// Lags that are kept ready: the nodes of two alternating step sizes, four at most.
pub(super) const SLOTS: usize = 8;

/// e^{−X}, w e^{−X} and ψ_p(X) of every mode for one lag.
#[derive(Debug, Clone)]
pub(super) struct Table {
    pub(super) lag: f64,
    pub(super) decay: Vec<Block>,
    pub(super) weighted: Vec<Block>,
    /// Those of a block stand together.
    pub(super) psi: Vec<Block>,
}

impl Default for Table {
    /// Of no lag.
    fn default() -> Self {
        Self { lag: f64::NAN, decay: Vec::new(), weighted: Vec::new(), psi: Vec::new() }
    }
}

impl Table {
    /// Whether it is that of a lag, with so many blocks of moments; lags that differ by no more than `slack` are one.
    pub(super) fn is_of(&self, lag: f64, moments: usize, slack: f64) -> bool {
        (self.lag - lag).abs() <= slack && self.psi.len() == moments
    }

    /// For `count` moments of the modes with these rates and weights, 0 beyond the first `modes` of them.
    pub(super) fn fill(&mut self, lag: f64, count: usize, modes: usize, [lambda, weight]: [&[Block]; 2]) {
        self.lag = lag;
        let blocks = lambda.len();
        self.decay.resize(blocks, [0.0; LANES]);
        self.weighted.resize(blocks, [0.0; LANES]);
        self.psi.resize(count * blocks, [0.0; LANES]);
        dispatch!(Level::new(), simd => self.fill_exponentials(simd, lambda, weight));
        if count != CUBIC && count != SEXTIC {
            self.fill_moments(count, lambda);
        }
        // What fills up the last block stays 0.
        for l in modes..LANES * blocks {
            let (block, l) = (l / LANES, l % LANES);
            (self.decay[block][l], self.weighted[block][l]) = (0.0, 0.0);
            self.psi[count * block..][..count].iter_mut().for_each(|psi| psi[l] = 0.0);
        }
    }

    /// The moments too, where they are those of a cubic or a sextic.
    #[inline(always)]
    fn fill_exponentials<S: Simd>(&mut self, simd: S, lambda: &[Block], weight: &[Block]) {
        match self.psi.len() / lambda.len().max(1) {
            CUBIC => self.fill_with::<_, CUBIC>(simd, lambda, weight),
            SEXTIC => self.fill_with::<_, SEXTIC>(simd, lambda, weight),
            _ => self.fill_with::<_, 0>(simd, lambda, weight),
        }
    }

    #[inline(always)]
    fn fill_with<S: Simd, const N: usize>(&mut self, simd: S, lambda: &[Block], weight: &[Block]) {
        let modes = lambda.iter().zip(weight).zip(&mut self.decay).zip(&mut self.weighted);
        let mut psi = self.psi.chunks_exact_mut(N.max(1));
        for (((lambda, weight), decayed), weighted) in modes {
            let x = load(simd, lambda) * self.lag;
            let decay = decay(x);
            decay.store_array(decayed);
            (load(simd, weight) * decay).store_array(weighted);
            if N > 0
                && let Some(psi) = psi.next()
            {
                let moments: [_; N] = lane_moments(x, decay);
                moments.iter().zip(psi).for_each(|(moment, psi)| moment.store_array(psi));
            }
        }
    }

    fn fill_moments(&mut self, count: usize, lambda: &[Block]) {
        let mut scalar = vec![0.0; count];
        for (psi, lambda) in self.psi.chunks_exact_mut(count).zip(lambda) {
            for l in 0..LANES {
                moments(lambda[l] * self.lag, &mut scalar);
                psi.iter_mut().zip(&scalar).for_each(|(psi, value)| psi[l] = *value);
            }
        }
    }

    /// Σ w e^{−X} z, and z at the end of a piece whose coefficients times its width are y.
    #[inline(always)]
    pub(super) fn advance<S: Simd>(&self, simd: S, z: &mut [Block], y: &[f64]) -> f64 {
        let mut total = f64x8::splat(simd, 0.0);
        let modes = z.iter_mut().zip(&self.decay).zip(&self.weighted).zip(self.psi.chunks_exact(y.len()));
        for (((z, decay), weighted), psi) in modes {
            let before = load(simd, z);
            total += load(simd, weighted) * before;
            let mut next = load(simd, decay) * before;
            for (y, psi) in y.iter().zip(psi) {
                next += load(simd, psi) * *y;
            }
            next.store_array(z);
        }
        sum(total)
    }
}
