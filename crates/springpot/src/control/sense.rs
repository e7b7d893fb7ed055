//! What feedback sees of the state.

use crate::observe::Axis;

/// One number of the state that feedback may name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sense {
    /// The coordinate of a joint of one degree, by its places in q and in v, rad or m.
    Coordinate {
        /// Place in q.
        place: usize,
        /// Place in v.
        velocity: usize,
    },
    /// A coordinate of a joint of several that move together, floating or spherical, by its place in q, m or a number of a quaternion.
    Part {
        /// Place in q.
        place: usize,
        /// The joint of the model.
        joint: usize,
    },
    /// A velocity, rad/s or m/s.
    Velocity(usize),
    /// Coordinate y of an element, m or rad.
    Length(usize),
    /// Stroke of an element, m or rad.
    Stroke(usize),
    /// Rate of an element, m/s or rad/s.
    Rate(usize),
    /// A coordinate of the gripper, m.
    Gripper(Axis),
    /// A velocity of the gripper, m/s.
    GripperVelocity(Axis),
    /// An acceleration, rad/s² or m/s²: sampled feedback alone.
    Acceleration(usize),
    /// Force of an element, N or N·m: sampled feedback alone.
    Force(usize),
    /// D^alpha x of an element: sampled feedback alone.
    Derivative(usize),
}

impl Sense {
    /// The same of another robot whose joints all have one degree, by the places of coordinates and velocities there.
    pub(crate) fn of_robot(self, [coordinates, velocities]: [&[usize]; 2]) -> Self {
        match self {
            Self::Coordinate { place, velocity } => {
                Self::Coordinate { place: coordinates[place], velocity: velocities[velocity] }
            }
            Self::Velocity(k) => Self::Velocity(velocities[k]),
            Self::Acceleration(k) => Self::Acceleration(velocities[k]),
            other => other,
        }
    }

    /// Whether it follows from forces, so that it is known only after a step: for sampled feedback alone.
    pub fn follows_from_forces(self) -> bool {
        matches!(self, Self::Acceleration(_) | Self::Force(_) | Self::Derivative(_))
    }

    /// Whether it is a place: how fast it changes hangs on no acceleration.
    pub fn is_place(self) -> bool {
        matches!(
            self,
            Self::Coordinate { .. } | Self::Part { .. } | Self::Length(_) | Self::Stroke(_) | Self::Gripper(_)
        )
    }
}
