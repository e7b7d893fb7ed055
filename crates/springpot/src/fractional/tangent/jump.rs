//! Strokes whose derivative jumps: at a singular start, and where a velocity jumps at a time that the parameters move.
//!
//! Behind a jump of δx by j at t*, δD^α x has the share j (t − t*)^−α/Γ(1−α). In modes it would be wrong until steps are much shorter than
//! its age: a share is kept apart, taken by its moments over each step, and folded into the modes later. At an event whose time moves by
//! δt* and over which x' jumps from x'⁻ to x'⁺, j = (x'⁻ − x'⁺) δt*.

use super::columns::add;
use super::order::ByOrder;
use super::{MemoryTangent, Singular, TangentStep};
use crate::collocation::MAX_NODES;
use crate::fractional::gamma::reciprocal_gamma;
use crate::fractional::history::History;
use crate::fractional::memory::{Memory, collocated};
use serde::{Deserialize, Serialize};

/// Largest step, in units of the age of a jump, behind which the jump goes into the modes.
///
/// Measured on x'' = −50 D^α x behind a jump of 1, α = 0.1 … 0.98, equal steps: the motion at t = 1 moves by 2e-8 where it is folded at 0.3,
/// 5e-10 at 0.1, 5e-11 at 0.05 and 2e-12 here, so that the next step may be five times as long.
pub(super) const FOLD: f64 = 0.02;

/// A share of the stroke that jumped.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Jump {
    /// When, s.
    pub(super) t: f64,
    /// By how much, P numbers.
    pub(super) size: Vec<f64>,
    /// Whether it was at the start: then it is never folded, as the memory's own.
    pub(super) is_start: bool,
}

impl Jump {
    pub(super) fn of_start(size: &[f64]) -> Self {
        Self { t: 0.0, size: size.to_vec(), is_start: true }
    }

    /// Adds it times a factor; what does not jump has no share, be the factor infinite.
    pub(super) fn add(&self, factor: f64, out: &mut [f64]) {
        let jumped = out.iter_mut().zip(&self.size).filter(|(_, size)| **size != 0.0);
        jumped.for_each(|(out, size)| *out += factor * size);
    }
}

/// t^−α/Γ(1−α).
fn kernel(alpha: f64, t: f64) -> f64 {
    t.powf(-alpha) * reciprocal_gamma(1.0 - alpha)
}

impl MemoryTangent {
    /// The derivative of x jumps by `size`, P numbers, at t: from now on its share of D^α x is kept apart ([`Self::singular_part`]).
    ///
    /// Steps must not reach beyond t from before it. At α = 0 and 1 nothing is kept: δx says it, or an impulse that is over.
    pub fn jump(&mut self, memory: &Memory, t: f64, size: &[f64]) {
        if !memory.is_fractional() || size.iter().all(|size| *size == 0.0) {
            return;
        }
        // No rate will have led there: it is not owed.
        add(&mut self.travelled, 1.0, size);
        match self.jumps.iter_mut().find(|jump| jump.t == t && !jump.is_start) {
            Some(jump) => add(&mut jump.size, 1.0, size),
            None => self.jumps.push(Jump { t, size: size.to_vec(), is_start: false }),
        }
    }

    /// Adds the derivative of [`Memory::singular_part`] at t, and what is left of jumps; infinite at the time of a jump.
    pub fn singular_part(&self, memory: &Memory, t: f64, out: &mut [f64]) {
        for jump in &self.jumps {
            jump.add(kernel(memory.alpha(), t - jump.t), out);
        }
        if let Some(by_order) = &self.by_order
            && memory.is_singular()
        {
            add(out, memory.singular_part(t) * by_order.singular(t), &self.alpha);
        }
    }

    /// Whether the derivative of x has jumped: it has singular parts where the memory itself may have none.
    pub fn has_jumps(&self) -> bool {
        !self.jumps.is_empty()
    }

    /// Adds the derivative of [`Memory::singular_moments`], and what stands for jumps, at the nodes of a step, s rows of P.
    pub fn singular_moments(&self, memory: &Memory, step: &TangentStep, out: &mut [f64]) {
        self.add_singular(memory, step, Singular::Moments, out);
    }

    /// Adds what [`Self::singular_part`] adds at t, its integral from `from` on, and the integral of that.
    pub fn singular_motion(&self, memory: &Memory, [from, t]: [f64; 2], out: [&mut [f64]; 3]) {
        let alpha = memory.alpha();
        let along = |parts: &dyn Fn(f64) -> [f64; 3], since: f64| -> [f64; 3] {
            let ([value, once, twice], [_, before, before_twice]) = (parts(t - since), parts(from - since));
            [value, once - before, twice - before_twice - (t - from) * before]
        };
        let [value, once, twice] = out;
        let mut add_each = |factors: [f64; 3], take: &dyn Fn(f64, &mut [f64])| {
            for (factor, out) in factors.into_iter().zip([&mut *value, &mut *once, &mut *twice]) {
                take(factor, out);
            }
        };
        for jump in &self.jumps {
            add_each(along(&|age| kernels(alpha, age), jump.t), &|factor, out| jump.add(factor, out));
        }
        if let Some(by_order) = &self.by_order
            && memory.is_singular()
        {
            let size = memory.singular_jump();
            let factors = along(&|age| by_order.kernels(kernels(alpha, age), age), 0.0);
            add_each(factors, &|factor, out| add(out, size * factor, &self.alpha));
        }
    }

