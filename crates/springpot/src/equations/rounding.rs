//! What rounding does to accelerations, so that nothing below it is taken for an error of a step.

mod weights;

use self::weights::Weights;
use super::assembly::{Equations, Tangent};
use super::context::Context;
use super::node::Node;
use crate::linalg::columns::{Block, LANES};
use serde::{Deserialize, Serialize};

/// What a sum of forces loses of its largest terms.
const LOST: f64 = 4.0 * f64::EPSILON;

/// The same of the rigid bodies, by so much more that the rounding of one step seldom comes near it: errors that no shorter step makes
/// smaller keep steps from growing.
const RIGID: f64 = 64.0;

/// How much more that is where laws of control hold a robot: their inverse dynamics round otherwise than those of the step.
const HELD: f64 = 16.0;

/// Above this multiple of the rounding that a velocity has by itself, what others bring in is not looked at.
const CLOSE: f64 = 1e6;

/// More free velocities than these take over from step to step what M⁻¹ does to their rounding, and so many steps: its size is what counts.
const FEW: usize = 16;
const STEPS: u32 = 16;

/// What a step takes over from those before.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Shares {
    /// Of each free velocity, what all forces make up in units of what its own does; NaN where not known.
    of: Vec<f64>,
    /// Steps since they began.
    steps: u32,
}

impl Shares {
    pub(super) fn forget(&mut self) {
        *self = Self::default();
    }

    pub(super) fn commit(&mut self) {
        self.steps += 1;
        if self.steps == STEPS {
            self.forget();
        }
    }
}

/// Forces that rounding makes up, and accelerations that follow.
#[derive(Debug, Default)]
pub(super) struct Rounding {
    /// √M_kk of every velocity, by which all that the rigid bodies do is bounded (Cauchy and Schwarz).
    roots: Vec<f64>,
    weights: Weights,
    /// Of each element, N.
    pulls: Vec<f64>,
    /// Of each free velocity, N or N·m.
    forces: Vec<f64>,
    /// Columns of M⁻¹ over the free velocities, [`LANES`] side by side; empty where not asked for since the last linearisation.
    inverse: Vec<Vec<Block>>,
    /// Whether M was regular, where it was factored since then.
    is_factored: Option<bool>,
    pub(super) shares: Shares,
    /// Of each free velocity, m/s² or rad/s².
    pub(super) accelerations: Vec<f64>,
}

impl Rounding {
    /// What is known of the mass matrix holds no longer.
    pub(super) fn forget(&mut self) {
        self.inverse.iter_mut().for_each(Vec::clear);
        self.is_factored = None;
    }
}

impl Equations {
    /// What rounding does to the accelerations of the free velocities, in their order, in a step of size `h` from where the robot is at `at`: where
    /// `allowed`, the tolerance of each velocity, is not far above what it has of its own, by |M⁻¹| from all of them.
    ///
    /// Terms of the equations of motion round as they are before they cancel: weights as |g| √(m_k M_kk), m_k being the mass that k carries,
    /// or less where k slides across them ([`Weights`]),
    /// inertia as √M_kk Σ √M_jj (|a_j| + ω |v_j|).
    pub(crate) fn round(&mut self, cx: Context, at: Node, h: f64, allowed: impl Fn(usize) -> f64) -> &[f64] {
        let mut rounding = std::mem::take(&mut self.rounding);
        self.round_pulls(cx, at.t, h, &mut rounding.pulls);
        rounding.weights.take(&cx.system.model, &self.tangent.kinematics);
        self.round_forces(cx, at, h, &mut rounding);
        let (n, count) = (cx.system.model.nv(), self.free().len());
        let mass = |k: usize| self.slopes().d_a[k * n + k];
        let own = self.free().iter().zip(&rounding.forces).map(|(&k, f)| if mass(k) > 0.0 { f / mass(k) } else { 0.0 });
        rounding.accelerations.clear();
        rounding.accelerations.extend(own);
        rounding.shares.of.resize(count, f64::NAN);
        for r in 0..count {
            let (force, own) = (rounding.forces[r], rounding.accelerations[r]);
            let is_close = allowed(r) <= CLOSE * h * own || (force > 0.0 && own == 0.0);
            let share = rounding.shares.of[r];
            if is_close && count > FEW && share.is_finite() {
                rounding.accelerations[r] = share * own;
            } else if is_close && self.invert(n, &mut rounding, r / LANES) {
                // M is symmetric: its columns are rows.
                let row = rounding.inverse[r / LANES].iter().zip(&rounding.forces);
                rounding.accelerations[r] = row.map(|(m, f)| m[r % LANES].abs() * f).sum();
                rounding.shares.of[r] = rounding.accelerations[r] / own;
            }
        }
        self.rounding = rounding;
        &self.rounding.accelerations
    }

