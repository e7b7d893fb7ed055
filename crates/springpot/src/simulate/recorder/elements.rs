//! What a step works out for its elements.

use super::{ElementStep, Recorder};
use crate::element::Element;
use crate::fractional::Nodes;
use crate::fractional::step::MAX_NODES;
use crate::law::{State, Step};
use crate::simulate::RunError;
use crate::simulate::moment::ElementMoment;

/// A step this short, in units of end·rtol^{1/(1+alpha)}, is kept whatever is known of inner strokes.
const ONSET: f64 = 0.1;

impl Recorder<'_> {
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

    /// Asks the law for the step: its powers, its errors, its state at the end. `false` for an element with a named scheme.
    pub(in crate::simulate) fn evaluate_element(&mut self, e: usize, t: f64, h: f64) -> bool {
        let law = &self.system.elements[e].law;
        let Some(state) = &mut self.accounts[e].law else { return false };
        let mut errors = std::mem::take(&mut self.steps[e].errors);
        errors.clear();
        let step = self.steps[e].law_step(t, h);
        law.prepare(&step, state);
        let powers = law.powers(&step, state);
        let end = law.at(&step, 1.0, &step.point(MAX_NODES), state);
        law.local_errors(&step, state, &mut errors);
        let step = &mut self.steps[e];
        (step.powers, step.end, step.errors) = (powers, end, errors);
        true
    }

    /// Adds the regular power that the element takes from the actuators of a motion given in advance.
    pub(in crate::simulate) fn add_actuator_power(&mut self, e: usize, t: f64, h: f64) {
        let element = &self.system.elements[e];
        let account = &self.accounts[e];
        let Some(state) = account.law.as_ref() else { return };
        let step = self.steps[e].law_step(t, h);
        let response = element.law.evaluate(&step, state);
        for k in 0..=MAX_NODES {
            let at = step.point(k);
            let regular = match k {
                0 => element.law.now(&at, state).regular,
                _ => response.force[k - 1] - response.singular[k - 1],
            };
            self.powers.actuators[k] += regular * at.rate;
        }
    }

    /// The largest of the element's local errors in units of their tolerances, and its order.
    pub(in crate::simulate) fn memory_error(&self, e: usize) -> (f64, f64) {
        let settings = self.settings;
        let h = self.moments[MAX_NODES].t - self.moments[0].t;
        let mut worst = (0.0, 0.0);
        for (m, error) in self.steps[e].errors.iter().enumerate() {
            // Where an inner stroke begins like t^alpha, every step knows little of it; what that does fades like (h/t)^{1+alpha}.
            if error.sharpness != 1.0 && h <= ONSET * settings.end * settings.rtol.powf(1.0 / (1.0 + error.order)) {
                continue;
            }
            let scale = self.scale_with_step(e, m);
            let allowed = settings.atol.unwrap_or(0.0).max(settings.rtol * scale);
            let share = error.share(scale, allowed);
            // What is no number is no step to keep.
            if share > worst.0 || share.is_nan() {
                worst = (share, error.order);
            }
        }
        worst
    }

    /// The largest regular D^order x so far, this step included, of the element's local error `m`.
    pub(in crate::simulate) fn scale_with_step(&self, e: usize, m: usize) -> f64 {
        let before = self.accounts[e].scales.get(m).copied().unwrap_or(0.0);
        before.max(self.steps[e].errors[m].value.abs())
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
    /// The law's state at t = 0, ready for steps whose shortest lag is `delta`, up to `horizon`.
    pub(in crate::simulate) fn open(
        &self,
        at: &ElementMoment,
        tolerance: f64,
        delta: f64,
        horizon: f64,
    ) -> Result<State, RunError> {
        let begun = self.begin(at.length, &at.inputs).and_then(|mut state| {
            state.open(tolerance, delta, horizon)?;
            Ok(state)
        });
        begun.map_err(|source| RunError::Kernel { element: self.name.clone(), source })
    }
}
