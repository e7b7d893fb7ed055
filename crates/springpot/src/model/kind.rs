//! The kinds of joint, each one row: what it is called, what it asks for, and the chain of elementary joints that it is.
//!
//! A kind whose coordinates are numbers is a chain of turns and shifts, one for each, on links without mass but the last. A new
//! kind of that sort is a variant, a row, and nothing else.

use super::dimension::Dimension;

/// Most coordinates of a joint whose coordinates are numbers.
pub const MOST_COORDINATES: usize = 3;

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
    /// One angle about the axis, along which the joint advances by the lead in each turn.
    Helical,
    /// A displacement z along the axis and an angle rz about it.
    Cylindrical,
    /// An angle about the axis, which is fixed in the parent, then one about the second axis, which is fixed in the body.
    Universal,
    /// Displacements x and y square to the axis, in the parent, then an angle rz about it.
    Planar,
    /// Free to turn. Four coordinates, a quaternion qx, qy, qz, qw; three velocities, angular, in the body's own axes.
    Spherical,
    /// Free in all six directions. Seven coordinates: the origin x, y, z in the parent's frame, then a quaternion qx, qy, qz,
    /// qw; six velocities: linear, then angular, both in the body's own axes.
    Floating,
}

/// The values that the coordinates of a joint have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Space {
    /// One number.
    Line(Dimension),
    /// One angle; angles a full turn apart are the same configuration.
    Circle,
    /// A quaternion qx, qy, qz, qw; three velocities, angular.
    Attitude,
    /// The origin x, y, z and a quaternion qx, qy, qz, qw; six velocities, linear and angular.
    Pose,
}

/// A number of q or v of a joint: what follows the joint's name after a dot, and what it measures.
pub type Component = (&'static str, Dimension);

const POSE: [Component; 7] = [
    ("x", Dimension::Length),
    ("y", Dimension::Length),
    ("z", Dimension::Length),
    ("qx", Dimension::Quaternion),
    ("qy", Dimension::Quaternion),
    ("qz", Dimension::Quaternion),
    ("qw", Dimension::Quaternion),
];
const TWIST: [Component; 6] = [
    ("vx", Dimension::Length),
    ("vy", Dimension::Length),
    ("vz", Dimension::Length),
    ("wx", Dimension::Angle),
    ("wy", Dimension::Angle),
    ("wz", Dimension::Angle),
];

impl Space {
    /// What its one coordinate measures; `None` where there are several.
    pub const fn dimension(self) -> Option<Dimension> {
        match self {
            Self::Line(dimension) => Some(dimension),
            Self::Circle => Some(Dimension::Angle),
            Self::Attitude | Self::Pose => None,
        }
    }

    /// Its coordinates, where there are several.
    pub const fn coordinates(self) -> &'static [Component] {
        match self {
            Self::Line(_) | Self::Circle => &[],
            Self::Attitude => POSE.split_at(3).1,
            Self::Pose => &POSE,
        }
    }

    /// Its velocities, where there are several.
    pub const fn velocities(self) -> &'static [Component] {
        match self {
            Self::Line(_) | Self::Circle => &[],
            Self::Attitude => TWIST.split_at(3).1,
            Self::Pose => &TWIST,
        }
    }

    /// Number of coordinates.
    pub const fn nq(self) -> usize {
        if self.dimension().is_some() { 1 } else { self.coordinates().len() }
    }

    /// Number of velocities.
    pub const fn nv(self) -> usize {
        if self.dimension().is_some() { 1 } else { self.velocities().len() }
    }

    /// Which of its coordinates the quaternion starts at; those before it are shifts.
    pub const fn quaternion(self) -> Option<usize> {
        match self {
            Self::Line(_) | Self::Circle => None,
            Self::Attitude => Some(0),
            Self::Pose => Some(3),
        }
    }
}

/// How a joint of a chain moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Move {
    /// A turn about the axis.
    Turn,
    /// A shift along the axis.
    Shift,
    /// A turn about the axis with a shift along it, by the lead in each turn.
    Screw,
    /// All turns.
    Ball,
    /// All shifts and turns.
    Pose,
}

/// What an elementary joint turns about or shifts along, in the joint's frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Along {
    /// All axes of the frame.
    Frame,
    /// `axis`.
    Axis,
    /// `axis2`.
    Axis2,
    /// x (0) or y (1), turned by the shortest turn that leads z to `axis`.
    Across(usize),
}

/// A joint of a chain, on a link of its own.
#[derive(Debug, Clone, Copy)]
pub(super) struct Elementary {
    /// What follows the joint's name and a dot in the name of the coordinate; empty where the chain has no other joint.
    pub(super) coordinate: &'static str,
    /// The same of the velocity.
    pub(super) velocity: &'static str,
    pub(super) moves: Move,
    pub(super) along: Along,
    pub(super) space: Space,
}

/// Whether a kind has an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AxisNeed {
    /// It has none.
    None,
    /// It must be given.
    Required,
    /// It is z where it is not given.
    Z,
}

/// A kind of joint.
struct Row {
    name: &'static str,
    chain: &'static [Elementary],
    axis: AxisNeed,
    has_axis2: bool,
    has_lead: bool,
    /// What it does, after "a joint of this kind".
    says: &'static str,
}

const ANGLE: Space = Space::Line(Dimension::Angle);
const LENGTH: Space = Space::Line(Dimension::Length);

const fn only(moves: Move, along: Along, space: Space) -> Elementary {
    Elementary { coordinate: "", velocity: "", moves, along, space }
}

