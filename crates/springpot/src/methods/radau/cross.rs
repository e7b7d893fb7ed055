//! A step evaluated for its energies, and the far side of breaks and kinks.

use super::dense::Dense;
use super::method::Radau;
use super::start;
use super::step::{Origin, Stage};
use crate::account::recorder::Recorder;
use crate::collocation::{RADAU_NODES, STAGES};
use crate::equations::context::Context;
use crate::equations::control::Eye;
use crate::equations::drives::drive;
use crate::law::Point;
use crate::methods::stepper::Target;
use crate::system::error::RunError;

impl Radau {
    /// Works out the energies of the step that was just solved.
    pub(super) fn evaluate_step(
        &mut self,
        cx: Context,
        recorder: &mut Recorder,
        target: &Target,
    ) -> Result<(), RunError> {
        self.step.fit();
        // Actuators of joints that signals move follow from all forces, and so does friction that holds.
        let is_whole = self.has_paths || self.step.stick.rubbing().next().is_some();
        let (t, h) = (target.from, target.size);
        recorder.is_whole[1] = is_whole;
        self.write_rates(cx, recorder);
        for (k, c) in RADAU_NODES.into_iter().enumerate() {
            let is_end = k + 1 == STAGES;
            let at = if is_end { target.to } else { t + c * h };
            let (evaluation, bank) = (&mut recorder.evaluations[k + 1], &recorder.bank);
            if is_whole || is_end {
                Dense { cx, step: &self.step, bank, h, scratch: &mut self.scratch }.place(at, c, evaluation);
            } else {
                drive(cx, &self.step.forward, at, evaluation);
            }
            let stage = &self.step.stages[k];
            evaluation.q.copy_from_slice(&stage.q);
            evaluation.v.copy_from_slice(&stage.v);
            if is_whole {
                let inputs_at = if is_end { target.end_inputs() } else { at };
                cx.fill(at, inputs_at, None, &mut recorder.scratch, evaluation)?;
                if let Some(control) = &recorder.control {
                    control.add_torques(cx, k + 1, evaluation);
                    for (e, element) in evaluation.elements.iter_mut().enumerate() {
                        element.inputs.copy_from_slice(bank.point(e, k + 1).inputs);
                    }
                }
                continue;
            }
            let elements = self.step.elements.iter().enumerate();
            let elements = elements.map(|(e, element)| (&element.readings[k + 1], bank.point(e, k + 1).inputs));
            cx.fill_energies(at, &stage.kinematics, elements, evaluation);
            if let Some(control) = &recorder.control {
                control.add_torques(cx, k + 1, evaluation);
            }
        }
        for e in 0..cx.system.elements.len() {
            recorder.bank.account(e);
        }
        self.take_powers(recorder);
        Ok(())
    }

    /// Tells the bank how fast inputs change that follow from the state, which the ledger asks for.
    fn write_rates(&self, cx: Context, recorder: &mut Recorder) {
        let Some(control) = recorder.control.as_ref().filter(|control| control.has_inputs()) else { return };
        let (system, step) = (cx.system, &self.step);
        for node in 0..=STAGES {
            let read = |e: usize| {
                let reading = &step.elements[e].readings[node];
                [reading.coordinate, reading.rate]
            };
            let t = control.time(node);
            if node == 0 {
                let Origin { q, v, a, .. } = &step.origin;
                let eye = Eye { system, t, q, v, kinematics: &step.start, element: &read };
                control.write_rates(node, &eye, a, &mut recorder.bank);
            } else {
                let Stage { q, v, a, kinematics, .. } = &step.stages[node - 1];
                let eye = Eye { system, t, q, v, kinematics, element: &read };
                control.write_rates(node, &eye, a, &mut recorder.bank);
            }
        }
    }

    /// Power of the actuators and losses of the joints at the start of the step and at its nodes.
    fn take_powers(&self, recorder: &mut Recorder) {
        let bank = &recorder.bank;
        for (k, evaluation) in recorder.evaluations.iter().enumerate() {
            let mut power = 0.0;
            for (j, v) in evaluation.v.iter().enumerate().filter(|(_, v)| **v != 0.0) {
                let computed = || {
                    let pull = evaluation.elements.iter().zip(&self.step.origin.forces).enumerate();
                    let pull = pull.map(|(e, (element, start))| {
                        let force = if k == 0 { *start } else { bank.response(e).force[k - 1] };
                        force * element.gradient[j]
                    });
                    evaluation.rigid[j] + pull.sum::<f64>()
                };
                power += evaluation.driven[j].unwrap_or_else(computed) * v;
            }
            recorder.powers.actuators[k] = power;
            recorder.powers.joints[k] = evaluation.joint_loss;
        }
    }

    /// Goes to the far side of a break or kink of the signals, where accelerations and prescribed velocities may jump.
    pub(super) fn restart_at(&mut self, cx: Context, recorder: &mut Recorder, to: f64) -> Result<(), RunError> {
        let (step, bank) = (&mut self.step, &recorder.bank);
        let forward = step.forward.clone();
        step.origin.t = to;
        step.restart();
        self.last = None;
        start::take_jumps(cx, &forward, &mut step.origin)?;
        let force = |e: usize, point: &Point| bank.now(e, point).map_or(0.0, |now| now.finite_force());
        let mut control = recorder.control.as_deref_mut();
        start::decide(cx, &forward, &mut step.stick, &mut step.origin, control.as_deref_mut(), |e, point, _| {
            Ok(force(e, point))
        })?;
        step.free = step.stick.free();
        start::accelerate(cx, &forward, &step.stick, &mut step.origin, control.as_deref_mut(), |e, point, _| {
            Ok(force(e, point))
        })?;
        let mut right = recorder.evaluations[0].clone();
        right.a.copy_from_slice(&step.origin.a);
        if step.is_singular {
            let regular = |e: usize, point: &Point| bank.now(e, point).map_or(0.0, |now| now.regular);
            start::accelerate(cx, &forward, &step.stick, &mut step.origin, control, |e, point, _| {
                Ok(regular(e, point))
            })?;
        }
        right.q.copy_from_slice(&step.origin.q);
        right.v.copy_from_slice(&step.origin.v);
        drive(cx, &forward, to, &mut right);
        cx.fill(to, to, None, &mut recorder.scratch, &mut right)?;
        recorder.control(cx, None, &mut right)?;
        recorder.jump(cx, right)?;
        self.expect(cx, recorder)
    }
}
