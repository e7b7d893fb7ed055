//! Control at one time, for rows and for the ledger.

use super::eye::Eye;
use super::{ControlRun, LawRun, Target, at, input};
use crate::control::Feedback;
use crate::dynamics::Kinematics;
use crate::elements::ElementBank;
use crate::equations::context::Context;
use crate::law::Point;
use crate::observe::evaluation::Evaluation;
use crate::signal::Jet;
use crate::system::error::RunError;
use crate::system::{Motion, System};
use serde::{Deserialize, Serialize};

/// An expression whose value at a row is not what its step used.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Misread {
    /// Its number.
    pub(crate) law: usize,
    pub(crate) is: f64,
    pub(crate) used: f64,
}

impl ControlRun {
    /// Completes an evaluation whose places, readings and other inputs are there, whatever its actuator forces are: at θ of the step at hand, or between
    /// two steps.
    ///
    /// # Errors
    /// Where an input breaks a rule of its law, or the reference cannot be followed.
    pub(crate) fn fill(
        &mut self,
        cx: Context,
        theta: Option<f64>,
        bank: &ElementBank,
        evaluation: &mut Evaluation,
    ) -> Result<(), RunError> {
        let system = cx.system;
        if let Some(controlled) = self.control.controller.clone() {
            let (site, spare) = (system.gripper.as_ref(), &mut self.scratch.kinematics);
            controlled.reference.at_into(&system.model, site, evaluation.t, spare, &mut self.row.aim)?;
            if site.is_some() {
                let off = evaluation.gripper.iter().zip(self.row.aim.gripper[0]);
                let square: f64 = off.map(|(is, wanted)| (is - wanted).powi(2)).sum();
                evaluation.gripper_error = Some(square.sqrt());
            }
        }
        if !self.acts_continuously() {
            return Ok(());
        }
        let mut kinematics = std::mem::replace(&mut self.row.kinematics, Kinematics::new(&system.model));
        kinematics.update_velocity(&system.model, &evaluation.q, &evaluation.v);
        let filled = self.fill_inputs(cx, &kinematics, evaluation);
        self.fill_torques(cx, theta, &kinematics, bank, evaluation);
        self.row.kinematics = kinematics;
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
        law.jet_on(branch, evaluation.t, &seen(law, cx, kinematics, evaluation))
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
            let at = at(&eye, &self.row.aim, &controlled.shaping);
            controlled.torque(&at, &mut self.scratch, &mut law);
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
                let [error, derived] = [at.error(joint.velocity), at.taken(joint.velocity)];
                let wanted = law[joint.velocity]
                    + own
                        .map(|term| (term, if term.is_integral() { error } else { derived }))
                        .map(|(term, error)| match theta {
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

    /// The first expression that the step took on the wrong side of a kink, as its own value at a row inside the step tells: what it gives there, and what
    /// the step used. What a kink is behind by rounding is none, nor what is nothing beside the largest value so far.
    pub(crate) fn misread(&mut self, cx: Context, allowed: f64, at: &Evaluation) -> Option<Misread> {
        if self.laws.iter().all(|law| !law.law.has_kinks()) {
            return None;
        }
        let mut kinematics = std::mem::replace(&mut self.row.kinematics, Kinematics::new(&cx.system.model));
        kinematics.update_velocity(&cx.system.model, &at.q, &at.v);
        let found = self.find_misread(cx, &kinematics, allowed, at);
        self.row.kinematics = kinematics;
        found
    }

    fn find_misread(&self, cx: Context, kinematics: &Kinematics, allowed: f64, at: &Evaluation) -> Option<Misread> {
        for (k, LawRun { law, target, branch, largest, .. }) in self.laws.iter().enumerate() {
            let is_held = match *target {
                Target::Torque(k) => cx.holds_force(k),
                Target::Input(e, i) => cx.holds_input(e, i),
            };
            if is_held || !law.has_kinks() {
                continue;
            }
            let jets = seen(law, cx, kinematics, at);
            let is_on = law.expression().branch(at.t, &jets);
            let wrong = is_on ^ branch;
            if wrong == 0 {
                continue;
            }
            let [is, used] = [is_on, *branch].map(|branch| law.jet_on(branch, at.t, &jets).value);
            let departs = (is - used).abs() > allowed * largest.max(is.abs()).max(used.abs());
            if departs && self.is_left(k, wrong, at.t, &jets) {
                return Some(Misread { law: k, is, used });
            }
        }
        None
    }

    /// Whether a kink of these bits was left before the row, by more than a small share of what its argument goes over in the step.
    fn is_left(&self, law: usize, bits: u64, t: f64, jets: &[Jet]) -> bool {
        const SHARE: f64 = 1e-3;
        let own = &self.laws[law];
        let (expression, branch) = (own.law.expression(), own.branch);
        let at_row: Vec<f64> = jets.iter().map(|jet| jet.value).collect();
        let mut left = Vec::new();
        expression.guards(branch, t, &at_row, &mut |bit, value| {
            if bits >> bit & 1 == 1 && value < 0.0 {
                left.push((bit, value, 0.0));
            }
        });
        for node in &self.nodes {
            expression.guards(branch, node.t, self.seen_by(law, node), &mut |bit, value| {
                for (_, at_row, moved) in left.iter_mut().filter(|(own, ..)| *own == bit) {
                    *moved = f64::max(*moved, (value - *at_row).abs());
                }
            });
        }
        left.into_iter().any(|(_, value, moved)| -value > SHARE * moved)
    }

    /// The text of an expression, and the column of what it says.
    pub(crate) fn words(&self, law: usize, system: &System) -> (String, String) {
        let LawRun { law, target, .. } = &self.laws[law];
        (law.expression().to_string(), target.column(system))
    }

    /// Tells an evaluation the forces at a node of the step (or its start).
    pub(crate) fn add_torques(&self, cx: Context, node: usize, evaluation: &mut Evaluation) {
        add(cx, &self.nodes[node].torque, evaluation);
    }

    /// Writes the rates of the inputs at a point of the bank, under the accelerations there.
    pub(crate) fn write_rates(&self, point: usize, eye: &Eye, a: &[f64], bank: &mut ElementBank) {
        for law in &self.laws {
            let Target::Input(e, i) = law.target else { continue };
            let jets: Vec<Jet> = law.law.senses().iter().map(|sense| eye.jet(*sense, a)).collect();
            bank.inputs_mut(e, point)[i].rate = law.law.jet_on(law.branch, eye.t, &jets).first;
        }
    }

    /// Whether an input follows from the state at every time.
    pub(crate) fn has_inputs(&self) -> bool {
        self.laws.iter().any(|law| matches!(law.target, Target::Input(..)))
    }
}

/// What an expression sees at the time of an evaluation, with time derivatives.
fn seen(law: &Feedback, cx: Context, kinematics: &Kinematics, evaluation: &Evaluation) -> Vec<Jet> {
    let read = |e: usize| {
        let reading = &evaluation.elements[e].reading;
        [reading.coordinate, reading.rate]
    };
    let (t, q, v) = (evaluation.t, &evaluation.q[..], &evaluation.v[..]);
    let eye = Eye { system: cx.system, t, q, v, kinematics, element: &read };
    law.senses().iter().map(|sense| eye.jet(*sense, &evaluation.a)).collect()
}

/// What signals and `torque` (nv) say together, in the place of what drives the joints; where that is not known, it stays so.
fn add(cx: Context, torque: &[f64], evaluation: &mut Evaluation) {
    let Motion::Forward(forward) = &cx.system.motion else { return };
    for (k, signal) in forward.forces(&cx.system.model) {
        if let Some(driven) = &mut evaluation.driven[k] {
            *driven = cx.force(k, signal, evaluation.t) + if cx.holds_force(k) { 0.0 } else { torque[k] };
        }
    }
}
