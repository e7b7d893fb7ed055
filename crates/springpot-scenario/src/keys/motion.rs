//! `[motion]` and signals.

use super::super::names;
use super::{Bound, Each, Key, Keys, Need, Shape, key};

/// A kind of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum MotionKind {
    Prescribed,
    GripperPath,
    Forward,
}

/// What is said of a kind of motion.
struct Row {
    name: &'static str,
    /// What it is, in a list of all kinds.
    words: &'static str,
    /// What its runs go along, where that is given in advance.
    along: Option<&'static str>,
}

impl MotionKind {
    /// In the order in which messages list them.
    pub(crate) const ALL: &'static [Self] = &[Self::Prescribed, Self::GripperPath, Self::Forward];

    const fn row(self) -> Row {
        match self {
            Self::Prescribed => {
                Row { name: "prescribed", words: "Prescribed joints", along: Some("a prescribed motion") }
            }
            Self::GripperPath => {
                Row { name: "gripper-path", words: "a path of the gripper", along: Some("a gripper path") }
            }
            Self::Forward => Row { name: "forward", words: "forward: forces", along: None },
        }
    }

    /// As scenarios name it.
    pub(crate) const fn name(self) -> &'static str {
        self.row().name
    }

    /// The kind of that name.
    pub(crate) fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|kind| kind.name() == name)
    }

    /// What runs go along whose motion is given in advance.
    pub(crate) fn given() -> String {
        names::either(Self::ALL.iter().filter_map(|kind| kind.row().along))
    }
}

const PRESCRIBED: &[&str] = &[MotionKind::Prescribed.name()];
const GRIPPER_PATH: &[&str] = &[MotionKind::GripperPath.name()];
const FORWARD: &[&str] = &[MotionKind::Forward.name()];

/// The kinds of it that `only` knows are the kinds of motion.
pub(crate) static MOTION: Keys = Keys {
    words: "What moves the robot.",
    keys: &[
        key(
            "kind",
            Shape::Kinds(|| MotionKind::ALL.iter().map(|kind| (kind.name(), kind.row().words)).collect()),
            Need::Kind,
            "",
        ),
        key("joints", Shape::ByJoint(Each::Path), Need::OneOf, "How every joint moves.").only(PRESCRIBED),
        key("csv", Shape::Text, Need::OneOf, "A CSV file with the column t and one column for every joint, SI.")
            .only(PRESCRIBED),
        coordinate("x").only(GRIPPER_PATH),
        coordinate("y").only(GRIPPER_PATH),
        coordinate("z").only(GRIPPER_PATH),
        key(
            "rpy",
            Shape::Signals("rad"),
            Need::Said("orientation free"),
            "Roll, pitch, yaw of the gripper's body in the world.",
        )
        .only(GRIPPER_PATH),
        key(
            "guess",
            Shape::ByJoint(Each::Coordinate),
            Need::Number(0.0),
            "Coordinates near the start, which choose the branch.",
        )
        .only(GRIPPER_PATH),
        key("start", Shape::Table(&START), Need::Number(0.0), "Where the robot starts, by joint.").only(FORWARD),
        key("torque", Shape::ByJoint(Each::Force), Need::Number(0.0), "Actuator forces.").only(FORWARD),
        key(
            "prescribed",
            Shape::ByJoint(Each::Path),
            Need::Said("none"),
            "Joints that move as said, whatever force that takes.",
        )
        .only(FORWARD),
        key(
            "locked",
            Shape::TextList,
            Need::Said("none"),
            "Joints that stay where they start, whatever force that takes.",
        )
        .only(FORWARD),
    ],
};

const fn coordinate(name: &'static str) -> Key {
    key(
        name,
        Shape::Signal("m"),
        Need::Required("a signal for each of x, y and z (in m)"),
        "Coordinate of the gripper in the world.",
    )
}

/// A signal that is a table.
pub(crate) static SIGNAL: Keys = Keys {
    words: "An expression with its unit, or a column of a CSV file.",
    keys: &[
        key("expression", Shape::Text, Need::OneOf, "An expression of t (in s), such as \"25 + 5*sin(t)\"."),
        key(
            "csv",
            Shape::Text,
            Need::OneOf,
            "Path of a CSV file with a column t in seconds, relative to the scenario.",
        ),
        key("column", Shape::Text, Need::Optional, "Column of the CSV file."),
        key("unit", Shape::Text, Need::Said("SI"), "Unit of the values."),
    ],
};

const OF_FRAME: &str = "Coordinate of the joint's frame.";
const NO_TURN: &str = "Roll, pitch, yaw.";

const fn path(name: &'static str) -> Key {
    key(name, Shape::Signal("m"), Need::Number(0.0), OF_FRAME)
}

/// How a floating joint moves.
pub(crate) static POSE: Keys = Keys {
    words: "Where a floating joint is.",
    keys: &[path("x"), path("y"), path("z"), key("rpy", Shape::Signals("rad"), Need::Vector([0.0; 3]), NO_TURN)],
};

pub(crate) static START: Keys = Keys {
    words: "Where the robot starts.",
    keys: &[
        key("q", Shape::ByJoint(Each::NumberOr(&START_POSE)), Need::Number(0.0), "Coordinates, rad or m."),
        key("v", Shape::ByJoint(Each::NumberOr(&START_VELOCITIES)), Need::Number(0.0), "Velocities, rad/s or m/s."),
    ],
};

const fn at(name: &'static str) -> Key {
    key(name, Shape::Number("m", Bound::Any), Need::Number(0.0), OF_FRAME)
}

/// Where a floating joint starts; the keys are those of [`POSE`].
pub(crate) static START_POSE: Keys = Keys {
    words: "Where a floating joint starts.",
    keys: &[at("x"), at("y"), at("z"), key("rpy", Shape::Vector("rad"), Need::Vector([0.0; 3]), NO_TURN)],
};

const fn velocity(name: &'static str) -> Key {
    key(name, Shape::Number("m/s", Bound::Any), Need::Number(0.0), "Velocity.")
}

const fn turning(name: &'static str) -> Key {
    key(name, Shape::Number("rad/s", Bound::Any), Need::Number(0.0), "Angular velocity.")
}

/// Velocities of a floating joint, as in the columns of the results.
pub(crate) static START_VELOCITIES: Keys = Keys {
    words: "How a floating joint starts, in the axes of its body.",
    keys: &[velocity("vx"), velocity("vy"), velocity("vz"), turning("wx"), turning("wy"), turning("wz")],
};

const fn force(name: &'static str) -> Key {
    key(name, Shape::Signal("N"), Need::Number(0.0), "Force.")
}

const fn torque(name: &'static str) -> Key {
    key(name, Shape::Signal("N*m"), Need::Number(0.0), "Torque.")
}

/// What acts on a floating joint; the keys are those of [`START_VELOCITIES`].
pub(crate) static FORCES: Keys = Keys {
    words: "Forces and torques on a floating joint, in the axes of its body.",
    keys: &[force("vx"), force("vy"), force("vz"), torque("wx"), torque("wy"), torque("wz")],
};
