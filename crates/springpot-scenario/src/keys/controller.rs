//! `[motion.controller]`.

use super::motion::of_gripper;
use super::{Bound, Each, Keys, Need, Shape, key};
use springpot::control::{ComputedTorque, Controller, Impedance, PdGravity, Pid};
use std::sync::Arc;

const PD_GRAVITY: &str = "pd-gravity";
const COMPUTED_TORQUE: &str = "computed-torque";
const PID: &str = "pid";
const FRACTIONAL_PID: &str = "fractional-pid";

/// A kind of controller: its name, what it takes, and the law that it is.
#[derive(Debug)]
pub(crate) struct ControllerKind {
    pub(crate) name: &'static str,
    /// In the list of kinds.
    words: &'static str,
    /// Where its gains act, and their units.
    pub(crate) gains: Gains,
    /// Whether lambda and mu are its own; else they are 1.
    pub(crate) has_orders: bool,
    /// Whether it can take the elements' generalized forces off.
    pub(crate) compensates: bool,
    /// Whether it asks for the accelerations of all joints, which must have one degree then.
    pub(crate) drives_all: bool,
    /// What it does where all gains are 0.
    pub(crate) without_gains: &'static str,
    /// The law of what was read.
    pub(crate) law: fn(Gained) -> Arc<dyn Controller>,
}

/// Units of gains: of kp, kd and, where there is an integral, ki.
#[derive(Debug)]
pub(crate) enum Gains {
    /// By joint: of joints that turn, and that slide.
    OfJoints([&'static [&'static str]; 2]),
    /// At the gripper.
    AtGripper([&'static str; 2]),
}

/// What was read of a controller: numbers by velocity (nv), or one at the gripper.
#[derive(Debug, Default)]
pub(crate) struct Gained {
    pub(crate) kp: Vec<f64>,
    pub(crate) kd: Vec<f64>,
    pub(crate) ki: Vec<f64>,
    pub(crate) lambda: Vec<f64>,
    pub(crate) mu: Vec<f64>,
    pub(crate) compensate_elements: bool,
}

const OF_FORCES: Gains = Gains::OfJoints([&["N*m/rad", "N*m*s/rad"], &["N/m", "N*s/m"]]);
const HANGS: &str = "it carries the weight and follows nothing";

/// Every kind.
pub(crate) static KINDS: [ControllerKind; 5] = [
    ControllerKind {
        name: PD_GRAVITY,
        words: "Proportional–derivative with gravity",
        gains: OF_FORCES,
        has_orders: false,
        compensates: false,
        drives_all: false,
        without_gains: HANGS,
        law: |Gained { kp, kd, .. }| Arc::new(PdGravity { kp, kd }),
    },
    ControllerKind {
        name: COMPUTED_TORQUE,
        words: "inverse dynamics",
        gains: Gains::OfJoints([&["1/s^2", "1/s"]; 2]),
        has_orders: false,
        compensates: true,
        drives_all: true,
        without_gains: "nothing brings the robot back to where it should be",
        law: |Gained { kp, kd, compensate_elements, .. }| Arc::new(ComputedTorque { kp, kd, compensate_elements }),
    },
    ControllerKind {
        name: PID,
        words: "proportional–integral–derivative",
        gains: Gains::OfJoints([&["N*m/rad", "N*m*s/rad", "N*m/(rad*s)"], &["N/m", "N*s/m", "N/(m*s)"]]),
        has_orders: false,
        compensates: false,
        drives_all: false,
        without_gains: "it gives no force at all",
        law: pid,
    },
    ControllerKind {
        name: FRACTIONAL_PID,
        words: "the same of fractional orders",
        gains: Gains::OfJoints([
            &["N*m/rad", "N*m*s^mu/rad", "N*m/(rad*s^lambda)"],
            &["N/m", "N*s^mu/m", "N/(m*s^lambda)"],
        ]),
        has_orders: true,
        compensates: false,
        drives_all: false,
        without_gains: "it gives no force at all",
        law: pid,
    },
    ControllerKind {
        name: "impedance",
        words: "a spring and a dashpot at the gripper",
        gains: Gains::AtGripper(["N/m", "N*s/m"]),
        has_orders: false,
        compensates: false,
        drives_all: false,
        without_gains: HANGS,
        law: |Gained { kp, kd, .. }| Arc::new(Impedance { kp: kp[0], kd: kd[0] }),
    },
];

fn pid(Gained { kp, kd, ki, lambda, mu, .. }: Gained) -> Arc<dyn Controller> {
    Arc::new(Pid { kp, ki, kd, lambda, mu })
}

impl ControllerKind {
    /// The kind called `name`.
    pub(crate) fn named(name: &str) -> &'static Self {
        KINDS.iter().find(|kind| kind.name == name).expect("a kind of the list")
    }

    /// Whether it has an integral.
    pub(crate) fn integrates(&self) -> bool {
        matches!(self.gains, Gains::OfJoints([[_, _, _], _]))
    }
}

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

