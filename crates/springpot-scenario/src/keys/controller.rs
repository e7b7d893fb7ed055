//! `[motion.controller]`.

use super::motion::of_gripper;
use super::{Bound, Each, Keys, Need, Shape, key};

/// The kinds of controller.
pub(crate) const PD_GRAVITY: &str = "pd-gravity";
pub(crate) const COMPUTED_TORQUE: &str = "computed-torque";
pub(crate) const PID: &str = "pid";
pub(crate) const FRACTIONAL_PID: &str = "fractional-pid";
pub(crate) const IMPEDANCE: &str = "impedance";

/// The kinds of reference.
pub(crate) const JOINTS: &str = "joints";
pub(crate) const GRIPPER_PATH: &str = "gripper-path";
pub(crate) const MOVE: &str = "move";

/// Profiles of a move.
pub(crate) const QUINTIC: &str = "quintic";
pub(crate) const TRAPEZOID: &str = "trapezoid";

/// What integrals do at a limit.
pub(crate) const CONDITIONAL: &str = "conditional";
pub(crate) const NONE: &str = "none";

fn kinds() -> Vec<(&'static str, &'static str)> {
    vec![
        (PD_GRAVITY, "Proportional–derivative with gravity"),
        (COMPUTED_TORQUE, "inverse dynamics"),
        (PID, "proportional–integral–derivative"),
        (FRACTIONAL_PID, "the same of fractional orders"),
        (IMPEDANCE, "a spring and a dashpot at the gripper"),
    ]
}

/// What drives the joints that forces drive.
pub(crate) static CONTROLLER: Keys = Keys {
    words: "A controller of all joints that forces drive.",
    keys: &[
        key("kind", Shape::Kinds(kinds), Need::Kind, ""),
        key("kp", Shape::ByJointOrNumber, Need::Required("kp = 100"), "Gain of the error e = q_d − q, in its unit."),
        key("kd", Shape::ByJointOrNumber, Need::Number(0.0), "Gain of its rate; of D^mu e where fractional."),
        key("ki", Shape::ByJointOrNumber, Need::Number(0.0), "Gain of its integral; of I^lambda e where fractional.")
            .only(&[PID, FRACTIONAL_PID]),
        key("lambda", Shape::ByJointOrNumber, Need::Number(1.0), "Order of the integral, above 0, at most 1.")
            .only(&[FRACTIONAL_PID]),
        key("mu", Shape::ByJointOrNumber, Need::Number(1.0), "Order of the derivative, above 0, at most 1.")
            .only(&[FRACTIONAL_PID]),
        key(
            "compensate_elements",
            Shape::Flag,
            Need::Flag(false),
            "Whether the generalized forces of the elements are taken off.",
        )
        .only(&[COMPUTED_TORQUE]),
        key(
            "reference",
            Shape::TableWithJoints(&REFERENCE),
            Need::Required("reference = { kind = \"move\", to = { q1 = 0.5 }, duration = \"2 s\" }"),
            "What it follows.",
        ),
        key(
            "limits",
            Shape::ByJoint(Each::Number),
            Need::Said("none"),
            "Largest actuator forces, by joint; they act last.",
        ),
        key(
            "anti_windup",
            Shape::Words(|| vec![CONDITIONAL, NONE]),
            Need::Word(CONDITIONAL),
            "What integrals do while a force is at its limit.",
        )
        .only(&[PID, FRACTIONAL_PID]),
        key(
            "rate_limits",
            Shape::ByJoint(Each::Number),
            Need::Said("none"),
            "Largest rates of the actuator forces, by joint.",
        ),
        key("sample", Shape::Number("s", Bound::Positive), Need::Said("at every time"), "Time between two samples."),
        key(
            "delay",
            Shape::Number("s", Bound::NotNegative),
            Need::Number(0.0),
            "Time from a sample to when it acts: a multiple of `sample`.",
        ),
    ],
};

fn references() -> Vec<(&'static str, &'static str)> {
    vec![(JOINTS, "Signals of joints"), (GRIPPER_PATH, "a path of the gripper"), (MOVE, "a move from point to point")]
}

/// What a controller follows; of signals of joints, these stand beside `kind` by name.
pub(crate) static REFERENCE: Keys = Keys {
    words: "What a controller follows.",
    keys: &[
        key("kind", Shape::Kinds(references), Need::Kind, ""),
        of_gripper("x", &[GRIPPER_PATH]),
        of_gripper("y", &[GRIPPER_PATH]),
        of_gripper("z", &[GRIPPER_PATH]),
        key(
            "rpy",
            Shape::Signals("rad"),
            Need::Said("orientation free"),
            "Roll, pitch, yaw of the gripper's body in the world.",
        )
        .only(&[GRIPPER_PATH]),
        key(
            "guess",
            Shape::ByJoint(Each::Coordinate),
            Need::Said("where the robot starts"),
            "Coordinates near the start, which choose the branch.",
        )
        .only(&[GRIPPER_PATH]),
        key(
            "to",
            Shape::ByJoint(Each::Coordinate),
            Need::Required("to = { q1 = 0.5 }: where joints end"),
            "Where joints go from where the robot starts; those left out stay.",
        )
        .only(&[MOVE]),
        key(
            "duration",
            Shape::Number("s", Bound::Positive),
            Need::Required("duration = \"2 s\""),
            "How long it takes; it stays there.",
        )
        .only(&[MOVE]),
        key(
            "profile",
            Shape::Words(|| vec![QUINTIC, TRAPEZOID]),
            Need::Word(QUINTIC),
            "At rest with no acceleration at both ends, or thirds of constant acceleration, velocity and deceleration.",
        )
        .only(&[MOVE]),
    ],
};
