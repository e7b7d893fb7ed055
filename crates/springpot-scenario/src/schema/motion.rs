//! `[motion]` and signals.

use super::super::motion::{GRIPPER_PATH_KEYS, KINDS, POSE_KEYS, PRESCRIBED_KEYS};
use super::super::{forward, signals};
use super::{QUANTITY, described, merge, object, one_of, quantity, signal, text, unknown, vector};
use serde_json::{Value, json};

/// Keys of a kind of motion.
fn keys_of(kind: &str) -> &'static [&'static str] {
    match kind {
        "prescribed" => &PRESCRIBED_KEYS,
        "gripper-path" => &GRIPPER_PATH_KEYS,
        _ => &forward::KEYS,
    }
}

pub(super) fn section() -> Value {
    let mut keys: Vec<&str> = Vec::new();
    for key in KINDS.into_iter().flat_map(keys_of) {
        if !keys.contains(key) {
            keys.push(key);
        }
    }
    let mut schema = object("What moves the robot.", &keys, |key| match key {
        "kind" => described(one_of(&KINDS), "Prescribed joints, a path of the gripper, or forward: forces."),
        "joints" => by_joint("prescribed: how every joint moves.", json!({ "$ref": "#/definitions/path" })),
        "csv" => described(text(), "prescribed: a CSV file with the column t and one column for every joint, SI."),
        "x" | "y" | "z" => signal("m", "gripper-path: coordinate of the gripper in the world."),
        "rpy" => three_signals("gripper-path: roll, pitch, yaw of the gripper's body in the world, rad."),
        "guess" => by_joint(
            "gripper-path: coordinates near the start, which choose the branch. Default: 0.",
            quantity("rad (prismatic: m)", "Coordinate."),
        ),
        "start" => start(),
        "torque" => by_joint("forward: actuator forces. Default: 0.", json!({ "$ref": "#/definitions/force" })),
        "prescribed" => by_joint(
            "forward: joints that move as said, whatever force that takes.",
            json!({ "$ref": "#/definitions/path" }),
        ),
        "locked" => json!({
            "type": "array", "items": { "type": "string" },
            "description": "forward: joints that stay where they start, whatever force that takes.",
        }),
        _ => unknown(),
    });
    let of_kind = |kind: &str| {
        json!({
            "if": { "properties": { "kind": { "const": kind } }, "required": ["kind"] },
            "then": { "propertyNames": { "enum": keys_of(kind) } },
        })
    };
    let not_both = json!({ "not": { "required": ["joints", "csv"] } });
    let rules: Vec<Value> = KINDS.into_iter().map(of_kind).chain([not_both]).collect();
    merge(&mut schema, json!({ "allOf": rules }));
    schema
}

/// What several places share.
pub(super) fn definitions() -> Value {
    json!({ "signal": any_signal(), "path": path(), "force": force() })
}

fn by_joint(description: &str, value: Value) -> Value {
    json!({ "type": "object", "description": description, "additionalProperties": value })
}

fn three_signals(description: &str) -> Value {
    let items = signal("rad", "An angle.");
    json!({ "type": "array", "items": items, "minItems": 3, "maxItems": 3, "description": description })
}

/// A number, a quantity, an expression, or a table.
fn any_signal() -> Value {
    let mut table =
        object("An expression with its unit, or a column of a CSV file.", &signals::KEYS, |key| match key {
            "expression" => described(text(), "An expression of t (in s), such as \"25 + 5*sin(t)\"."),
            "csv" => described(text(), "Path of a CSV file with a column t in seconds, relative to the scenario."),
            "column" => described(text(), "Column of the CSV file."),
            "unit" => described(text(), "Unit of the values. Default: SI."),
            _ => unknown(),
        });
    let rules = json!({
        "oneOf": [{ "required": ["expression"] }, { "required": ["csv"] }],
        "dependencies": { "csv": ["column"], "column": ["csv"] },
    });
    merge(&mut table, rules);
    json!({ "anyOf": [{ "type": "number" }, { "type": "string", "minLength": 1 }, table] })
}

/// How a joint moves: a signal, or the pose of a floating joint.
fn path() -> Value {
    let pose = object("Where a floating joint is; what is left out is 0.", &POSE_KEYS, |key| match key {
        "rpy" => three_signals("Roll, pitch, yaw, rad."),
        _ => signal("m", "Coordinate of the joint's frame."),
    });
    json!({ "anyOf": [{ "$ref": "#/definitions/signal" }, pose] })
}

/// An actuator force: a signal, or the six of a floating joint.
fn force() -> Value {
    let six = object("Forces and torques on a floating joint, in the axes of its body.", &forward::VELOCITIES, |key| {
        if key.starts_with('v') { signal("N", "Force.") } else { signal("N*m", "Torque.") }
    });
    json!({ "anyOf": [{ "$ref": "#/definitions/signal" }, six] })
}

fn start() -> Value {
    let number = json!({ "type": ["number", "string"], "pattern": QUANTITY });
    let pose = object("Where a floating joint starts.", &POSE_KEYS, |key| match key {
        "rpy" => vector("rad", "Roll, pitch, yaw, rad."),
        _ => quantity("m", "Coordinate of the joint's frame."),
    });
    let velocities = object("How a floating joint starts, in the axes of its body.", &forward::VELOCITIES, |key| {
        if key.starts_with('v') { quantity("m/s", "Velocity.") } else { quantity("rad/s", "Angular velocity.") }
    });
    object("forward: where the robot starts, by joint. Default: 0.", &forward::START_KEYS, |key| match key {
        "q" => by_joint("Coordinates, rad or m.", json!({ "anyOf": [&number, &pose] })),
        _ => by_joint("Velocities, rad/s or m/s.", json!({ "anyOf": [&number, &velocities] })),
    })
}
