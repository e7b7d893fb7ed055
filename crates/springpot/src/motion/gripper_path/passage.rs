//! Passages through singular configurations.
//!
//! Where the arm is stretched out, or the gripper is on an axis, J loses rank: v = J⁺ṙ says nothing about one direction, and beside
//! such an instant, where the smallest singular value is σ (over the largest), rounding is magnified 1/σ² times in v and 1/σ³ times
//! in a. The motion itself may well be smooth there: at a fold σ changes its sign while u·ṙ does, and v is the limit of their ratio.
//! So q around the instant is a polynomial through the positions at [`COUNT`] Chebyshev nodes (none of them near the instant, since
//! there are only positions to σ ~ the distance), and v and a are its derivatives: the analytic continuation of the branch from both
//! sides, or from the one that there is where a path starts, turns or ends there.
//!
//! The last coefficients of the polynomial tell how far it may be trusted. Where no stretch of any length gives a polynomial (a square
//! root of time at the limit of the reach, a stay in singular configurations), the path ends there with an error. That is also so where a
//! *redundant* robot starts, or its path turns, in a singular configuration: motions of least velocity then lead from it in several ways.

use super::chebyshev::{Chebyshev, nodes};
use super::hermite::Knot;
use super::solver::{ITERATIONS, START_ITERATIONS, Solver};

/// Closer to a loss of rank than this a passage is looked for: rounding is 1e-10 in v here.
pub(super) const CLOSE: f64 = 1e-3;

/// Closer than this J says nothing.
pub(super) const SINGULAR: f64 = 3e-8;

/// Nodes of a polynomial; fewer or more by one or two where a node would come near the singular instant.
const COUNT: usize = 16;

/// The relative error of v up to which a polynomial is taken, and below which a better one is not looked for.
const ROUGH: f64 = 1e-6;
const SMOOTH: f64 = 1e-11;

/// How often stretches of time are halved.
const HALVINGS: usize = 30;

/// How far a start may be from where the polynomial leads, rad or m: a position at a fold is known to the root of its tolerance.
const SAME: f64 = 1e-3;

/// A smooth way through a singular configuration.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Passage {
    /// When the polynomial is used, s.
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) polynomial: Chebyshev,
}

/// Where a polynomial is looked for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Search {
    /// The singular instant, s.
    pub(super) t: f64,
    /// How near it is to a loss of rank.
    pub(super) conditioning: f64,
    /// Times to which it may go, s.
    pub(super) within: [f64; 2],
    /// The longest and the shortest reach to either side, s.
    pub(super) longest: f64,
    pub(super) shortest: f64,
}

impl Search {
    /// The smoothest polynomial of those through positions that `place` finds for a stretch of time at its nodes; `None` where there is none
    /// that is better than J itself.
    pub(super) fn find(&self, mut place: impl FnMut([f64; 2], &[f64]) -> Option<Vec<Vec<f64>>>) -> Option<Passage> {
        let (mut best, mut roughness) = (None, ROUGH.min(f64::EPSILON / (self.conditioning * self.conditioning)));
        let mut reach = self.longest;
        for _ in 0..HALVINGS {
            if reach < self.shortest || roughness < SMOOTH {
                break;
            }
            let [from, to] = [(self.t - reach).max(self.within[0]), (self.t + reach).min(self.within[1])];
            let times = self.clear_nodes(from, to);
            if let Some(values) = place([from, to], &times) {
                let polynomial = Chebyshev::through(from, to, &values);
                // Not of one that is no number.
                if polynomial.roughness() < roughness {
                    roughness = polynomial.roughness();
                    let half = 0.5 * reach;
                    best = Some(Passage { from: from.max(self.t - half), to: to.min(self.t + half), polynomial });
                }
            }
            reach *= 0.5;
        }
        best
    }

    /// Nodes of which none is near the singular instant.
    fn clear_nodes(&self, from: f64, to: f64) -> Vec<f64> {
        let gap = |times: &[f64]| times.iter().map(|t| (t - self.t).abs()).fold(f64::INFINITY, f64::min);
        let choices = (COUNT - 1..=COUNT + 2).map(|count| nodes(from, to, count));
        choices.max_by(|a, b| gap(a).total_cmp(&gap(b))).unwrap_or_default()
    }
}

impl Passage {
    /// The knot at t.
    pub(super) fn knot(&self, t: f64, conditioning: f64) -> Knot {
        let n = self.polynomial.coordinates();
        let [mut q, mut v, mut a] = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
        self.polynomial.at(t, [&mut q, &mut v, &mut a]);
        Knot { t, q, v, a, conditioning }
    }
}

impl Solver<'_> {
    /// Positions at `times`, which lead away from `near` one after the other.
    pub(super) fn chain(&mut self, near: &Knot, times: impl Iterator<Item = f64>) -> Option<Vec<Vec<f64>>> {
        let mut near = near.clone();
        let mut values = Vec::new();
        for t in times {
            let guess = if self.freedom.is_redundant { self.extrapolate(&near, t) } else { near.taylor(t - near.t) };
            near = self.knot(t, guess, ITERATIONS).ok()?;
            values.push(near.q.clone());
        }
        Some(values)
    }

    /// The way that leads from the singular `start` to the side where `ahead` is: a guess for a time after it.
    pub(super) fn way_out(
        &mut self,
        start: &Knot,
        search: &Search,
        ahead: impl Fn(f64) -> Vec<f64>,
    ) -> Option<Passage> {
        search.find(|[_, to], times| {
            let far = self.knot(to, ahead(to), START_ITERATIONS).ok()?;
            if far.conditioning < CLOSE {
                return None;
            }
            let mut values = self.chain(&far, times.iter().rev().copied())?;
            values.reverse();
            let [first, last] = [values.first()?, values.last()?];
            let is_same = (0..first.len()).all(|j| {
                let size = start.q[j].abs().max(1.0);
                (first[j] - start.q[j]).abs() <= SAME * size + 0.05 * (last[j] - first[j]).abs()
            });
            is_same.then_some(values)
        })
    }
}