    /// Adds what stands for singular parts at the nodes of a step, s rows of P.
    pub(super) fn add_singular(&self, memory: &Memory, step: &TangentStep, singular: Singular, out: &mut [f64]) {
        let (start, count) = (&step.start, step.nodes.count());
        let rows = |out: &mut [f64], take: &mut dyn FnMut(usize, &mut [f64])| {
            (0..count).for_each(|i| take(i, &mut out[i * self.parameters..][..self.parameters]));
        };
        match singular {
            Singular::Apart => {}
            Singular::Values => rows(out, &mut |i, row| {
                self.singular_part(memory, start.t + step.positions()[i] * start.h, row);
            }),
            Singular::Moments => {
                for jump in &self.jumps {
                    let moments = moments(memory.alpha(), start.t - jump.t, step);
                    rows(out, &mut |i, row| jump.add(moments[i], row));
                }
                if let Some(by_order) = &self.by_order
                    && memory.is_singular()
                {
                    let moments = moments_by_order(by_order, memory.alpha(), step);
                    rows(out, &mut |i, row| add(row, memory.singular_jump() * moments[i], &self.alpha));
                }
            }
        }
    }

    /// Puts jumps that have become a smooth past into the modes, at t behind a step of h.
    pub(super) fn fold(&mut self, memory: &Memory, past: &History, t: f64, h: f64) {
        let Self { jumps, modes, now, .. } = self;
        jumps.retain(|jump| {
            let age = t - jump.t;
            if jump.is_start || h > FOLD * age || past.kernel().missing(age) > 0 {
                return true;
            }
            for (k, lambda) in past.kernel().lambda.iter().enumerate() {
                jump.add((-lambda * age).exp(), modes.row_mut(k));
            }
            jump.add(kernel(memory.alpha(), age), now);
            false
        });
    }

    /// Moves t = 0 on to `age` after a singular start, s, itself moved by `delta_age`, P numbers; before [`Memory`] is aged.
    pub fn age(&mut self, memory: &Memory, age: f64, delta_age: &[f64]) {
        let mut now = std::mem::take(&mut self.now);
        self.singular_part(memory, age, &mut now);
        add(&mut now, -memory.alpha() / age * memory.singular_part(age), delta_age);
        self.now = now;
        let jump = memory.singular_jump();
        let Some(past) = memory.past() else { return };
        for (k, lambda) in past.kernel().lambda.iter().enumerate() {
            let share = (-lambda * age).exp();
            let row = self.modes.row_mut(k);
            self.jumps.iter().for_each(|start| start.add(share, row));
            add(row, -lambda * share * jump, delta_age);
        }
        self.jumps.clear();
        if let Some(by_order) = &mut self.by_order {
            by_order.slow.add_jump(jump, age);
        }
    }
}

/// t^{n−α}/Γ(n+1−α), n = 0, 1, 2: t^−α/Γ(1−α) and its integrals.
fn kernels(alpha: f64, t: f64) -> [f64; 3] {
    std::array::from_fn(|n| {
        let n = n as f64;
        if t == 0.0 && n > 0.0 { 0.0 } else { t.powf(n - alpha) * reciprocal_gamma(n + 1.0 - alpha) }
    })
}

/// σ of [`Memory::singular_moments`] for x(0) = 1, `since` after the jump.
fn moments(alpha: f64, since: f64, step: &TangentStep) -> [f64; MAX_NODES] {
    let scale = reciprocal_gamma(2.0 - alpha);
    collocated(|c| scale * grown(1.0 - alpha, since, c * step.start.h) / step.start.h, step.nodes, step.places)
}

/// ∂σ/∂α, t_n being that of the step: s_j (ψ(2−α) − ln t_n) − ℓ e^{(1−α)ℓ} t_n^{1−α}/Γ(2−α), ℓ = ln(1 + c_j h/t_n).
fn moments_by_order(by_order: &ByOrder, alpha: f64, step: &TangentStep) -> [f64; MAX_NODES] {
    let (power, scale, t) = (1.0 - alpha, reciprocal_gamma(2.0 - alpha), step.start.t);
    let moved = |c: f64| {
        let lag = c * step.start.h;
        let impulse = scale * grown(power, t, lag);
        let moved = if t == 0.0 {
            impulse * (by_order.digamma() - lag.ln())
        } else {
            let ln = (lag / t).ln_1p();
            impulse * (by_order.digamma() - t.ln()) - scale * ln * (t + lag).powf(power)
        };
        moved / step.start.h
    };
    collocated(moved, step.nodes, step.places)
}

/// (t + lag)^p − t^p.
fn grown(power: f64, t: f64, lag: f64) -> f64 {
    if t == 0.0 { lag.powf(power) } else { t.powf(power) * (power * (lag / t).ln_1p()).exp_m1() }
}
