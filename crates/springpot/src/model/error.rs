//! What can be wrong with the description of a robot.

use super::kind::JointKind;
use std::fmt;

/// Why a description is not a robot; every message names the place, the value and what would be right.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// There is nothing to move.
    #[error("the robot has no bodies; it needs at least one")]
    NoBodies,

    /// A component of gravity is NaN or infinite.
    #[error("gravity[{component}] is {value}; it must be a finite number of m/s²")]
    GravityNotFinite {
        /// 0, 1, 2 for x, y, z.
        component: usize,
        /// The value.
        value: f64,
    },

    /// The name of a body or of its joint is not an identifier.
    #[error(
        "{field} of body {body} is \"{name}\"; a name starts with a letter or _, then letters, digits, _ and - follow"
    )]
    InvalidName {
        /// Index of the body.
        body: usize,
        /// [`Field::Name`] or [`Field::JointName`].
        field: Field,
        /// The name.
        name: String,
    },

    /// A body is called like the inertial frame.
    #[error("body {body} is called \"world\"; that name belongs to the inertial frame, choose another")]
    ReservedName {
        /// Index of the body.
        body: usize,
    },

    /// Two bodies, or two joints, of one name.
    #[error("{field} \"{name}\" of body {body} is taken by body {first}; names must be unique")]
    DuplicateName {
        /// Index of the later body.
        body: usize,
        /// [`Field::Name`] or [`Field::JointName`].
        field: Field,
        /// The name.
        name: String,
        /// Index of the body that has it.
        first: usize,
    },

    /// The parent is the body itself, a later body or none at all.
    #[error("the parent of body \"{name}\" is body {parent}; it must be the world or an earlier body (below {body})")]
    ParentNotEarlier {
        /// Index of the body.
        body: usize,
        /// Its name.
        name: String,
        /// Index of the parent.
        parent: usize,
    },

    /// A number is NaN or infinite.
    #[error("{field} of body \"{name}\" holds {value}; it must be finite")]
    NotFinite {
        /// Index of the body.
        body: usize,
        /// Its name.
        name: String,
        /// The field.
        field: Field,
        /// The first value that is not finite.
        value: f64,
    },

    /// The axis has no direction.
    #[error("the {} of joint \"{joint}\" is [0, 0, 0]; it must point somewhere, as in [0, 0, 1]", field.last())]
    ZeroAxis {
        /// Index of the body.
        body: usize,
        /// Name of its joint.
        joint: String,
        /// [`Field::Axis`] or [`Field::Axis2`].
        field: Field,
    },

    /// The second axis is parallel to the first, so that both turns are one.
    #[error(
        "the axis2 of joint \"{joint}\" is parallel to its axis; both turns would be the same, choose another direction"
    )]
    ParallelAxes {
        /// Index of the body.
        body: usize,
        /// Name of its joint.
        joint: String,
    },

    /// A helical joint does not advance.
    #[error(
        "the lead of joint \"{joint}\" is 0; a helical joint advances by its lead in each turn (one that does not is revolute)"
    )]
    NoLead {
        /// Index of the body.
        body: usize,
        /// Name of its joint.
        joint: String,
    },

    /// The smallest coordinate of a joint is above the largest.
    #[error("the limits of joint \"{joint}\" are lower = {lower} and upper = {upper}; lower must not be above upper")]
    LimitOrder {
        /// Index of the body.
        body: usize,
        /// Name of its joint.
        joint: String,
        /// The smallest coordinate.
        lower: f64,
        /// The largest.
        upper: f64,
    },

    /// A largest speed or force is not positive.
    #[error("the {} of joint \"{joint}\" is {value}; it must be positive", field.last())]
    LimitNotPositive {
        /// Index of the body.
        body: usize,
        /// Name of its joint.
        joint: String,
        /// [`Field::Velocity`] or [`Field::Effort`].
        field: Field,
        /// The value.
        value: f64,
    },

    /// A mass, damping, friction or armature is below zero.
    #[error("{field} of body \"{name}\" is {value}; it must be 0 or more")]
    Negative {
        /// Index of the body.
        body: usize,
        /// Its name.
        name: String,
        /// [`Field::Mass`], [`Field::Damping`], [`Field::Friction`] or [`Field::Armature`].
        field: Field,
        /// The value.
        value: f64,
    },

    /// The speed of smooth friction is not positive.
    #[error("{} of body \"{name}\" is {speed}; it must be positive", Field::FrictionSpeed)]
    FrictionSpeed {
        /// Index of the body.
        body: usize,
        /// Its name.
        name: String,
        /// The speed, rad/s or m/s.
        speed: f64,
    },

    /// The inertia tensor is not symmetric.
    #[error(
        "inertia of body \"{name}\" is not symmetric: [{row}][{column}] is {upper} but [{column}][{row}] is {lower}"
    )]
    AsymmetricInertia {
        /// Index of the body.
        body: usize,
        /// Its name.
        name: String,
        /// Row of the upper entry.
        row: usize,
        /// Column of the upper entry.
        column: usize,
        /// The upper entry.
        upper: f64,
        /// The lower entry.
        lower: f64,
    },

    /// The inertia tensor has a negative principal moment.
    #[error("inertia of body \"{name}\" has the principal moment {} kg*m^2; all three must be 0 or more", brief(*.smallest))]
    InertiaNotPositive {
        /// Index of the body.
        body: usize,
        /// Its name.
        name: String,
        /// The smallest principal moment.
        smallest: f64,
    },

    /// No distribution of mass has these principal moments.
    #[error(
        "inertia of body \"{name}\" has the principal moment {largest} kg*m^2, above the sum {others} of the other two; \
         no distribution of mass has that"
    )]
    TriangleInequality {
        /// Index of the body.
        body: usize,
        /// Its name.
        name: String,
        /// The largest principal moment.
        largest: f64,
        /// The sum of the other two.
        others: f64,
    },

    /// Numbers that are finite one by one overflow together.
    #[error("the mass, com, inertia or joint origin of body \"{name}\" is so large that the dynamics overflow")]
    Overflow {
        /// Index of the body whose joint's inertia overflows.
        body: usize,
        /// Its name.
        name: String,
    },

    /// The mass matrix is not positive definite: a joint can move without moving any mass.
    #[error(
        "the mass matrix is singular at joint \"{joint}\": it can move without resistance, because body \"{name}\" and what \
         hangs on it have no mass or inertia of their own there; give \"{name}\" a mass or an inertia"
    )]
    SingularMassMatrix {
        /// Index of the body that the joint carries.
        body: usize,
        /// Its name.
        name: String,
        /// Name of the joint.
        joint: String,
    },

    /// The mass matrix has a negative pivot: an inertia that was accepted is negative there.
    #[error(
        "the mass matrix is not positive definite at joint \"{joint}\": body \"{name}\" and what hangs on it resist it with \
         a negative inertia; correct the inertia of these bodies"
    )]
    IndefiniteMassMatrix {
        /// Index of the body that the joint carries.
        body: usize,
        /// Its name.
        name: String,
        /// Name of the joint.
        joint: String,
    },

    /// A joint follows a joint that does not exist or does not move by one degree of freedom.
    #[error("joint \"{joint}\" follows joint \"{followed}\", which {}", if *.exists { "has not exactly one degree of freedom" } else { "does not exist" })]
    MimicTarget {
        /// Index of the body that the joint carries.
        body: usize,
        /// Name of the joint.
        joint: String,
        /// What it follows.
        followed: String,
        /// Whether there is such a joint.
        exists: bool,
    },

    /// A joint of several degrees of freedom follows another one.
    #[error("joint \"{joint}\" is {}, so it cannot follow another joint; only joints of one degree of freedom can", kind.name())]
    MimicKind {
        /// Index of the body that the joint carries.
        body: usize,
        /// Name of the joint.
        joint: String,
        /// What it is.
        kind: JointKind,
    },

    /// Joints follow one another in a circle.
    #[error("joint \"{joint}\" follows itself, directly or through other joints")]
    MimicCycle {
        /// Index of the body that the joint carries.
        body: usize,
        /// Name of the joint.
        joint: String,
    },

    /// An anchor names a body that the robot does not have.
    #[error("the anchor is on body {body}, but the robot has only {count} bodies")]
    NoSuchBody {
        /// The index.
        body: usize,
        /// Number of bodies.
        count: usize,
    },

    /// An anchor's point is NaN or infinite.
    #[error("the anchor's point is {point:?}; it must be finite")]
    AnchorNotFinite {
        /// The point.
        point: [f64; 3],
    },
}

