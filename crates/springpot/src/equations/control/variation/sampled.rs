//! What parameters change of samples.

use super::super::eye::{Eye, Shown};
use super::super::mode::Mode;
use super::super::{ControlRun, Target};
use super::see::add_sense;
use super::{ControlVariation, Place, ROW};
use crate::control::Sense;

use crate::signal::Jet;
use serde::{Deserialize, Serialize};

/// What changes of what sampled laws said last.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Held {
    /// Of the torques, a block for each velocity of the run, or nothing.
    pub(in crate::equations::control) torques: Vec<f64>,
    /// Of inputs: which, and a block.
    pub(in crate::equations::control) inputs: Vec<(usize, usize, Vec<f64>)>,
}

/// On which side of its limits a force of a sampled controller is: of its rate, and of itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Sides {
    pub(in crate::equations::control) rate: i8,
    pub(in crate::equations::control) force: i8,
}

/// Who tells what parameters change of samples.
pub(crate) trait OfSamples {
    /// Number of parameters.
    fn count(&self) -> usize;

    /// From now on what sampled laws said changes so.
    fn hold(&mut self, held: Option<&Held>);

    /// What changes of what the sampled expression for `target` says of the row that was read.
    fn say(&self, target: Target, shown: &dyn Shown) -> Vec<f64>;

    /// The same of a sampled controller, ahead of its last limit and behind it.
    fn say_of_controller(
        &mut self,
        run: &ControlRun,
        told: (&[Sides], &[f64], f64),
        shown: &dyn Shown,
    ) -> [Vec<f64>; 2];
}

impl ControlVariation {
    /// From now on what sampled laws said changes so.
    pub(crate) fn hold(&mut self, held: &Held) {
        self.held.clone_from(held);
    }

    /// What changes of the inputs that sampled laws said last: element, input and a block.
    pub(crate) fn held_inputs(&self) -> impl Iterator<Item = (usize, usize, &[f64])> {
        self.held.inputs.iter().map(|(e, input, by)| (*e, *input, &by[..]))
    }

    /// What changes of what the sampled expression for a target of the run says of the row that was seen, where elements pull with forces that change
    /// by `forces`, and the motion changes by these blocks of q, v and a.
    pub(crate) fn say(
        &self,
        target: Target,
        at: Place,
        forces: &dyn Fn(usize) -> (f64, Vec<f64>),
        [dq, dv, da]: [&[f64]; 3],
    ) -> Vec<f64> {
        let count = self.count();
        let target = target.of_robot(&self.own_v);
        let Some(law) = self.sampled.iter().find(|law| law.target == target) else { return vec![0.0; count] };
        let [q, v, a] = at.motion;
        let read = |e: usize| at.readings[e];
        let eye = Eye { system: &self.system, t: at.t, q, v, kinematics: at.kinematics, element: &read };
        let seen: Vec<f64> = law
            .senses
            .iter()
            .map(|sense| match *sense {
                Sense::Acceleration(k) => a[k],
                Sense::Force(e) => forces(e).0,
                sense => eye.value(sense),
            })
            .collect();
        let jets: Vec<Jet> = seen.iter().map(|value| Jet::constant(*value)).collect();
        let branch = law.law.expression().branch(at.t, &jets);
        let (mut slopes, mut said) = (Vec::new(), vec![0.0; count]);
        law.law.slopes_on(branch, at.t, &seen, &mut slopes);
        let mut by_state = [vec![0.0; v.len()], vec![0.0; v.len()]];
        let mut by_forces = vec![0.0; v.len()];
        for (sense, slope) in law.senses.iter().zip(&slopes).filter(|(_, slope)| **slope != 0.0) {
            match *sense {
                Sense::Acceleration(k) => by_forces[k] += slope,
                Sense::Force(e) => said.iter_mut().zip(forces(e).1).for_each(|(sum, own)| *sum += slope * own),
                sense => add_sense(&eye, sense, *slope, at, (&mut by_state, &mut said)),
            }
        }
        let [by_q, by_v] = &by_state;
        for (p, said) in said.iter_mut().enumerate() {
            for (slopes, blocks) in [(by_q, dq), (by_v, dv), (&by_forces, da)] {
                *said += slopes.iter().enumerate().map(|(k, slope)| slope * blocks[k * count + p]).sum::<f64>();
            }
            *said += law.own[p].iter().map(|slope| slope.value_on(branch, at.t, &seen)).sum::<f64>();
        }
        said
    }

    /// The same of a sampled controller, whose forces are on these sides of their limits, by velocity of the run; `before` is what changed of what it
    /// said before, ahead of its last limit, and `pull` what changes of Σ F·∂y/∂q of a velocity of the extended robot. Gives what changes ahead of
    /// the last limit and behind it.
    pub(crate) fn say_of_controller(
        &mut self,
        run: &ControlRun,
        (sides, before, period): (&[Sides], &[f64], f64),
        pull: &dyn Fn(usize, usize) -> f64,
        motion: [&[f64]; 2],
        t: f64,
    ) -> [Vec<f64>; 2] {
        let count = self.count();
        self.push_at(ROW, None, (run, true), motion);
        let mut said = [vec![0.0; sides.len() * count], vec![0.0; sides.len() * count]];
        for (joint, own) in self.joints.iter().enumerate() {
            let Sides { rate, force } = sides[own.velocity];
            let wanted = self.shaped(ROW, joint, Mode::default(), t, motion);
            for (p, wanted) in wanted.into_iter().enumerate() {
                let place = own.velocity * count + p;
                let shaped = match rate {
                    0 => wanted + if run.compensates { pull(own.row, p) } else { 0.0 },
                    sign => before[place] + f64::from(sign) * period * own.rate_limit[p],
                };
                let behind = if force == 0 { shaped } else { f64::from(force) * own.limit[p] };
                (said[0][place], said[1][place]) = (shaped, behind);
            }
        }
        said
    }
}
