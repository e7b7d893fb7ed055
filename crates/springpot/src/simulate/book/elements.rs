//! What a step works out for its elements.

use super::{Book, ElementStep};
use crate::element::Element;
use crate::fractional::Nodes;
use crate::fractional::step::MAX_NODES;
use crate::law::{Point, State, Step};

impl Book<'_> {
    /// Takes the element's kinematics and inputs from the moments of the step.
    pub(in crate::simulate) fn fill_element_step(&mut self, e: usize) {
        let step = &mut self.steps[e];
        let inputs = self.system.elements[e].inputs.len();
        for (k, moment) in self.moments.iter().enumerate() {
            let state = &moment.elements[e];
            step.stroke[k] = state.stroke;
            step.rate[k] = state.rate;
            step.inputs[k * inputs..(k + 1) * inputs].copy_from_slice(&state.inputs);
        }
        step.resolution = self.system.elements[e].resolution(self.moments[0].elements[e].length);
    }

    /// Asks the law for the step: its powers, its state at the end. Returns the embedded error; `None` for an element with a
    /// named scheme.
    pub(in crate::simulate) fn evaluate_element(&mut self, e: usize, t: f64, h: f64) -> Option<f64> {
        let element = &self.system.elements[e];
        let account = &self.accounts[e];
        let state = account.law.as_ref()?;
        let step = self.steps[e].law_step(t, h);
        let powers = element.law.powers(&step, state);
        let end = element.law.observe(&step, 1.0, &step.point(MAX_NODES), state);
        let defect = element.law.defect(&step, state);
        self.steps[e].powers = powers;
        self.steps[e].end = end;
        Some(defect)
    }

    /// Adds the regular power that the element takes from the actuators of a motion given in advance.
    pub(in crate::simulate) fn add_actuator_power(&mut self, e: usize, t: f64, h: f64) {
        let element = &self.system.elements[e];
        let account = &self.accounts[e];
        let Some(state) = account.law.as_ref() else { return };
        let step = self.steps[e].law_step(t, h);
        let response = element.law.respond(&step, state);
        for k in 0..=MAX_NODES {
            let at = step.point(k);
            let force = if k == 0 { element.force_at_start(&at, account.derivative) } else { response.force[k - 1] };
            let singular = if at.t > 0.0 { singular_force(element, &at, state, at.t) } else { 0.0 };
            self.powers.actuators[k] += (force - singular) * at.rate;
        }
    }

    /// The largest regular D^alpha x so far, this step included.
    pub(in crate::simulate) fn scale_with_step(&self, e: usize, to: f64) -> f64 {
        let account = &self.accounts[e];
        let Some(state) = &account.law else { return 0.0 };
        let regular = self.steps[e].end.derivative - self.system.elements[e].law.singular(to, state);
        account.scale.max(regular.abs())
    }
}

impl ElementStep {
    pub(in crate::simulate) fn law_step(&self, t: f64, h: f64) -> Step<'_> {
        Step {
            t,
            h,
            nodes: Nodes::Radau,
            form: self.form,
            stroke: &self.stroke,
            rate: &self.rate,
            inputs: &self.inputs,
            resolution: self.resolution,
            singular: self.singular,
        }
    }
}

impl Element {
    /// F at the start of a step, where D^alpha x is what the step before ended with; at alpha = 1 it follows the rate.
    pub(in crate::simulate) fn force_at_start(&self, at: &Point, derivative: f64) -> f64 {
        self.law.force(at, if self.law.order() == 1.0 { at.rate } else { derivative })
    }
}

/// The force of the singular share of D^alpha x, that share being taken at the time `when`.
pub(in crate::simulate) fn singular_force(element: &Element, at: &Point, state: &State, when: f64) -> f64 {
    let share = element.law.singular(when, state);
    if share == 0.0 { 0.0 } else { element.law.force(at, share) - element.law.force(at, 0.0) }
}