const fn turn(coordinate: &'static str, velocity: &'static str, along: Along) -> Elementary {
    Elementary { coordinate, velocity, moves: Move::Turn, along, space: ANGLE }
}

const fn shift(coordinate: &'static str, velocity: &'static str, along: Along) -> Elementary {
    Elementary { coordinate, velocity, moves: Move::Shift, along, space: LENGTH }
}

impl Row {
    const fn new(name: &'static str, says: &'static str, axis: AxisNeed, chain: &'static [Elementary]) -> Self {
        Self { name, chain, axis, has_axis2: false, has_lead: false, says }
    }
}

const FIXED: Row = Row::new("fixed", "does not move", AxisNeed::None, &[]);
const REVOLUTE: Row =
    Row::new("revolute", "turns about its axis", AxisNeed::Required, &[only(Move::Turn, Along::Axis, ANGLE)]);
const CONTINUOUS: Row = Row::new(
    "continuous",
    "turns about its axis without end",
    AxisNeed::Required,
    &[only(Move::Turn, Along::Axis, Space::Circle)],
);
const PRISMATIC: Row =
    Row::new("prismatic", "shifts along its axis", AxisNeed::Required, &[only(Move::Shift, Along::Axis, LENGTH)]);
const HELICAL: Row = Row {
    has_lead: true,
    ..Row::new(
        "helical",
        "turns about its axis and advances along it by its lead in each turn",
        AxisNeed::Required,
        &[only(Move::Screw, Along::Axis, ANGLE)],
    )
};
const CYLINDRICAL: Row = Row::new(
    "cylindrical",
    "shifts along its axis and turns about it",
    AxisNeed::Required,
    &[shift("z", "vz", Along::Axis), turn("rz", "wz", Along::Axis)],
);
const UNIVERSAL: Row = Row {
    has_axis2: true,
    ..Row::new(
        "universal",
        "turns about an axis of the parent and one of the body",
        AxisNeed::Required,
        &[turn("first", "first", Along::Axis), turn("second", "second", Along::Axis2)],
    )
};
const PLANAR: Row = Row::new(
    "planar",
    "shifts square to its axis and turns about it",
    AxisNeed::Z,
    &[shift("x", "vx", Along::Across(0)), shift("y", "vy", Along::Across(1)), turn("rz", "wz", Along::Axis)],
);
const SPHERICAL: Row = Row::new(
    "spherical",
    "turns freely about its origin",
    AxisNeed::None,
    &[only(Move::Ball, Along::Frame, Space::Attitude)],
);
const FLOATING: Row = Row::new(
    "floating",
    "moves freely in all six directions",
    AxisNeed::None,
    &[only(Move::Pose, Along::Frame, Space::Pose)],
);

impl JointKind {
    /// Every kind.
    pub const ALL: [Self; 10] = [
        Self::Fixed,
        Self::Revolute,
        Self::Continuous,
        Self::Prismatic,
        Self::Helical,
        Self::Cylindrical,
        Self::Universal,
        Self::Planar,
        Self::Spherical,
        Self::Floating,
    ];

    const fn row(self) -> &'static Row {
        match self {
            Self::Fixed => &FIXED,
            Self::Revolute => &REVOLUTE,
            Self::Continuous => &CONTINUOUS,
            Self::Prismatic => &PRISMATIC,
            Self::Helical => &HELICAL,
            Self::Cylindrical => &CYLINDRICAL,
            Self::Universal => &UNIVERSAL,
            Self::Planar => &PLANAR,
            Self::Spherical => &SPHERICAL,
            Self::Floating => &FLOATING,
        }
    }

    /// Its name in scenario files and in URDF.
    pub const fn name(self) -> &'static str {
        self.row().name
    }

    /// The kind called `name`.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// What it does, after "a … joint".
    pub const fn says(self) -> &'static str {
        self.row().says
    }

    /// What its coordinate measures, if it has one alone.
    pub const fn dimension(self) -> Option<Dimension> {
        match self.row().chain {
            [only] => only.space.dimension(),
            _ => None,
        }
    }

    /// Its coordinates that are numbers: what follows the joint's name and a dot (nothing, if there is one alone), and what it
    /// measures. Joints that turn freely have none.
    pub fn numbers(self) -> impl Iterator<Item = Component> + Clone {
        self.row().chain.iter().filter_map(|joint| Some((joint.coordinate, joint.space.dimension()?)))
    }

    /// What follows the joint's name and a dot in the names of the velocities of [`Self::numbers`].
    pub fn rates(self) -> impl Iterator<Item = &'static str> + Clone {
        self.row().chain.iter().filter(|joint| joint.space.dimension().is_some()).map(|joint| joint.velocity)
    }

    /// Number of coordinates.
    pub fn nq(self) -> usize {
        self.row().chain.iter().map(|joint| joint.space.nq()).sum()
    }

    /// Number of velocities.
    pub fn nv(self) -> usize {
        self.row().chain.iter().map(|joint| joint.space.nv()).sum()
    }

    /// Whether the joint has an axis that the description gives.
    pub const fn has_axis(self) -> bool {
        !matches!(self.axis(), AxisNeed::None)
    }

    /// Whether, and how, the joint asks for an axis.
    pub const fn axis(self) -> AxisNeed {
        self.row().axis
    }

    /// Whether the joint has a second axis.
    pub const fn has_axis2(self) -> bool {
        self.row().has_axis2
    }

    /// Whether the joint advances along its axis as it turns.
    pub const fn has_lead(self) -> bool {
        self.row().has_lead
    }

    pub(super) const fn chain(self) -> &'static [Elementary] {
        self.row().chain
    }
}
