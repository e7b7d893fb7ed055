//! `[motion]`: prescribed joints and gripper paths; forward dynamics is read by `forward`.

use super::forward;
use super::keys::{MOTION, MotionKind, POSE, Shape};
use super::path;
use super::plan::{JointPlan, MotionPlan, PosePlan, SignalPlan};
use super::reader::{Field, Read, Refused, Table, all};
use super::refusal::RefusalKind;
use super::robot::{OwnJoint, Robot};
use super::signals::{self, Wanted};
use springpot::law::Range;
use springpot::model::JointKind;
use springpot::model::urdf::FLOATING_BASE;
use std::collections::HashSet;

/// What follows the name of a floating joint in the columns of a motion.
const POSE_COLUMNS: [&str; 6] = ["x", "y", "z", "roll", "pitch", "yaw"];

/// Reads `[motion]`.
pub(crate) fn read(root: &Table<'_>, robot: &Robot, end: Option<f64>) -> Read<MotionPlan> {
    let field = root.require("motion")?;
    if field.node.entries().is_none() {
        return Err(field.wrong_type("a table: [motion]"));
    }
    let row = MOTION.get("kind");
    let Some(node) = field.node.get("kind") else {
        let refusal = field.node.place.refuse(RefusalKind::Missing, "[motion] has no `kind`");
        let right = row.map(|row| row.right()).unwrap_or_default();
        return Err(root.ctx.refuse(refusal.help(format!("write {right}"))));
    };
    let word = Field { key: "kind", row, node, owner: "[motion]".into(), ..field.clone() }.word("kind of motion")?;
    match MotionKind::named(word).expect("a word that may stand there") {
        MotionKind::Prescribed => prescribed(&field, robot, end),
        MotionKind::GripperPath => gripper_path(&field, robot, end),
        MotionKind::Forward => forward::read(&field, robot, end),
    }
}

fn wanted(unit: &str, end: Option<f64>) -> Wanted<'_> {
    Wanted { unit, range: Range::ANY, smooth: true, end }
}

/// A signal in the unit of its key; `smooth` as in [`Wanted`].
pub(super) fn signal(field: &Field<'_>, smooth: bool, end: Option<f64>) -> Read<SignalPlan> {
    let unit = match field.row.map(|row| row.shape) {
        Some(Shape::Signal(unit) | Shape::Signals(unit)) => unit,
        _ => "",
    };
    signals::read(field, Wanted { smooth, ..wanted(unit, end) })
}

fn prescribed(field: &Field<'_>, robot: &Robot, end: Option<f64>) -> Read<MotionPlan> {
    let table = Table::of_kind(field.ctx, field.node, "[motion]", (&MOTION, "prescribed"), |_| None)?;
    let joints: Vec<OwnJoint<'_>> = robot.own_joints().collect();
    let joints = match (table.get("joints"), table.get("csv")) {
        (Some(field), None) => {
            let given = open_joints(&field, robot)?;
            let missing = joints.iter().map(|joint| joint.name).filter(|name| given.get(name).is_none());
            refuse_missing(&given, &missing.collect::<Vec<_>>(), "joints", &field)?;
            all(joints.iter().map(|joint| path_of_joint(&given.get(joint.name).ok_or(Refused)?, joint, end)))?
        }
        (None, Some(csv)) => from_csv(&table, &csv, &joints, end)?,
        (Some(_), Some(csv)) => {
            let help = "write one of them".to_owned();
            return Err(csv.refuse(RefusalKind::Rule, "stands beside `joints`", Some(help)));
        }
        (None, None) => {
            let all: Vec<String> =
                joints.iter().map(|joint| format!("{} = …", path::toml_key(joint.name))).take(12).collect();
            let right = format!("joints = {{ {} }} or csv = \"motion.csv\"", all.join(", "));
            return Err(table.missing("joints", &right));
        }
    };
    Ok(MotionPlan::Prescribed { joints })
}

/// How one joint moves.
pub(super) fn path_of_joint(field: &Field<'_>, joint: &OwnJoint<'_>, end: Option<f64>) -> Read<JointPlan> {
    match joint.kind {
        JointKind::Floating => pose(field, end).map(|pose| JointPlan::Pose(Box::new(pose))),
        _ => signals::read(field, wanted(joint.unit(), end)).map(JointPlan::Coordinate),
    }
}

/// The pose of a floating joint; what is left out is 0.
fn pose(field: &Field<'_>, end: Option<f64>) -> Read<PosePlan> {
    if field.node.entries().is_none() {
        let right = "a table { x = …, y = …, z = …, rpy = [roll, pitch, yaw] }, since the joint is floating";
        return Err(field.wrong_type(right));
    }
    let table = field.table(&POSE)?;
    let zero = || forward::zero(field);
    let axis = |key| table.get(key).map_or_else(|| Ok(zero()), |field| signal(&field, true, end));
    let position = [axis("x"), axis("y"), axis("z")];
    let rpy = table.get("rpy").map_or_else(|| Ok([zero(), zero(), zero()]), |field| rpy(&field, end));
    let [x, y, z] = position;
    Ok(PosePlan { position: [x?, y?, z?], rpy: rpy? })
}

/// Opens a table whose keys are names of joints that have coordinates of their own.
pub(super) fn open_joints<'a>(field: &Field<'a>, robot: &Robot) -> Read<Table<'a>> {
    let names: Vec<&str> = robot.own_joints().map(|joint| joint.name).collect();
    let reason = |key: &str| robot.why_no_coordinate(key).map(|why| (RefusalKind::Rule, why));
    Table::open_with(field.ctx, field.node, field.to_string(), &names, reason)
}