/// `x` to six digits, by powers of ten where it is small or large.
fn brief(x: f64) -> String {
    let rounded: f64 = format!("{x:.5e}").parse().unwrap_or(x);
    if rounded == 0.0 || (1e-3..1e6).contains(&rounded.abs()) { rounded.to_string() } else { format!("{rounded:e}") }
}

/// A field of the description of a body; `Display` writes it as in a scenario file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Field {
    /// `name`
    Name,
    /// `parent`
    Parent,
    /// `joint.name`
    JointName,
    /// `joint.axis`
    Axis,
    /// `joint.axis2`
    Axis2,
    /// `joint.lead`
    Lead,
    /// `joint.lower`
    Lower,
    /// `joint.velocity`
    Velocity,
    /// `joint.effort`
    Effort,
    /// `joint.armature`
    Armature,
    /// `joint.origin`
    Origin,
    /// `joint.rpy`
    Rpy,
    /// `joint.damping`
    Damping,
    /// `joint.friction`
    Friction,
    /// `joint.friction.speed`
    FrictionSpeed,
    /// `joint.mimic`
    Mimic,
    /// `mass`
    Mass,
    /// `com`
    Com,
    /// `inertia`
    Inertia,
}

impl Field {
    /// The dotted key, as in a scenario's `[[robot.body]]`.
    pub fn key(self) -> &'static str {
        match self {
            Self::Name => "name",
            Self::Parent => "parent",
            Self::JointName => "joint.name",
            Self::Axis => "joint.axis",
            Self::Axis2 => "joint.axis2",
            Self::Lead => "joint.lead",
            Self::Lower => "joint.lower",
            Self::Velocity => "joint.velocity",
            Self::Effort => "joint.effort",
            Self::Armature => "joint.armature",
            Self::Origin => "joint.origin",
            Self::Rpy => "joint.rpy",
            Self::Damping => "joint.damping",
            Self::Friction => "joint.friction",
            Self::FrictionSpeed => "joint.friction.speed",
            Self::Mimic => "joint.mimic",
            Self::Mass => "mass",
            Self::Com => "com",
            Self::Inertia => "inertia",
        }
    }
}

