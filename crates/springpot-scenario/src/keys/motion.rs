//! Signals, and what motions hold for a joint.

use super::{Bound, Each, Key, Keys, Need, Shape, key};
use springpot::model::JointKind;

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
        key(
            "sample",
            Shape::Number("s", Bound::Positive),
            Need::Said("at every time"),
            "Of feedback: it is taken at so many seconds, and holds in between.",
        ),
        TIME_COLUMN,
        TIME_UNIT,
        SEPARATOR,
        OUTSIDE,
    ],
};

/// How a CSV file is written, beside `csv`.
pub(crate) const TIME_COLUMN: Key = key("time", Shape::Text, Need::Word("t"), "Column of the times.");
pub(crate) const TIME_UNIT: Key = key("time_unit", Shape::Text, Need::Word("s"), "Unit of the times.");
pub(crate) const SEPARATOR: Key = key(
    "separator",
    Shape::Words(|| vec![",", ";", "\t", "|"]),
    Need::Word(","),
    "What stands between cells; with \";\" a comma is the decimal point.",
);
pub(crate) const OUTSIDE: Key = key(
    "outside",
    Shape::Words(|| vec!["refuse", "hold"]),
    Need::Word("refuse"),
    "Before the first row and behind the last: refused, or the nearest value holds.",
);

/// A coordinate of a path of the gripper, of the kinds `only`.
pub(crate) const fn of_gripper(name: &'static str, only: &'static [&'static str]) -> Key {
    key(
        name,
        Shape::Signal("m"),
        Need::Required("a signal for each of x, y and z (in m)"),
        "Coordinate of the gripper in the world.",
    )
    .only(only)
}

/// Joints that turn freely.
pub(crate) const SPHERICAL: JointKind = JointKind::Spherical;
pub(crate) const FLOATING: JointKind = JointKind::Floating;
/// What of them floating joints take alone.
const ALONE: &[&str] = &[FLOATING.name()];

const OF_FRAME: &str = "Coordinate of the joint's frame.";
const NO_TURN: &str = "Roll, pitch, yaw.";

const fn path(name: &'static str) -> Key {
    key(name, Shape::Signal("m"), Need::Number(0.0), OF_FRAME).only(ALONE)
}

/// How a joint that turns freely moves.
pub(crate) static POSE: Keys = Keys {
    words: "Where a floating or spherical joint is.",
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
    key(name, Shape::Number("m", Bound::Any), Need::Number(0.0), OF_FRAME).only(ALONE)
}

/// Where a joint that turns freely starts; the keys are those of [`POSE`].
pub(crate) static START_POSE: Keys = Keys {
    words: "Where a floating or spherical joint starts.",
    keys: &[at("x"), at("y"), at("z"), key("rpy", Shape::Vector("rad"), Need::Vector([0.0; 3]), NO_TURN)],
};

const fn velocity(name: &'static str) -> Key {
    key(name, Shape::Number("m/s", Bound::Any), Need::Number(0.0), "Velocity.").only(ALONE)
}

const fn turning(name: &'static str) -> Key {
    key(name, Shape::Number("rad/s", Bound::Any), Need::Number(0.0), "Angular velocity.")
}

/// Velocities of a joint that turns freely, as in the columns of the results.
pub(crate) static START_VELOCITIES: Keys = Keys {
    words: "How a floating or spherical joint starts, in the axes of its body.",
    keys: &[velocity("vx"), velocity("vy"), velocity("vz"), turning("wx"), turning("wy"), turning("wz")],
};

const fn force(name: &'static str) -> Key {
    key(name, Shape::Signal("N"), Need::Number(0.0), "Force.").only(ALONE)
}

const fn torque(name: &'static str) -> Key {
    key(name, Shape::Signal("N*m"), Need::Number(0.0), "Torque.")
}

/// What acts on a joint that turns freely; the keys are those of [`START_VELOCITIES`].
pub(crate) static FORCES: Keys = Keys {
    words: "Forces and torques on a floating or spherical joint, in the axes of its body.",
    keys: &[force("vx"), force("vy"), force("vz"), torque("wx"), torque("wy"), torque("wz")],
};