/// What a derivative part takes.
pub(crate) const ERROR: &str = "error";
pub(crate) const MEASUREMENT: &str = "measurement";

/// Those whose derivative part may go through a filter.
const FILTERED: &[&str] = &[PD_GRAVITY, PID, FRACTIONAL_PID];

/// Those that act on errors of joints.
const WEIGHTED: &[&str] = &[PD_GRAVITY, COMPUTED_TORQUE, PID, FRACTIONAL_PID];

/// Noise of what a sampled controller measures.
pub(crate) static NOISE: Keys = Keys {
    words: "Noise of the coordinates that a sampled controller measures: white, of the normal distribution.",
    keys: &[
        key("sd", Shape::ByJointOrNumber, Need::Required("sd = \"1 mrad\""), "Standard deviation."),
        key("seed", Shape::Whole(0, None), Need::Number(1.0), "Of the random numbers."),
    ],
};

fn kinds() -> Vec<(&'static str, &'static str)> {
    KINDS.iter().map(|kind| (kind.name, kind.words)).collect()
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
            "filter",
            Shape::Number("s", Bound::Positive),
            Need::Said("none"),
            "Time T of a filter 1/(1 + T s) behind the derivative part.",
        )
        .only(FILTERED),
        key(
            "derivative_on",
            Shape::Words(|| vec![ERROR, MEASUREMENT]),
            Need::Word(ERROR),
            "What the derivative part takes: q_d − q, or −q.",
        ),
        key(
            "set_point_weight",
            Shape::ByJointOrNumber,
            Need::Number(1.0),
            "b of the proportional part, which takes b·q_d − q.",
        )
        .only(WEIGHTED),
        key(
            "feed_forward",
            Shape::ByJoint(Each::Force),
            Need::Said("none"),
            "Forces that are added to those of the law, before all limits.",
        ),
        key("noise", Shape::Table(&NOISE), Need::Said("none"), "Noise of the coordinates that are measured.")
            .only(WEIGHTED),
        key("quantization", Shape::ByJointOrNumber, Need::Said("none"), "Steps of the coordinates that are measured.")
            .only(WEIGHTED),
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

#[cfg(test)]
mod tests {
    use super::{CONTROLLER, ControllerKind, Gains, KINDS};

    #[test]
    fn keys_belong_to_the_kinds_that_take_them() {
        for key in ["ki", "anti_windup", "lambda", "mu", "compensate_elements", "filter", "noise", "set_point_weight"] {
            let takes = |kind: &&ControllerKind| match key {
                "filter" => !kind.compensates && matches!(kind.gains, Gains::OfJoints(_)),
                "noise" | "set_point_weight" => matches!(kind.gains, Gains::OfJoints(_)),
                "ki" | "anti_windup" => kind.integrates(),
                "lambda" | "mu" => kind.has_orders,
                _ => kind.compensates,
            };
            let kinds: Vec<_> = KINDS.iter().filter(takes).map(|kind| kind.name).collect();
            assert_eq!(CONTROLLER.get(key).unwrap().only, kinds, "{key}");
        }
    }
}
