//! The elements over one step of a fixed-step method.

use super::Method;
use super::stepper::Stepper;
use crate::dynamics::{Kinematics, Pair, PairForce, pair_into};
use crate::element::Element;
use crate::fractional::Form;
use crate::law::{InputValue, Response, Singular, State, Step};
use crate::model::Model;
use crate::simulate::RunError;

/// One element over a step.
#[derive(Debug, Clone)]
pub(super) struct ElementStep {
    /// At the start and at the end.
    pub(super) ends: [Pair; 2],
    /// At the start, and what the law is asked for: at the end, or the mean over the step.
    stroke: [f64; 2],
    rate: [f64; 2],
    inputs: Vec<InputValue>,
    pub(super) held: Vec<Option<f64>>,
    resolution: f64,
    pub(super) response: Response,
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
        Ok(Self {
            ends: [pair; 2],
            stroke: [0.0; 2],
            rate: [0.0; 2],
            inputs: vec![InputValue::default(); 2 * element.inputs.len()],
            held: vec![None; element.inputs.len()],
            resolution: 0.0,
            response: Response::default(),
            gradients: [gradient.clone(), gradient],
        })
    }
}

impl ElementStep {
    /// Inputs at the start of the step.
    pub(super) fn start_inputs(&self) -> &[InputValue] {
        &self.inputs[..self.inputs.len() / 2]
    }

    fn law_step(&self, t: f64, h: f64, method: Method) -> Step<'_> {
        Step {
            t,
            h,
            nodes: method.nodes(),
            form: Form::Strokes,
            stroke: &self.stroke,
            rate: &self.rate,
            inputs: &self.inputs,
            resolution: self.resolution,
            singular: Singular::Moments,
        }
    }
}

impl Stepper<'_> {
    /// The step as the law of element `e` is told of it.
    pub(super) fn law_step(&self, e: usize, h: f64) -> Step<'_> {
        self.elements[e].law_step(self.origin.t, h, self.method)
    }

    /// What the law of element `e` knows before the step is found.
    pub(super) fn prepare(&self, e: usize, h: f64, law: &mut State) {
        let (element, step) = (&self.system.elements[e], &self.elements[e]);
        let [start, _] = step.ends;
        let (stroke, rate) = ([start.length - element.rest_length; 2], [start.rate; 2]);
        let asked = step.law_step(self.origin.t, h, self.method);
        element.law.prepare(&Step { stroke: &stroke, rate: &rate, ..asked }, law);
    }

    /// Inputs of an element at the stage of the last step.
    pub(super) fn inputs(&self, e: usize) -> &[InputValue] {
        let inputs = &self.elements[e].inputs;
        &inputs[inputs.len() / 2..]
    }

    pub(super) fn take_inputs(&mut self, at: f64) -> Result<(), RunError> {
        for (element, step) in self.system.elements.iter().zip(&mut self.elements) {
            let count = element.inputs.len();
            for (t, values) in [self.origin.t, at].into_iter().zip(step.inputs.chunks_exact_mut(count.max(1))) {
                element.inputs_at(t, values);
                for (value, held) in values.iter_mut().zip(&step.held) {
                    if let Some(held) = *held {
                        *value = InputValue { value: held, rate: 0.0 };
                    }
                }
                element.check_inputs(t, values)?;
            }
        }
        Ok(())
    }

    /// Asks the elements.
    ///
    /// With the midpoint rule, which acts along ∂l/∂q at the stage, the law gets the mean of the strokes at both ends and the rate
    /// (x_1 − x_0)/h. The work of a spring is then the energy that it takes up, but for terms of order h³: with strokes and rates of the stage
    /// itself stiff elements make energy.
    pub(super) fn respond<'l>(&mut self, h: f64, law: &impl Fn(usize) -> &'l State) -> Result<(), RunError> {
        let ends_at_stage = self.method.node() == 1.0;
        self.pairs.clear();
        for (e, element) in self.system.elements.iter().enumerate() {
            let step = &mut self.elements[e];
            let [at_stage, at_end] = &mut step.gradients;
            let (stage, end) = (&self.stage.kinematics, &self.end.kinematics);
            let pair = pair_into(self.model, stage, &element.from, &element.to, at_stage);
            let start = step.ends[0];
            let (stroke, rate) = if ends_at_stage {
                step.ends[1] = pair;
                (pair.length, pair.rate)
            } else {
                step.ends[1] = pair_into(self.model, end, &element.from, &element.to, at_end);
                let length = step.ends[1].length;
                (0.5 * (start.length + length), (length - start.length) / h)
            };
            if pair.length.is_finite() && pair.check().is_err() {
                let (t, element) = (self.stage.t, element.name.clone());
                return Err(RunError::ZeroLength { t, element, length: pair.length });
            }
            step.stroke = [start.length, stroke].map(|length| length - element.rest_length);
            step.rate = [start.rate, rate];
            step.resolution = element.resolution(pair.length);
            step.response = element.law.evaluate(&step.law_step(self.origin.t, h, self.method), law(e));
            let Response { force, d_stroke, d_rate, .. } = &step.response;
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
