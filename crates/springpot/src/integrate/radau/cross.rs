//! A step evaluated for its energies, and the far side of breaks and kinks.

use super::dense::Dense;
use super::drives::drive;
use super::method::Radau;
use super::start;
use crate::collocation::{RADAU_NODES, STAGES};
use crate::integrate::context::Context;
use crate::integrate::error::RunError;
use crate::integrate::recorder::Recorder;
use crate::integrate::stepper::Target;
use crate::law::Point;

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
                continue;
            }
            let elements = self.step.elements.iter().enumerate();
            let elements = elements.map(|(e, element)| (&element.readings[k + 1], bank.point(e, k + 1).inputs));
            cx.fill_energies(at, &stage.kinematics, elements, evaluation);
        }
        for e in 0..cx.system.elements.len() {
            recorder.bank.account(e);
        }
        self.take_powers(recorder);
        Ok(())
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
        start::decide(cx, &forward, &mut step.stick, &mut step.origin, |e, point, _| Ok(force(e, point)))?;
        step.free = step.stick.free();
        start::accelerate(cx, &forward, &step.stick, &mut step.origin, |e, point, _| Ok(force(e, point)))?;
        let mut right = recorder.evaluations[0].clone();
        right.a.copy_from_slice(&step.origin.a);
        if step.is_singular {
            let regular = |e: usize, point: &Point| bank.now(e, point).map_or(0.0, |now| now.regular);
            start::accelerate(cx, &forward, &step.stick, &mut step.origin, |e, point, _| Ok(regular(e, point)))?;
        }
        right.q.copy_from_slice(&step.origin.q);
        right.v.copy_from_slice(&step.origin.v);
        drive(cx, &forward, to, &mut right);
        cx.fill(to, to, None, &mut recorder.scratch, &mut right)?;
        recorder.jump(cx, right)?;
        self.expect(cx, recorder)
    }
}
