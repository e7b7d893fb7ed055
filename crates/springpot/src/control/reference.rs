//! What a controller aims at.

use super::controller::Aim;
use crate::dynamics::Kinematics;
use crate::model::{Model, Site};
use crate::motion::PathError;
use crate::motion::{JointPath, Trajectory};
use crate::signal::{Expression, Signal};
use std::sync::Arc;

/// A motion to be followed: joints by signals, a path of the gripper, or a move from point to point.
#[derive(Debug, Clone)]
pub struct Reference {
    trajectory: Arc<Trajectory>,
}

/// How a move goes from 0 to 1 over w = t/duration, 0 ≤ w ≤ 1; it stays there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Profile {
    /// 10w³ − 15w⁴ + 6w⁵: at rest with no acceleration at both ends.
    Quintic,
    /// A third each of constant acceleration, constant velocity and constant deceleration: 2.25w², ¼ + 1.5(w − ⅓), 1 − 2.25(1 − w)².
    Trapezoid,
}

impl Profile {
    /// Of `w`, as an expression.
    const fn text(self) -> &'static str {
        match self {
            Self::Quintic => "min(t*r,1)^3*(10-min(t*r,1)*(15-6*min(t*r,1)))",
            Self::Trapezoid => "2.25*(min(t*r,1)^2-max(0,min(t*r,1)-1/3)^2-max(0,min(t*r,1)-2/3)^2)",
        }
    }

    /// A coordinate that goes so from `from` to `to` in `duration`, s.
    pub fn signal(self, from: f64, to: f64, duration: f64) -> Signal {
        let text = Expression::parse_with(self.text(), &[("r".to_owned(), duration.recip())]);
        Signal::scaled(Signal::expression(text.expect("an expression of its own")), to - from, from)
    }
}

impl Reference {
    /// Follows a trajectory.
    pub fn new(trajectory: impl Into<Arc<Trajectory>>) -> Self {
        Self { trajectory: trajectory.into() }
    }

    /// Joints of one degree, in the order of those with coordinates of their own, each as its path says.
    pub fn joints(paths: Vec<JointPath>) -> Self {
        Self::new(Trajectory::Prescribed(paths))
    }

    /// The motion it is.
    pub fn trajectory(&self) -> &Trajectory {
        &self.trajectory
    }

    /// Where it is at t; the gripper counts where there is one. `kinematics` is scratch.
    ///
    /// # Errors
    /// [`PathError`] where the gripper cannot follow its path.
    pub fn at_into(
        &self,
        model: &Model,
        gripper: Option<&Site>,
        t: f64,
        kinematics: &mut Kinematics,
        aim: &mut Aim,
    ) -> Result<(), PathError> {
        let Aim { q, v, a, gripper: wanted } = aim;
        q.resize(model.nq(), 0.0);
        v.resize(model.nv(), 0.0);
        a.resize(model.nv(), 0.0);
        let point = self.trajectory.at(model, t, q, v, a)?;
        *wanted = match (point, gripper) {
            (Some(point), _) => [point.position, point.velocity],
            (None, Some(site)) => {
                kinematics.update_velocity(model, q, v);
                [kinematics.position(site).0, kinematics.velocity(site).0]
            }
            (None, None) => return Ok(()),
        };
        Ok(())
    }
}
