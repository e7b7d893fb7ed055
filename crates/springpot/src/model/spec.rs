//! The robot as it is described.

use super::kind::{Along, JointKind, MOST_COORDINATES, Move, Space};
use crate::spatial::{Rotation, Vec3};

/// Where a body hangs: on the world or on an earlier body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parent {
    /// The inertial frame.
    World,
    /// Index of an earlier body of the builder.
    Body(usize),
}

/// What a coordinate of a joint is built for; the algorithms do not enforce it. Infinite where there is no limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Smallest coordinate, rad or m.
    pub lower: f64,
    /// Largest coordinate, rad or m.
    pub upper: f64,
    /// Largest speed, rad/s or m/s.
    pub velocity: f64,
    /// Largest actuator force, N·m or N.
    pub effort: f64,
}

impl Limits {
    /// No limits.
    pub const NONE: Self =
        Self { lower: f64::NEG_INFINITY, upper: f64::INFINITY, velocity: f64::INFINITY, effort: f64::INFINITY };
}

/// Speed at which smooth friction has reached 76 % of its value where nothing else is said, rad/s or m/s.
pub const FRICTION_SPEED: f64 = 1e-3;

/// What Coulomb friction of the value f does at and near rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FrictionLaw {
    /// f·tanh(v/speed), smooth: nothing is ever held, and a load below f creeps at speed·artanh(load/f).
    Smooth {
        /// Speed at which it has reached 76 % of f, rad/s or m/s, positive.
        speed: f64,
    },
    /// Coulomb's law as it stands: f·sign(v) where the joint slides; at rest whatever holds it there, up to f.
    Sticking,
}

impl Default for FrictionLaw {
    /// Smooth, at [`FRICTION_SPEED`].
    fn default() -> Self {
        Self::Smooth { speed: FRICTION_SPEED }
    }
}

/// A joint of one coordinate that follows another one: coordinate = multiplier · coordinate of `joint` + offset.
#[derive(Debug, Clone, PartialEq)]
pub struct Mimic {
    /// Name of the joint that it follows; of one of several coordinates with the coordinate's, "c.rz".
    pub joint: String,
    /// Ratio of the two speeds.
    pub multiplier: f64,
    /// Its coordinate where the other one's is 0, rad or m.
    pub offset: f64,
}

/// A joint as it is described: pose of the joint frame in the parent's joint frame, then motion about or along `axis`.
#[derive(Debug, Clone, PartialEq)]
pub struct JointSpec {
    /// Unique name.
    pub name: String,
    /// Kind of motion.
    pub kind: JointKind,
    /// Axis in the joint frame (any length but zero; without meaning where [`JointKind::has_axis`] says no).
    pub axis: [f64; 3],
    /// Second axis, fixed in the body, in the joint frame where all coordinates are 0 (of any length but zero, not parallel to the
    /// first; without meaning where [`JointKind::has_axis2`] says no).
    pub axis2: [f64; 3],
    /// Advance along the axis in each turn, m, not 0 (without meaning where [`JointKind::has_lead`] says no).
    pub lead: f64,
    /// Origin of the joint frame in the parent's joint frame, m.
    pub origin: [f64; 3],
    /// Roll, pitch, yaw of the joint frame in the parent's (R = Rz(yaw) Ry(pitch) Rx(roll)), rad.
    pub rpy: [f64; 3],
    // Of each coordinate that is a number, in the order of q.
    /// Viscous damping, N·m·s/rad or N·s/m, 0 or more.
    pub damping: [f64; MOST_COORDINATES],
    /// Coulomb friction, N·m or N, 0 or more.
    pub friction: [f64; MOST_COORDINATES],
    /// What friction does at and near rest.
    pub friction_law: [FrictionLaw; MOST_COORDINATES],
    /// Inertia of the rotor as felt along the coordinate, kg·m² or kg, 0 or more.
    pub armature: [f64; MOST_COORDINATES],
    /// Inertia felt along each velocity of a joint without numbers for coordinates, kg·m² and kg, 0 or more (without meaning for others).
    pub armature_all: f64,
    /// What it is built for.
    pub limits: [Limits; MOST_COORDINATES],
    /// The joint that it follows, if it has no coordinate of its own.
    pub mimic: Option<Mimic>,
}

impl JointSpec {
    /// A revolute joint without rpy, damping, friction and limits.
    pub fn revolute(name: impl Into<String>, axis: [f64; 3], origin: [f64; 3]) -> Self {
        Self::plain(name.into(), JointKind::Revolute, axis, origin)
    }

    /// A prismatic joint without rpy, damping, friction and limits.
    pub fn prismatic(name: impl Into<String>, axis: [f64; 3], origin: [f64; 3]) -> Self {
        Self::plain(name.into(), JointKind::Prismatic, axis, origin)
    }

