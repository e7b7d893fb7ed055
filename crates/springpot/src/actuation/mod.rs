//! Forward dynamics: what robots start from, and what drives their joints.

use crate::model::Model;
use crate::motion::JointPath;
use crate::signal::Signal;

/// A motion that follows from the equations of motion.
#[derive(Debug, Clone)]
pub struct Forward {
    /// q(0), nq values.
    pub q: Vec<f64>,
    /// v(0), nv values.
    pub v: Vec<f64>,
    /// One for each joint that has coordinates of its own, in their order.
    pub drives: Vec<Drive>,
}

impl Forward {
    /// Whether signals prescribe joints, whose actuators follow from all forces.
    pub(crate) fn has_paths(&self) -> bool {
        self.drives.iter().any(|drive| matches!(drive, Drive::Prescribed(_)))
    }

    /// The functions of time that drive it.
    pub(crate) fn signals(&self) -> Vec<&Signal> {
        self.drives.iter().flat_map(Drive::signals).collect()
    }

    /// The velocities of `model`'s joints that forces drive, in rising order, with the signals that say how large these are.
    pub(crate) fn forces<'a>(&'a self, model: &'a Model) -> impl Iterator<Item = (usize, &'a Signal)> {
        self.forced(model).flat_map(|(j, signals)| model.v_range(j).zip(signals))
    }

    /// The joints of `model` that signals move.
    pub(crate) fn paths<'a>(&'a self, model: &'a Model) -> impl Iterator<Item = (usize, &'a JointPath)> {
        model.own_joints().zip(&self.drives).filter_map(|(j, drive)| match drive {
            Drive::Prescribed(path) => Some((j, path)),
            _ => None,
        })
    }

    /// The joints of `model` that stay where they start.
    pub(crate) fn locked<'a>(&'a self, model: &'a Model) -> impl Iterator<Item = usize> + 'a {
        let drives = model.own_joints().zip(&self.drives);
        drives.filter(|(_, drive)| matches!(drive, Drive::Locked)).map(|(j, _)| j)
    }

    /// The joints of `model` that forces drive, each with the signals of its velocities.
    pub(crate) fn forced<'a>(&'a self, model: &'a Model) -> impl Iterator<Item = (usize, &'a [Signal])> {
        model.own_joints().zip(&self.drives).filter_map(|(j, drive)| match drive {
            Drive::Force(signals) => Some((j, &signals[..])),
            _ => None,
        })
    }

    /// The velocities of `model`'s joints that forces drive, in rising order.
    pub(crate) fn free_velocities(&self, model: &Model) -> Vec<usize> {
        self.forces(model).map(|(k, _)| k).collect()
    }
}

/// What drives one joint.
#[derive(Debug, Clone)]
pub enum Drive {
    /// An actuator force for each of its velocities, N·m or N.
    Force(Vec<Signal>),
    /// The joint moves as signals say, whatever force that takes.
    Prescribed(JointPath),
    /// The joint stays where it starts, whatever force that takes.
    Locked,
}

impl Drive {
    pub(crate) fn signals(&self) -> Vec<&Signal> {
        match self {
            Self::Force(signals) => signals.iter().collect(),
            Self::Prescribed(path) => path.signals(),
            Self::Locked => Vec::new(),
        }
    }
}
