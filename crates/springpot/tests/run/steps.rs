//! Marching a memory along a function.

#![allow(dead_code, reason = "each test uses its share")]

use springpot::collocation::{Nodes, RADAU_NODES};
use springpot::fractional::{Memory, RatePolynomial, StepStart};

/// How a step's polynomial is made.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Interpolation {
    Rates,
    Strokes,
    Hermite,
    Linear,
}

type Function<'a> = &'a dyn Fn(f64) -> f64;

fn polynomial(kind: Interpolation, t: f64, h: f64, x: Function, v: Function) -> RatePolynomial {
    let at = |f: Function| -> Vec<f64> { [0.0].iter().chain(&RADAU_NODES).map(|c| f(t + c * h)).collect() };
    match kind {
        Interpolation::Rates => RatePolynomial::through_rates(h, Nodes::Radau, &at(v)),
        Interpolation::Strokes => RatePolynomial::through_strokes(h, Nodes::Radau, &at(x)),
        Interpolation::Hermite => RatePolynomial::hermite(h, [x(t), x(t + h)], [v(t), v(t + h)]),
        Interpolation::Linear => RatePolynomial::through_strokes(h, Nodes::One, &[x(t), x(t + h)]),
    }
}

/// D^alpha x at the times of `grid` but the first, from which the memory goes on.
pub(crate) fn march(memory: &mut Memory, kind: Interpolation, grid: &[f64], x: Function, v: Function) -> Vec<f64> {
    let step = |w: &[f64]| {
        let (t, h) = (w[0], w[1] - w[0]);
        let step = polynomial(kind, t, h, x, v);
        let value = memory.derivative(&StepStart { t, h, stroke: x(t), rate: v(t) }, &step, 1.0, x(w[1]), v(w[1]));
        memory.commit(&step);
        value
    };
    grid.windows(2).map(step).collect()
}

/// `count` equal steps to `end`.
pub(crate) fn uniform(end: f64, count: usize) -> Vec<f64> {
    (0..=count).map(|k| end * k as f64 / count as f64).collect()
}

/// `count` steps to `end` that grow from the start: t_k = end·(k/count)³.
pub(crate) fn graded(end: f64, count: usize) -> Vec<f64> {
    (0..=count).map(|k| end * (k as f64 / count as f64).powi(3)).collect()
}

/// Starts and sizes of `count` steps, sizes spread evenly in their logarithm.
pub(crate) fn random_steps(seed: u64, count: usize, shortest: f64, longest: f64) -> Vec<(f64, f64)> {
    // Sizes from a splitmix generator: the same on every machine.
    let mut state = seed;
    let mut uniform = move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / u64::MAX as f64
    };
    let mut t = 0.0;
    (0..count)
        .map(|_| {
            let h = shortest * (longest / shortest).powf(uniform());
            let step = (t, h);
            t += h;
            step
        })
        .collect()
}
