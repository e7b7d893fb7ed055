//! Control at one time, for rows and for the ledger.

use super::eye::Eye;
use super::{ControlRun, Target, at, input};
use crate::actuation::Drive;
use crate::control::Feedback;
use crate::dynamics::Kinematics;
use crate::elements::ElementBank;
use crate::integrate::context::Context;
use crate::integrate::error::RunError;
use crate::integrate::system::Motion;
use crate::law::Point;
use crate::observe::evaluation::Evaluation;
use crate::signal::Jet;

impl ControlRun {
    /// Completes an evaluation whose places, readings and other inputs are there, whatever its actuator forces are: at θ of the step at hand, or between
    /// two steps.
    ///
    /// # Errors
    /// Where an input breaks a rule of its law, or the reference cannot be followed.
    pub(in crate::integrate) fn fill(
        &mut self,
        cx: Context,
        theta: Option<f64>,
        bank: &ElementBank,
        evaluation: &mut Evaluation,
    ) -> Result<(), RunError> {
        let system = cx.system;
        if let Some(controlled) = self.control.controller.clone() {
            let (site, spare) = (system.gripper.as_ref(), &mut self.scratch.kinematics);
            controlled.reference.at_into(&system.model, site, evaluation.t, spare, &mut self.row_aim)?;
            if site.is_some() {
                let off = evaluation.gripper.iter().zip(self.row_aim.gripper[0]);
                let square: f64 = off.map(|(is, wanted)| (is - wanted).powi(2)).sum();
                evaluation.gripper_error = Some(square.sqrt());
            }
        }
        if !self.acts_continuously() {
            return Ok(());
        }
        let mut kinematics = std::mem::replace(&mut self.row_kinematics, Kinematics::new(&system.model));
        kinematics.update_velocity(&system.model, &evaluation.q, &evaluation.v);
        let filled = self.fill_inputs(cx, &kinematics, evaluation);
        self.fill_torques(cx, theta, &kinematics, bank, evaluation);
        self.row_kinematics = kinematics;
        filled
    }

    fn fill_inputs(&self, cx: Context, kinematics: &Kinematics, evaluation: &mut Evaluation) -> Result<(), RunError> {
        for law in &self.laws {
            let Target::Input(e, i) = law.target else { continue };
            if cx.holds_input(e, i) {
                continue;
            }
            let jet = self.jet(&law.law, law.branch, cx, kinematics, evaluation);
            evaluation.elements[e].inputs[i] = input(jet.value, jet.first);
            cx.system.elements[e].check_inputs(evaluation.t, &evaluation.elements[e].inputs)?;
        }
        Ok(())
    }

    fn jet(&self, law: &Feedback, branch: u64, cx: Context, kinematics: &Kinematics, evaluation: &Evaluation) -> Jet {
        let read = |e: usize| {
            let reading = &evaluation.elements[e].reading;
            [reading.coordinate, reading.rate]
        };
        let (t, q, v) = (evaluation.t, &evaluation.q[..], &evaluation.v[..]);
        let eye = Eye { system: cx.system, t, q, v, kinematics, element: &read };
        let jets: Vec<Jet> = law.senses().iter().map(|sense| eye.jet(*sense, &evaluation.a)).collect();
        law.jet_on(branch, t, &jets)
    }

    fn fill_torques(
        &mut self,
        cx: Context,
        theta: Option<f64>,
        kinematics: &Kinematics,
        bank: &ElementBank,
        evaluation: &mut Evaluation,
    ) {
        let mut torque = std::mem::take(&mut self.spare);
        torque.clear();
        torque.resize(cx.system.model.nv(), 0.0);
        for law in &self.laws {
            if let Target::Torque(k) = law.target {
                torque[k] += self.jet(&law.law, law.branch, cx, kinematics, evaluation).value;
            }
        }
        if self.is_continuous
            && let Some(controlled) = self.control.controller.clone()
        {
            let read = |e: usize| [evaluation.elements[e].reading.coordinate, evaluation.elements[e].reading.rate];
            let (t, q, v) = (evaluation.t, &evaluation.q[..], &evaluation.v[..]);
            let eye = Eye { system: cx.system, t, q, v, kinematics, element: &read };
            let mut law = vec![0.0; torque.len()];
            let at = at(&eye, &self.row_aim);
            controlled.law.torque(&at, &mut self.scratch, &mut law);
            if self.compensates {
                for (e, element) in evaluation.elements.iter().enumerate() {
                    let point: Point = element.point(t);
                    let seen = theta.map_or_else(|| bank.now(e, &point), |theta| bank.at(e, theta, &point));
                    let force = seen.map_or(0.0, |observation| observation.force());
                    law.iter_mut().zip(&element.gradient).for_each(|(sum, slope)| *sum += force * slope);
                }
            }
            for joint in &self.joints {
                let own = self.terms.iter().filter(|term| term.law.velocity == joint.velocity);
                let error = at.error(joint.velocity);
                let wanted = law[joint.velocity]
                    + own
                        .map(|term| match theta {
                            Some(theta) => term.at(theta, error, joint.mode.integrand),
                            None => term.now(error, joint.mode.integrand),
                        })
                        .sum::<f64>();
                torque[joint.velocity] += joint.mode.force(wanted, joint.limit, t);
            }
        }
        add(cx, &torque, evaluation);
        self.spare = torque;
    }

    /// Tells an evaluation the forces at a node of the step (or its start).
    pub(in crate::integrate) fn add_torques(&self, cx: Context, node: usize, evaluation: &mut Evaluation) {
        add(cx, &self.nodes[node].torque, evaluation);
    }

    /// Writes the inputs at a node with their rates, under the accelerations there, once the step is solved.
    pub(in crate::integrate) fn write_rates(&self, node: usize, eye: &Eye, a: &[f64], bank: &mut ElementBank) {
        for law in &self.laws {
            let Target::Input(e, i) = law.target else { continue };
            let jets: Vec<Jet> = law.law.senses().iter().map(|sense| eye.jet(*sense, a)).collect();
            bank.inputs_mut(e, node)[i].rate = law.law.jet_on(law.branch, eye.t, &jets).first;
        }
    }

    /// Whether an input follows from the state at every time.
    pub(in crate::integrate) fn has_inputs(&self) -> bool {
        self.laws.iter().any(|law| matches!(law.target, Target::Input(..)))
    }
}

/// What signals and `torque` (nv) say together, in the place of what drives the joints; where that is not known, it stays so.
fn add(cx: Context, torque: &[f64], evaluation: &mut Evaluation) {
    let Motion::Forward(forward) = &cx.system.motion else { return };
    for (j, drive) in cx.system.model.own_joints().zip(&forward.drives) {
        let Drive::Force(signals) = drive else { continue };
        for (k, signal) in cx.system.model.v_range(j).zip(signals) {
            if let Some(driven) = &mut evaluation.driven[k] {
                *driven = cx.force(k, signal, evaluation.t) + if cx.holds_force(k) { 0.0 } else { torque[k] };
            }
        }
    }
}
