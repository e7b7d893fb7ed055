//! The derivative of a kernel by its order.
//!
//! k_α(t) = ∂/∂α t^−α/Γ(1−α) = t^−α/Γ(1−α)·(ψ(1−α) − ln t), t in s, changes its sign, and so do its weights. On the modes that the
//! trapezoidal rule gave, ẇ_k = η λ_k^α [cos πα + (sin πα/π) ln λ_k]: the derivative of w_k with λ_k held. The slow tail, the measure
//! {e^{−kη}, e^{−αkη}} in units of λ_c, has a Gauss rule of n nodes, which knows its own measure to degree 2n − 1 but the derivative
//! −η{k e^{−αkη}} on the same nodes to degree n − 1 alone: it is taken on a rule with some nodes more, which are modes of their own.

use super::super::gamma::{digamma, gamma};
use super::super::history::{History, Lag};
use super::super::kernel::{Kernel, LARGEST_TAIL, geometric_measure, strength};
use super::super::lanes::{Block, blocks, load, sum};
use super::super::local::Local;
use super::super::step::{CUBIC, RatePolynomial, SEXTIC};
use crate::linalg::gauss_rules;
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f64x8};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use std::ops::RangeInclusive;

/// How many nodes more than the kernel the tail has: 2 … 5 for kernels from 1e-6 to 1e-11.
const MORE: RangeInclusive<usize> = 2..=10;

/// Lags at which the derivative of a tail is compared with its measure, and how far below the longest they begin.
const SAMPLES: usize = 100;
const FROM: f64 = 1e-5;

/// How near the nodes of a rule are to those of a kernel that has them.
const SAME: f64 = 1e-9;

/// ∂/∂α of all that a memory is made of, rates of modes, counts and steps held.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct ByOrder {
    alpha: f64,
    /// ψ(p+2−α), p = 0…6.
    digamma: [f64; SEXTIC],
    /// ẇ/w of the modes of the memory; 0 for those of its tail, for which `slow` stands.
    ratio: Vec<Block>,
    modes: usize,
    /// The fastest rate, and ẇ/w of a mode of the trapezoidal rule that has it.
    top: [f64; 2],
    /// η/(1 − e^{−η(n−α)}), n = 1, 2, 3.
    steepness: [f64; 3],
    /// The tail with ẇ for weights, and what it has seen of x'.
    pub(super) slow: History,
}

/// ẇ/w of a mode of the trapezoidal rule.
fn ratio(alpha: f64, lambda: f64) -> f64 {
    (PI * alpha).cos() / strength(alpha) + lambda.ln()
}

impl ByOrder {
    /// Of a kernel that has its slowest modes from [`Kernel::new`].
    pub(super) fn of(kernel: &Kernel) -> Self {
        let (slow, tail) = slow_tail(kernel);
        let mut digammas = [digamma(2.0 - kernel.alpha); SEXTIC];
        for p in 1..SEXTIC {
            digammas[p] = digammas[p - 1] + 1.0 / (p as f64 + 1.0 - kernel.alpha);
        }
        let fast = kernel.modes() - tail;
        let mut ratios: Vec<f64> = kernel.lambda[..fast].iter().map(|lambda| ratio(kernel.alpha, *lambda)).collect();
        ratios.resize(kernel.modes(), 0.0);
        Self {
            alpha: kernel.alpha,
            digamma: digammas,
            ratio: blocks(&ratios),
            modes: kernel.modes(),
            top: [kernel.lambda[0], ratio(kernel.alpha, kernel.lambda[0])],
            steepness: [1.0, 2.0, 3.0].map(|n| -kernel.eta / (-kernel.eta * (n - kernel.alpha)).exp_m1()),
            slow: History::new(slow),
        }
    }

    /// Does what a kernel does that puts modes of these rates in front, or drops the `surplus` fastest.
    pub(super) fn follow(&mut self, kernel: &Kernel, front: &[f64], surplus: usize) {
        if front.is_empty() && surplus == 0 {
            return;
        }
        let top = front.first().copied().unwrap_or(kernel.lambda[surplus]);
        self.top = [top, ratio(self.alpha, top)];
        let mut ratios: Vec<f64> = front.iter().map(|lambda| ratio(self.alpha, *lambda)).collect();
        ratios.extend_from_slice(&self.ratio.as_flattened()[..self.modes]);
        ratios.drain(..surplus);
        self.modes = ratios.len();
        self.ratio = blocks(&ratios);
    }

    /// Appends ẇ/w and the state of the tail to `numbers`.
    pub(super) fn save(&self, numbers: &mut Vec<f64>) {
        numbers.extend(self.top);
        numbers.extend_from_slice(&self.ratio.as_flattened()[..self.modes]);
        self.slow.save(numbers);
    }

