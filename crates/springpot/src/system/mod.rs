//! What is simulated: a robot with its elements and what moves it.

pub(crate) mod definite;
mod end_stops;
pub(crate) mod error;
pub(crate) mod event;
mod explicit;
pub(crate) mod fixed_step;
pub(crate) mod jump;
pub(crate) mod row_times;
pub mod sensitivity;
pub(crate) mod settings;
mod shared;
mod signals;

pub use error::RunError;
pub use event::{Action, Direction, Event, Setting};
pub use explicit::Unfit;
pub use fixed_step::FixedStep;
pub use row_times::RowTimes;
pub use settings::{Adaptive, Settings, Stop};
pub use shared::Shared;

use sensitivity::Sensitivity;

use crate::actuation::Forward;
use crate::control::Control;
use crate::elements::Element;
use crate::model::{Model, Site};
use crate::motion::Trajectory;
use crate::observe::{ElementQuantity, Observables, Quantity, Table};
use crate::table::Column;
use std::sync::Arc;

/// A robot, its elements and its motion.
#[derive(Debug, Clone)]
pub struct System {
    /// The robot.
    pub model: Arc<Model>,
    /// The elements, end stops ([`System::with_end_stops`]) among them.
    pub elements: Vec<Element>,
    /// How it moves.
    pub motion: Motion,
    /// The gripper, where there is one.
    pub gripper: Option<Site>,
    /// Whether the rows tell the energy lost in damping and friction of joints. It is part of the balance in any case.
    pub tells_joint_losses: bool,
    /// Whether the rows tell the leaves of the elements' laws.
    pub tells_leaves: bool,
    /// What is watched in forward runs, in the order in which it is done where several happen at one time.
    pub events: Vec<Event>,
    /// What follows from the state in forward runs.
    pub control: Arc<Control>,
    /// By what its runs are differentiated; `None`: by nothing.
    pub sensitivity: Option<Arc<Sensitivity>>,
    /// What it has in common with others.
    pub shared: Shared,
}

/// Whether motion or forces are given.
#[derive(Debug, Clone)]
pub enum Motion {
    /// Kinematics given in advance; the actuator forces follow.
    Given(Arc<Trajectory>),
    /// Forward dynamics: the motion follows from the forces.
    Forward(Arc<Forward>),
}

impl From<Trajectory> for Motion {
    fn from(trajectory: Trajectory) -> Self {
        Self::Given(trajectory.into())
    }
}

impl From<Forward> for Motion {
    fn from(forward: Forward) -> Self {
        Self::Forward(forward.into())
    }
}

impl Motion {
    /// Whether it says where the gripper should be.
    pub fn has_path(&self) -> bool {
        matches!(self, Self::Given(trajectory) if trajectory.has_path())
    }
}

impl System {
    /// A system without a gripper, whose rows tell nothing of losses in joints.
    pub fn new(model: impl Into<Arc<Model>>, elements: Vec<Element>, motion: impl Into<Motion>) -> Self {
        let (model, motion) = (model.into(), motion.into());
        Self {
            model,
            elements,
            motion,
            gripper: None,
            tells_joint_losses: false,
            tells_leaves: false,
            events: Vec::new(),
            control: Arc::default(),
            sensitivity: None,
            shared: Shared::default(),
        }
    }

    /// The same, which looks up with others what they have in common.
    #[must_use]
    pub fn sharing(self, shared: &Shared) -> Self {
        Self { shared: shared.clone(), ..self }
    }

    /// What can be observed of it, in the order of a run's rows.
    pub fn observables(&self) -> Observables {
        let mut observables = Observables::new(&self.model, &self.elements);
        if self.gripper.is_some() {
            let aims = self.motion.has_path() || self.control.controller.is_some();
            observables = observables.with_gripper(aims);
        }
        if self.tells_joint_losses {
            observables = observables.with_joint_losses();
        }
        if self.tells_leaves {
            observables = observables.with_leaves();
        }
        let Some(by) = &self.sensitivity else { return observables };
        observables.with_derivatives(by.columns.iter().map(|derivative| derivative.column.clone()).collect())
    }

    /// The velocities that forces drive; none where the motion is given in advance.
    pub(crate) fn driven_velocities(&self) -> Vec<usize> {
        let Motion::Forward(forward) = &self.motion else { return Vec::new() };
        forward.free_velocities(&self.model)
    }

    /// Whether somebody asks for the leaves of the elements' laws.
    pub(crate) fn needs_leaves(&self) -> bool {
        let is_leaf = |quantity: &Quantity| matches!(quantity, Quantity::Element(_, ElementQuantity::Leaf(..)));
        self.tells_leaves || self.events.iter().flat_map(|event| &event.columns).any(is_leaf)
    }

    /// The columns of a run's rows, in order.
    pub fn columns(&self) -> Vec<Column> {
        self.observables().columns()
    }

    /// A table for the rows of its runs.
    pub fn table(&self) -> Table {
        Table::new(&self.observables())
    }
}
