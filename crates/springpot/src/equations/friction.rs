//! Coulomb friction of the joints: which of them it holds and which slide against it, between two changes.

use super::coulomb::{Candidate, Coulomb};
use super::resistance::holding_forces;
use super::solve::Solve;
use crate::actuation::Forward;
use crate::model::Model;
use serde::{Deserialize, Serialize};

/// Changes between holding and sliding after which a run that does not get on stops.
const MOST_CHANGES: u32 = 1_000;

/// What counts as not getting on: all those changes within this share of the run.
pub(crate) const CHATTER: f64 = 1e-9;

/// What a force must exceed its limit by to move a joint that holds, in units of its rounding.
const ROUNDINGS: f64 = 64.0;

/// What is carried from step to step.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Sliding {
    /// Of every velocity that rubs, in their order, −1, 0 (held) or 1: the direction in which it slides.
    directions: Vec<i8>,
    /// Changes since that time, s.
    changes: u32,
    since: f64,
}

/// Friction that sticks, at the velocities of forward dynamics.
#[derive(Debug)]
pub(crate) struct Friction {
    /// What friction can hold at every velocity, N·m or N; 0 where nothing sticks.
    limits: Vec<f64>,
    /// Velocities that forces drive.
    driven: Vec<usize>,
    /// Those of them at which friction sticks.
    rubbing: Vec<usize>,
    /// Joints that signals move against friction that sticks.
    led: Vec<usize>,
    pub(super) sliding: Sliding,
    /// Velocities that come to rest at the end of the step, those that are held from then on in any case, and whether any joint
    /// breaks away there.
    pub(super) stopping: Vec<usize>,
    pub(super) caught: Vec<usize>,
    pub(super) breaks_away: bool,
    coulomb: Coulomb,
}

impl Friction {
    pub(super) fn new(model: &Model, forward: &Forward) -> Self {
        let limits = holding_forces(model);
        let driven = forward.free_velocities(model);
        let rubbing: Vec<usize> = driven.iter().copied().filter(|&k| limits[k] > 0.0).collect();
        let is_rubbed = |j: &usize| model.v_range(*j).any(|k| limits[k] > 0.0);
        let led = forward.paths(model).map(|(j, _)| j).filter(is_rubbed).collect();
        let sliding = Sliding { directions: vec![0; rubbing.len()], ..Sliding::default() };
        Self {
            limits,
            driven,
            rubbing,
            led,
            sliding,
            stopping: Vec::new(),
            caught: Vec::new(),
            breaks_away: false,
            coulomb: Coulomb::default(),
        }
    }

    /// Whether a state may be one of the same system.
    pub(super) fn fits(&self, sliding: &Sliding) -> bool {
        sliding.directions.len() == self.rubbing.len()
    }

    /// Whether nothing sticks anywhere.
    pub(super) fn is_idle(&self) -> bool {
        self.rubbing.is_empty() && self.led.is_empty()
    }

    /// Whether the end of the step is a change between holding and sliding.
    pub(super) fn changes(&self) -> bool {
        self.breaks_away || !self.stopping.is_empty()
    }

    /// Forgets the changes at the end of a step.
    pub(super) fn forget_changes(&mut self) {
        self.stopping.clear();
        self.caught.clear();
        self.breaks_away = false;
    }

    /// Whether friction holds any joint.
    pub(super) fn holds_any(&self) -> bool {
        self.sliding.directions.contains(&0)
    }

    /// Whether friction holds velocity `k`.
    pub(super) fn holds(&self, k: usize) -> bool {
        self.limits[k] > 0.0 && self.rubbing().any(|(other, direction)| other == k && direction == 0)
    }