    /// A fixed joint without rpy.
    pub fn fixed(name: impl Into<String>, origin: [f64; 3]) -> Self {
        Self::plain(name.into(), JointKind::Fixed, [0.0, 0.0, 1.0], origin)
    }

    /// A helical joint that advances by `lead`, m, in each turn, without rpy, damping, friction and limits.
    pub fn helical(name: impl Into<String>, axis: [f64; 3], lead: f64, origin: [f64; 3]) -> Self {
        Self { lead, ..Self::plain(name.into(), JointKind::Helical, axis, origin) }
    }

    /// A cylindrical joint without rpy, damping, friction and limits.
    pub fn cylindrical(name: impl Into<String>, axis: [f64; 3], origin: [f64; 3]) -> Self {
        Self::plain(name.into(), JointKind::Cylindrical, axis, origin)
    }

    /// A universal joint without rpy, damping, friction and limits.
    pub fn universal(name: impl Into<String>, [axis, axis2]: [[f64; 3]; 2], origin: [f64; 3]) -> Self {
        Self { axis2, ..Self::plain(name.into(), JointKind::Universal, axis, origin) }
    }

    /// A planar joint in the plane square to `axis`, without rpy, damping, friction and limits.
    pub fn planar(name: impl Into<String>, axis: [f64; 3], origin: [f64; 3]) -> Self {
        Self::plain(name.into(), JointKind::Planar, axis, origin)
    }

    /// A spherical joint without rpy.
    pub fn spherical(name: impl Into<String>, origin: [f64; 3]) -> Self {
        Self::plain(name.into(), JointKind::Spherical, [0.0, 0.0, 1.0], origin)
    }

    /// A floating joint without rpy.
    pub fn floating(name: impl Into<String>, origin: [f64; 3]) -> Self {
        Self::plain(name.into(), JointKind::Floating, [0.0, 0.0, 1.0], origin)
    }

    fn plain(name: String, kind: JointKind, axis: [f64; 3], origin: [f64; 3]) -> Self {
        Self {
            name,
            kind,
            axis,
            axis2: [0.0; 3],
            lead: 0.0,
            origin,
            rpy: [0.0; 3],
            damping: [0.0; MOST_COORDINATES],
            friction: [0.0; MOST_COORDINATES],
            friction_law: [FrictionLaw::default(); MOST_COORDINATES],
            armature: [0.0; MOST_COORDINATES],
            armature_all: 0.0,
            limits: [Limits::NONE; MOST_COORDINATES],
            mimic: None,
        }
    }
}

/// A joint of the chain that a described joint is: what one coordinate does, or all of a joint that turns freely.
#[derive(Debug, Clone, PartialEq)]
pub struct JointPart {
    /// Name of the coordinate; of the joint, where that has no other number.
    pub name: String,
    /// Name of the velocity, likewise.
    pub velocity: String,
    /// How it moves.
    pub moves: Move,
    /// What it turns about or shifts along, of length 1, in the joint frame where all coordinates are 0.
    pub axis: [f64; 3],
    pub(super) space: Space,
}

impl JointSpec {
    /// The chain that the joint is, from the parent outwards; of a valid joint.
    pub fn parts(&self) -> Vec<JointPart> {
        let called = |part: &str| if part.is_empty() { self.name.clone() } else { format!("{}.{part}", self.name) };
        let chain = self.kind.chain().iter().map(|part| JointPart {
            name: called(part.coordinate),
            velocity: called(part.velocity),
            moves: part.moves,
            axis: match part.along {
                Along::Frame => [0.0, 0.0, 1.0],
                Along::Axis => unit(self.axis).0,
                Along::Axis2 => unit(self.axis2).0,
                Along::Across(side) => Rotation::shortest_from_z(unit(self.axis)).column(side).0,
            },
            space: part.space,
        });
        chain.collect()
    }
}

/// A body as it is described.
#[derive(Debug, Clone, PartialEq)]
pub struct BodySpec {
    /// Unique name.
    pub name: String,
    /// What the joint hangs on.
    pub parent: Parent,
    /// The joint that carries the body.
    pub joint: JointSpec,
    /// Mass, kg.
    pub mass: f64,
    /// Centre of mass in the joint frame, m.
    pub com: [f64; 3],
    /// Inertia tensor about the centre of mass in the joint frame's axes, kg·m² (off-diagonals are tensor components).
    pub inertia: [[f64; 3]; 3],
}

/// A point fixed in a body (or in the world).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anchor {
    /// The body that carries the point.
    pub body: Parent,
    /// The point in the body's joint frame (world frame for the world), m.
    pub point: [f64; 3],
}

/// The direction of a vector that is not zero, safe from overflow and underflow.
pub(super) fn unit(axis: [f64; 3]) -> Vec3 {
    let largest = axis.iter().fold(0.0, |s: f64, x| s.max(x.abs()));
    let scaled = Vec3(axis.map(|x| x / largest));
    let norm = scaled.norm();
    Vec3(scaled.0.map(|x| x / norm))
}