    /// Of the elements: what their strokes and inputs lose, and the last digits of the force itself.
    fn round_pulls(&self, cx: Context, from: f64, h: f64, pulls: &mut Vec<f64>) {
        pulls.clear();
        let (bank, t) = (&self.bank, from + h);
        for (e, element) in cx.system.elements.iter().enumerate() {
            // From nothing that a run that goes on does not know.
            let stiffness = element.law.stiffness(&bank.point(e, 0), 1.0 / h);
            let mut pull = stiffness * bank.resolution(e) + LOST * self.force_at_start(e).abs();
            let mut input = |i: usize, lost: f64| {
                if lost > 0.0 {
                    let slopes = bank.by_input_at_start(e, i);
                    pull += lost * slopes.iter().flatten().fold(0.0, |largest: f64, slope| largest.max(slope.abs()));
                }
            };
            for (i, signal) in element.inputs.iter().enumerate().filter(|(i, _)| !cx.holds_input(e, *i)) {
                input(i, signal.rounding(t));
            }
            if let Some(control) = &self.control {
                control.for_each_rounded_input(e, &mut input);
            }
            pulls.push(if pull.is_finite() { pull } else { 0.0 });
        }
    }

    /// Of all that acts on each free velocity.
    fn round_forces(&self, cx: Context, at: Node, h: f64, rounding: &mut Rounding) {
        let Rounding { roots, weights, pulls, forces, .. } = rounding;
        let (model, n, slopes) = (&cx.system.model, cx.system.model.nv(), self.slopes());
        roots.clear();
        roots.extend((0..n).map(|k| slopes.d_a[k * n + k].max(0.0).sqrt()));
        let turning: f64 = model.turning(at.v).map(f64::abs).sum();
        let moved: f64 =
            roots.iter().zip(at.a).zip(at.v).map(|((root, a), v)| root * (a.abs() + turning * v.abs())).sum();
        forces.clear();
        let t = at.t + h;
        let mut free = self.free().iter().peekable();
        for (j, signals) in self.forward.forced(model) {
            let carried = weights.felt(model, j) * model.subtree_mass(j).sqrt();
            for (k, signal) in model.v_range(j).zip(signals) {
                if free.next_if(|free| **free == k).is_none() {
                    continue;
                }
                let rigid = roots[k] * (carried + moved);
                let pull: f64 = self.elements.iter().zip(&*pulls).map(|(e, pull)| e.gradient[k].abs() * pull).sum();
                let driven = self.driven.iter().fold(0.0, |largest: f64, driven| {
                    largest.max(driven.get(forces.len()).map_or(0.0, |driven| driven.abs()))
                });
                let signal = if cx.holds_force(k) { 0.0 } else { signal.rounding(t) };
                let held = self.control.as_ref();
                let held = held.map_or(0.0, |control| HELD * LOST * control.largest(k) + control.rounded_torque(k));
                let sum = LOST * (RIGID * rigid + driven) + pull + signal + held;
                forces.push(if sum.is_finite() { sum } else { 0.0 });
            }
        }
    }

    /// A block of columns of M⁻¹ over the free velocities; `false` where M is singular.
    fn invert(&mut self, nv: usize, rounding: &mut Rounding, block: usize) -> bool {
        let Rounding { inverse, is_factored, .. } = rounding;
        let (free, Tangent { mass, slopes, .. }) = (&self.free, &mut self.tangent);
        if !*is_factored.get_or_insert_with(|| mass.factor_part(&slopes.d_a, nv, free)) {
            return false;
        }
        let count = free.len();
        inverse.resize_with(count.div_ceil(LANES).max(inverse.len()), Vec::new);
        let columns = &mut inverse[block];
        if columns.len() != count {
            columns.clear();
            columns.resize(count, [0.0; LANES]);
            columns[block * LANES..].iter_mut().take(LANES).enumerate().for_each(|(lane, row)| row[lane] = 1.0);
            mass.solve_rows(columns.as_flattened_mut(), LANES);
        }
        true
    }
}
