//! One step tried: the laws' answers, and the errors that decide whether it is kept.

use super::{ElementStep, Run, StepPowers};
use crate::element::Element;
use crate::fractional::step::{MAX_NODES, RADAU_NODES};
use crate::fractional::{Form, Nodes};
use crate::law::{Point, Singular, State, Step};
use crate::simulate::RunError;
use crate::simulate::control::StepError;
use crate::simulate::ledger::work_defect;

/// A step this short, as a share of the motion, is kept whatever it does to the energy ledger: behind a kink of the rates the
/// powers rise like t^{1−alpha}, which no step resolves, and such a step turns over next to nothing.
const SHORTEST_LEDGER_STEP: f64 = 1e-11;

/// Share of rtol^⅔ that the energy ledger may err in one step, in units of the energy turned over.
const ENERGY_SHARE: f64 = 0.01;

impl Run<'_> {
    /// Evaluates the step from t to `to` without keeping it; an element that turns over on the way is asked for a shorter step.
    pub(super) fn attempt(&mut self, t: f64, to: f64, on_break: bool) -> Result<StepError, RunError> {
        let h = to - t;
        for (k, c) in RADAU_NODES.into_iter().enumerate() {
            let node = if c == 1.0 { to } else { t + c * h };
            let t_inputs = if c == 1.0 && on_break { to.next_down() } else { node };
            self.system.evaluate(node, t_inputs, &mut self.scratch, &mut self.moments[k + 1])?;
        }
        if let Some(element) = self.reversed(t, h)? {
            return Ok(StepError { memory: 1e3, alpha: 0.0, element: Some(element), energy: 0.0 });
        }
        self.powers = StepPowers::default();
        for (k, moment) in self.moments.iter().enumerate() {
            self.powers.actuators[k] = moment.rigid_power();
            self.powers.joints[k] = moment.joint_loss;
        }
        let mut error = StepError::NONE;
        for e in 0..self.system.elements.len() {
            self.fill_element_step(e);
            let Some(defect) = self.evaluate_element(e, t, h) else { continue };
            let alpha = self.system.elements[e].law.order();
            let scale = self.scale_with_step(e, to);
            let allowed = self.settings.atol.unwrap_or(0.0) + self.settings.rtol * scale;
            let share = if defect == 0.0 { 0.0 } else { defect / allowed };
            if share > error.memory {
                error = StepError { memory: share, alpha, element: Some(e), ..error };
            }
        }
        if h > SHORTEST_LEDGER_STEP * self.settings.end {
            error.energy = self.energy_error(h);
        }
        Ok(error)
    }

    /// An element whose direction turned by more than a right angle between two nodes: its points passed each other.
    fn reversed(&self, t: f64, h: f64) -> Result<Option<usize>, RunError> {
        for pair in self.moments.windows(2) {
            for (e, (a, b)) in pair[0].elements.iter().zip(&pair[1].elements).enumerate() {
                if a.direction.dot(b.direction) > 0.0 {
                    continue;
                }
                let element = &self.system.elements[e];
                let length = a.length.min(b.length);
                if h < 1e-9 * self.settings.end || length < 1e-9 * element.rest_length {
                    return Err(RunError::ZeroLength { t: t + 0.5 * h, element: element.name.clone(), length });
                }
                return Ok(Some(e));
            }
        }
        Ok(None)
    }

    fn fill_element_step(&mut self, e: usize) {
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

    /// Asks the law for the step: its powers, its state at the end, the regular power it takes from the actuators.
    /// Returns the embedded error; `None` for an element with a named scheme.
    fn evaluate_element(&mut self, e: usize, t: f64, h: f64) -> Option<f64> {
        let element = &self.system.elements[e];
        let account = &self.accounts[e];
        let state = account.law.as_ref()?;
        let step = self.steps[e].law_step(t, h);
        let response = element.law.respond(&step, state);
        let powers = element.law.powers(&step, state);
        let end = element.law.observe(&step, 1.0, &step.point(MAX_NODES), state);
        let defect = element.law.defect(&step, state);
        for k in 0..=MAX_NODES {
            let at = step.point(k);
            let force = if k == 0 { element.force_at_start(&at, account.derivative) } else { response.force[k - 1] };
            let singular = if at.t > 0.0 { singular_force(element, &at, state, at.t) } else { 0.0 };
            self.powers.actuators[k] += (force - singular) * at.rate;
        }
        self.steps[e].powers = powers;
        self.steps[e].end = end;
        Some(defect)
    }

    /// The largest regular D^alpha x so far, this step included.
    pub(super) fn scale_with_step(&self, e: usize, to: f64) -> f64 {
        let account = &self.accounts[e];
        let Some(state) = &account.law else { return 0.0 };
        let regular = self.steps[e].end.derivative - self.system.elements[e].law.singular(to, state);
        account.scale.max(regular.abs())
    }

    /// Estimate of what the step adds to the error of the energy ledger, in units of its tolerance.
    fn energy_error(&self, h: f64) -> f64 {
        let turned_over = self.energy_floor.max(self.turnover.total());
        if self.actuators_unknown() || turned_over == 0.0 {
            return 0.0;
        }
        let mut defect = work_defect(&self.powers.actuators, h) + work_defect(&self.powers.joints, h);
        for step in &self.steps {
            defect += work_defect(&step.powers.map(|p| p.dissipation), h);
            defect += work_defect(&step.powers.map(|p| p.input), h);
        }
        if defect.is_nan() { 0.0 } else { defect / (ENERGY_SHARE * self.settings.rtol.powf(2.0 / 3.0) * turned_over) }
    }
}

impl ElementStep {
    pub(super) fn law_step(&self, t: f64, h: f64) -> Step<'_> {
        Step {
            t,
            h,
            nodes: Nodes::Radau,
            form: Form::Rates,
            stroke: &self.stroke,
            rate: &self.rate,
            inputs: &self.inputs,
            resolution: self.resolution,
            singular: Singular::Value,
        }
    }
}

impl Element {
    /// F at the start of a step, where D^alpha x is what the step before ended with; at alpha = 1 it follows the rate.
    fn force_at_start(&self, at: &Point, derivative: f64) -> f64 {
        self.law.force(at, if self.law.order() == 1.0 { at.rate } else { derivative })
    }
}

/// The force of the singular share of D^alpha x, that share being taken at the time `when`.
pub(super) fn singular_force(element: &Element, at: &Point, state: &State, when: f64) -> f64 {
    let share = element.law.singular(when, state);
    if share == 0.0 { 0.0 } else { element.law.force(at, share) - element.law.force(at, 0.0) }
}
