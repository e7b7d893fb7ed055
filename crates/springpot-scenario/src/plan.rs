//! The plan: a scenario validated and resolved, in SI units, with every default filled in.

pub(crate) mod control;
pub(crate) mod cure;
pub(crate) mod design;
pub(crate) mod events;
pub(crate) mod metrics;
mod output;
mod resolved;
pub(crate) mod sensitivity;
pub(crate) mod steady;
mod system;

pub use self::output::OutputPlan;
use crate::elements::plan::ElementPlan;
use crate::motion::MotionPlan;
use crate::plan::design::DesignPlan;
use crate::plan::events::EventPlan;
use crate::plan::metrics::MetricPlan;
use crate::robot::described::{BodyPlaces, DescriptionPlan, EndStops, Gripper};
use crate::text::refusal::Remark;
use sensitivity::SensitivityPlan;
use springpot::model::{BodySpec, Model};
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
    pub urdf: Option<DescriptionPlan>,
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
    /// What its parameters are moved for, where it says so.
    pub design: Option<DesignPlan>,
    /// What deserves a warning in its files.
    pub warnings: Vec<Remark>,
    /// Duration, rows, accuracy and steps.
    pub settings: Settings,
    /// By what it is differentiated, and what.
    pub sensitivity: Option<SensitivityPlan>,
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
