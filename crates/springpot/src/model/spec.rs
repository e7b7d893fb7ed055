//! The robot as it is described.

use super::degree::JointMotion;
use super::dimension::Dimension;

/// Where a body hangs: on the world or on an earlier body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parent {
    /// The inertial frame.
    World,
    /// Index of an earlier body of the builder.
    Body(usize),
}

/// The values that the coordinates of a joint have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Space {
    /// No coordinate.
    Point,
    /// One number.
    Line(Dimension),
    /// One angle; angles a full turn apart are the same configuration.
    Circle,
    /// The origin x, y, z and a quaternion qx, qy, qz, qw; six velocities, linear and angular.
    Pose,
}

/// The kinds of joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum JointKind {
    /// No coordinate.
    Fixed,
    /// One angle about the axis.
    Revolute,
    /// One angle about the axis, without limits: angles a full turn apart are the same configuration.
    Continuous,
    /// One displacement along the axis.
    Prismatic,
    /// Free in all six directions. Seven coordinates: the origin x, y, z in the parent's frame, then a quaternion qx, qy, qz,
    /// qw; six velocities: linear, then angular, both in the body's own axes.
    Floating,
}

impl JointKind {
    /// Every kind.
    pub const ALL: [Self; 5] = [Self::Fixed, Self::Revolute, Self::Continuous, Self::Prismatic, Self::Floating];

    /// Its name in scenario files and in URDF.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fixed => "fixed",
            Self::Revolute => "revolute",
            Self::Continuous => "continuous",
            Self::Prismatic => "prismatic",
            Self::Floating => "floating",
        }
    }

    /// What its coordinates may be.
    pub const fn space(self) -> Space {
        match self {
            Self::Fixed => Space::Point,
            Self::Revolute => Space::Line(Dimension::Angle),
            Self::Continuous => Space::Circle,
            Self::Prismatic => Space::Line(Dimension::Length),
            Self::Floating => Space::Pose,
        }
    }

    /// What its coordinate measures, if it has one alone.
    pub const fn dimension(self) -> Option<Dimension> {
        match self.space() {
            Space::Line(dimension) => Some(dimension),
            Space::Circle => Some(Dimension::Angle),
            Space::Point | Space::Pose => None,
        }
    }

    /// Number of coordinates.
    pub const fn nq(self) -> usize {
        match self.space() {
            Space::Point => 0,
            Space::Line(_) | Space::Circle => 1,
            Space::Pose => 7,
        }
    }

    /// Number of velocities.
    pub const fn nv(self) -> usize {
        match self.space() {
            Space::Point => 0,
            Space::Line(_) | Space::Circle => 1,
            Space::Pose => 6,
        }
    }

    /// Whether the joint turns about, or shifts along, an axis that the description must give.
    pub const fn has_axis(self) -> bool {
        self.nv() == 1
    }
}

/// What a joint is built for; the algorithms do not enforce it. Infinite where there is no limit.
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

/// A joint of one degree that follows another one: coordinate = multiplier · coordinate of `joint` + offset.
#[derive(Debug, Clone, PartialEq)]
pub struct Mimic {
    /// Name of the joint that it follows.
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
    /// Origin of the joint frame in the parent's joint frame, m.
    pub origin: [f64; 3],
    /// Roll, pitch, yaw of the joint frame in the parent's (R = Rz(yaw) Ry(pitch) Rx(roll)), rad.
    pub rpy: [f64; 3],
    /// Viscous damping, N·m·s/rad or N·s/m, 0 or more.
    pub damping: f64,
    /// Coulomb friction, N·m or N, 0 or more.
    pub friction: f64,
    /// What friction does at and near rest.
    pub friction_law: FrictionLaw,
    /// What it is built for.
    pub limits: Limits,
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

    /// A floating joint without rpy.
    pub fn floating(name: impl Into<String>, origin: [f64; 3]) -> Self {
        Self::plain(name.into(), JointKind::Floating, [0.0, 0.0, 1.0], origin)
    }

    /// How it moves its body; `None` where it does not.
    pub(super) const fn motion(&self) -> Option<JointMotion> {
        match self.kind {
            JointKind::Fixed => None,
            JointKind::Revolute | JointKind::Continuous => Some(JointMotion::Revolute),
            JointKind::Prismatic => Some(JointMotion::Prismatic),
            JointKind::Floating => Some(JointMotion::Floating),
        }
    }

    fn plain(name: String, kind: JointKind, axis: [f64; 3], origin: [f64; 3]) -> Self {
        Self {
            name,
            kind,
            axis,
            origin,
            rpy: [0.0; 3],
            damping: 0.0,
            friction: 0.0,
            friction_law: FrictionLaw::default(),
            limits: Limits::NONE,
            mimic: None,
        }
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
