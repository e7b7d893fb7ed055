//! Robot and elements at one time: what the quantities of a row are taken from.

use super::evaluation::{ElementRow, Evaluation};
use super::quantity::{EnergyQuantity, Quantity};

/// All that is known at one time of a run.
#[derive(Debug, Clone)]
pub struct Snapshot {
    pub(crate) evaluation: Evaluation,
    pub(crate) elements: Vec<ElementRow>,
    /// Work of the actuators since t = 0, J; NaN where unknown.
    pub(crate) actuators: f64,
    /// Lost in joints since t = 0, J.
    pub(crate) joints: f64,
    /// Residual of the energy balance, J; NaN where unknown.
    pub(crate) residual: f64,
    /// Of [`crate::system::sensitivity::Sensitivity::columns`]; empty where nobody asked for them.
    pub(crate) derivatives: Vec<f64>,
}

impl Snapshot {
    /// Time, s.
    pub fn t(&self) -> f64 {
        self.evaluation.t
    }

    /// Coordinates, nq values.
    pub fn q(&self) -> &[f64] {
        &self.evaluation.q
    }

    /// Velocities, nv values.
    pub fn v(&self) -> &[f64] {
        &self.evaluation.v
    }

    /// Accelerations, nv values; NaN at a singular start.
    pub fn a(&self) -> &[f64] {
        &self.evaluation.a
    }

    /// Force of an element, N (N·m where it acts on an angle), positive in tension; NaN at a singular start.
    ///
    /// # Panics
    /// Where there is no such element.
    pub fn force(&self, element: usize) -> f64 {
        self.elements[element].observation.force()
    }

    /// The value of a quantity of the system, SI, NaN where unknown.
    ///
    /// # Panics
    /// Where an index is none of this system.
    pub fn value(&self, quantity: Quantity) -> f64 {
        let Self { evaluation, elements, .. } = self;
        match quantity {
            Quantity::Time => evaluation.t,
            Quantity::Coordinate(k) => evaluation.q[k],
            Quantity::Velocity(k) => evaluation.v[k],
            Quantity::Acceleration(k) => evaluation.a[k],
            Quantity::Torque(k) => evaluation.driven[k].unwrap_or_else(|| {
                let of_element = |(row, state): (&ElementRow, _)| row.generalized_force(state, k);
                evaluation.rigid[k] - elements.iter().zip(&evaluation.elements).map(of_element).sum::<f64>()
            }),
            Quantity::Element(e, of_element) => of_element.value(&elements[e], &evaluation.elements[e]),
            Quantity::Gripper(axis) => evaluation.gripper[axis.index()],
            Quantity::GripperError => evaluation.gripper_error.unwrap_or(f64::NAN),
            Quantity::Energy(EnergyQuantity::Kinetic) => evaluation.kinetic,
            Quantity::Energy(EnergyQuantity::Potential) => evaluation.potential,
            Quantity::Energy(EnergyQuantity::Actuators) => self.actuators,
            Quantity::Energy(EnergyQuantity::Joints) => self.joints,
            Quantity::Energy(EnergyQuantity::Residual) => self.residual,
            Quantity::Derivative(k) => self.derivatives.get(k).copied().unwrap_or(f64::NAN),
        }
    }
}
