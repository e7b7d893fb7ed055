//! The robot as it is described.

/// Where a body hangs: on the world or on an earlier body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parent {
    /// The inertial frame.
    World,
    /// Index of an earlier body of the builder.
    Body(usize),
}

/// The kinds of joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    /// No coordinate.
    Fixed,
    /// One angle about the axis.
    Revolute,
    /// One displacement along the axis.
    Prismatic,
}

/// A joint as it is described: pose of the joint frame in the parent's joint frame, then motion about or along `axis`.
#[derive(Debug, Clone, PartialEq)]
pub struct JointSpec {
    /// Unique name.
    pub name: String,
    /// Kind of motion.
    pub kind: JointKind,
    /// Axis in the joint frame (any length but zero; without meaning for a fixed joint).
    pub axis: [f64; 3],
    /// Origin of the joint frame in the parent's joint frame, m.
    pub origin: [f64; 3],
    /// Roll, pitch, yaw of the joint frame in the parent's (R = Rz(yaw) Ry(pitch) Rx(roll)), rad.
    pub rpy: [f64; 3],
    /// Viscous damping, N·m·s/rad or N·s/m, 0 or more.
    pub damping: f64,
    /// Coulomb friction, N·m or N, 0 or more.
    pub friction: f64,
}

impl JointSpec {
    /// A revolute joint without rpy, damping and friction.
    pub fn revolute(name: impl Into<String>, axis: [f64; 3], origin: [f64; 3]) -> Self {
        Self::plain(name.into(), JointKind::Revolute, axis, origin)
    }

    /// A prismatic joint without rpy, damping and friction.
    pub fn prismatic(name: impl Into<String>, axis: [f64; 3], origin: [f64; 3]) -> Self {
        Self::plain(name.into(), JointKind::Prismatic, axis, origin)
    }

    /// A fixed joint without rpy.
    pub fn fixed(name: impl Into<String>, origin: [f64; 3]) -> Self {
        Self::plain(name.into(), JointKind::Fixed, [0.0, 0.0, 1.0], origin)
    }

    fn plain(name: String, kind: JointKind, axis: [f64; 3], origin: [f64; 3]) -> Self {
        Self { name, kind, axis, origin, rpy: [0.0; 3], damping: 0.0, friction: 0.0 }
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
