//! What parameters change where the motion starts anew: the time of a change moves, and with it what acts before and behind it.
//!
//! Where accelerations jump from a⁻ to a⁺ at a time t* that comes later by δt*, the changes at fixed t jump by δv⁺ = δv⁻ + (a⁻ − a⁺) δt*; places,
//! strokes and memories go on as they are (Galán, Feehery & Barton, Applied Numerical Mathematics 31, 1999).

use super::assembly::Equations;
use super::evaluate::Evaluation;
use super::node::Node;
use super::variation::Variation;
use crate::sensitivity::Lost;

/// Times of one change that differ by less than this share of them are one.
const ONE_TIME: f64 = 1e-9;

impl Variation {
    /// Whether the derivatives by parameter `p` exist so far.
    pub(crate) fn knows(&self, p: usize) -> bool {
        self.lost[p].is_none()
    }

    /// Where derivatives ended, parameter by parameter.
    pub(crate) fn lost(&self) -> &[Option<Lost>] {
        &self.lost
    }

    /// Derivatives by parameter `p` end at `t`.
    pub(crate) fn lose(&mut self, p: usize, t: f64, why: &str) {
        self.lost[p].get_or_insert_with(|| Lost { t, why: why.to_owned() });
    }

    /// The change at the present time, `t`, comes later by δt* = −δγ/γ̇, parameter by parameter, where a function γ that changes by `of(p)` passes
    /// zero at `speed`.
    pub(crate) fn passes(&mut self, t: f64, speed: f64, of: impl Fn(&Self, usize) -> f64) {
        let change = |p: usize| match of(self, p) {
            0.0 => 0.0,
            change => -change / speed,
        };
        let later = (0..self.count()).map(change).collect();
        self.comes_later(t, later);
    }

    /// The change at the present time, `t`, comes later by so much, s, parameter by parameter.
    pub(crate) fn comes_later(&mut self, t: f64, later: Vec<f64>) {
        let known = self.later.take();
        for p in 0..later.len() {
            let other = known.as_ref().map_or(later[p], |known| known[p]);
            if !later[p].is_finite() {
                self.lose(p, t, "what changes there is reached without speed");
            } else if (later[p] - other).abs() > ONE_TIME * later[p].abs().max(other.abs()) {
                self.lose(p, t, "two changes come at one time, which it moves apart");
            }
        }
        self.later = Some(later);
    }

    /// These velocities come to rest at the present time, where the robot is `at`.
    pub(crate) fn stop(&mut self, stopping: &[usize], at: &Evaluation) {
        for &k in stopping {
            let row = self.own_v[k];
            self.passes(at.t, at.a[k], |own, p| own.nodes[0].v[row * own.count() + p]);
        }
    }

    /// Goes to the far side of what was crossed, `start`, where the accelerations were `before`.
    pub(crate) fn settle(&mut self, equations: &Equations, start: Node, before: &[f64]) {
        let count = self.count();
        if let Some(later) = self.later.take() {
            for (k, (before, after)) in before.iter().zip(start.a).enumerate() {
                let blocks = self.own_v[k] * count..;
                let changes = self.nodes[0].v[blocks].iter_mut().zip(&later).filter(|(_, later)| later.is_finite());
                changes.for_each(|(v, later)| *v += (before - after) * later);
            }
        }
        self.hold(equations);
        self.see_start(equations, start);
        self.accelerate(equations);
    }

    /// What friction holds stays at rest.
    pub(super) fn hold(&mut self, equations: &Equations) {
        let count = self.count();
        for (k, &row) in self.own_v.iter().enumerate() {
            if equations.holds(k) {
                self.nodes[0].v[row * count..(row + 1) * count].fill(0.0);
            }
        }
    }
}
