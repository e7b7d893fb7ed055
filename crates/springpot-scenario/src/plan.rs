//! The plan: a scenario validated and resolved, in SI units, with every default filled in.

pub(crate) mod cure;
pub(crate) mod events;
pub(crate) mod metrics;
mod output;
mod resolved;
mod system;

pub use self::output::OutputPlan;
use crate::elements::past::PastPlan;
use crate::motion::MotionPlan;
use crate::plan::events::EventPlan;
use crate::plan::metrics::MetricPlan;
use crate::signals::feedback::FeedbackText;
use crate::text::refusal::{Place, Remark};
use springpot::elements::{Component, Element};
use springpot::model::urdf::Urdf;
use springpot::model::{Anchor, BodySpec, Model};
use springpot::signal::Signal;
use springpot::system::Settings;
use std::sync::Arc;

/// One run, ready to be started.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Title of the scenario.
    pub title: Option<String>,
    /// Gravity in the world frame, m/s².
    pub gravity: [f64; 3],
    /// The bodies, parents before children.
    pub bodies: Vec<BodySpec>,
    /// The robot built of them.
    pub model: Arc<Model>,
    /// Where each body stands in the scenario; those of a URDF file stand where the file is named.
    pub body_places: Vec<BodyPlaces>,
    /// The URDF file that the bodies come from, if they do.
    pub urdf: Option<UrdfPlan>,
    /// The gripper, if there is one.
    pub gripper: Option<Gripper>,
    /// Whether limits of joints are stops.
    pub end_stops: Option<EndStops>,
    /// The elements that act, in the order of the scenario.
    pub elements: Vec<ElementPlan>,
    /// Those that are not enabled, with their places among all elements of the scenario: they have columns, whose cells are empty.
    pub absent: Vec<(usize, ElementPlan)>,
    /// What moves the robot.
    pub motion: MotionPlan,
    /// What is watched in forward runs.
    pub events: Vec<EventPlan>,
    /// What says how good it is.
    pub metrics: Vec<MetricPlan>,
    /// What deserves a warning in its files.
    pub warnings: Vec<Remark>,
    /// Duration, rows, accuracy and steps.
    pub settings: Settings,
    /// What its results hold and show.
    pub output: OutputPlan,
}

impl Plan {
    /// All elements in the order of the scenario, those that are not enabled among them.
    pub fn all_elements(&self) -> Vec<&ElementPlan> {
        let mut all: Vec<&ElementPlan> = self.elements.iter().collect();
        self.absent.iter().for_each(|(place, plan)| all.insert(*place, plan));
        all
    }

    /// The elements that act, with their places among all elements of the scenario.
    pub fn placed_elements(&self) -> impl Iterator<Item = (usize, &ElementPlan)> {
        let count = self.elements.len() + self.absent.len();
        let is_absent = |place: &usize| self.absent.binary_search_by_key(place, |(absent, _)| *absent).is_ok();
        (0..count).filter(move |place| !is_absent(place)).zip(&self.elements)
    }

    /// Whether the element whose column or component has this name is not enabled.
    pub(crate) fn lacks(&self, column: &str) -> bool {
        let of = |name: &str| column.strip_prefix(name).is_some_and(|rest| rest.starts_with('.'));
        self.absent.iter().any(|(_, plan)| of(&plan.element.name))
    }

    /// Names of the joints that move as they are described, those that follow another one included.
    pub fn joint_names(&self) -> impl Iterator<Item = &str> {
        self.model.described_joints().iter().map(|joint| joint.name.as_str())
    }

    /// Names of the joints of the model that have coordinates of their own, in the order of q: `q1`, `c.rz`.
    pub fn own_joint_names(&self) -> impl Iterator<Item = &str> {
        let own = (0..self.model.joint_count()).filter(|&j| self.model.followed(j).is_none());
        own.map(|j| self.model.joint_names()[j].as_str())
    }
}

/// The robot of a scenario by itself.
#[derive(Debug, Clone)]
pub struct RobotPlan {
    /// Gravity in the world frame, m/s².
    pub gravity: [f64; 3],
    /// The bodies, parents before children.
    pub bodies: Vec<BodySpec>,
    /// The robot built of them.
    pub model: Arc<Model>,
    /// The URDF file that the bodies come from, if they do.
    pub urdf: Option<UrdfPlan>,
    /// The gripper, if there is one.
    pub gripper: Option<Gripper>,
}

/// Where the fields of a body stand in the scenario.
#[derive(Debug, Clone)]
pub struct BodyPlaces {
    /// The body's table.
    pub table: Place,
    /// The fields that were written, by dotted key: `mass`, `joint.axis`, …
    pub fields: Vec<(String, Place)>,
}

impl BodyPlaces {
    /// Place of the field with the dotted key `key`; the body's table where the field was left out.
    pub fn at(&self, key: &str) -> &Place {
        self.fields.iter().find(|(field, _)| field == key).map_or(&self.table, |(_, place)| place)
    }
}

/// A URDF file and how it was read.
#[derive(Debug, Clone)]
pub struct UrdfPlan {
    /// The path as written in the scenario, to whose folder it is relative.
    pub written: String,
    /// Whether mimic joints have coordinates of their own.
    pub ignore_mimic: bool,
    /// Folders that are packages or hold some, as written.
    pub package_path: Vec<String>,
    /// What the file says; its warnings are among those of [`crate::Cases::warnings`].
    pub robot: Arc<Urdf>,
}

/// Limits of joints as stops, SI of each joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndStops {
    /// Stiffness, N·m/rad or N/m.
    pub stiffness: f64,
    /// Damping, N·m·s/rad or N·s/m.
    pub damping: f64,
}

/// The point that a gripper path is about, and whose coordinates are columns.
#[derive(Debug, Clone)]
pub struct Gripper {
    /// Name of the body that carries it.
    pub body: String,
    /// The point.
    pub anchor: Anchor,
}

/// A signal and the text it was read from.
#[derive(Debug, Clone)]
pub struct SignalPlan {
    /// The function of time, SI.
    pub signal: Signal,
    /// Its value where it is a plain number or a quantity, SI.
    pub constant: Option<f64>,
    /// As written in the scenario.
    pub written: String,
    /// Where it stands.
    pub place: Place,
    /// Where it is none, but an expression of the state: the function counts for nothing then.
    pub(crate) feedback: Option<Arc<FeedbackText>>,
}

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
