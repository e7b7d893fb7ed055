//! What rows and the ledger are told of a step.

use super::assembly::Equations;
use super::context::Context;
use super::control::{Eye, Misread};
use super::evaluate::Evaluation;
use super::node::Node;
use crate::collocation::STAGES;
use crate::dynamics::Kinematics;
use crate::elements::Reading;
use crate::law::InputValue;
use crate::system::System;
use crate::system::error::RunError;

impl Equations {
    /// Writes the inputs of element `e` that follow from the state at the start.
    pub(crate) fn inputs_at_start(&self, cx: Context, e: usize, inputs: &mut [InputValue]) {
        if let Some(control) = &self.control {
            control.inputs_at_start(cx, e, inputs);
        }
    }

    /// Completes an evaluation by what follows from the state: at θ of the step at hand, or between two steps.
    ///
    /// # Errors
    /// Where an input breaks a rule of its law, or the reference cannot be followed.
    pub(crate) fn complete(
        &mut self,
        cx: Context,
        theta: Option<f64>,
        evaluation: &mut Evaluation,
    ) -> Result<(), RunError> {
        match &mut self.control {
            Some(control) => control.fill(cx, theta, &self.bank, evaluation),
            None => Ok(()),
        }
    }

    /// Adds the torques that follow from the state at the start (0) or at a node to those of an evaluation there.
    pub(crate) fn add_torques(&self, cx: Context, node: usize, evaluation: &mut Evaluation) {
        if let Some(control) = &self.control {
            control.add_torques(cx, node, evaluation);
        }
    }

    /// Tells an evaluation at a node what follows from the state there: forces of the actuators, inputs.
    pub(crate) fn complete_node(&self, cx: Context, node: usize, evaluation: &mut Evaluation) {
        if self.control.is_none() {
            return;
        }
        self.add_torques(cx, node, evaluation);
        for (e, element) in evaluation.elements.iter_mut().enumerate() {
            element.inputs.copy_from_slice(self.bank.point(e, node).inputs);
        }
    }

    /// Readings and inputs of the elements at the start (0) or at a node.
    pub(crate) fn read(&self, node: usize) -> impl Iterator<Item = (&Reading, &[InputValue])> {
        let elements = self.elements.iter().enumerate();
        elements.map(move |(e, nodes)| (&nodes.readings[node], self.bank.point(e, node).inputs))
    }

    /// Tells the bank how fast inputs change that follow from the state, which the ledger asks for; `at` are the start and the nodes, `kinematics`
    /// those of the nodes.
    pub(crate) fn write_rates(&mut self, cx: Context, at: [Node; STAGES + 1], kinematics: [&Kinematics; STAGES]) {
        let Some(control) = self.control.as_ref().filter(|control| control.has_inputs()) else { return };
        for (node, Node { q, v, a, .. }) in at.into_iter().enumerate() {
            let read = |e: usize| self.elements[e].read(node);
            let kinematics = if node == 0 { &self.tangent.kinematics } else { kinematics[node - 1] };
            let eye = Eye { system: cx.system, t: control.time(node), q, v, kinematics, element: &read };
            control.write_rates(node, &eye, a, &mut self.bank);
        }
    }

    /// The force of element `e` at the start (0), without the share of a singular start, or at a node, N or N·m.
    pub(crate) fn force(&self, e: usize, node: usize) -> f64 {
        if node == 0 { self.elements[e].force } else { self.bank.response(e).force[node - 1] }
    }

    /// The first expression that the step took on the wrong side of a kink, as its own value at a row inside the step tells.
    pub(crate) fn misread(&mut self, cx: Context, allowed: f64, at: &Evaluation) -> Option<Misread> {
        self.control.as_mut()?.misread(cx, allowed, at)
    }

    /// The text of a misread expression, and the column of what it says.
    pub(crate) fn words(&self, misread: &Misread, system: &System) -> (String, String) {
        self.control.as_ref().map(|control| control.words(misread.law, system)).unwrap_or_default()
    }
}
