//! Back through the past of a memory: the transposed of [`MemoryTangent`].
//!
//! With ∂m/∂z of the modes behind a step, that of its piece is ∂m/∂u_p = h Σ_k ψ_p(X_k) ∂m/∂z_k, and of the modes in front of it e^{−X_k} ∂m/∂z_k, X =
//! λ_k h. What a lag τ of the past tells adds w_k e^{−λ_k τ} ∂m/∂(that).

use super::ports::{Told, Weights};
use crate::fractional::exponentials::moments;
use crate::fractional::history::History;
use crate::fractional::step::{CUBIC, SEXTIC};
use std::sync::Arc;

/// What an accepted step did to the past of a memory.
#[derive(Debug, Clone)]
pub(crate) struct PastOfStep {
    /// The kernel in front of the step.
    kernel: Arc<History>,
    /// Whether there was no piece before.
    is_first: bool,
    /// Width of the piece before, and of this one.
    widths: [f64; 2],
    /// How many coefficients they have.
    coefficients: [usize; 2],
    /// How many modes were put in front behind it, and how many of the fastest were dropped.
    front: usize,
    surplus: usize,
    /// How modes behind it, and the coefficients of its piece, follow where its end moves.
    pub(super) moved: Option<Weights>,
}

impl PastOfStep {
    pub(super) fn new(
        kernel: Arc<History>,
        past: &History,
        (h, coefficients): (f64, [usize; 2]),
        [front, surplus]: [usize; 2],
    ) -> Self {
        let widths = [past.last().0, h];
        Self { kernel, is_first: past.is_empty(), widths, coefficients, front, surplus, moved: None }
    }

    /// Whether its end moves.
    pub(crate) fn has_moved(&self) -> bool {
        self.moved.is_some()
    }

    /// How much it holds beside its kernel, bytes.
    pub(crate) fn bytes(&self) -> usize {
        size_of::<Self>() + self.moved.as_ref().map_or(0, Weights::bytes)
    }
}

/// ∂m/∂ the past of a memory, for M numbers m side by side.
#[derive(Debug, Clone)]
pub(crate) struct MemoryAdjoint {
    count: usize,
    /// By each mode, M numbers each; empty before the last step that was taken into the past.
    modes: Vec<f64>,
    /// By the coefficients of the last piece.
    piece: Vec<Vec<f64>>,
    ready: Vec<Ready>,
    taken: Option<Taken>,
}

/// What counts of the step that was gone back over: of the coefficients of its piece, and of the time by which its end moves.
#[derive(Debug)]
pub(crate) struct OfStep {
    pub(crate) piece: Vec<Vec<f64>>,
    pub(crate) moved: Option<Vec<f64>>,
}

/// w e^{−X} of all modes of a kernel at a lag.
#[derive(Debug, Clone)]
struct Ready {
    kernel: Arc<History>,
    lag: f64,
    weighted: Vec<f64>,
}

/// e^{−X} and ψ_0, ψ_1, … of all modes of a kernel over a step.
#[derive(Debug, Clone)]
struct Taken {
    kernel: Arc<History>,
    lag: f64,
    decay: Vec<f64>,
    psi: Vec<Vec<f64>>,
}

/// Lags that are kept ready.
const LAGS: usize = 8;

impl MemoryAdjoint {
    /// Of nothing, yet.
    pub(crate) fn new(count: usize) -> Self {
        Self { count, modes: Vec::new(), piece: vec![vec![0.0; count]; CUBIC], ready: Vec::new(), taken: None }
    }