    /// Takes back what [`Self::save`] wrote of so many modes of a memory, from the front of `numbers`; `None` where it is not that.
    pub(super) fn load(&mut self, modes: usize, numbers: &mut &[f64]) -> Option<()> {
        let &[top, ratio] = numbers.split_off(..2)? else { return None };
        self.top = [top, ratio];
        (self.ratio, self.modes) = (blocks(numbers.split_off(..modes)?), modes);
        self.slow.load(numbers)
    }

    /// ẇ of a mode in front of the kernel.
    pub(super) fn weight(&self, lambda: f64, weight: f64) -> f64 {
        weight * ratio(self.alpha, lambda)
    }

    /// ẇ/w of a block of modes.
    #[inline(always)]
    pub(super) fn ratio<S: Simd>(&self, simd: S, k: usize) -> f64x8<S> {
        load(simd, &self.ratio[k])
    }

    /// ∂/∂α of Σ_k w_k e^{−λ_k τ} z_k.
    pub(super) fn history(&self, past: &History, lag: f64) -> f64 {
        if past.is_empty() {
            return 0.0;
        }
        let mut total = self.kept(past, past.lag(lag)) + self.slow.at(lag);
        for k in 1..=past.kernel().missing(lag) {
            let (lambda, weight) = past.kernel().faster(k);
            total += self.weight(lambda, weight) * (-lambda * lag).exp() * past.fast_mode(lambda);
        }
        total
    }

    fn kept(&self, past: &History, lag: Lag) -> f64 {
        dispatch!(Level::new(), simd => {
            let mut total = f64x8::splat(simd, 0.0);
            for k in 0..past.blocks() {
                let [_, _, z] = past.block(simd, k);
                total += lag.weighted(simd, k) * self.ratio(simd, k) * z;
            }
            sum(total)
        })
    }

    /// ∂/∂α of the mean of the past over lags up to τ, as [`History::mean`] and what modes above settle to.
    pub(super) fn mean_history(&self, past: &History, lag: f64) -> f64 {
        if past.is_empty() {
            return 0.0;
        }
        let at = past.lag(lag);
        let kept = dispatch!(Level::new(), simd => {
            let mut total = f64x8::splat(simd, 0.0);
            for k in 0..past.blocks() {
                let [_, weight, z] = past.block(simd, k);
                let (_, [psi, ..]): (_, [_; CUBIC]) = at.moments(simd, k);
                total += weight * self.ratio(simd, k) * psi * z;
            }
            sum(total)
        });
        let [_, d2, _] = self.fast_tail(past);
        kept + self.slow.mean(lag) + d2 * past.last_value() / lag
    }

    /// ∂/∂α of [`Kernel::fast_tail`], λ_0 held: d_n [π cot πα + ln λ_0 + η/(1 − e^{−η(n−α)})].
    pub(super) fn fast_tail(&self, past: &History) -> [f64; 3] {
        let top = past.kernel().lambda[0];
        let first = if top == self.top[0] { self.top[1] } else { ratio(self.alpha, top) };
        let tail = past.fast_tail();
        std::array::from_fn(|k| tail[k] * (first + self.steepness[k]))
    }

    /// ∂/∂α of the share of a step in D^α x at θ.
    pub(super) fn local(&self, local: &Local, step: &RatePolynomial, theta: f64) -> f64 {
        let moments = self.local_moments(local, step.h, theta);
        step.u.iter().zip(moments).map(|(u, moment)| u * moment).sum()
    }

    /// ∂/∂α of [`local_moments`], L_p (ψ(p+2−α) − ln θh).
    pub(super) fn local_moments(&self, local: &Local, h: f64, theta: f64) -> [f64; SEXTIC] {
        let (values, ln) = (local_moments(local, h, theta), (theta * h).ln());
        std::array::from_fn(|p| values[p] * (self.digamma[p] - ln))
    }

    /// ∂/∂α of the mean of D^α x over a step under the rate 1, h^{1−α}/Γ(3−α).
    pub(super) fn mean_local(&self, mean: f64, h: f64) -> f64 {
        mean * (self.digamma[1] - h.ln())
    }

    /// ψ(1−α) − ln t: ∂/∂α of t^−α/Γ(1−α) over itself.
    pub(super) fn singular(&self, t: f64) -> f64 {
        self.digamma[0] - 1.0 / (1.0 - self.alpha) - t.ln()
    }

    /// ∂/∂α of `kernels` = t^{n−α}/Γ(n+1−α), n = 0, 1, 2.
    pub(super) fn kernels(&self, kernels: [f64; 3], t: f64) -> [f64; 3] {
        let [first, second, ..] = self.digamma;
        let digamma = [first - 1.0 / (1.0 - self.alpha), first, second];
        std::array::from_fn(|n| if kernels[n] == 0.0 { 0.0 } else { kernels[n] * (digamma[n] - t.ln()) })
    }

    /// ψ(2−α).
    pub(super) fn digamma(&self) -> f64 {
        self.digamma[0]
    }
}

