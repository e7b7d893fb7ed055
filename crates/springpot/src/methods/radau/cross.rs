//! A step evaluated for its energies, and the far side of breaks and kinks.

use super::dense::Dense;
use super::method::Radau;
use crate::account::recorder::Recorder;
use crate::collocation::{RADAU_NODES, STAGES};
use crate::equations::Within;
use crate::equations::context::Context;
use crate::equations::drives::drive;
use crate::equations::resistance::joint_loss;
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
        let Recorder { evaluations, equations, scratch, .. } = recorder;
        // Actuators of joints that signals move follow from all forces, and so does friction that holds.
        let is_whole = self.has_paths || equations.rubs();
        let (t, h) = (target.from, target.size);
        let [a, b, c] = self.step.stages.each_ref().map(|stage| stage.node(t));
        equations.write_rates(
            cx,
            [self.step.origin.node(), a, b, c],
            self.step.stages.each_ref().map(|stage| &stage.kinematics),
        );
        for (k, c) in RADAU_NODES.into_iter().enumerate() {
            let is_end = k + 1 == STAGES;
            let at = if is_end { target.to } else { t + c * h };
            let (evaluation, stage) = (&mut evaluations[k + 1], &self.step.stages[k]);
            if is_whole || is_end {
                Dense { step: &self.step, h, scratch: &mut self.scratch }.place(cx, equations, at, c, evaluation);
            } else {
                drive(cx, equations.forward(), at, evaluation);
            }
            evaluation.q.copy_from_slice(&stage.q);
            evaluation.v.copy_from_slice(&stage.v);
            if is_whole {
                let inputs_at = if is_end { target.end_inputs() } else { at };
                cx.fill(at, inputs_at, None, scratch, evaluation)?;
                equations.complete_node(cx, k + 1, evaluation);
                continue;
            }
            if is_end {
                cx.fill_energies(at, &stage.kinematics, equations.read(k + 1), evaluation);
            } else {
                evaluation.t = at;
                evaluation.joint_loss = joint_loss(cx.system, &evaluation.v);
            }
            equations.add_torques(cx, k + 1, evaluation);
        }
        for e in 0..cx.system.elements.len() {
            equations.bank.account(e);
        }
        recorder.is_whole[1] = is_whole;
        recorder.take_powers(|equations, e, node| equations.force(e, node));
        Ok(())
    }

    /// Goes to the far side of a break or kink of the signals, where accelerations and prescribed velocities may jump.
    pub(super) fn restart_at(&mut self, cx: Context, recorder: &mut Recorder, to: f64) -> Result<(), RunError> {
        let (step, equations) = (&mut self.step, &mut recorder.equations);
        step.origin.t = to;
        step.restart();
        self.last = None;
        let mut right = recorder.evaluations[0].clone();
        right.a = equations.cross(cx, &mut step.origin)?;
        right.q.copy_from_slice(&step.origin.q);
        right.v.copy_from_slice(&step.origin.v);
        drive(cx, equations.forward(), to, &mut right);
        cx.fill(to, to, None, &mut recorder.scratch, &mut right)?;
        equations.complete(cx, None, &mut right)?;
        recorder.jump(cx, right)?;
        self.expect(cx, recorder)
    }
}
