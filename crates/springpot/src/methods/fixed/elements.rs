//! The elements over one step of a fixed-step method.

use super::element_step::ElementStep;
use super::step::OneStage;
use crate::elements::{ElementBank, Pull};
use crate::equations::context::Context;
use crate::law::Response;
use crate::system::error::RunError;

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
            let [start, _] = &step.ends;
            for (point, time) in [t, at].into_iter().enumerate() {
                bank.set_stroke(e, point, element.stroke(start.coordinate), start.rate);
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
    /// With the midpoint rule, which acts along ∂y/∂q at the stage, the law gets the mean of the strokes at both ends and the
    /// rate (x_1 − x_0)/h. The work of a spring is then the energy that it takes up, but for terms of order h³: with strokes
    /// and rates of the stage itself stiff elements make energy.
    pub(super) fn respond(&mut self, cx: Context, bank: &mut ElementBank, h: f64) -> Result<(), RunError> {
        let ends_at_stage = self.method.node() == 1.0;
        self.forces.clear();
        for (e, element) in cx.system.elements.iter().enumerate() {
            let ElementStep { ends: [start, end], stage, gradients: [at_stage, at_end] } = &mut self.elements[e];
            let (model, measure) = (&self.model, &element.measure);
            let (stage, coordinate, rate) = if ends_at_stage {
                measure.read_into(model, &self.stage.kinematics, at_stage, end);
                (&*end, end.coordinate, end.rate)
            } else {
                measure.read_into(model, &self.stage.kinematics, at_stage, stage);
                measure.read_into(model, &self.end.kinematics, at_end, end);
                let travel = end.coordinate - start.coordinate;
                (&*stage, 0.5 * (start.coordinate + end.coordinate), travel / h)
            };
            if stage.coordinate.is_finite() {
                element.check_direction(self.stage.t, stage)?;
            }
            bank.set_stroke(e, 1, element.stroke(coordinate), rate);
            bank.set_resolution(e, element.resolution(stage.coordinate));
            bank.evaluate_element(e);
            let Response { force, d_stroke, d_rate, .. } = bank.response(e);
            let [d_coordinate, d_rate] = if ends_at_stage { [d_stroke[0][0], d_rate[0][0]] } else { [0.0; 2] };
            self.forces.push(measure, Pull { force: force[0], d_coordinate, d_rate });
        }
        Ok(())
    }
}
