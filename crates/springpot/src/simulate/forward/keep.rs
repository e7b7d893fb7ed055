//! A step kept: its rows and energies; and the far side of breaks and kinks.

use super::dense::Dense;
use super::drives::drive;
use super::{Run, start};
use crate::fractional::step::{MAX_NODES, RADAU_NODES};
use crate::law::{Observation, Point};
use crate::simulate::moment::{Moment, Scratch};
use crate::simulate::{RunError, System};

impl Run<'_> {
    /// Works out the energies of the step that was just solved.
    pub(super) fn evaluate_step(&mut self, to: f64, h: f64, on_break: bool) -> Result<(), RunError> {
        self.stepper.fit();
        // Actuators of joints that signals move follow from all forces, and so does friction that holds.
        let is_whole = self.has_paths || self.stepper.stick.rubbing().next().is_some();
        let Self { recorder, stepper, starts, scratch, .. } = self;
        let (system, t) = (recorder.system, stepper.origin.t);
        let mut dense = Dense { stepper, h, starts, scratch };
        recorder.end_is_whole = is_whole;
        for k in 0..MAX_NODES {
            let is_end = k + 1 == MAX_NODES;
            let at = if is_end { to } else { t + RADAU_NODES[k] * h };
            let (moment, stage) = (&mut recorder.moments[k + 1], &stepper.stages[k]);
            if is_whole || is_end {
                dense.place(at, RADAU_NODES[k], moment);
            } else {
                drive(&system.model, stepper.forward, at, moment);
            }
            moment.q.copy_from_slice(&stage.q);
            moment.v.copy_from_slice(&stage.v);
            if is_whole {
                let t_inputs = if is_end && on_break { to.next_down() } else { at };
                system.fill(at, t_inputs, None, &mut recorder.scratch, moment)?;
                continue;
            }
            let elements = stepper.elements.iter().map(|element| {
                let count = element.inputs.len() / (MAX_NODES + 1);
                let pair = element.pairs[k + 1].expect("a stage that was placed");
                (pair, &element.inputs[(k + 1) * count..(k + 2) * count])
            });
            system.fill_energies(at, &stage.kinematics, elements, moment);
        }
        for (e, element) in stepper.elements.iter().enumerate() {
            recorder.steps[e].form = element.form;
            recorder.fill_element_step(e);
            recorder.evaluate_element(e, t, h);
        }
        self.take_powers();
        Ok(())
    }

    /// Accepts the step that was evaluated: writes its rows and takes it into the past.
    pub(super) fn keep(&mut self, to: f64, h: f64, on_break: bool) -> Result<(), RunError> {
        let Self { recorder, stepper, starts, scratch, .. } = self;
        let t = stepper.origin.t;
        let mut dense = Dense { stepper, h, starts, scratch };
        let mut place = |system: &System, scratch: &mut Scratch, at: f64, theta: f64, moment: &mut Moment| {
            dense.place(at, theta, moment);
            system.fill(at, at, None, scratch, moment)
        };
        recorder.emit_rows(t, to, on_break, &mut place)?;
        recorder.commit(h);
        recorder.report.steps += 1;
        stepper.accept(h, to);
        Ok(())
    }

    /// Power of the actuators and losses of the joints at the start of the step and at its nodes.
    fn take_powers(&mut self) {
        let Self { recorder, stepper, .. } = self;
        for (k, moment) in recorder.moments.iter().enumerate() {
            let mut power = 0.0;
            for (j, v) in moment.v.iter().enumerate().filter(|(_, v)| **v != 0.0) {
                let computed = || {
                    let forces = stepper.elements.iter().zip(&moment.elements).zip(&stepper.origin.forces);
                    let pull = forces.map(|((element, state), start)| {
                        let force = if k == 0 { *start } else { element.response.force[k - 1] };
                        force * state.gradient[j]
                    });
                    moment.rigid[j] + pull.sum::<f64>()
                };
                power += moment.driven[j].unwrap_or_else(computed) * v;
            }
            recorder.powers.actuators[k] = power;
            recorder.powers.joints[k] = moment.joint_loss;
        }
    }

    /// Goes to the far side of a break or kink of the signals, where accelerations and prescribed velocities may jump.
    pub(super) fn cross(&mut self, after: f64) -> Result<(), RunError> {
        self.restart_at(after)?;
        // A little further, since a sign is 0 while it turns.
        let start = self.recorder.system.past_turns(after);
        if start == after { Ok(()) } else { self.restart_at(start) }
    }

    fn restart_at(&mut self, to: f64) -> Result<(), RunError> {
        let Self { recorder, stepper, forward, .. } = self;
        let system = recorder.system;
        stepper.origin.t = to;
        stepper.restart();
        self.last = None;
        start::take_jumps(system, forward, &mut stepper.origin)?;
        let now = |e: usize, point: &Point| system.elements[e].law.now(point, recorder.accounts[e].memory());
        start::decide(system, forward, &mut stepper.stick, &mut stepper.origin, |e, point, _| {
            let Observation { regular, singular, .. } = now(e, point);
            Ok(regular + if singular.is_nan() { 0.0 } else { singular })
        })?;
        stepper.free = stepper.stick.free();
        start::accelerate(system, forward, &stepper.stick, &mut stepper.origin, |e, point, _| {
            Ok(now(e, point).regular)
        })?;
        let left = recorder.moments[0].clone();
        let mut right = left.clone();
        right.a.copy_from_slice(&stepper.origin.a);
        right.q.copy_from_slice(&stepper.origin.q);
        right.v.copy_from_slice(&stepper.origin.v);
        drive(&system.model, forward, to, &mut right);
        system.fill(to, to, None, &mut recorder.scratch, &mut right)?;
        recorder.jump([left, right]);
        recorder.emit_rows_between_steps(to)?;
        self.expect()
    }
}
