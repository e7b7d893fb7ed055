//! `[motion]`: its kinds, and the keys of each.

use super::controller::CONTROLLER;
use super::motion::{OUTSIDE, SEPARATOR, START, TIME_COLUMN, TIME_UNIT, of_gripper};
use super::solver::FORWARD_RUNS;
use super::{Each, Keys, Need, Shape, key};

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
            Self::Forward => Row { name: FORWARD_RUNS, words: "forward: forces", along: None },
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
        crate::text::names::either(Self::ALL.iter().filter_map(|kind| kind.row().along))
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
        key(
            "unit",
            Shape::UnitOrByName,
            Need::Said("SI"),
            "Unit of the joints' columns, or a table of units by joint.",
        )
        .only(PRESCRIBED),
        TIME_COLUMN.only(PRESCRIBED),
        TIME_UNIT.only(PRESCRIBED),
        SEPARATOR.only(PRESCRIBED),
        OUTSIDE.only(PRESCRIBED),
        of_gripper("x", GRIPPER_PATH),
        of_gripper("y", GRIPPER_PATH),
        of_gripper("z", GRIPPER_PATH),
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
        key(
            "controller",
            Shape::Table(&CONTROLLER),
            Need::Said("none"),
            "A controller that drives all joints that forces drive.",
        )
        .only(FORWARD),
    ],
};
