//! Measures: what an element sees of the configuration.
//!
//! A measure turns the configuration into one scalar y with rate y', gradient ∂y/∂q_b and second derivatives; a force F
//! along it has the generalized forces Q_b = −F ∂y/∂q_b. It knows no law.

mod forces;
mod joint;
mod line;

use crate::dynamics::{CoincidentAnchors, Kinematics, Pair};
use crate::model::Model;
pub(crate) use forces::{Forces, Pull};
pub use joint::{Joint, JointMeasureError};
pub use line::Line;
use serde::{Deserialize, Serialize};

/// What an element sees of the configuration: one scalar y.
#[derive(Debug, Clone, PartialEq)]
pub enum Measure {
    /// The distance of two points, m; F in N, positive in tension.
    Line(Line),
    /// The coordinate of a joint, m or rad; F in N or N·m, positive where it drives the coordinate down.
    Joint(Joint),
}

/// A measure in one state.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// y, m or rad.
    pub coordinate: f64,
    /// y' = Σ_b ∂y/∂q_b v_b, m/s or rad/s.
    pub rate: f64,
    direction: Direction,
}

/// Along what the force acts, as far as it may become undefined.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
enum Direction {
    /// Always defined.
    #[default]
    Fixed,
    /// Along a line, undefined at length 0.
    Line(Pair),
}

impl Measure {
    /// Reads y and y' into `reading` and ∂y/∂q_b into `gradient` (nv; all entries are written); needs velocities. Does not
    /// allocate.
    ///
    /// Where [`Reading::check`] refuses, all but y is NaN or noise.
    #[inline]
    pub fn read_into(&self, model: &Model, kinematics: &Kinematics, gradient: &mut [f64], reading: &mut Reading) {
        match self {
            Self::Line(line) => line.read_into(model, kinematics, gradient, reading),
            Self::Joint(joint) => joint.read_into(model, kinematics, gradient, reading),
        }
    }

    /// [`Self::read_into`], allocating: the reading and its gradient.
    pub fn read(&self, model: &Model, kinematics: &Kinematics) -> (Reading, Vec<f64>) {
        let (mut reading, mut gradient) = (Reading::default(), vec![0.0; model.nv()]);
        self.read_into(model, kinematics, &mut gradient, &mut reading);
        (reading, gradient)
    }

    /// Whether y is an angle (rad, F in N·m), not a length (m, F in N).
    pub fn is_rotation(&self) -> bool {
        match self {
            Self::Line(_) => false,
            Self::Joint(joint) => joint.is_rotation(),
        }
    }

    /// Whether it is the coordinate of a joint.
    pub(crate) fn is_on_joint(&self) -> bool {
        matches!(self, Self::Joint(_))
    }

    /// Adds a force along y to all others.
    #[inline]
    fn push(&self, pull: Pull, forces: &mut Forces) {
        match self {
            Self::Line(line) => line.push(pull, forces),
            Self::Joint(joint) => joint.push(pull, forces),
        }
    }

    /// The constant term of y, m or rad: beside y the measure of its rounding.
    pub(super) fn offset(&self) -> f64 {
        match self {
            Self::Line(_) => 0.0,
            Self::Joint(joint) => joint.offset(),
        }
    }
}

impl Reading {
    /// Whether the force has a direction to act in.
    ///
    /// # Errors
    /// [`CoincidentAnchors`] where it acts along a line of length 0 ([`Pair::check`]).
    #[inline]
    pub fn check(&self) -> Result<(), CoincidentAnchors> {
        match &self.direction {
            Direction::Fixed => Ok(()),
            Direction::Line(pair) => pair.check(),
        }
    }

    /// Whether a line turned by more than a right angle until `after`: its points passed each other.
    #[inline]
    pub(crate) fn turned_over(&self, after: &Self) -> bool {
        match (&self.direction, &after.direction) {
            (Direction::Line(before), Direction::Line(after)) => before.direction.dot(after.direction) <= 0.0,
            _ => false,
        }
    }
}
