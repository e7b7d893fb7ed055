//! Robot and elements at one time: what the quantities of a row are taken from.

use super::element::generalized_force;
use super::{Axis, EnergyQuantity, Quantity};
use crate::elements::Reading;
use crate::law::{InputValue, Observation};
use serde::{Deserialize, Serialize};

/// State of one element at one time, before its law is asked.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct ElementMoment {
    pub(crate) reading: Reading,
    /// x = y − y0, m or rad.
    pub(crate) stroke: f64,
    /// ∂y/∂q_b.
    pub(crate) gradient: Vec<f64>,
    pub(crate) inputs: Vec<InputValue>,
}

/// State of robot and elements at one time, before any law is asked.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Moment {
    pub(crate) t: f64,
    pub(crate) q: Vec<f64>,
    pub(crate) v: Vec<f64>,
    pub(crate) a: Vec<f64>,
    /// M a + C v + g and joint friction: the actuator forces were there no elements.
    pub(crate) rigid: Vec<f64>,
    /// Actuator forces that are known beforehand; the others follow from `rigid` and the elements.
    pub(crate) driven: Vec<Option<f64>>,
    /// Power lost in the joints' damping and friction, W.
    pub(crate) joint_loss: f64,
    pub(crate) kinetic: f64,
    pub(crate) potential: f64,
    pub(crate) elements: Vec<ElementMoment>,
    pub(crate) gripper: [f64; 3],
    /// Distance of the gripper from the wanted point, where there is one.
    pub(crate) gripper_error: Option<f64>,
}

/// What the law and the ledger say of one element in one row.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ElementRow {
    pub(crate) observation: Observation,
    /// Dissipated and supplied since t = 0, J; NaN where unknown.
    pub(crate) dissipated: f64,
    pub(crate) input: f64,
}

/// All that is known at one time of a run.
#[derive(Debug, Clone)]
pub struct Snapshot {
    pub(crate) moment: Moment,
    pub(crate) elements: Vec<ElementRow>,
    /// Work of the actuators since t = 0, J; NaN where unknown.
    pub(crate) actuators: f64,
    /// Lost in joints since t = 0, J.
    pub(crate) joints: f64,
    /// Residual of the energy balance, J; NaN where unknown.
    pub(crate) residual: f64,
}

impl Snapshot {
    /// Time, s.
    pub fn t(&self) -> f64 {
        self.moment.t
    }

    /// Coordinates, nq values.
    pub fn q(&self) -> &[f64] {
        &self.moment.q
    }

    /// Velocities, nv values.
    pub fn v(&self) -> &[f64] {
        &self.moment.v
    }

    /// Accelerations, nv values; NaN at a singular start.
    pub fn a(&self) -> &[f64] {
        &self.moment.a
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
        let Self { moment, elements, .. } = self;
        match quantity {
            Quantity::Time => moment.t,
            Quantity::Coordinate(k) => moment.q[k],
            Quantity::Velocity(k) => moment.v[k],
            Quantity::Acceleration(k) => moment.a[k],
            Quantity::Torque(k) => moment.driven[k].unwrap_or_else(|| {
                let of_element = |(row, state)| generalized_force(row, state, k);
                moment.rigid[k] - elements.iter().zip(&moment.elements).map(of_element).sum::<f64>()
            }),
            Quantity::Element(e, of_element) => of_element.value(&elements[e], &moment.elements[e]),
            Quantity::Gripper(Axis::X) => moment.gripper[0],
            Quantity::Gripper(Axis::Y) => moment.gripper[1],
            Quantity::Gripper(Axis::Z) => moment.gripper[2],
            Quantity::GripperError => moment.gripper_error.unwrap_or(f64::NAN),
            Quantity::Energy(EnergyQuantity::Kinetic) => moment.kinetic,
            Quantity::Energy(EnergyQuantity::Potential) => moment.potential,
            Quantity::Energy(EnergyQuantity::Actuators) => self.actuators,
            Quantity::Energy(EnergyQuantity::Joints) => self.joints,
            Quantity::Energy(EnergyQuantity::Residual) => self.residual,
        }
    }
}
