//! `[motion]`: prescribed joints and gripper paths.

use super::document::shorten;
use super::names;
use super::plan::{MotionPlan, SignalPlan};
use super::reader::{Field, Read, Refused, Table, all};
use super::refusal::RefusalKind;
use super::robot::Robot;
use super::signals::{self, Wanted};
use crate::law::Range;
use crate::model::{JointKind, JointSpec};

const KINDS: [&str; 3] = ["prescribed", "gripper-path", "forward"];

/// Reads `[motion]`.
pub(crate) fn read(root: &Table<'_>, robot: &Robot, end: Option<f64>) -> Read<MotionPlan> {
    let right = "[motion] with kind = \"prescribed\" or \"gripper-path\"";
    let field = root.require("motion", right)?;
    if field.node.entries().is_none() {
        return Err(field.wrong_type("a table: [motion]"));
    }
    let Some(kind) = field.node.get("kind") else {
        let refusal = field.node.place.refuse(RefusalKind::Missing, "[motion] has no `kind`");
        return Err(root.ctx.refuse(refusal.help("write kind = \"prescribed\" or kind = \"gripper-path\"")));
    };
    let kind = Field { key: "kind", node: kind, owner: "[motion]".into(), ..field.clone() };
    match kind.text()? {
        "prescribed" => prescribed(&field, robot, end),
        "gripper-path" => gripper_path(&field, robot, end),
        "forward" => {
            let message = "is \"forward\", which this version does not run yet";
            let help = "this version runs \"prescribed\" motions and \"gripper-path\"".to_owned();
            Err(kind.refuse(RefusalKind::NotYet, message, Some(help)))
        }
        other => {
            let message = format!("is {:?}, which is no kind of motion", shorten(other));
            Err(kind.refuse(RefusalKind::UnknownName, message, Some(names::suggest(other, KINDS))))
        }
    }
}

fn unit(joint: &JointSpec) -> &'static str {
    if joint.kind == JointKind::Prismatic { "m" } else { "rad" }
}

fn wanted(unit: &str, end: Option<f64>) -> Wanted<'_> {
    Wanted { unit, range: Range::ANY, smooth: true, end }
}

fn prescribed(field: &Field<'_>, robot: &Robot, end: Option<f64>) -> Read<MotionPlan> {
    let table = Table::open(field.ctx, field.node, "[motion]", &["kind", "joints", "csv"])?;
    let joints = robot.joints();
    let signals = match (table.get("joints"), table.get("csv")) {
        (Some(field), None) => {
            let given = open_joints(&field, robot)?;
            refuse_missing(&given, &joints, |name| given.get(name).is_some(), &field)?;
            all(joints.iter().map(|joint| {
                let field = given.get(&joint.name).ok_or(Refused)?;
                signals::read(&field, wanted(unit(joint), end))
            }))?
        }
        (None, Some(csv)) => from_csv(&table, &csv, &joints, end)?,
        (Some(_), Some(csv)) => {
            let help = "write one of them".to_owned();
            return Err(csv.refuse(RefusalKind::Rule, "stands beside `joints`", Some(help)));
        }
        (None, None) => {
            let all: Vec<String> = joints.iter().map(|joint| format!("{} = …", joint.name)).take(12).collect();
            let right = format!("joints = {{ {} }} or csv = \"motion.csv\"", all.join(", "));
            return Err(table.missing("joints", &right));
        }
    };
    Ok(MotionPlan::Prescribed { joints: signals })
}

/// Opens a table whose keys are names of moving joints.
fn open_joints<'a>(field: &Field<'a>, robot: &Robot) -> Read<Table<'a>> {
    let joints = robot.joints();
    let names: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
    let reason = |key: &str| {
        robot.is_fixed_joint(key).then(|| (RefusalKind::Rule, format!("joint {key:?} is fixed and has no coordinate")))
    };
    Table::open_with(field.ctx, field.node, field.to_string(), &names, reason)
}

/// Refuses the joints for which `has` is false, all in one message.
fn refuse_missing(given: &Table<'_>, joints: &[&JointSpec], has: impl Fn(&str) -> bool, field: &Field<'_>) -> Read<()> {
    let missing: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).filter(|name| !has(name)).collect();
    let untold: Vec<&str> = missing.iter().copied().filter(|name| !given.suspects(name)).collect();
    if untold.is_empty() {
        return if missing.is_empty() { Ok(()) } else { Err(Refused) };
    }
    let message = format!("leaves out the joints {}", all_names(&untold));
    let help = "every moving joint needs a signal: a number, a quantity, an expression of t or a CSV column".to_owned();
    Err(field.refuse(RefusalKind::Missing, message, Some(help)))
}

/// Every name, however many.
fn all_names(names: &[&str]) -> String {
    names.join(", ")
}

fn from_csv(table: &Table<'_>, csv: &Field<'_>, joints: &[&JointSpec], end: Option<f64>) -> Read<Vec<SignalPlan>> {
    let samples = signals::csv_table(csv, end)?;
    refuse_missing(table, joints, |name| samples.headers().iter().any(|header| header == name), csv)?;
    all(joints.iter().map(|joint| {
        let signal = signals::samples_signal(csv, &samples, &joint.name, true)?;
        let written = format!("{{ csv = {}, column = \"{}\" }}", csv.node.written(), joint.name);
        Ok(SignalPlan { signal, constant: None, written, place: csv.node.place.clone() })
    }))
}

fn gripper_path(field: &Field<'_>, robot: &Robot, end: Option<f64>) -> Read<MotionPlan> {
    let table = Table::open(field.ctx, field.node, "[motion]", &["kind", "x", "y", "z", "rpy", "guess"])?;
    if robot.gripper.is_none() {
        let message = "kind = \"gripper-path\" needs a gripper, but the robot has none";
        let place = table.get("kind").map_or(&table.node.place, |field| &field.node.place);
        let right = "write [robot.gripper] with body = \"NAME\" and point = [x, y, z]";
        field.ctx.refuse(place.refuse(RefusalKind::Missing, message).help(right));
    }
    let axis = |key: &'static str| {
        let field = table.require(key, "a signal for each of x, y and z (in m)")?;
        signals::read(&field, wanted("m", end))
    };
    let (x, y, z) = (axis("x"), axis("y"), axis("z"));
    let rpy = table.get("rpy").map(|field| rpy(&field, end)).transpose();
    let guess = table.get("guess").map_or_else(|| Ok(vec![0.0; robot.joints().len()]), |field| guess(&field, robot));
    Ok(MotionPlan::GripperPath { position: [x?, y?, z?], rpy: rpy?, guess: guess?, place: field.node.place.clone() })
}

fn rpy(field: &Field<'_>, end: Option<f64>) -> Read<[SignalPlan; 3]> {
    let right = "an array of three signals: roll, pitch, yaw";
    let items = field.items(right)?;
    let signals = all(items.iter().map(|item| signals::read(item, wanted("rad", end))))?;
    signals.try_into().map_err(|signals: Vec<_>| {
        let message = format!("has {} entries, but must be {right}", signals.len());
        field.refuse(RefusalKind::WrongType, message, Some("write [roll, pitch, yaw]".to_owned()))
    })
}

fn guess(field: &Field<'_>, robot: &Robot) -> Read<Vec<f64>> {
    let given = open_joints(field, robot)?;
    all(robot.joints().iter().map(|joint| given.get(&joint.name).map_or(Ok(0.0), |field| field.number(unit(joint)))))
}