    /// Goes back over the piece that a step added: all is as before the step then, but for what of the past the step was told.
    pub(crate) fn take_back(&mut self, step: &PastOfStep) -> OfStep {
        let (count, kernel) = (self.count, step.kernel.kernel());
        let ([before, h], [of_before, coefficients]) = (step.widths, step.coefficients);
        let own = kernel.modes();
        self.piece.resize(coefficients, vec![0.0; count]);
        let mut earlier = vec![vec![0.0; count]; of_before];
        let moved = step.moved.as_ref().map(|moved| {
            let mut sum = vec![0.0; count];
            let parts = moved.piece.iter().zip(&self.piece).map(|(factor, block)| (factor, &block[..]));
            let modes = moved.modes.iter().zip(self.modes.chunks_exact(count));
            for (factor, block) in parts.chain(modes) {
                sum.iter_mut().zip(block).for_each(|(sum, by)| *sum += factor * by);
            }
            sum
        });
        if self.modes.is_empty() {
            self.modes.resize((step.front + own) * count, 0.0);
        } else {
            self.modes.splice(0..0, std::iter::repeat_n(0.0, step.surplus * count));
        }
        let add = |to: &mut [Vec<f64>], factors: [f64; SEXTIC], block: &[f64]| {
            for (to, factor) in to.iter_mut().zip(factors) {
                to.iter_mut().zip(block).for_each(|(to, z)| *to += factor * z);
            }
        };
        let (front, kept) = self.modes.split_at_mut(step.front * count);
        let taken = match self.taken.take() {
            Some(taken)
                if taken.lag == h && taken.psi.len() == coefficients && Arc::ptr_eq(&taken.kernel, &step.kernel) =>
            {
                taken
            }
            _ => {
                let (decay, psi) = match coefficients {
                    CUBIC => {
                        let (decay, psi) = step.kernel.moments::<CUBIC>(h);
                        (decay, psi.to_vec())
                    }
                    _ => {
                        let (decay, psi) = step.kernel.moments::<SEXTIC>(h);
                        (decay, psi.to_vec())
                    }
                };
                Taken { kernel: step.kernel.clone(), lag: h, decay, psi }
            }
        };
        for (piece, psi) in self.piece.iter_mut().zip(&taken.psi) {
            for (m, piece) in piece.iter_mut().enumerate() {
                let own = kept.iter().skip(m).step_by(count);
                *piece += h * psi.iter().zip(own).map(|(psi, z)| psi * z).sum::<f64>();
            }
        }
        for (block, decay) in kept.chunks_exact_mut(count).zip(&taken.decay) {
            block.iter_mut().for_each(|z| *z *= decay);
        }
        self.taken = Some(taken);
        for (k, block) in (1..=step.front).rev().zip(front.chunks_exact(count)) {
            let (lambda, _) = kernel.faster(k);
            let mut psi = [0.0; SEXTIC];
            moments(lambda * h, &mut psi[..coefficients]);
            add(&mut self.piece, psi.map(|psi| h * psi), block);
            if !step.is_first {
                add(&mut earlier, settled(lambda, before, (-lambda * h).exp(), of_before), block);
            }
        }
        self.modes.drain(..step.front * count);
        OfStep { piece: std::mem::replace(&mut self.piece, earlier), moved }
    }

    /// What the past told counts so much; where it was told by a lag, that is one of the step that follows.
    pub(crate) fn tell(&mut self, step: Option<&PastOfStep>, told: &Told, by: &[f64]) {
        if by.iter().all(|by| *by == 0.0) {
            return;
        }
        match (told, step) {
            (Told::Lag(lag), Some(step)) => self.tell_lag(step, *lag, by),
            (Told::Lag(_), None) => self.piece.iter_mut().for_each(|piece| piece.fill(f64::NAN)),
            (Told::Sum(Weights { modes, piece }), _) => {
                self.modes.resize(modes.len() * self.count, 0.0);
                self.piece.resize(piece.len().max(self.piece.len()), vec![0.0; self.count]);
                let own = self.piece.iter_mut().map(|own| &mut own[..]);
                let blocks = self.modes.chunks_exact_mut(self.count).chain(own);
                for (block, factor) in blocks.zip(modes.iter().chain(piece)) {
                    block.iter_mut().zip(by).for_each(|(z, by)| *z += factor * by);
                }
            }
        }
    }

    fn tell_lag(&mut self, step: &PastOfStep, lag: f64, by: &[f64]) {
        if step.is_first {
            return;
        }
        let [before, _] = step.coefficients;
        self.piece.resize(before, vec![0.0; self.count]);
        let (count, kernel) = (self.count, step.kernel.kernel());
        self.modes.resize(kernel.modes() * count, 0.0);
        let place = self.place(&step.kernel, lag);
        for (block, weighted) in self.modes.chunks_exact_mut(count).zip(&self.ready[place].weighted) {
            block.iter_mut().zip(by).for_each(|(z, by)| *z += weighted * by);
        }
        for k in 1..=kernel.missing(lag) {
            let (lambda, weight) = kernel.faster(k);
            let factors = settled(lambda, step.widths[0], weight * (-lambda * lag).exp(), before);
            for (piece, factor) in self.piece.iter_mut().zip(factors) {
                piece.iter_mut().zip(by).for_each(|(piece, by)| *piece += factor * by);
            }
        }
    }

    /// The place of what a lag tells.
    fn place(&mut self, kernel: &Arc<History>, lag: f64) -> usize {
        let is_it = |ready: &Ready| ready.lag == lag && Arc::ptr_eq(&ready.kernel, kernel);
        if let Some(place) = self.ready.iter().position(is_it) {
            return place;
        }
        if self.ready.len() == LAGS {
            self.ready.remove(0);
        }
        self.ready.push(Ready { kernel: kernel.clone(), lag, weighted: kernel.weighted(lag) });
        self.ready.len() - 1
    }
}

/// What a mode that knows the last piece alone has of its coefficients, times `share`.
fn settled(lambda: f64, width: f64, share: f64, coefficients: usize) -> [f64; SEXTIC] {
    let mut psi = [0.0; SEXTIC];
    moments(lambda * width, &mut psi[..coefficients]);
    psi.map(|psi| share * (width * psi))
}

impl Weights {
    pub(crate) fn bytes(&self) -> usize {
        size_of::<Self>() + size_of_val(&self.modes[..]) + size_of_val(&self.piece[..])
    }
}
