//! One of the six coordinates of a frame in another one.

use super::forces::{Forces, Pull};
use super::{Direction, Measure, NoDirection, Reading};
use crate::dynamics::{Kinematics, RelativeCoordinate, gradient_into};
use crate::model::{Frame, Model};
use crate::spatial::Vec3;
use std::f64::consts::PI;

/// Turns from here on are refused, rad: at half a turn the rotation vector jumps.
const LARGEST_TURN: f64 = PI - 1e-3;

/// A coordinate of a bushing between two frames `from` and `to`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Component {
    /// Shift of the origin of `to` along x of `from`, m; F in N.
    X,
    /// Along y.
    Y,
    /// Along z.
    Z,
    /// Component x of the rotation vector φ of R_fromᵀ R_to in the axes of `from`, rad; F in N·m.
    Rx,
    /// Component y.
    Ry,
    /// Component z.
    Rz,
}

impl Component {
    /// All six.
    pub const ALL: [Self; 6] = [Self::X, Self::Y, Self::Z, Self::Rx, Self::Ry, Self::Rz];

    /// Its name in files and columns.
    pub const fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
            Self::Rx => "rx",
            Self::Ry => "ry",
            Self::Rz => "rz",
        }
    }

    /// Whether it is an angle.
    pub const fn is_rotation(self) -> bool {
        matches!(self, Self::Rx | Self::Ry | Self::Rz)
    }

    const fn axis(self) -> usize {
        match self {
            Self::X | Self::Rx => 0,
            Self::Y | Self::Ry => 1,
            Self::Z | Self::Rz => 2,
        }
    }
}

/// y = e·(r_to − r_from) with an axis e of `from`, m, or a component of the rotation vector of the turn from `from` to `to`,
/// rad. A force F > 0 (N or N·m) drives y down.
///
/// The rotation vector is defined for turns below π; a run that comes within 1 mrad stops. It belongs to the [`Model`] that it
/// was made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bushing {
    seen: RelativeCoordinate,
    component: Component,
    /// Size of the numbers that y is a difference of, m or rad.
    reach: f64,
}

impl Bushing {
    /// A coordinate of the frame `to` in the frame `from` ([`Model::resolve_frame`]).
    pub fn new(model: &Model, from: Frame, to: Frame, component: Component) -> Self {
        let (axis, is_turn) = (component.axis(), component.is_rotation());
        let reach = if is_turn { 1.0 } else { model.reach(&from).max(model.reach(&to)) };
        Self { seen: RelativeCoordinate { from, to, axis, is_turn }, component, reach }
    }

    /// Which of the six.
    pub fn component(&self) -> Component {
        self.component
    }

    pub(super) fn coordinate(&self) -> &RelativeCoordinate {
        &self.seen
    }

    pub(super) fn reach(&self) -> f64 {
        self.reach
    }

    #[inline]
    pub(super) fn read_into(
        &self,
        model: &Model,
        kinematics: &Kinematics,
        gradient: &mut [f64],
        reading: &mut Reading,
    ) {
        let (coordinate, turn) = self.seen.value(kinematics);
        let rate = gradient_into(model, kinematics, &self.seen, gradient);
        *reading = Reading { coordinate, rate, direction: turn.map_or(Direction::Fixed, Direction::Turn) };
    }

    #[inline]
    pub(super) fn push(&self, pull: Pull, forces: &mut Forces) {
        forces.bushings.push((*self, pull));
    }
}

/// Whether the turn is one that the rotation vector can tell.
pub(super) fn check(turn: Vec3) -> Result<(), NoDirection> {
    let angle = turn.norm();
    if angle < LARGEST_TURN { Ok(()) } else { Err(NoDirection::HalfTurn { angle }) }
}

/// Turns that only half a turn can lie between, or one that cannot be told.
pub(super) fn passed(before: Vec3, after: Vec3) -> Option<NoDirection> {
    let (first, last) = (before.norm(), after.norm());
    let jumped = before.dot(after) < 0.0 && first + last > PI;
    (jumped || check(after).is_err()).then_some(NoDirection::HalfTurn { angle: first.max(last) })
}

impl From<Bushing> for Measure {
    fn from(bushing: Bushing) -> Self {
        Self::Bushing(bushing)
    }
}
