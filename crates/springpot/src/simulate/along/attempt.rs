//! One step tried: the laws' answers, and the errors that decide whether it is kept.

use super::Run;
use crate::fractional::step::RADAU_NODES;
use crate::simulate::RunError;
use crate::simulate::control::StepError;
use crate::simulate::recorder::StepPowers;

impl Run<'_> {
    /// Evaluates the step from t to `to` without keeping it; an element that turns over on the way is asked for a shorter step.
    pub(super) fn attempt(&mut self, t: f64, to: f64, on_break: bool) -> Result<StepError, RunError> {
        let h = to - t;
        for (k, c) in RADAU_NODES.into_iter().enumerate() {
            let node = if c == 1.0 { to } else { t + c * h };
            let t_inputs = if c == 1.0 && on_break { to.next_down() } else { node };
            self.recorder.system.evaluate(
                node,
                t_inputs,
                &mut self.recorder.scratch,
                &mut self.recorder.moments[k + 1],
            )?;
        }
        if let Some(element) = self.reversed(t, h)? {
            return Ok(StepError { memory: 1e3, alpha: 0.0, element: Some(element), energy: 0.0 });
        }
        self.recorder.powers = StepPowers::default();
        for (k, moment) in self.recorder.moments.iter().enumerate() {
            self.recorder.powers.actuators[k] = moment.rigid_power();
            self.recorder.powers.joints[k] = moment.joint_loss;
        }
        let mut error = StepError::NONE;
        for e in 0..self.recorder.system.elements.len() {
            self.recorder.fill_element_step(e);
            if !self.recorder.evaluate_element(e, t, h) {
                continue;
            }
            self.recorder.add_actuator_power(e, t, h);
            let (share, alpha) = self.recorder.memory_error(e);
            if share > error.memory {
                error = StepError { memory: share, alpha, element: Some(e), ..error };
            }
        }
        error.energy = self.recorder.energy_error(h, self.energy_floor);
        Ok(error)
    }

    /// An element whose direction turned by more than a right angle between two nodes: its points passed each other.
    fn reversed(&self, t: f64, h: f64) -> Result<Option<usize>, RunError> {
        for pair in self.recorder.moments.windows(2) {
            for (e, (a, b)) in pair[0].elements.iter().zip(&pair[1].elements).enumerate() {
                if a.direction.dot(b.direction) > 0.0 {
                    continue;
                }
                let element = &self.recorder.system.elements[e];
                let length = a.length.min(b.length);
                if h < 1e-9 * self.recorder.settings.end || length < 1e-9 * element.rest_length {
                    return Err(RunError::ZeroLength { t: t + 0.5 * h, element: element.name.clone(), length });
                }
                return Ok(Some(e));
            }
        }
        Ok(None)
    }
}
