//! What is known of the robot and its elements at the start and at the nodes of a step.

use crate::actuation::Forward;
use crate::collocation::STAGES;
use crate::elements::{NoDirection, Reading};
use crate::model::Model;
use serde::{Deserialize, Serialize};

/// The robot at one time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Node<'a> {
    pub(crate) t: f64,
    pub(crate) q: &'a [f64],
    pub(crate) v: &'a [f64],
    pub(crate) a: &'a [f64],
}

/// Where a step starts.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Origin {
    pub(crate) t: f64,
    pub(crate) q: Vec<f64>,
    pub(crate) v: Vec<f64>,
    /// Accelerations without the share of a singular start.
    pub(crate) a: Vec<f64>,
}

impl Origin {
    /// Where the motion of a system starts, joints that stay at rest.
    pub(crate) fn new(model: &Model, forward: &Forward) -> Self {
        let mut origin = Self { t: 0.0, q: forward.q.clone(), v: forward.v.clone(), a: vec![0.0; model.nv()] };
        forward.locked(model).for_each(|j| origin.v[model.v_range(j)].fill(0.0));
        origin
    }

    pub(crate) fn node(&self) -> Node<'_> {
        Node { t: self.t, q: &self.q, v: &self.v, a: &self.a }
    }
}

/// One element over a step.
#[derive(Debug, Clone)]
pub(super) struct ElementNodes {
    /// At the start (0) and at the nodes.
    pub(super) readings: [Reading; STAGES + 1],
    /// ∂y/∂q at the start.
    pub(super) gradient: Vec<f64>,
    /// −M⁻¹ ∂y/∂q at the start: the accelerations that a unit of force gives. Only kept up to date where a run needs it.
    pub(super) share: Vec<f64>,
    /// The force at the start without the share of a singular start, N or N·m, and that share.
    pub(super) force: f64,
    pub(super) singular: f64,
}

impl ElementNodes {
    pub(super) fn new(nv: usize) -> Self {
        let zero = vec![0.0; nv];
        Self { readings: Default::default(), gradient: zero.clone(), share: zero, force: 0.0, singular: 0.0 }
    }

    /// Coordinate and rate at the start (0) or at a node.
    pub(super) fn read(&self, node: usize) -> [f64; 2] {
        let reading = &self.readings[node];
        [reading.coordinate, reading.rate]
    }

    /// Why the element lost its direction between two nodes, where it did.
    pub(super) fn lost(&self) -> Option<NoDirection> {
        self.readings.windows(2).find_map(|two| two[0].lost_until(&two[1]))
    }

    /// What its stroke goes over where all velocities move by `way`, m or rad.
    pub(super) fn travel(&self, way: &[f64]) -> f64 {
        self.gradient.iter().zip(way).map(|(g, way)| g * way).sum()
    }
}
