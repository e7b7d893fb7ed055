//! The past of a piecewise polynomial y as exponentials: the one memory under time loops, streams and files.
//!
//! Of the kernel t^−alpha/Γ(1−alpha) ≈ Σ_k w_k e^{−λ_k t} the past has left one number for each exponential,
//! z_k = ∫₀ᵗ e^{−λ_k(t−s)} y(s) ds. A piece y(θ) = Σ_p y_p θ^p of the width h takes it to e^{−X} z_k + h Σ_p y_p ψ_p(X), X = λ_k h,
//! without error. Modes stand in blocks of eight; what is missing to a whole block has weight 0 and stays 0.
//!
//! There is no shortest lag: faster modes are made where one is asked for, from the last piece alone. That is exact, since they
//! have forgotten everything before it (X > 100).

use super::exponentials::{decay, lane_moments, moments};
use super::kernel::{Kernel, KernelError};
use super::lanes::{Block, LANES, blocks, load, sum};
use super::shelf::{Modes, Shelf};
use super::step::{CUBIC, SEXTIC};
use super::table::{SLOTS, Table};
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f64x8};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Share of the shortest lag of a kernel down to which its tail tells what the modes above do.
const SETTLED: f64 = 0.25;

/// Modes faster than the pieces need are dropped once there are this many.
const SURPLUS: usize = 16;

/// A kernel and what it has seen of y.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(from = "Kept", into = "Kept")]
pub(super) struct History {
    /// The exponentials, which alike histories share.
    modes: Arc<Modes>,
    z: Vec<Block>,
    /// Width and coefficients of the last piece; none before the first.
    last: (f64, Vec<f64>),
    /// What they make of the lags that were asked for last.
    tables: Vec<Arc<Table>>,
    /// Where modes are found that others have made.
    shelf: Shelf,
}

/// What of a history outlasts a run: all else follows.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Kept {
    kernel: Kernel,
    z: Vec<f64>,
    last: (f64, Vec<f64>),
}

/// A history at one lag, by its table where there is one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lag<'a> {
    history: &'a History,
    lag: f64,
    table: Option<&'a Table>,
}

impl Lag<'_> {
    /// w e^{−X} of a block.
    #[inline(always)]
    pub(super) fn weighted<S: Simd>(&self, simd: S, k: usize) -> f64x8<S> {
        match self.table {
            Some(table) => load(simd, &table.weighted[k]),
            None if self.lag == 0.0 => load(simd, &self.history.modes.weight[k]),
            None => {
                let [lambda, weight, _] = self.history.block(simd, k);
                weight * decay(lambda * self.lag)
            }
        }
    }

    /// e^{−X} and ψ_0 … ψ_{N−1} of a block.
    #[inline(always)]
    pub(super) fn moments<S: Simd, const N: usize>(&self, simd: S, k: usize) -> (f64x8<S>, [f64x8<S>; N]) {
        match self.table {
            Some(table) => {
                let (own, mut psi): (&[Block; N], _) = (&table.psi.as_chunks().0[k], [f64x8::splat(simd, 0.0); N]);
                for p in 0..N {
                    psi[p] = load(simd, &own[p]);
                }
                (load(simd, &table.decay[k]), psi)
            }
            None if self.lag == 0.0 => {
                let (one, mut psi) = (f64x8::splat(simd, 1.0), [f64x8::splat(simd, 1.0); N]);
                for p in 1..N {
                    psi[p] = one * (1.0 / (p + 1) as f64);
                }
                (one, psi)
            }
            None => {
                let x = load(simd, &self.history.modes.lambda[k]) * self.lag;
                let decay = decay(x);
                (decay, lane_moments(x, decay))
            }
        }
    }
}

/// Quadratic forms of the z: Σ w z² and Σ w λ z².
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Squares {
    pub(super) weighted: f64,
    pub(super) with_rates: f64,
}

impl From<Kept> for History {
    fn from(kept: Kept) -> Self {
        let Kept { kernel, z, last } = kept;
        let mut history = Self::new(kernel);
        history.z = blocks(&z);
        history.last = last;
        history
    }
}

