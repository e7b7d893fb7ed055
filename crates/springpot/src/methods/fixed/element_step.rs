//! One element over a step of a fixed-step method.

use crate::dynamics::Kinematics;
use crate::elements::{Element, Reading};
use crate::model::Model;
use crate::system::error::RunError;

/// One element over a step.
#[derive(Debug, Clone)]
pub(super) struct ElementStep {
    /// At the start and at the end.
    pub(super) ends: [Reading; 2],
    /// At the stage, where that is not the end.
    pub(super) stage: Reading,
    /// ∂y/∂q at the stage and at the end.
    pub(super) gradients: [Vec<f64>; 2],
}

impl ElementStep {
    /// At the start of a motion.
    ///
    /// # Errors
    /// Where its force has no direction.
    pub(super) fn new(element: &Element, model: &Model, start: &Kinematics) -> Result<Self, RunError> {
        let (reading, gradient) = element.measure.read(model, start);
        element.check_direction(0.0, &reading)?;
        let ends = [reading.clone(), reading.clone()];
        Ok(Self { ends, stage: reading, gradients: [gradient.clone(), gradient] })
    }
}
