//! Robot and elements evaluated at one time.

use crate::elements::Reading;
use crate::law::{InputValue, LeafState, Observation};
use serde::{Deserialize, Serialize};

/// State of one element at one time, before its law is asked.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct ElementEvaluation {
    pub(crate) reading: Reading,
    /// x = y − y0, m or rad.
    pub(crate) stroke: f64,
    /// ∂y/∂q_b.
    pub(crate) gradient: Vec<f64>,
    pub(crate) inputs: Vec<InputValue>,
}

/// State of robot and elements at one time, before any law is asked.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Evaluation {
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
    pub(crate) elements: Vec<ElementEvaluation>,
    pub(crate) gripper: [f64; 3],
    /// Distance of the gripper from the wanted point, where there is one.
    pub(crate) gripper_error: Option<f64>,
}

/// What the law and the ledger say of one element in one row.
#[derive(Debug, Clone)]
pub(crate) struct ElementRow {
    pub(crate) observation: Observation,
    /// What its law tells of itself, as many as [`crate::law::Network::tells`] has; nothing where it takes no part.
    pub(crate) told: Vec<f64>,
    /// Its leaves, where rows tell them.
    pub(crate) leaves: Vec<LeafState>,
    /// Dissipated and supplied since t = 0, J; NaN where unknown.
    pub(crate) dissipated: f64,
    pub(crate) input: f64,
}

impl ElementRow {
    /// Before its law was asked.
    pub(crate) const UNKNOWN: Self = Self {
        observation: Observation { derivative: f64::NAN, regular: f64::NAN, singular: 0.0, stored: None },
        told: Vec::new(),
        leaves: Vec::new(),
        dissipated: f64::NAN,
        input: f64::NAN,
    };

    /// Q_b = −F·∂y/∂q_b.
    pub(super) fn generalized_force(&self, state: &ElementEvaluation, b: usize) -> f64 {
        -self.observation.force() * state.gradient[b]
    }
}