/// h^{1−α} θ^{p+1−α} p!/Γ(p+2−α), p = 0…6: D^α of θ^p within a step.
pub(super) fn local_moments(local: &Local, h: f64, theta: f64) -> [f64; SEXTIC] {
    let mut power = local.power(theta * h);
    local.factors.map(|factor| {
        let value = power * factor;
        power *= theta;
        value
    })
}

/// The tail of a kernel with ẇ for weights, and how many of the slowest modes of the kernel it stands for.
fn slow_tail(kernel: &Kernel) -> (Kernel, usize) {
    let Kernel { alpha, eta, horizon, tolerance, .. } = *kernel;
    let (points, masses) = geometric_measure(alpha, eta);
    let modes = kernel.modes();
    let is_tail = |nodes: &[f64]| {
        let Some(fast) = modes.checked_sub(nodes.len() + 1) else { return false };
        let cut = kernel.lambda[fast] * (-eta).exp();
        kernel.lambda[fast + 1..].iter().zip(nodes).all(|(lambda, node)| (lambda / cut - node).abs() <= SAME * node)
    };
    let mut own = gauss_rules(&points, &masses, 1..=LARGEST_TAIL).into_iter();
    let tail = own.find(|(nodes, _)| is_tail(nodes)).expect("the tail of a kernel that is new, or extended").0.len();
    let cut = kernel.lambda[modes - tail - 1] * (-eta).exp();

    // −η k e^{−αkη}; beyond the last point k and more by a geometric series at 0.
    let last = points.len() - 1;
    let mut moved: Vec<f64> = masses.iter().enumerate().map(|(k, mass)| k as f64 * mass).collect();
    let share = (-alpha * eta).exp();
    moved[last] = masses[last] * (last as f64 - share / (-alpha * eta).exp_m1());
    let to_kernel = strength(alpha) * eta * eta * gamma(1.0 - alpha);
    let longest = cut * horizon;
    let lags: Vec<f64> = (0..=SAMPLES).map(|k| longest * FROM.powf(k as f64 / SAMPLES as f64)).collect();
    let value = |points: &[f64], masses: &[f64], x: f64| -> f64 {
        points.iter().zip(masses).map(|(point, mass)| mass * (-x * point).exp()).sum()
    };
    let exact: Vec<f64> = lags.iter().map(|x| value(&points, &moved, *x)).collect();
    let error = |nodes: &[f64], shares: &[f64]| {
        lags.iter()
            .zip(&exact)
            .map(|(x, exact)| (value(nodes, shares, *x) - exact).abs() * to_kernel * x.powf(alpha))
            .fold(0.0, f64::max)
    };
    let mut best: Option<(f64, [Vec<f64>; 3])> = None;
    // Two sizes at a time: large rules are dear.
    for more in MORE.step_by(2) {
        for (nodes, masses) in gauss_rules(&points, &masses, tail + more..=tail + more + 1) {
            let shares = interpolatory(&nodes, &points, &moved);
            let found = error(&nodes, &shares);
            if best.as_ref().is_none_or(|(least, _)| found < *least && *least > tolerance) {
                best = Some((found, [nodes, masses, shares]));
            }
        }
        if best.as_ref().is_some_and(|(found, _)| *found <= tolerance) {
            break;
        }
    }
    let (_, [nodes, masses, shares]) = best.expect("some sizes were tried");
    let (scale, first) = (strength(alpha) * eta * cut.powf(alpha), ratio(alpha, cut));
    let weight = masses.iter().zip(&shares).map(|(mass, share)| scale * (first * mass - eta * share)).collect();
    let lambda = nodes.iter().map(|node| cut * node).collect();
    // No lag is too short for it: what is faster belongs to the kernel.
    (Kernel { lambda, weight, delta: f64::MIN_POSITIVE, ..*kernel }, tail)
}

/// Masses on `nodes` that integrate polynomials of degree nodes.len() − 1 as the measure does.
fn interpolatory(nodes: &[f64], points: &[f64], masses: &[f64]) -> Vec<f64> {
    let lagrange = |j: usize, x: f64| -> f64 {
        let others = nodes.iter().enumerate().filter(|(i, _)| *i != j);
        others.map(|(_, node)| (x - node) / (nodes[j] - node)).product()
    };
    (0..nodes.len()).map(|j| points.iter().zip(masses).map(|(x, mass)| mass * lagrange(j, *x)).sum()).collect()
}

#[cfg(test)]
impl ByOrder {
    /// Σ ẇ e^{−λt} of the kernel whose modes these are.
    pub(super) fn kernel_by_order(&self, kernel: &Kernel, t: f64) -> f64 {
        let modes = kernel.lambda.iter().zip(&kernel.weight).zip(self.ratio.as_flattened());
        let trapezoid: f64 = modes.map(|((l, w), ratio)| w * ratio * (-l * t).exp()).sum();
        trapezoid + self.slow.kernel().value(t)
    }

    pub(super) fn ratios(&self) -> &[f64] {
        &self.ratio.as_flattened()[..self.modes]
    }
}
