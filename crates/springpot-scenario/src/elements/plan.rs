//! An element as it is read.

use super::past::PastPlan;
use crate::signals::plan::SignalPlan;
use crate::text::refusal::Place;
use springpot::elements::{Component, Element};
use springpot::model::Anchor;

/// One element: as the engine has it, and what the scenario says besides.
#[derive(Debug, Clone)]
pub struct ElementPlan {
    /// The element.
    pub element: Element,
    /// What happened to it before t = 0.
    pub past: PastPlan,
    /// Whether its rest length is its length at t = 0 of this case.
    pub rest_at_start: bool,
    /// What it acts along.
    pub shape: ShapePlan,
    /// Whether its law is a network of the scenario's own.
    pub is_network: bool,
    /// Parameters of it that are names of files, and these as they are written.
    pub files: Vec<(String, String)>,
    /// Parameters of its law in the order of the catalog, SI.
    pub parameters: Vec<f64>,
    /// Inputs of its law in the order of the catalog.
    pub inputs: Vec<SignalPlan>,
    /// Where its parameters stand in the scenario (the element itself where it has none).
    pub place: Place,
    /// Where what it acts along stands: its points, from one end to the other, or its joint.
    pub ends: Vec<Place>,
    /// Where its scheme stands, if it says one.
    pub scheme_place: Option<Place>,
}

/// What an element acts along.
#[derive(Debug, Clone)]
pub enum ShapePlan {
    /// Straight from point to point: two of a line, more of a cable.
    Points(Vec<Anchor>),
    /// The coordinate of the joint of this name.
    Joint(String),
    /// A coordinate of one frame in another, of a bushing.
    Bushing {
        /// The frame whose axes count.
        from: FramePlan,
        /// The other frame.
        to: FramePlan,
        /// Which of the six.
        component: Component,
    },
}

/// A frame on a body.
#[derive(Debug, Clone, Copy)]
pub struct FramePlan {
    /// Its origin.
    pub anchor: Anchor,
    /// Roll, pitch and yaw against the frame of the body's joint, rad.
    pub rpy: [f64; 3],
}