impl Field {
    /// The key without its table.
    fn last(self) -> &'static str {
        self.key().rsplit_once('.').map_or(self.key(), |(_, last)| last)
    }
}

impl fmt::Display for Field {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.key())
    }
}

/// The field to blame for a [`ModelError`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Subject {
    /// Index of the body.
    pub body: usize,
    /// Its field.
    pub field: Field,
}

impl ModelError {
    /// Whether it is an inertia that no distribution of mass has, which
    /// [`ModelBuilder::accept_inertia`](super::ModelBuilder::accept_inertia) takes.
    pub fn is_of_no_mass(&self) -> bool {
        matches!(self, Self::InertiaNotPositive { .. } | Self::TriangleInequality { .. })
    }

    /// The body and field to blame; `None` for errors that concern no body of the description (no bodies, gravity, anchors).
    pub fn subject(&self) -> Option<Subject> {
        let (body, field) = match *self {
            Self::NoBodies | Self::GravityNotFinite { .. } | Self::NoSuchBody { .. } | Self::AnchorNotFinite { .. } => {
                return None;
            }
            Self::InvalidName { body, field, .. }
            | Self::DuplicateName { body, field, .. }
            | Self::NotFinite { body, field, .. }
            | Self::ZeroAxis { body, field, .. }
            | Self::LimitNotPositive { body, field, .. }
            | Self::Negative { body, field, .. } => (body, field),
            Self::ParallelAxes { body, .. } => (body, Field::Axis2),
            Self::NoLead { body, .. } => (body, Field::Lead),
            Self::LimitOrder { body, .. } => (body, Field::Lower),
            Self::MimicTarget { body, .. } | Self::MimicKind { body, .. } | Self::MimicCycle { body, .. } => {
                (body, Field::Mimic)
            }
            Self::FrictionSpeed { body, .. } => (body, Field::FrictionSpeed),
            Self::ReservedName { body } => (body, Field::Name),
            Self::ParentNotEarlier { body, .. } => (body, Field::Parent),
            Self::AsymmetricInertia { body, .. }
            | Self::InertiaNotPositive { body, .. }
            | Self::TriangleInequality { body, .. } => (body, Field::Inertia),
            Self::Overflow { body, .. }
            | Self::SingularMassMatrix { body, .. }
            | Self::IndefiniteMassMatrix { body, .. } => (body, Field::Mass),
        };
        Some(Subject { body, field })
    }
}
