//! Every joint moves as signals say.

use super::joints::{ByJoint, Parts, attitude, coordinate, path_of_joint, posed};
use super::{Made, ready};
use crate::reader::{Field, Read, Refused, Table, all};
use crate::robot::{OwnJoint, Robot};
use crate::signals::of_time;
use crate::signals::plan::SignalPlan;
use crate::text::quoted::toml_key;
use crate::text::refusal::RefusalKind;
use serde_json::{Map, Value};
use springpot::model::Space;
use springpot::motion::{JointPath, Trajectory};
use std::collections::HashSet;

/// What follows the name of a floating joint in the columns of a motion; the last three that of a spherical one.
const POSE_COLUMNS: [&str; 6] = ["x", "y", "z", "roll", "pitch", "yaw"];

/// Reads what belongs to the kind "prescribed".
pub(super) fn read(table: &Table<'_>, robot: &Robot, end: Option<f64>) -> Read<Made> {
    let joints: Vec<OwnJoint<'_>> = robot.own_joints().collect();
    let paths = match (table.get("joints"), table.get("csv")) {
        (Some(field), None) => {
            let given = ByJoint::open(&field, robot, Parts::Coordinates)?;
            let mut missing: Vec<&OwnJoint<'_>> = joints.iter().filter(|joint| !given.names(joint)).collect();
            missing.dedup_by_key(|joint| joint.joint);
            let untold = missing.iter().filter(|joint| !given.suspects(joint)).map(|joint| joint.joint).collect();
            refuse_missing(untold, !missing.is_empty(), "joints", &field)?;
            all(joints.iter().map(|joint| path_of_joint(given.get(joint), given.place(), joint, end)))?
        }
        (None, Some(csv)) => from_csv(table, &csv, (robot, &joints), end)?,
        (Some(_), Some(csv)) => {
            let help = "write one of them".to_owned();
            return Err(csv.refuse(RefusalKind::Rule, "stands beside `joints`", Some(help)));
        }
        (None, None) => {
            let all: Vec<String> =
                robot.joints_as_described().iter().map(|joint| format!("{} = …", toml_key(joint))).take(12).collect();
            let right = format!("joints = {{ {} }} or csv = \"motion.csv\"", all.join(", "));
            return Err(table.missing("joints", &right));
        }
    };
    let (paths, records): (Vec<JointPath>, Vec<Value>) = paths.into_iter().unzip();
    let records: Map<String, Value> = joints.iter().map(|joint| joint.name.to_owned()).zip(records).collect();
    Ok(ready([("joints", records.into())], Trajectory::Prescribed(paths)))
}

/// Refuses what is missing, all in one message; where something `is_missing`, but nothing untold, the refusal is noted already.
fn refuse_missing(untold: Vec<&str>, is_missing: bool, what: &str, field: &Field<'_>) -> Read<()> {
    if untold.is_empty() {
        return if is_missing { Err(Refused) } else { Ok(()) };
    }
    let message = format!("leaves out the {what} {}", all_names(&untold));
    let help = "every moving joint needs a signal: a number, a quantity, an expression of t or a CSV column".to_owned();
    Err(field.refuse(RefusalKind::Missing, message, Some(help)))
}

/// Every name, however many.
fn all_names(names: &[&str]) -> String {
    names.join(", ")
}

/// Motion from a CSV file: per coordinate a column of its name; of a floating joint six, `NAME.x` to `NAME.yaw`, of a spherical one
/// the last three.
fn from_csv(
    table: &Table<'_>,
    csv: &Field<'_>,
    (robot, joints): (&Robot, &[OwnJoint<'_>]),
    end: Option<f64>,
) -> Read<Vec<(JointPath, Value)>> {
    let samples = of_time::csv_table(table, csv, end)?;
    let columns: Vec<Vec<String>> = joints.iter().map(columns_of).collect();
    let headers: HashSet<&str> = samples.table.headers().iter().map(String::as_str).collect();
    let missing = columns.iter().flatten().map(String::as_str).filter(|column| !headers.contains(column));
    let missing: Vec<&str> = missing.collect();
    let untold = missing.iter().copied().filter(|name| !table.suspects(name)).collect();
    refuse_missing(untold, !missing.is_empty(), "columns", csv)?;
    let unit_field = table.get("unit");
    let by_joint = unit_field
        .as_ref()
        .filter(|field| field.node.entries().is_some())
        .map(|field| ByJoint::open(field, robot, Parts::Coordinates))
        .transpose()?;
    let unit_of = |joint: &OwnJoint<'_>| match &by_joint {
        Some(table) => robot.own_joints().find(|own| own.name == joint.name).and_then(|own| table.get(&own)),
        None => table.get("unit"),
    };
    let column = |name: &String, joint: &OwnJoint<'_>| -> Read<SignalPlan> {
        let signal = of_time::samples_signal(csv, &samples, name, true)?;
        let signal = match (unit_of(joint), joint.units()) {
            (Some(unit), Some(units)) => of_time::in_unit(&unit, signal, units.coordinate)?,
            (Some(unit), None) => {
                let message = match joint.space.quaternion() {
                    Some(0) => "stands for a spherical joint, whose columns are in rad",
                    _ => "stands for a floating joint, whose columns are in m and rad",
                };
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
        [roll, pitch, yaw] => {
            let column = |name| column(name, joint);
            Ok(attitude([column(roll)?, column(pitch)?, column(yaw)?]))
        }
        names => column(&names[0], joint).map(coordinate),
    }))
}

/// Columns of a CSV file that say how a joint moves.
fn columns_of(joint: &OwnJoint<'_>) -> Vec<String> {
    let parts = match joint.space {
        Space::Line(_) | Space::Circle => return vec![joint.name.to_owned()],
        Space::Attitude => &POSE_COLUMNS[3..],
        Space::Pose => &POSE_COLUMNS[..],
    };
    parts.iter().map(|part| format!("{}.{part}", joint.name)).collect()
}
