//! Parts of a series that are free at some strokes: ropes, pads that lift off, stops.
//!
//! All of them together are one spring with play: with X the sum of their strokes F = K·(X − U) above U, K·(X − L) below L, 0 between, where L
//! and U are the sums of their ends and 1/K = Σ 1/k.

use crate::collocation::MAX_NODES;
use crate::law::leaf::Free;
use crate::law::network::{MOST_IN_SERIES, Network};
use crate::law::step::Step;

/// Rounding of a stroke, in units of what it was told to be, and of what it moves by in the last bit of the time.
const ROUNDINGS: f64 = 16.0;
const BITS: f64 = 4.0;

/// Where a play is: it pulls (1), pushes (−1), or carries nothing (0).
pub(super) type Side = i8;

/// The parts of a series that are free at some strokes, as one.
#[derive(Debug, Clone)]
pub(super) struct Play {
    /// Which parts, and where they are free.
    parts: Vec<(usize, Free)>,
    lower: f64,
    upper: f64,
    stiffness: f64,
}

/// How well a stroke is known in a step: where a kink is met is known no better than the time.
pub(super) fn near(step: &Step) -> f64 {
    let moved = step.stroke.iter().fold(0.0f64, |moved, x| moved.max((x - step.stroke[0]).abs()));
    ROUNDINGS * step.resolution + BITS * f64::EPSILON * (step.t / step.h) * moved
}

impl Play {
    /// That of `parts`, where there is one.
    pub(super) fn of(parts: &[Network]) -> Option<Self> {
        let free: Vec<(usize, Free)> =
            parts.iter().enumerate().filter_map(|(k, part)| Some((k, part.ask().free()?))).collect();
        let sum = |of: fn(&Free) -> f64| free.iter().map(|(_, free)| of(free)).sum::<f64>();
        let [lower, upper] = [sum(|free| free.lower), sum(|free| free.upper)];
        let stiffness = sum(|free| free.stiffness.recip()).recip();
        (!free.is_empty()).then_some(Self { parts: free, lower, upper, stiffness })
    }

    /// K, N/m.
    pub(super) fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// k of part `k` of the series.
    pub(super) fn stiffness_of(&self, k: usize) -> f64 {
        self.parts.iter().find(|(own, _)| *own == k).map_or(0.0, |(_, free)| free.stiffness)
    }

    /// The part of the series that slack goes to first.
    pub(super) fn first(&self) -> usize {
        self.parts[0].0
    }

    /// Its ends that are there.
    pub(super) fn ends(&self) -> impl Iterator<Item = f64> {
        [self.lower, self.upper].into_iter().filter(|end| end.is_finite())
    }

    /// Whether it gives a force anywhere.
    pub(super) fn is_any(&self) -> bool {
        self.ends().next().is_some()
    }

    /// Whether part `k` of the series is one of its own.
    pub(super) fn has(&self, k: usize) -> bool {
        self.parts.iter().any(|(own, _)| *own == k)
    }

    /// X where its parts have these strokes.
    pub(super) fn stroke(&self, strokes: impl Fn(usize) -> f64) -> f64 {
        self.parts.iter().map(|(k, _)| strokes(*k)).sum()
    }

    /// The stroke nearest to `x` at which it carries nothing.
    pub(super) fn free(&self, x: f64) -> f64 {
        x.clamp(self.lower, self.upper)
    }

    pub(super) fn force(&self, x: f64) -> f64 {
        self.stiffness * (x - self.free(x))
    }

    /// The end at which it is engaged on `side`.
    pub(super) fn end(&self, side: Side) -> f64 {
        if side > 0 { self.upper } else { self.lower }
    }

    /// Where it is at the stroke `x`; `None` on an end, as `near` as strokes are known.
    pub(super) fn side(&self, x: f64, near: f64) -> Option<Side> {
        if self.ends().any(|end| (x - end).abs() <= near) {
            return None;
        }
        Some(i8::from(x > self.upper) - i8::from(x < self.lower))
    }

    /// The strokes of its parts, by their places in the series, that are X = `x` together under the force `force`; slack goes to the first that is free.
    pub(super) fn spread(&self, x: f64, force: f64, side: Side) -> [f64; MOST_IN_SERIES] {
        let mut strokes = [0.0; MOST_IN_SERIES];
        if side != 0 {
            for (k, free) in &self.parts {
                strokes[*k] = if side > 0 { free.upper } else { free.lower } + force / free.stiffness;
            }
            return strokes;
        }
        let rest = |free: &Free| 0.0f64.clamp(free.lower, free.upper);
        let mut left = x - self.parts.iter().map(|(_, free)| rest(free)).sum::<f64>();
        for (k, free) in &self.parts {
            strokes[*k] = (rest(free) + left).clamp(free.lower, free.upper);
            left -= strokes[*k] - rest(free);
        }
        // Beyond its ends, where only its course is asked for.
        self.parts.first().into_iter().for_each(|(k, _)| strokes[*k] += left);
        strokes
    }

    /// Where nodes are that were taken to be on `sides` and so have these strokes and forces.
    pub(super) fn sides(
        &self,
        sides: &[Side; MAX_NODES],
        stroke: &[f64; MAX_NODES],
        force: &[f64; MAX_NODES],
        count: usize,
        near: f64,
    ) -> [Side; MAX_NODES] {
        std::array::from_fn(|i| match sides[i] {
            side if i >= count => side,
            0 if stroke[i] > self.upper + near => 1,
            0 if stroke[i] < self.lower - near => -1,
            0 => 0,
            side if f64::from(side) * force[i] < -self.stiffness * near => 0,
            side => side,
        })
    }
}
