//! What kinematics given in advance are asked.

use super::error::PathError;
use super::wanted::Wanted;
use crate::model::Model;
use crate::signal::Signal;
use std::fmt;

/// A source of kinematics given in advance; one of another crate joins by [`Trajectory::source`](super::Trajectory::source).
///
/// What it does between two times must show in its signals or in [`reach`](Self::reach): steps see it at their nodes alone.
pub trait Source: fmt::Debug + Send + Sync {
    /// q (nq values), v and a (nv values each, the exact derivatives) at t, and where the gripper should be, if that is said.
    ///
    /// # Errors
    /// [`PathError`] where the gripper cannot follow its path.
    fn at(
        &self,
        model: &Model,
        t: f64,
        q: &mut [f64],
        v: &mut [f64],
        a: &mut [f64],
    ) -> Result<Option<Wanted>, PathError>;

    /// The functions of time that it follows: steps end on their kinks and break points.
    fn signals(&self) -> Vec<&Signal>;

    /// The same, each with what messages call it.
    fn named_signals(&self, _model: &Model) -> Vec<(String, &Signal)> {
        self.signals().into_iter().map(|signal| ("the motion".to_owned(), signal)).collect()
    }

    /// How far coordinates may be from where they should be, rad or m: 0 where signals say it.
    fn solved_to(&self) -> f64 {
        0.0
    }

    /// Whether it says where the gripper should be.
    fn has_path(&self) -> bool {
        false
    }

    /// How long a step from t may be, at most h, so that its nodes see what the coordinates do beyond what the signals do: near
    /// singular configurations a gripper path turns joints at once.
    fn reach(&self, _t: f64, h: f64) -> f64 {
        h
    }

    /// Where and why the motion ends early, if it does.
    fn failure(&self) -> Option<PathError> {
        None
    }
}
