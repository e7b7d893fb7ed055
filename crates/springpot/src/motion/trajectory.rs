//! Kinematics given in advance, whatever they are made of.

use super::error::PathError;
use super::gripper_path::GripperPath;
use super::prescribed::JointPath;
use super::source::Source;
use super::wanted::Wanted;
use crate::model::Model;
use crate::signal::Signal;
use std::sync::Arc;

/// Kinematics given in advance.
#[derive(Debug, Clone)]
pub enum Trajectory {
    /// Each joint that has coordinates of its own moves as signals say, in joint order.
    Prescribed(Vec<JointPath>),
    /// The gripper follows a path; the coordinates come from inverse kinematics.
    GripperPath(Box<GripperPath>),
    /// Any other source.
    Source(Arc<dyn Source>),
}

impl Trajectory {
    /// Kinematics that `source` gives.
    pub fn source(source: impl Source + 'static) -> Self {
        Self::Source(Arc::new(source))
    }

    fn asked(&self) -> &dyn Source {
        match self {
            Self::Prescribed(joints) => joints,
            Self::GripperPath(path) => &**path,
            Self::Source(source) => &**source,
        }
    }

    /// q (nq values), v and a (nv values each) at t, and where the gripper should be.
    ///
    /// # Errors
    /// [`PathError`] where the gripper cannot follow its path.
    pub fn at(
        &self,
        model: &Model,
        t: f64,
        q: &mut [f64],
        v: &mut [f64],
        a: &mut [f64],
    ) -> Result<Option<Wanted>, PathError> {
        self.asked().at(model, t, q, v, a)
    }

    /// The functions of time that it follows.
    pub(crate) fn signals(&self) -> Vec<&Signal> {
        self.asked().signals()
    }

    /// The same, each with what messages call it.
    pub(crate) fn named_signals(&self, model: &Model) -> Vec<(String, &Signal)> {
        self.asked().named_signals(model)
    }

    /// How far coordinates may be from where the path has them, rad or m: 0 where signals say it.
    pub(crate) fn solved_to(&self) -> f64 {
        self.asked().solved_to()
    }

    /// Whether it says where the gripper should be.
    pub fn has_path(&self) -> bool {
        self.asked().has_path()
    }

    /// How long a step from t may be, at most h, so that its nodes see what the coordinates do beyond what the signals do: near
    /// singular configurations a gripper path turns joints at once.
    pub fn reach(&self, t: f64, h: f64) -> f64 {
        self.asked().reach(t, h)
    }

    /// Where and why the motion ends early, if it does.
    pub fn failure(&self) -> Option<PathError> {
        self.asked().failure()
    }
}
