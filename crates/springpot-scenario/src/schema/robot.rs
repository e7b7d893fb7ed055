//! `[robot]`.

use super::super::bodies::{BODY_KEYS, FRICTION_KEYS, INERTIA_KEYS, JOINT_KEYS, PLAIN_JOINT_KEYS};
use super::super::robot::{ANCHOR_KEYS, KEYS, URDF_KEYS};
use super::{array_of, described, merge, not_negative, object, one_of, positive, quantity, text, unknown, vector};
use serde_json::{Map, Value, json};
use springpot::model::JointKind;

pub(super) fn section() -> Value {
    let mut schema = object("Gravity, bodies or a URDF file, gripper.", &KEYS, |key| match key {
        "gravity" => vector("m/s^2", "Gravity in the axes of the world, m/s^2. Default: [0, 0, -9.81]."),
        "body" => array_of("Bodies, parents before children.", body()),
        "gripper" => anchor("The point that a gripper path moves."),
        "urdf" => described(text(), "Path of a URDF file, relative to the scenario."),
        "floating_base" => flag("Whether the root link floats on a joint called floating_base. Default: false."),
        "ignore_mimic" => flag("Whether mimic joints have coordinates of their own. Default: false."),
        "package_path" => json!({
            "description": "Folders that are packages or hold some, for package:// paths.",
            "type": ["string", "array"], "items": { "type": "string" },
        }),
        _ => unknown(),
    });
    let needs: Map<String, Value> = URDF_KEYS.iter().map(|key| ((*key).to_owned(), json!(["urdf"]))).collect();
    merge(&mut schema, json!({ "dependencies": needs, "not": { "required": ["urdf", "body"] } }));
    schema
}

/// A point on a body.
pub(super) fn anchor(description: &str) -> Value {
    object(description, &ANCHOR_KEYS, |key| match key {
        "body" => described(text(), "Name of a body or link, or \"world\"."),
        "point" => vector("m", "The point in the frame of the body's joint, m."),
        _ => unknown(),
    })
}

fn flag(description: &str) -> Value {
    json!({ "type": "boolean", "description": description })
}

fn body() -> Value {
    let mut schema = object("A body and the joint that it hangs on.", &BODY_KEYS, |key| match key {
        "name" => name("Name of the body; not \"world\"."),
        "parent" => described(text(), "\"world\" or an earlier body. Default: the body before."),
        "joint" => joint(),
        "mass" => not_negative("kg", "Mass."),
        "com" => vector("m", "Centre of mass in the frame of the joint, m. Default: [0, 0, 0]."),
        "inertia" => object(
            "Inertia about the centre of mass in the axes of the joint, kg*m^2. Default: 0, a point mass.",
            &INERTIA_KEYS,
            |key| match key {
                "xx" | "yy" | "zz" => not_negative("kg*m^2", "Moment of inertia."),
                _ => quantity("kg*m^2", "Component of the tensor, J_xy = -∫xy dm. Default: 0."),
            },
        ),
        _ => unknown(),
    });
    merge(&mut schema, json!({ "required": ["name"] }));
    schema
}

fn joint() -> Value {
    let kinds = JointKind::ALL.map(JointKind::name);
    let mut schema = object("The joint between the body and its parent.", &JOINT_KEYS, |key| match key {
        "name" => name("Name of the joint."),
        "kind" => described(one_of(&kinds), "How it moves."),
        "origin" => vector("m", "Origin of the joint frame in the parent's joint frame, m. Default: [0, 0, 0]."),
        "rpy" => vector("rad", "Roll, pitch, yaw of the joint frame in the parent's, rad. Default: [0, 0, 0]."),
        "axis" => vector("", "Axis in the joint frame, of any length but 0."),
        "damping" => not_negative("N*m*s/rad (prismatic: N*s/m)", "Viscous damping. Default: 0."),
        "friction" => friction(),
        _ => unknown(),
    });
    let plain: Vec<&str> = JointKind::ALL.into_iter().filter(|kind| !kind.has_axis()).map(JointKind::name).collect();
    let without_axis = json!({
        "if": { "properties": { "kind": { "enum": plain } }, "required": ["kind"] },
        "then": { "propertyNames": { "enum": &JOINT_KEYS[..PLAIN_JOINT_KEYS] } },
    });
    merge(&mut schema, json!({ "required": ["name"], "allOf": [without_axis] }));
    schema
}

fn friction() -> Value {
    let force = || not_negative("N*m (prismatic: N)", "Coulomb friction. Default: 0.");
    let mut table = object("Coulomb friction, and what it does near rest.", &FRICTION_KEYS, |key| match key {
        "force" => force(),
        "speed" => positive(
            "rad/s (prismatic: m/s)",
            "v_0 of force·tanh(v/v_0), at which a load below the force creeps. Default: 1e-3. Not used where it sticks.",
        ),
        "stick" => flag("Whether Coulomb's law holds as it stands, with rest. Default: false."),
        _ => unknown(),
    });
    let description = "Coulomb friction: a number or quantity, or a table with `force`. Default: 0.";
    merge(&mut table, json!({ "required": ["force"] }));
    json!({ "description": description, "anyOf": [force(), table] })
}

/// A name of the scenario's own.
pub(super) fn name(description: &str) -> Value {
    json!({ "type": "string", "pattern": "^[A-Za-z_][A-Za-z0-9_-]*$", "description": description })
}