impl From<History> for Kept {
    fn from(history: History) -> Self {
        let z = history.modes().to_vec();
        Self { kernel: history.modes.kernel.clone(), z, last: history.last }
    }
}

impl History {
    /// Nothing yet.
    pub(super) fn new(kernel: Kernel) -> Self {
        let shelf = Shelf::default();
        Self::of(shelf.modes(kernel), shelf)
    }

    /// Nothing yet, of a kernel that is found on the shelf or put there ([`Kernel::new`]).
    ///
    /// # Errors
    /// [`KernelError`] where it cannot be built.
    pub(super) fn open(
        shelf: &Shelf,
        alpha: f64,
        tolerance: f64,
        delta: f64,
        horizon: f64,
    ) -> Result<Self, KernelError> {
        Ok(Self::of(shelf.built(alpha, tolerance, delta, horizon)?, shelf.clone()))
    }

    fn of(modes: Arc<Modes>, shelf: Shelf) -> Self {
        let z = vec![[0.0; LANES]; modes.lambda.len()];
        Self { modes, z, last: (0.0, Vec::with_capacity(CUBIC)), tables: Vec::new(), shelf }
    }

    /// The same kernel, which has seen nothing.
    pub(super) fn without_past(&self) -> Self {
        Self::of(self.modes.clone(), self.shelf.clone())
    }

    /// Whether another one has the same kernel.
    pub(super) fn has_kernel_of(&self, other: &Self) -> bool {
        let [own, other] = [self.kernel(), other.kernel()];
        own.modes() == other.modes() && own.lambda.first() == other.lambda.first()
    }

    /// w e^{−X} of every mode at a lag.
    pub(super) fn weighted(&self, lag: f64) -> Vec<f64> {
        let (at, mut all) = (self.lag(lag), vec![[0.0; LANES]; self.z.len()]);
        dispatch!(Level::new(), simd => {
            for (k, block) in all.iter_mut().enumerate() {
                at.weighted(simd, k).store_array(block);
            }
        });
        all.as_flattened()[..self.kernel().modes()].to_vec()
    }

    /// e^{−X}, and ψ_0 … ψ_{N−1}, of every mode at a lag.
    pub(super) fn moments<const N: usize>(&self, lag: f64) -> (Vec<f64>, [Vec<f64>; N]) {
        let (at, modes) = (self.lag_of(lag, N), self.kernel().modes());
        let none = || vec![[0.0; LANES]; self.z.len()];
        let (mut decays, mut all) = (none(), [(); N].map(|()| none()));
        dispatch!(Level::new(), simd => {
            for k in 0..self.z.len() {
                let (decay, psi): (_, [_; N]) = at.moments(simd, k);
                decay.store_array(&mut decays[k]);
                all.iter_mut().zip(psi).for_each(|(all, psi)| psi.store_array(&mut all[k]));
            }
        });
        let flat = |blocks: Vec<Block>| blocks.as_flattened()[..modes].to_vec();
        (flat(decays), all.map(flat))
    }

    pub(super) fn kernel(&self) -> &Kernel {
        &self.modes.kernel
    }

    /// [`Kernel::fast_tail`] of the modes above those that are kept.
    pub(super) fn fast_tail(&self) -> [f64; 3] {
        self.modes.fast_tail
    }

    /// z_k, one for each exponential of the kernel.
    pub(super) fn modes(&self) -> &[f64] {
        &self.z.as_flattened()[..self.kernel().modes()]
    }

    /// Whether there was no piece yet.
    pub(super) fn is_empty(&self) -> bool {
        self.last.1.is_empty()
    }

    /// The last piece at its end.
    pub(super) fn last_value(&self) -> f64 {
        self.last.1.iter().sum()
    }