    /// The velocities at which friction sticks, with their directions of sliding; 0 where it holds.
    pub(super) fn rubbing(&self) -> impl Iterator<Item = (usize, i8)> + '_ {
        self.rubbing.iter().copied().zip(self.sliding.directions.iter().copied())
    }

    /// The joints that signals move against friction that sticks.
    pub(super) fn led(&self) -> &[usize] {
        &self.led
    }

    /// What friction can hold at velocity `k`, N·m or N.
    pub(super) fn limit(&self, k: usize) -> f64 {
        self.limits[k]
    }

    /// Velocities that forces drive and friction does not hold.
    pub(super) fn free(&self) -> Vec<usize> {
        self.driven.iter().copied().filter(|&k| !self.holds(k)).collect()
    }

    /// Adds what sliding asks of the actuators.
    pub(super) fn add_sliding(&self, tau: &mut [f64]) {
        for (k, direction) in self.rubbing() {
            tau[k] += f64::from(direction) * self.limits[k];
        }
    }

    /// The force at velocity `k` that moves a joint that holds, for sure.
    pub(super) fn breaking(&self, k: usize, size: f64) -> f64 {
        self.limits[k] + ROUNDINGS * slack(self.limits[k], size)
    }

    /// Decides which joints hold at the velocities `v`. `residual` (nv) is what the accelerations of prescribed joints alone leave
    /// over in the equations of motion without the friction that sticks, `sizes` (nv) how large its terms are, `mass` (nv × nv).
    ///
    /// # Errors
    /// A velocity that finds no friction.
    pub(super) fn decide(&mut self, v: &[f64], residual: &[f64], sizes: &[f64], mass: &[f64]) -> Result<(), usize> {
        let mut push: Vec<f64> = self.driven.iter().map(|&k| -residual[k]).collect();
        let Self { coulomb, limits, sliding, .. } = self;
        coulomb.candidates.clear();
        let mut at_rest = Vec::new();
        for (at, (place, &k)) in self.driven.iter().enumerate().filter(|(_, k)| limits[**k] > 0.0).enumerate() {
            let direction = if v[k] == 0.0 { 0 } else { v[k].signum() as i8 };
            sliding.directions[at] = direction;
            push[place] -= f64::from(direction) * limits[k];
            if direction == 0 {
                let slack = slack(limits[k], sizes[k]);
                coulomb.candidates.push(Candidate { place, limit: limits[k], slack, offset: 0.0 });
                at_rest.push((at, k));
            }
        }
        let Some(&(_, first)) = at_rest.first() else { return Ok(()) };
        let mut solve = Solve::default();
        if !solve.factor_part(mass, limits.len(), &self.driven) {
            return Err(first);
        }
        solve.solve(&mut push);
        let outcome = coulomb.solve(&mut solve, &mut push);
        for (&(at, k), &direction) in at_rest.iter().zip(&coulomb.directions) {
            sliding.directions[at] = if self.caught.contains(&k) { 0 } else { direction };
        }
        self.caught.clear();
        outcome.map_err(|c| at_rest[c].1)
    }

    /// Counts a change at `t`; the count where there are too many of them within `span`, s.
    pub(super) fn count_change(&mut self, t: f64, span: f64) -> Option<u32> {
        let Sliding { changes, since, .. } = &mut self.sliding;
        if t - *since > span {
            (*changes, *since) = (0, t);
        }
        *changes += 1;
        (*changes > MOST_CHANGES).then_some(*changes)
    }
}

/// Rounding of a force that friction holds; `size` is that of its terms.
fn slack(limit: f64, size: f64) -> f64 {
    1e-13 * limit + 16.0 * f64::EPSILON * size
}

#[cfg(test)]
mod tests {
    use super::{Friction, MOST_CHANGES};
    use crate::actuation::{Drive, Forward};
    use crate::model::{BodySpec, FrictionLaw, JointSpec, ModelBuilder, Parent};
    use crate::signal::Signal;

    /// A slider of 4 kg with 2 N of friction.
    fn slider() -> Friction {
        let mut builder = ModelBuilder::new([0.0; 3]);
        let joint = JointSpec {
            friction: [2.0; 3],
            friction_law: [FrictionLaw::Sticking; 3],
            ..JointSpec::prismatic("q", [1.0, 0.0, 0.0], [0.0; 3])
        };
        let (name, parent) = ("b".to_owned(), Parent::World);
        builder.push(BodySpec { name, parent, joint, mass: 4.0, com: [0.0; 3], inertia: [[0.0; 3]; 3] }).unwrap();
        let drives = vec![Drive::Force(vec![Signal::constant(0.0)])];
        Friction::new(&builder.finish().unwrap(), &Forward { q: vec![0.0], v: vec![0.0], drives })
    }

    #[test]
    fn changes_that_do_not_get_on_are_counted() {
        let mut friction = slider();
        assert!(!friction.is_idle() && friction.holds(0) && friction.free().is_empty());
        // Apart they may be as many as there are; together they are too many.
        for k in 0..3 * MOST_CHANGES {
            assert_eq!(friction.count_change(f64::from(k), 0.5), None);
        }
        let counts: Vec<_> =
            (0..MOST_CHANGES).map(|_| friction.count_change(f64::from(3 * MOST_CHANGES), 0.5)).collect();
        assert!(counts.iter().all(Option::is_none));
        assert_eq!(friction.count_change(f64::from(3 * MOST_CHANGES), 0.5), Some(MOST_CHANGES + 1));
    }

    #[test]
    fn a_push_above_the_limit_moves() {
        let mut friction = slider();
        for (v, push, direction) in [(0.0, 1.9, 0), (0.0, 2.1, 1), (0.0, -2.1, -1), (0.3, -5.0, 1), (-1e-9, 5.0, -1)] {
            friction.decide(&[v], &[-push], &[1.0], &[4.0]).unwrap();
            assert_eq!(friction.rubbing().collect::<Vec<_>>(), [(0, direction)], "{v} {push}");
        }
        // What breaks it away is more than what decides that it does.
        assert!(friction.breaking(0, 1.0) > 2.0 && friction.breaking(0, 1.0) < 2.0 + 1e-10);
        assert_eq!(friction.decide(&[0.0], &[-f64::NAN], &[1.0], &[4.0]), Err(0));
    }
}