/// Refuses what is missing, all in one message.
fn refuse_missing(given: &Table<'_>, missing: &[&str], what: &str, field: &Field<'_>) -> Read<()> {
    let untold: Vec<&str> = missing.iter().copied().filter(|name| !given.suspects(name)).collect();
    if untold.is_empty() {
        return if missing.is_empty() { Ok(()) } else { Err(Refused) };
    }
    let message = format!("leaves out the {what} {}", all_names(&untold));
    let help = "every moving joint needs a signal: a number, a quantity, an expression of t or a CSV column".to_owned();
    Err(field.refuse(RefusalKind::Missing, message, Some(help)))
}

/// Every name, however many.
fn all_names(names: &[&str]) -> String {
    names.join(", ")
}

/// Motion from a CSV file: per joint a column of its name; of a floating one six, `NAME.x` to `NAME.yaw`.
fn from_csv(table: &Table<'_>, csv: &Field<'_>, joints: &[OwnJoint<'_>], end: Option<f64>) -> Read<Vec<JointPlan>> {
    let samples = signals::csv_table(csv, end)?;
    let columns: Vec<Vec<String>> = joints.iter().map(columns_of).collect();
    let headers: HashSet<&str> = samples.headers().iter().map(String::as_str).collect();
    let missing = columns.iter().flatten().map(String::as_str).filter(|column| !headers.contains(column));
    refuse_missing(table, &missing.collect::<Vec<_>>(), "columns", csv)?;
    let column = |name: &String| -> Read<SignalPlan> {
        let signal = signals::samples_signal(csv, &samples, name, true)?;
        let written = format!("{{ csv = {}, column = {name:?} }}", csv.node.written());
        Ok(SignalPlan { signal, constant: None, written, place: csv.node.place.clone() })
    };
    all(columns.iter().map(|names| match &names[..] {
        [x, y, z, roll, pitch, yaw] => {
            let position = [column(x)?, column(y)?, column(z)?];
            let rpy = [column(roll)?, column(pitch)?, column(yaw)?];
            Ok(JointPlan::Pose(Box::new(PosePlan { position, rpy })))
        }
        names => column(&names[0]).map(JointPlan::Coordinate),
    }))
}

/// Columns of a CSV file that say how a joint moves.
fn columns_of(joint: &OwnJoint<'_>) -> Vec<String> {
    match joint.kind {
        JointKind::Floating => POSE_COLUMNS.map(|part| format!("{}.{part}", joint.name)).to_vec(),
        _ => vec![joint.name.to_owned()],
    }
}

fn gripper_path(field: &Field<'_>, robot: &Robot, end: Option<f64>) -> Read<MotionPlan> {
    let table = Table::of_kind(field.ctx, field.node, "[motion]", (&MOTION, "gripper-path"), |_| None)?;
    if robot.gripper.is_none() {
        let message = "kind = \"gripper-path\" needs a gripper, but the robot has none";
        let place = table.get("kind").map_or(&table.node.place, |field| &field.node.place);
        let right = "write [robot.gripper] with body = \"NAME\" and point = [x, y, z]";
        field.ctx.refuse(place.refuse(RefusalKind::Missing, message).help(right));
    }
    if let Some(joint) = robot.own_joints().find(|joint| joint.kind.nv() != 1) {
        let name = joint.name;
        let message = format!("kind = \"gripper-path\" moves joints of one degree, but joint {name:?} is floating");
        let place = table.get("kind").map_or(&table.node.place, |field| &field.node.place);
        let right = match &robot.parts.urdf {
            Some(_) if name == FLOATING_BASE => "leave floating_base out, or write kind = \"prescribed\"",
            _ => "write kind = \"prescribed\", or a joint of another kind",
        };
        return Err(field.ctx.refuse(place.refuse(RefusalKind::Rule, message).help(right)));
    }
    let axis = |key: &'static str| {
        let field = table.require(key)?;
        signal(&field, true, end)
    };
    let (x, y, z) = (axis("x"), axis("y"), axis("z"));
    let rpy = table.get("rpy").map(|field| rpy(&field, end)).transpose();
    let guess = table.get("guess").map_or_else(|| Ok(vec![0.0; robot.model().nq()]), |field| guess(&field, robot));
    Ok(MotionPlan::GripperPath { position: [x?, y?, z?], rpy: rpy?, guess: guess?, place: field.node.place.clone() })
}

fn rpy(field: &Field<'_>, end: Option<f64>) -> Read<[SignalPlan; 3]> {
    let right = "an array of three signals: roll, pitch, yaw";
    let items = field.items(right)?;
    let signals = all(items.iter().map(|item| signal(item, true, end)))?;
    signals.try_into().map_err(|signals: Vec<_>| {
        let message = format!("has {} entries, but must be {right}", signals.len());
        field.refuse(RefusalKind::WrongType, message, Some("write [roll, pitch, yaw]".to_owned()))
    })
}

fn guess(field: &Field<'_>, robot: &Robot) -> Read<Vec<f64>> {
    let given = open_joints(field, robot)?;
    all(robot.own_joints().map(|joint| given.get(joint.name).map_or(Ok(0.0), |field| field.number(joint.unit()))))
}
