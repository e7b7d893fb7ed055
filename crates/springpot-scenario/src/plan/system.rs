//! From a plan to what the time loop runs.

use crate::elements::plan::ElementPlan;
use crate::plan::Plan;
use crate::robot::described::EndStops;
use springpot::model::{Anchor, Site};
use springpot::motion::gripper_path::Course;
use springpot::observe::Observables;
use springpot::system::{Shared, Stop, System};
use springpot::table::Column;
use std::collections::HashMap;

/// So much of a gripper path is solved where its start alone is wanted.
const BEGINNING: f64 = 1e-9;

impl Plan {
    /// The robot, its elements and its motion. A gripper path is solved here, as far as it can be followed.
    pub fn system(&self) -> System {
        self.system_unless(&Stop::new(false))
    }

    /// [`Self::system`], but a gripper path is followed until `stop` is set: it then ends there.
    pub fn system_unless(&self, stop: &Stop) -> System {
        self.system_along(&Course { end: self.settings.end, max_step: self.settings.max_step, stop })
    }

    fn system_along(&self, course: &Course<'_>) -> System {
        let system = System {
            elements: self.elements.iter().map(|plan| plan.element.clone()).collect(),
            motion: self.motion.made(&self.model, course),
            gripper: self.gripper.as_ref().map(|gripper| self.site(&gripper.anchor)),
            model: self.model.clone(),
            tells_joint_losses: self.output.tells_joint_losses,
            tells_leaves: self.output.tells_leaves,
            events: self.events.iter().map(|plan| plan.event.clone()).collect(),
            control: self.motion.control(&self.model, course).into(),
            sensitivity: self.sensitivity.as_ref().and_then(|plan| plan.engine.clone()),
            shared: Shared::default(),
        };
        self.with_end_stops(system)
    }

    /// The system with the stops that limits of joints are.
    pub(crate) fn with_end_stops(&self, system: System) -> System {
        match self.end_stops {
            None => system,
            Some(EndStops { stiffness, damping }) => {
                system.with_end_stops(stiffness, damping).expect("numbers that were read in their ranges")
            }
        }
    }

    /// [`Self::system`], but of a gripper path no more than its beginning is solved.
    pub fn system_at_start(&self) -> System {
        let course = Course { end: self.settings.end * BEGINNING, max_step: None, stop: &Stop::new(false) };
        self.system_along(&course)
    }

    /// Gives the elements that rest where they start their length at t = 0. Where the motion cannot start, a run says why.
    pub(crate) fn rest_at_start(&mut self) {
        if !self.elements.iter().any(|plan| plan.rest_at_start) {
            return;
        }
        let Ok(starts) = self.system_at_start().element_starts() else { return };
        for (plan, start) in self.elements.iter_mut().zip(starts).filter(|(plan, _)| plan.rest_at_start) {
            plan.element.rest = start.length;
        }
    }

    /// The columns of the rows of all cases, in order: those of elements that are not enabled are among them.
    pub fn columns(&self) -> Vec<Column> {
        let observables = self.observables();
        let observables = if self.output.tells_joint_losses { observables.with_joint_losses() } else { observables };
        let derivatives = self.sensitivity.as_ref().map_or_else(Vec::new, |plan| plan.columns.clone());
        observables.with_derivatives(derivatives).columns()
    }

    /// [`Self::columns`], and behind them the derivatives that metrics alone need: what a row has.
    pub fn row_columns(&self) -> Vec<Column> {
        let mut columns = self.columns();
        columns.extend(self.sensitivity.iter().flat_map(|plan| plan.for_metrics.iter().cloned()));
        columns
    }

    /// For each of [`Self::row_columns`] its place in a row of `system`, which was made of this plan; `None` where a cell is empty. Nothing where
    /// all elements are enabled: rows are as they are.
    pub fn places(&self, system: &System) -> Option<Vec<Option<usize>>> {
        if self.absent.is_empty() {
            return None;
        }
        let own = system.columns();
        let own: HashMap<&str, usize> = own.iter().enumerate().map(|(k, column)| (&*column.name, k)).collect();
        Some(self.row_columns().iter().map(|column| own.get(&*column.name).copied()).collect())
    }

    /// What can be observed of all elements, but for the energy lost in joints.
    pub(crate) fn observables(&self) -> Observables {
        self.observables_of(self.all_elements().into_iter())
    }

    /// As [`Self::observables`], without the elements that are not enabled: what the system has.
    pub(crate) fn acting_observables(&self) -> Observables {
        self.observables_of(self.elements.iter())
    }

    fn observables_of<'a>(&self, elements: impl Iterator<Item = &'a ElementPlan>) -> Observables {
        let observables = Observables::new(&self.model, elements.map(|plan| &plan.element));
        let observables = if self.output.tells_leaves { observables.with_leaves() } else { observables };
        match self.gripper {
            Some(_) => observables.with_gripper(self.motion.has_path() || self.motion.has_controller()),
            None => observables,
        }
    }

    fn site(&self, anchor: &Anchor) -> Site {
        self.model.resolve(anchor).expect("an anchor that was read")
    }
}