    /// Makes the table of a lag of pieces with `count` coefficients, so that asking for it is cheap; lags that differ by no more than
    /// `slack` are one.
    ///
    /// Gives its place among the tables.
    pub(super) fn prepare(&mut self, lag: f64, count: usize, slack: f64) -> usize {
        let blocks = self.z.len();
        if let Some(slot) = self.tables.iter().position(|table| table.is_of(lag, count * blocks, slack)) {
            return slot;
        }
        let Self { modes, tables, .. } = self;
        let oldest = if tables.len() < SLOTS { Arc::default() } else { tables.remove(0) };
        // Alone, it fills its own again and again; what others have filled is to the bit what it would.
        let table = match Arc::strong_count(modes) {
            1 => modes.fill(oldest, lag, count),
            _ => {
                drop(oldest);
                modes.table(lag, count)
            }
        };
        tables.push(table);
        tables.len() - 1
    }

    /// Σ_k w_k e^{−λ_k τ} z_k: what the past adds at the lag τ, with faster modes where τ is shorter than the kernel's delta.
    pub(super) fn at(&self, lag: f64) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        let mut sum = dispatch!(Level::new(), simd => self.kept_at(simd, lag));
        for k in 1..=self.kernel().missing(lag) {
            let (lambda, weight) = self.kernel().faster(k);
            sum += weight * (-lambda * lag).exp() * self.fast_mode(lambda);
        }
        sum
    }

    /// Σ_k w_k e^{−λ_k τ} z_k over the modes that are kept.
    #[inline(always)]
    fn kept_at<S: Simd>(&self, simd: S, lag: f64) -> f64 {
        let mut total = f64x8::splat(simd, 0.0);
        if let Some(table) = self.tables.iter().find(|table| table.lag == lag) {
            for (weighted, z) in table.weighted.iter().zip(&self.z) {
                total += load(simd, weighted) * load(simd, z);
            }
        } else {
            for ((lambda, weight), z) in self.modes.lambda.iter().zip(&self.modes.weight).zip(&self.z) {
                let weighted = load(simd, weight) * decay(load(simd, lambda) * lag);
                total += weighted * load(simd, z);
            }
        }
        sum(total)
    }

    /// The mean of the past over lags up to τ, Σ_k w_k z_k ψ_0(λ_k τ), modes above the kernel's left out.
    pub(super) fn mean(&self, lag: f64) -> f64 {
        dispatch!(Level::new(), simd => {
            let mut total = f64x8::splat(simd, 0.0);
            self.with_moments(
                simd,
                lag,
                #[inline(always)]
                |k, _, [psi, ..]: [_; CUBIC]| total += load(simd, &self.modes.weight[k]) * psi * load(simd, &self.z[k]),
            );
            sum(total)
        })
    }

    /// Σ w z² and Σ w λ z² at the lag τ, where the piece under way has the coefficients y of θ^p, θ = s/τ.
    pub(super) fn squares(&self, lag: f64, y: &[f64; SEXTIC]) -> Squares {
        let [a, b, c, d, higher @ ..] = y;
        let is_cubic = higher.iter().all(|y| *y == 0.0);
        dispatch!(Level::new(), simd => match is_cubic {
            true => self.squares_with(simd, lag, &[*a, *b, *c, *d]),
            false => self.squares_with(simd, lag, y),
        })
    }

    #[inline(always)]
    fn squares_with<S: Simd, const N: usize>(&self, simd: S, lag: f64, y: &[f64; N]) -> Squares {
        let mut totals = [f64x8::splat(simd, 0.0); 2];
        if lag == 0.0 {
            for (k, z) in self.z.iter().enumerate() {
                self.add_squares(k, load(simd, z), &mut totals);
            }
        } else {
            self.with_moments(
                simd,
                lag,
                #[inline(always)]
                |k, decay, psi: [f64x8<S>; N]| {
                    let mut grown = psi[0] * y[0];
                    for p in 1..N {
                        grown += psi[p] * y[p];
                    }
                    self.add_squares(k, decay * load(simd, &self.z[k]) + grown * lag, &mut totals);
                },
            );
        }
        let [weighted, with_rates] = totals;
        Squares { weighted: sum(weighted), with_rates: sum(with_rates) }
    }

    #[inline(always)]
    fn add_squares<S: Simd>(&self, k: usize, z: f64x8<S>, [plain, rated]: &mut [f64x8<S>; 2]) {
        let square = load(z.simd, &self.modes.weight[k]) * z * z;
        *plain += square;
        *rated += load(z.simd, &self.modes.lambda[k]) * square;
    }

    /// Hands over index, e^{−X} and ψ_0 … ψ_{N−1} of every block.
    #[inline(always)]
    fn with_moments<S: Simd, const N: usize>(
        &self,
        simd: S,
        lag: f64,
        mut take: impl FnMut(usize, f64x8<S>, [f64x8<S>; N]),
    ) {
        let at = self.lag_of(lag, N);
        for k in 0..self.z.len() {
            let (decay, psi) = at.moments(simd, k);
            take(k, decay, psi);
        }
    }

    /// Takes a piece into the past, z_k ← e^{−X} z_k + h Σ_p y_p ψ_p(X), and gives Σ_k w_k e^{−λ_k h} z_k at its end, what was before
    /// it. Widths that differ by no more than `slack` are one.
    pub(super) fn advance(&mut self, width: f64, y: &[f64], slack: f64) -> f64 {
        let slot = self.prepare(width, y.len(), slack);
        let (table, z) = (&self.tables[slot], &mut self.z);
        // The lengths of cubic rates and of splines, unrolled; any other in a loop.
        let before = dispatch!(Level::new(), simd => match *y {
            [a, b, c] => table.advance(simd, z, &[width * a, width * b, width * c]),
            [a, b, c, d] => table.advance(simd, z, &[width * a, width * b, width * c, width * d]),
            [a, b, c, d, e] => table.advance(simd, z, &[width * a, width * b, width * c, width * d, width * e]),
            [a, b, c, d, e, f, g] => {
                table.advance(simd, z, &[a, b, c, d, e, f, g].map(|y| width * y))
            }
            _ => {
                let y: Vec<f64> = y.iter().map(|y| width * y).collect();
                table.advance(simd, z, &y)
            }
        });
        self.last.0 = width;
        self.last.1.clear();
        self.last.1.extend_from_slice(y);
        before
    }

    /// Puts another past in the place of what was seen: z as a function of λ, and the last piece.
    pub(super) fn recall(&mut self, mode: &dyn Fn(f64) -> f64, width: f64, y: &[f64]) {
        let z: Vec<f64> = self.kernel().lambda.iter().map(|lambda| mode(*lambda)).collect();
        self.z = blocks(&z);
        self.last = (width, y.to_vec());
    }

    /// Adds an impulse of y of this size, `age` ago.
    pub(super) fn add_jump(&mut self, jump: f64, age: f64) {
        let modes = self.kernel().lambda.iter().zip(self.modes());
        let z: Vec<f64> = modes.map(|(lambda, z)| z + jump * (-lambda * age).exp()).collect();
        self.z = blocks(&z);
        if self.is_empty() {
            self.last = (age, vec![0.0; CUBIC]);
        }
    }

    /// Puts the faster modes in front that lags down to `lag` need.
    pub(super) fn extend(&mut self, lag: f64) {
        if self.kernel().missing(lag) == 0 {
            return;
        }
        let mut kernel = self.kernel().clone();
        let mut z: Vec<f64> = kernel.extend(lag).into_iter().map(|lambda| self.fast_mode(lambda)).collect();
        z.extend_from_slice(self.modes());
        self.take_modes(kernel, &z);
    }

    /// The same with the faster modes that lags down to `lag` need; nothing where it has them, or nearly: under a smooth rate the tail is as good.
    pub(super) fn extended(&self, lag: f64) -> Option<Self> {
        if lag >= SETTLED * self.kernel().delta {
            return None;
        }
        let mut longer = Self { tables: Vec::new(), ..self.clone() };
        longer.extend(lag);
        Some(longer)
    }

    /// Drops modes that are faster than lags of `lag` and longer need, once there are many of them.
    pub(super) fn drop_surplus(&mut self, lag: f64) {
        let surplus = self.surplus(lag);
        if surplus == 0 {
            return;
        }
        let mut kernel = self.kernel().clone();
        kernel.drop_fastest(surplus);
        let z = self.modes()[surplus..].to_vec();
        self.take_modes(kernel, &z);
    }

    /// How many modes [`Self::drop_surplus`] drops.
    pub(super) fn surplus(&self, lag: f64) -> usize {
        let kernel = self.kernel();
        let surplus = ((lag / kernel.delta).ln() / kernel.eta).floor();
        if surplus < SURPLUS as f64 { 0 } else { (surplus as usize).min(kernel.modes() - 1) }
    }

    /// Width and coefficients of the last piece; none before the first.
    pub(super) fn last(&self) -> (f64, &[f64]) {
        (self.last.0, &self.last.1)
    }

    /// What the modes that are kept make of one lag, of a cubic.
    pub(super) fn lag(&self, lag: f64) -> Lag<'_> {
        self.lag_of(lag, CUBIC)
    }

    /// The same of a piece with so many coefficients.
    pub(super) fn lag_of(&self, lag: f64, coefficients: usize) -> Lag<'_> {
        let moments = coefficients * self.z.len();
        let table = self.tables.iter().find(|table| table.is_of(lag, moments, 0.0)).map(|table| &**table);
        Lag { history: self, lag, table }
    }

    /// Number of blocks of modes.
    pub(super) fn blocks(&self) -> usize {
        self.z.len()
    }

    /// λ, w and z of a block.
    #[inline(always)]
    pub(super) fn block<S: Simd>(&self, simd: S, k: usize) -> [f64x8<S>; 3] {
        [load(simd, &self.modes.lambda[k]), load(simd, &self.modes.weight[k]), load(simd, &self.z[k])]
    }

    /// Appends the state to `numbers`: modes with their rates and weights, and the last piece.
    pub(super) fn save(&self, numbers: &mut Vec<f64>) {
        let Kernel { lambda, weight, delta, .. } = self.kernel();
        let (width, y) = &self.last;
        numbers.extend([*delta, lambda.len() as f64, y.len() as f64, *width]);
        [lambda, weight, self.modes(), y].into_iter().for_each(|values: &[f64]| numbers.extend_from_slice(values));
    }

    /// Takes back what [`Self::save`] wrote of a history with this kernel, from the front of `numbers`; `None` where it is not that.
    pub(super) fn load(&mut self, numbers: &mut &[f64]) -> Option<()> {
        let &[delta, modes, count, width] = numbers.split_off(..4)? else { return None };
        if !(delta > 0.0 && modes >= 1.0 && width >= 0.0) {
            return None;
        }
        let lambda = numbers.split_off(..modes as usize)?;
        let weight = numbers.split_off(..modes as usize)?;
        let z = numbers.split_off(..modes as usize)?;
        let y = numbers.split_off(..count as usize)?;
        let kernel = Kernel { delta, lambda: lambda.to_vec(), weight: weight.to_vec(), ..self.kernel().clone() };
        self.last = (width, y.to_vec());
        self.take_modes(kernel, z);
        Some(())
    }

    /// Goes on with another kernel, and these numbers for its modes.
    fn take_modes(&mut self, kernel: Kernel, z: &[f64]) {
        self.z = blocks(z);
        self.modes = self.shelf.modes(kernel);
        self.tables.clear();
    }

    /// What such a mode has of so many coefficients of the last piece: its width times ψ_0, ψ_1, …
    pub(super) fn fast_moments(&self, lambda: f64, coefficients: usize) -> [f64; SEXTIC] {
        let mut psi = [0.0; SEXTIC];
        moments(lambda * self.last.0, &mut psi[..coefficients]);
        psi.map(|psi| self.last.0 * psi)
    }

    /// z of a mode that has forgotten all but the last piece.
    pub(super) fn fast_mode(&self, lambda: f64) -> f64 {
        let (width, y) = &self.last;
        let (mut few, mut many) = ([0.0; 2 * CUBIC], Vec::new());
        let psi = match few.get_mut(..y.len()) {
            Some(few) => few,
            None => {
                many.resize(y.len(), 0.0);
                &mut many[..]
            }
        };
        moments(lambda * width, psi);
        width * psi.iter().zip(y).map(|(psi, y)| psi * y).sum::<f64>()
    }
}
