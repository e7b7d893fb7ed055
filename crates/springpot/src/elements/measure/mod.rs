//! Measures: what an element sees of the configuration.
//!
//! A measure turns the configuration into one scalar y with rate y', gradient ∂y/∂q_b and second derivatives; a force F
//! along it has the generalized forces Q_b = −F ∂y/∂q_b. It knows no law.

mod bushing;
mod cable;
mod forces;
mod joint;
mod line;

use crate::dynamics::{
    CoincidentAnchors, Kinematics, Pair, Workspace, hessian_into, pair_hessian_into, pair_hessian_of_moving,
};
use crate::model::Model;
use crate::spatial::Vec3;
pub use bushing::{Bushing, Component};
pub use cable::{Cable, CableError};
pub(crate) use forces::{Forces, Pull};
pub use joint::{Joint, JointMeasureError};
pub use line::Line;
use serde::{Deserialize, Serialize};

/// What an element sees of the configuration: one scalar y.
#[derive(Debug, Clone, PartialEq)]
pub enum Measure {
    /// The distance of two points, m; F in N, positive in tension.
    Line(Line),
    /// The length of a cable through several points, m; F in N, positive in tension.
    Cable(Cable),
    /// The coordinate of a joint, m or rad; F in N or N·m, positive where it drives the coordinate down.
    Joint(Joint),
    /// A coordinate of one frame in another, m or rad; F in N or N·m, positive where it drives the coordinate down.
    Bushing(Bushing),
}

/// Why a force has no direction to act in.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NoDirection {
    /// The ends of a line met.
    #[error(transparent)]
    Line(#[from] CoincidentAnchors),
    /// The ends of a segment of a cable met.
    #[error(
        "the ends of segment {segment} of the cable coincide (length {length} m): there is no direction for the force"
    )]
    Segment {
        /// The segment, from 1.
        segment: usize,
        /// Its length, m.
        length: f64,
    },
    /// Two frames are half a turn apart, where their rotation vector jumps.
    #[error("the frames are turned against each other by {angle} rad: at half a turn the rotation vector jumps")]
    HalfTurn {
        /// The turn, rad.
        angle: f64,
    },
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
    /// Along segments, each undefined at length 0.
    Cable(Vec<cable::Segment>),
    /// Along a rotation vector, which jumps at half a turn.
    Turn(Vec3),
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
            Self::Cable(cable) => cable.read_into(model, kinematics, gradient, reading),
            Self::Joint(joint) => joint.read_into(model, kinematics, gradient, reading),
            Self::Bushing(bushing) => bushing.read_into(model, kinematics, gradient, reading),
        }
    }

    /// [`Self::read_into`], allocating: the reading and its gradient.
    pub fn read(&self, model: &Model, kinematics: &Kinematics) -> (Reading, Vec<f64>) {
        let (mut reading, mut gradient) = (Reading::default(), vec![0.0; model.nv()]);
        self.read_into(model, kinematics, &mut gradient, &mut reading);
        (reading, gradient)
    }

    /// Second derivatives, nv × nv, row-major: entry (a, b) is ∂(∂y/∂q_a)/∂q_b, symmetric but for the degrees of one floating joint.
    /// Needs positions; NaN where the force has no direction.
    pub fn hessian(&self, model: &Model, kinematics: &Kinematics) -> Vec<f64> {
        let mut hessian = vec![0.0; model.nv() * model.nv()];
        self.hessian_into(model, kinematics, &mut Workspace::new(model), &mut hessian);
        hessian
    }

    /// [`Self::hessian`] into nv × nv values, which does not allocate.
    pub fn hessian_into(&self, model: &Model, kinematics: &Kinematics, workspace: &mut Workspace, hessian: &mut [f64]) {
        match self {
            Self::Line(line) => pair_hessian_into(model, kinematics, &line.from, &line.to, workspace, hessian),
            Self::Joint(_) => hessian.fill(0.0),
            Self::Cable(cable) => hessian_into(model, kinematics, &cable.coordinate(), workspace, hessian),
            Self::Bushing(bushing) => hessian_into(model, kinematics, bushing.coordinate(), workspace, hessian),
        }
    }

    /// [`Self::hessian_into`], of two points no more than the rows and columns of the velocities that move.
    pub(crate) fn hessian_of_moving(
        &self,
        model: &Model,
        kinematics: &Kinematics,
        moves: &[bool],
        workspace: &mut Workspace,
        hessian: &mut [f64],
    ) {
        match self {
            Self::Line(line) => {
                let sites = [&line.from, &line.to];
                pair_hessian_of_moving(model, kinematics, sites, |velocity| moves[velocity], workspace, hessian);
            }
            _ => self.hessian_into(model, kinematics, workspace, hessian),
        }
    }

    /// Whether y is an angle (rad, F in N·m), not a length (m, F in N).
    pub fn is_rotation(&self) -> bool {
        match self {
            Self::Line(_) | Self::Cable(_) => false,
            Self::Joint(joint) => joint.is_rotation(),
            Self::Bushing(bushing) => bushing.component().is_rotation(),
        }
    }

    /// What kind of coordinate it is, for words.
    pub(crate) fn kind(&self) -> MeasureKind {
        match self {
            Self::Line(_) | Self::Cable(_) => MeasureKind::Length,
            Self::Joint(_) => MeasureKind::Joint,
            Self::Bushing(bushing) if bushing.component().is_rotation() => MeasureKind::Turn,
            Self::Bushing(_) => MeasureKind::Shift,
        }
    }

    /// Adds a force along y to all others.
    #[inline]
    fn push(&self, pull: Pull, forces: &mut Forces) {
        match self {
            Self::Line(line) => line.push(pull, forces),
            Self::Cable(cable) => cable.push(pull, forces),
            Self::Joint(joint) => joint.push(pull, forces),
            Self::Bushing(bushing) => bushing.push(pull, forces),
        }
    }

    /// What y is a difference of, m or rad: beside y the measure of its rounding.
    pub(super) fn offset(&self) -> f64 {
        match self {
            Self::Line(_) | Self::Cable(_) => 0.0,
            Self::Joint(joint) => joint.offset(),
            Self::Bushing(bushing) => bushing.reach(),
        }
    }
}

/// What kind of coordinate a measure is, for words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum MeasureKind {
    Length,
    Joint,
    Shift,
    Turn,
}

impl Reading {
    /// Whether the force has a direction to act in.
    ///
    /// # Errors
    /// [`NoDirection`]: it acts along a line of length 0 ([`Pair::check`]), or a bushing is turned by nearly half a turn.
    #[inline]
    pub fn check(&self) -> Result<(), NoDirection> {
        match &self.direction {
            Direction::Fixed => Ok(()),
            Direction::Line(pair) => Ok(pair.check()?),
            Direction::Cable(segments) => cable::check(segments),
            Direction::Turn(turn) => bushing::check(*turn),
        }
    }

    /// What went wrong on the way to `after`: points met, or passed each other, so that a line turned by more than a right angle;
    /// two frames came to half a turn.
    #[inline]
    pub(crate) fn lost_until(&self, after: &Self) -> Option<NoDirection> {
        match (&self.direction, &after.direction) {
            (Direction::Line(before), Direction::Line(after)) => {
                let length = before.length.min(after.length);
                before.lost_until(after).then_some(NoDirection::Line(CoincidentAnchors { length }))
            }
            (Direction::Cable(before), Direction::Cable(after)) => cable::met(before, after),
            (Direction::Turn(before), Direction::Turn(after)) => bushing::passed(*before, *after),
            _ => None,
        }
    }
}
