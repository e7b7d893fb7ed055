//! The elements over one step of a fixed-step method.

use super::step::OneStage;
use crate::dynamics::{Kinematics, Pair, PairForce, pair_into};
use crate::elements::{Element, ElementBank};
use crate::integrate::RunError;
use crate::integrate::context::Context;
use crate::law::Response;
use crate::model::Model;

/// The points of one element over a step.
#[derive(Debug, Clone)]
pub(super) struct ElementStep {
    /// At the start and at the end.
    pub(super) ends: [Pair; 2],
    /// ∂l/∂q at the stage and at the end.
    pub(super) gradients: [Vec<f64>; 2],
}

impl ElementStep {
    /// At the start of a motion.
    ///
    /// # Errors
    /// [`RunError::ZeroLength`].
    pub(super) fn new(element: &Element, model: &Model, start: &Kinematics) -> Result<Self, RunError> {
        let mut gradient = vec![0.0; model.nv()];
        let pair = pair_into(model, start, &element.from, &element.to, &mut gradient);
        if pair.check().is_err() {
            return Err(RunError::ZeroLength { t: 0.0, element: element.name.clone(), length: pair.length });
        }
        Ok(Self { ends: [pair; 2], gradients: [gradient.clone(), gradient] })
    }
}

impl OneStage {
    /// Begins the step of the elements, whose stage is at the time `at`: what they know before it is found.
    pub(super) fn begin_elements(
        &mut self,
        cx: Context,
        bank: &mut ElementBank,
        h: f64,
        at: f64,
    ) -> Result<(), RunError> {
        let t = self.origin.t;
        bank.start(t, h);
        bank.set_nodes(self.method.nodes());
        for (e, (element, step)) in cx.system.elements.iter().zip(&self.elements).enumerate() {
            let [start, _] = step.ends;
            for (point, time) in [t, at].into_iter().enumerate() {
                bank.set_stroke(e, point, start.length - element.rest_length, start.rate);
                let values = bank.inputs_mut(e, point);
                cx.inputs_at(e, time, values);
                element.check_inputs(time, values)?;
            }
        }
        bank.prepare();
        Ok(())
    }

    /// Asks the elements.
    ///
    /// With the midpoint rule, which acts along ∂l/∂q at the stage, the law gets the mean of the strokes at both ends and the rate
    /// (x_1 − x_0)/h. The work of a spring is then the energy that it takes up, but for terms of order h³: with strokes and rates of the stage
    /// itself stiff elements make energy.
    pub(super) fn respond(&mut self, cx: Context, bank: &mut ElementBank, h: f64) -> Result<(), RunError> {
        let ends_at_stage = self.method.node() == 1.0;
        self.pairs.clear();
        for (e, element) in cx.system.elements.iter().enumerate() {
            let step = &mut self.elements[e];
            let [at_stage, at_end] = &mut step.gradients;
            let (stage, end) = (&self.stage.kinematics, &self.end.kinematics);
            let pair = pair_into(&self.model, stage, &element.from, &element.to, at_stage);
            let start = step.ends[0];
            let (length, rate) = if ends_at_stage {
                step.ends[1] = pair;
                (pair.length, pair.rate)
            } else {
                step.ends[1] = pair_into(&self.model, end, &element.from, &element.to, at_end);
                let length = step.ends[1].length;
                (0.5 * (start.length + length), (length - start.length) / h)
            };
            if pair.length.is_finite() && pair.check().is_err() {
                let (t, element) = (self.stage.t, element.name.clone());
                return Err(RunError::ZeroLength { t, element, length: pair.length });
            }
            bank.set_stroke(e, 1, length - element.rest_length, rate);
            bank.set_resolution(e, element.resolution(pair.length));
            bank.evaluate_element(e);
            let Response { force, d_stroke, d_rate, .. } = bank.response(e);
            let tangents = if ends_at_stage { [d_stroke[0][0], d_rate[0][0]] } else { [0.0; 2] };
            self.pairs.push(PairForce {
                from: element.from,
                to: element.to,
                force: force[0],
                d_length: tangents[0],
                d_rate: tangents[1],
            });
        }
        Ok(())
    }
}
