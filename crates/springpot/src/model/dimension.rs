//! What numbers of q and v measure.

/// What a coordinate or a velocity measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// An angle, rad.
    Angle,
    /// A length, m.
    Length,
    /// A component of a quaternion, without unit.
    Quaternion,
}

/// What a coordinate and all that goes with it is written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Units {
    /// Of the coordinate.
    pub coordinate: &'static str,
    /// Of its velocity.
    pub velocity: &'static str,
    /// Of its acceleration.
    pub acceleration: &'static str,
    /// Of the generalized force along it.
    pub force: &'static str,
}

impl Dimension {
    /// The SI units; no velocity and no force belongs to one component of a quaternion.
    pub const fn units(self) -> Units {
        match self {
            Self::Angle => Units { coordinate: "rad", velocity: "rad/s", acceleration: "rad/s^2", force: "N*m" },
            Self::Length => Units { coordinate: "m", velocity: "m/s", acceleration: "m/s^2", force: "N" },
            Self::Quaternion => Units { coordinate: "1", velocity: "", acceleration: "", force: "" },
        }
    }
}
