//! Every joint moves as signals say.

use super::joints::{coordinate, open_joints, path_of_joint, posed};
use super::{Made, ready};
use crate::path;
use crate::plan::SignalPlan;
use crate::reader::{Field, Read, Refused, Table, all};
use crate::refusal::RefusalKind;
use crate::robot::{OwnJoint, Robot};
use crate::signals;
use serde_json::{Map, Value};
use springpot::model::JointKind;
use springpot::motion::{JointPath, Trajectory};
use std::collections::HashSet;

/// What follows the name of a floating joint in the columns of a motion.
const POSE_COLUMNS: [&str; 6] = ["x", "y", "z", "roll", "pitch", "yaw"];

/// Reads what belongs to the kind "prescribed".
pub(super) fn read(table: &Table<'_>, robot: &Robot, end: Option<f64>) -> Read<Made> {
    let joints: Vec<OwnJoint<'_>> = robot.own_joints().collect();
    let paths = match (table.get("joints"), table.get("csv")) {
        (Some(field), None) => {
            let given = open_joints(&field, robot)?;
            let missing = joints.iter().map(|joint| joint.name).filter(|name| given.get(name).is_none());
            refuse_missing(&given, &missing.collect::<Vec<_>>(), "joints", &field)?;
            all(joints.iter().map(|joint| path_of_joint(&given.get(joint.name).ok_or(Refused)?, joint, end)))?
        }
        (None, Some(csv)) => from_csv(table, &csv, (robot, &joints), end)?,
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
    let (paths, records): (Vec<JointPath>, Vec<Value>) = paths.into_iter().unzip();
    let records: Map<String, Value> = joints.iter().map(|joint| joint.name.to_owned()).zip(records).collect();
    Ok(ready([("joints", records.into())], Trajectory::Prescribed(paths)))
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
fn from_csv(
    table: &Table<'_>,
    csv: &Field<'_>,
    (robot, joints): (&Robot, &[OwnJoint<'_>]),
    end: Option<f64>,
) -> Read<Vec<(JointPath, Value)>> {
    let samples = signals::csv_table(table, csv, end)?;
    let columns: Vec<Vec<String>> = joints.iter().map(columns_of).collect();
    let headers: HashSet<&str> = samples.table.headers().iter().map(String::as_str).collect();
    let missing = columns.iter().flatten().map(String::as_str).filter(|column| !headers.contains(column));
    refuse_missing(table, &missing.collect::<Vec<_>>(), "columns", csv)?;
    let unit_field = table.get("unit");
    let by_joint = unit_field
        .as_ref()
        .filter(|field| field.node.entries().is_some())
        .map(|field| open_joints(field, robot))
        .transpose()?;
    let unit_of = |joint: &OwnJoint<'_>| match &by_joint {
        Some(table) => table.fields().find(|field| field.key == joint.name),
        None => table.get("unit"),
    };
    let column = |name: &String, joint: &OwnJoint<'_>| -> Read<SignalPlan> {
        let signal = signals::samples_signal(csv, &samples, name, true)?;
        let signal = match (unit_of(joint), joint.kind == JointKind::Floating) {
            (Some(unit), false) => signals::in_unit(&unit, signal, joint.unit())?,
            (Some(unit), true) => {
                let message = "stands for a floating joint, whose columns are in m and rad";
                let help = "write unit = { NAME = \"…\" } for the other joints".to_owned();
                return Err(unit.refuse(RefusalKind::Rule, message, Some(help)));
            }
            (None, _) => signal,
        };
        let written = format!("{{ csv = {}, column = {name:?} }}", csv.node.written());
        Ok(SignalPlan { signal, constant: None, written, place: csv.node.place.clone(), feedback: None })
    };
    all(columns.iter().zip(joints).map(|(names, joint)| match &names[..] {
        [x, y, z, roll, pitch, yaw] => {
            let column = |name| column(name, joint);
            let position = [column(x)?, column(y)?, column(z)?];
            let rpy = [column(roll)?, column(pitch)?, column(yaw)?];
            Ok(posed(position, rpy))
        }
        names => column(&names[0], joint).map(coordinate),
    }))
}

/// Columns of a CSV file that say how a joint moves.
fn columns_of(joint: &OwnJoint<'_>) -> Vec<String> {
    match joint.kind {
        JointKind::Floating => POSE_COLUMNS.map(|part| format!("{}.{part}", joint.name)).to_vec(),
        _ => vec![joint.name.to_owned()],
    }
}
