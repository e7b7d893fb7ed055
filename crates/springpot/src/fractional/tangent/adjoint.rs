//! Back through the past of a memory: the transposed of [`MemoryTangent`].
//!
//! With ∂m/∂z of the modes behind a step, that of its piece is ∂m/∂u_p = h Σ_k ψ_p(X_k) ∂m/∂z_k, and of the modes in front of it e^{−X_k} ∂m/∂z_k, X =
//! λ_k h. What a lag τ of the past tells adds w_k e^{−λ_k τ} ∂m/∂(that).

use crate::fractional::exponentials::moments;
use crate::fractional::history::History;
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
    /// How many modes were put in front behind it, and how many of the fastest were dropped.
    front: usize,
    surplus: usize,
}

impl PastOfStep {
    pub(super) fn new(kernel: Arc<History>, past: &History, h: f64, [front, surplus]: [usize; 2]) -> Self {
        Self { kernel, is_first: past.is_empty(), widths: [past.last().0, h], front, surplus }
    }
}

/// ∂m/∂ the past of a memory, for M numbers m side by side.
#[derive(Debug, Clone)]
pub(crate) struct MemoryAdjoint {
    count: usize,
    /// By each mode, M numbers each; empty before the last step that was taken into the past.
    modes: Vec<f64>,
    /// By the coefficients of the last piece.
    pub(crate) piece: [Vec<f64>; 4],
    pub(crate) travelled: Vec<f64>,
    pub(crate) now: Vec<f64>,
    pub(crate) origin: Vec<f64>,
    told: Vec<Told>,
    taken: Option<Taken>,
}

/// w e^{−X} of all modes of a kernel at a lag.
#[derive(Debug, Clone)]
struct Told {
    kernel: Arc<History>,
    lag: f64,
    weighted: Vec<f64>,
}

/// e^{−X} and ψ_0 … ψ_3 of all modes of a kernel over a step.
#[derive(Debug, Clone)]
struct Taken {
    kernel: Arc<History>,
    lag: f64,
    decay: Vec<f64>,
    psi: [Vec<f64>; 4],
}

/// Lags that are kept ready.
const LAGS: usize = 8;

impl MemoryAdjoint {
    /// Of nothing, yet.
    pub(crate) fn new(count: usize) -> Self {
        let zeros = || vec![0.0; count];
        Self {
            count,
            modes: Vec::new(),
            piece: [(); 4].map(|()| zeros()),
            travelled: zeros(),
            now: zeros(),
            origin: zeros(),
            told: Vec::new(),
            taken: None,
        }
    }

    /// Goes back over the piece that a step added: [`Self::piece`] is complete then, and all else is as before the step but for what of the past the
    /// step was told. Gives what the piece before the step gets.
    pub(crate) fn take_back(&mut self, step: &PastOfStep) -> [Vec<f64>; 4] {
        let (count, kernel) = (self.count, step.kernel.kernel());
        let [before, h] = step.widths;
        let own = kernel.modes();
        let mut earlier = [(); 4].map(|()| vec![0.0; count]);
        if self.modes.is_empty() {
            self.modes.resize((step.front + own) * count, 0.0);
        } else {
            self.modes.splice(0..0, std::iter::repeat_n(0.0, step.surplus * count));
        }
        let add = |to: &mut [Vec<f64>; 4], factors: [f64; 4], block: &[f64]| {
            for (to, factor) in to.iter_mut().zip(factors) {
                to.iter_mut().zip(block).for_each(|(to, z)| *to += factor * z);
            }
        };
        let (front, kept) = self.modes.split_at_mut(step.front * count);
        let taken = match self.taken.take() {
            Some(taken) if taken.lag == h && Arc::ptr_eq(&taken.kernel, &step.kernel) => taken,
            _ => {
                let (decay, psi) = step.kernel.moments(h);
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
            let mut psi = [0.0; 4];
            moments(lambda * h, &mut psi);
            add(&mut self.piece, psi.map(|psi| h * psi), block);
            if !step.is_first {
                add(&mut earlier, settled(lambda, before, (-lambda * h).exp()), block);
            }
        }
        self.modes.drain(..step.front * count);
        earlier
    }

    /// What the past told at a lag of a step counts so much.
    pub(crate) fn tell(&mut self, step: &PastOfStep, lag: f64, by: &[f64]) {
        if step.is_first || by.iter().all(|by| *by == 0.0) {
            return;
        }
        let (count, kernel) = (self.count, step.kernel.kernel());
        self.modes.resize(kernel.modes() * count, 0.0);
        let place = self.place(&step.kernel, lag);
        for (block, weighted) in self.modes.chunks_exact_mut(count).zip(&self.told[place].weighted) {
            block.iter_mut().zip(by).for_each(|(z, by)| *z += weighted * by);
        }
        for k in 1..=kernel.missing(lag) {
            let (lambda, weight) = kernel.faster(k);
            let factors = settled(lambda, step.widths[0], weight * (-lambda * lag).exp());
            for (piece, factor) in self.piece.iter_mut().zip(factors) {
                piece.iter_mut().zip(by).for_each(|(piece, by)| *piece += factor * by);
            }
        }
    }

    /// The place of what a lag tells.
    fn place(&mut self, kernel: &Arc<History>, lag: f64) -> usize {
        let is_it = |told: &Told| told.lag == lag && Arc::ptr_eq(&told.kernel, kernel);
        if let Some(place) = self.told.iter().position(is_it) {
            return place;
        }
        if self.told.len() == LAGS {
            self.told.remove(0);
        }
        self.told.push(Told { kernel: kernel.clone(), lag, weighted: kernel.weighted(lag) });
        self.told.len() - 1
    }
}

/// What a mode that knows the last piece alone has of its coefficients, times `share`.
fn settled(lambda: f64, width: f64, share: f64) -> [f64; 4] {
    let mut psi = [0.0; 4];
    moments(lambda * width, &mut psi);
    psi.map(|psi| share * (width * psi))
}
