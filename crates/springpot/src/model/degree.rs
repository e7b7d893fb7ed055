//! Degrees of freedom: what the columns of Jacobians and mass matrices stand for.

use crate::spatial::{Motion, Vec3};

/// What a joint does in the frame of the link that it moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum JointMotion {
    /// Turns about z.
    Revolute,
    /// Shifts along z.
    Prismatic,
    /// Turns about z and shifts along it, by its pitch.
    Helical,
    /// Turns about x, y and z.
    Spherical,
    /// Shifts along, and turns about, x, y and z.
    Floating,
}

/// An axis of a link's frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Axis {
    X,
    Y,
    Z,
}

/// The motion that one degree of freedom gives to its link, through the origin of the link's frame and fixed in that frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum DegreeMotion {
    /// A turn about the axis.
    Turn(Axis),
    /// A shift along the axis.
    Shift(Axis),
    /// A turn about z with a shift along it, by the pitch of its joint.
    Screw,
}

impl DegreeMotion {
    /// The axis.
    #[inline]
    pub(crate) const fn axis(self) -> Axis {
        match self {
            Self::Turn(axis) | Self::Shift(axis) => axis,
            Self::Screw => Axis::Z,
        }
    }
}

impl Degree {
    /// The motion of the link at unit velocity, in its own frame; `pitch` is that of its joint.
    pub(crate) fn unit(&self, pitch: f64) -> Motion {
        let along = match self.motion.axis() {
            Axis::X => Vec3([1.0, 0.0, 0.0]),
            Axis::Y => Vec3([0.0, 1.0, 0.0]),
            Axis::Z => Vec3([0.0, 0.0, 1.0]),
        };
        match self.motion {
            DegreeMotion::Turn(_) => Motion { angular: along, ..Motion::ZERO },
            DegreeMotion::Shift(_) => Motion { linear: along, ..Motion::ZERO },
            DegreeMotion::Screw => Motion { angular: along, linear: along * pitch },
        }
    }
}

/// One degree of freedom of a joint.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Degree {
    /// The link that it moves.
    pub(crate) link: usize,
    pub(crate) motion: DegreeMotion,
    /// Its velocity is ratio · v\[index\]; several degrees share an index where joints follow one another.
    pub(crate) index: usize,
    pub(crate) ratio: f64,
}

/// Where a joint finds its coordinates in q and its velocities in v.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Coordinates {
    /// First of its coordinates in q.
    pub(crate) q: usize,
    /// First of its velocities in v.
    pub(crate) v: usize,
    /// A joint of one degree stands at ratio · q + offset.
    pub(crate) ratio: f64,
    pub(crate) offset: f64,
}

impl JointMotion {
    /// The degrees of freedom in the order of v.
    pub(crate) fn degrees(self) -> Vec<DegreeMotion> {
        use DegreeMotion::{Screw, Shift, Turn};
        match self {
            Self::Revolute => vec![Turn(Axis::Z)],
            Self::Prismatic => vec![Shift(Axis::Z)],
            Self::Helical => vec![Screw],
            Self::Spherical => vec![Turn(Axis::X), Turn(Axis::Y), Turn(Axis::Z)],
            Self::Floating => {
                vec![Shift(Axis::X), Shift(Axis::Y), Shift(Axis::Z), Turn(Axis::X), Turn(Axis::Y), Turn(Axis::Z)]
            }
        }
    }
}
