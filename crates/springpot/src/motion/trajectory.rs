//! Kinematics given in advance, whatever they are made of.

use super::gripper_path::{self, GripperPath, PathError, Wanted};
use super::prescribed::{self, JointPath};
use crate::model::Model;
use crate::signal::Signal;

/// Kinematics given in advance.
#[derive(Debug, Clone)]
pub enum Trajectory {
    /// Each joint that has coordinates of its own moves as signals say, in joint order.
    Prescribed(Vec<JointPath>),
    /// The gripper follows a path; the coordinates come from inverse kinematics.
    GripperPath(Box<GripperPath>),
}

impl Trajectory {
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
        match self {
            Self::Prescribed(joints) => {
                prescribed::at(model, joints, t, q, v, a);
                Ok(None)
            }
            Self::GripperPath(path) => path.at(model, t, q, v, a).map(Some),
        }
    }

    /// The functions of time that it follows.
    pub(crate) fn signals(&self) -> Vec<&Signal> {
        match self {
            Self::Prescribed(joints) => joints.iter().flat_map(JointPath::signals).collect(),
            Self::GripperPath(path) => path.signals().collect(),
        }
    }

    /// How far coordinates may be from where the path has them, rad or m: 0 where signals say it.
    pub(crate) fn solved_to(&self) -> f64 {
        if let Self::GripperPath(_) = self { gripper_path::STEP_TOLERANCE } else { 0.0 }
    }

    /// Whether it says where the gripper should be.
    pub fn has_path(&self) -> bool {
        matches!(self, Self::GripperPath(_))
    }

    /// How long a step from t may be, at most h, so that its nodes see what the coordinates do beyond what the signals do: near
    /// singular configurations a gripper path turns joints at once.
    pub fn reach(&self, t: f64, h: f64) -> f64 {
        match self {
            Self::Prescribed(_) => h,
            Self::GripperPath(path) => path.reach(t, h),
        }
    }

    /// Where and why the motion ends early, if it does.
    pub fn failure(&self) -> Option<PathError> {
        match self {
            Self::Prescribed(_) => None,
            Self::GripperPath(path) => path.failure(),
        }
    }
}
