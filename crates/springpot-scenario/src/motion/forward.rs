//! Forward dynamics: where the robot starts and what drives its joints.

use super::controller::{self, ControllerPlan, Joints};
use super::idle;
use super::joints::{open_joints, path_of_joint, signal, zero};
use super::{Made, ready};
use crate::document::{shorten, shortest};
use crate::feedback::{self, TorqueTexts};
use crate::keys::{FORCES, START, START_POSE, START_VELOCITIES};
use crate::names;
use crate::plan::SignalPlan;
use crate::reader::{Field, Read, Table, all};
use crate::refusal::{RefusalKind, Remark};
use crate::robot::{OwnJoint, Robot};
use crate::signals::Wanted;
use serde_json::{Map, Value, json};
use springpot::actuation::{Drive, Forward};
use springpot::law::Range;
use springpot::model::JointKind;
use springpot::motion::JointPath;
use springpot::signal::{Expression, Signal};
use springpot::spatial::Quaternion;
use std::collections::HashSet;

/// Reads what belongs to the kind "forward".
pub(super) fn read(
    table: &Table<'_>,
    robot: &Robot,
    end: Option<f64>,
) -> Read<(Made, TorqueTexts, Option<ControllerPlan>)> {
    let start = table.get("start").map(|field| start(&field, robot)).transpose();
    let torque = table.get("torque").map(|field| open_joints(&field, robot)).transpose();
    let prescribed = table.get("prescribed").map(|field| open_joints(&field, robot)).transpose();
    let locked = table.get("locked").map_or_else(|| Ok(HashSet::new()), |field| locked(&field, robot));
    let (torque, prescribed, locked) = (torque?, prescribed?, locked?);
    if let Some(field) = table.get("start") {
        let is_moved = |joint: &str| prescribed.as_ref().is_some_and(|table| table.get(joint).is_some());
        warn_of_led(&field.table(&START)?, robot, |joint| match locked.contains(joint) {
            true => Some("locked"),
            false => is_moved(joint).then_some("prescribed"),
        })?;
    }
    let place = &table.node.place;
    let mut feedback = TorqueTexts::new();
    let is_idle = |joint: &str| {
        let given = |table: &Option<Table<'_>>| table.as_ref().is_some_and(|table| table.get(joint).is_some());
        !given(&torque) && !given(&prescribed) && !locked.contains(joint)
    };
    let is_led =
        |joint: &str| locked.contains(joint) || prescribed.as_ref().is_some_and(|table| table.get(joint).is_some());
    let started = start.as_ref().ok().and_then(Option::as_ref);
    let still = idle::joints(robot, started.map(|(q, _)| &q[..]), is_led, is_idle);
    if !still.is_empty() {
        let which = names::list(still.iter().map(|&j| robot.model().joint_names()[j].as_str()));
        let message = format!(
            "nothing says how joints move that carry no mass, or point masses that others move alike; they go on as they start: {which}"
        );
        table.ctx.warn(Remark::new(message).help("give what they carry an inertia"));
    }
    let drives = all(robot.own_joints().map(|joint| {
        let given = |table: &Option<Table<'_>>| table.as_ref().and_then(|table| table.get(joint.name)).is_some();
        let is_locked = locked.contains(joint.name);
        let (driven, moved) = (given(&torque), given(&prescribed));
        if usize::from(driven) + usize::from(moved) + usize::from(is_locked) > 1 {
            let kinds = [("torque", driven), ("prescribed", moved), ("locked", is_locked)];
            let which: Vec<&str> = kinds.iter().filter(|(_, is)| *is).map(|(kind, _)| *kind).collect();
            let message = format!("[motion] moves joint {:?} in more than one way: {}", joint.name, which.join(", "));
            let refusal = place.refuse(RefusalKind::Rule, message);
            return Err(table.ctx.refuse(refusal.help("leave it in one of them")));
        }
        if is_locked {
            return Ok((Drive::Locked, json!("locked")));
        }
        if let Some(field) = prescribed.as_ref().and_then(|table| table.get(joint.name)) {
            let (path, record) = path_of_joint(&field, &joint, end)?;
            return Ok((Drive::Prescribed(path), json!({ "prescribed": record })));
        }
        if still.contains(&index_of(robot, joint.name)) {
            return Ok(coast(robot, index_of(robot, joint.name), started));
        }
        let forces = match torque.as_ref().and_then(|table| table.get(joint.name)) {
            Some(field) => force(&field, &joint, end)?,
            None => (0..joint.kind.nv()).map(|_| zero(place)).collect(),
        };
        let first = robot.model().v_range(index_of(robot, joint.name)).start;
        let texts = forces.iter().enumerate().filter_map(|(k, force)| Some((first + k, force.feedback.clone()?)));
        feedback.extend(texts);
        Ok(driven_by(forces))
    }));
    let (q, v) = start?.unwrap_or_else(|| (robot.model().neutral(), vec![0.0; robot.model().nv()]));
    let controller = table.get("controller");
    let is_forced = |joint: &str| {
        let is_moved = prescribed.as_ref().is_some_and(|table| table.get(joint).is_some());
        !is_moved && !locked.contains(joint)
    };
    let (drives, records): (Vec<Drive>, Vec<Value>) = drives?.into_iter().unzip();
    let moved = |joint: &str| match &drives[index_of(robot, joint)] {
        Drive::Prescribed(path) => Some(path.clone()),
        _ => None,
    };
    let joints = Joints { robot, start: &q, is_driven: &is_forced, moved: &moved };
    let controller = controller.map(|field| controller::read(&field, &joints, end)).transpose();
    let records: Map<String, Value> = robot.own_joints().map(|joint| joint.name.to_owned()).zip(records).collect();
    let controller = controller?;
    let mut made = ready([("start", json!({ "q": q, "v": v })), ("joints", records.into())], Forward { q, v, drives });
    if let Some(controller) = &controller {
        made.0.insert("controller".to_owned(), controller.record.clone());
    }
    Ok((made, feedback, controller))
}

/// The joint of that name, of a robot that has it.
fn index_of(robot: &Robot, joint: &str) -> usize {
    robot.model().joint_index(joint).expect("a joint of its own")
}

/// A joint of one degree that keeps its velocity, and the record of it.
fn coast(robot: &Robot, joint: usize, start: Option<&(Vec<f64>, Vec<f64>)>) -> (Drive, Value) {
    let model = robot.model();
    let (q, v) = start.map_or((0.0, 0.0), |(q, v)| (q[model.q_range(joint).start], v[model.v_range(joint).start]));
    if v == 0.0 {
        return (Drive::Locked, json!("locked, since nothing says how it moves"));
    }
    let time = Signal::expression(Expression::parse("t").expect("an expression"));
    let path = JointPath::Coordinate(Signal::scaled(time, v, q));
    (Drive::Prescribed(path), json!({ "prescribed": format!("{} + {}*t", shortest(q), shortest(v)) }))
}

/// Warns of what `start` says of joints that [motion] leads.
fn warn_of_led(start: &Table<'_>, robot: &Robot, led: impl Fn(&str) -> Option<&'static str>) -> Read<()> {
    for key in ["q", "v"] {
        let Some(field) = start.get(key) else { continue };
        let table = open_joints(&field, robot)?;
        for joint in robot.own_joints() {
            // Locked joints stay where they start.
            let Some((field, how)) = table.get(joint.name).zip(led(joint.name)) else { continue };
            if key == "v" || how == "prescribed" {
                let message =
                    format!("{key} of joint {:?} at the start says nothing: [motion] has it {how}", joint.name);
                start.ctx.warn(Remark::at(&field.node.place, message));
            }
        }
    }
    Ok(())
}

/// A joint that forces drive, and the record of it.
fn driven_by(forces: Vec<SignalPlan>) -> (Drive, Value) {
    let record = match &forces[..] {
        [only] => only.record(),
        several => several.iter().map(SignalPlan::record).collect(),
    };
    (Drive::Force(forces.into_iter().map(|force| force.signal).collect()), json!({ "torque": record }))
}

/// `start = { q = {…}, v = {…} }`; what is left out is 0.
fn start(field: &Field<'_>, robot: &Robot) -> Read<(Vec<f64>, Vec<f64>)> {
    let table = field.table(&START)?;
    let model = robot.model();
    let (mut q, mut v) = (model.neutral(), vec![0.0; model.nv()]);
    let positions = table.get("q").map(|field| open_joints(&field, robot)).transpose();
    let velocities = table.get("v").map(|field| open_joints(&field, robot)).transpose();
    let (positions, velocities) = (positions?, velocities?);
    all(model.own_joints().zip(robot.own_joints()).map(|(j, joint)| {
        if let Some(field) = positions.as_ref().and_then(|table| table.get(joint.name)) {
            let q = &mut q[model.q_range(j)];
            if joint.kind == JointKind::Floating {
                start_pose(&field, q)?;
            } else {
                q[0] = field.number(joint.unit())?;
                must_be_near(&field, q[0], joint.unit())?;
            }
        }
        if let Some(field) = velocities.as_ref().and_then(|table| table.get(joint.name)) {
            let v = &mut v[model.v_range(j)];
            if joint.kind == JointKind::Floating {
                let table = field.table(&START_VELOCITIES)?;
                for (v, name) in v.iter_mut().zip(START_VELOCITIES.names()) {
                    *v = table.number(name)?;
                }
            } else {
                v[0] = field.number(joint.units().velocity)?;
            }
        }
        Ok(())
    }))?;
    Ok((q, v))
}

/// Farther away, rad or m, numbers are more than 1e-7 apart: no motion of a robot can be told there.
const FARTHEST: f64 = 1e9;

fn must_be_near(field: &Field<'_>, q: f64, unit: &str) -> Read<()> {
    if q.abs() <= FARTHEST {
        return Ok(());
    }
    let message = format!(
        "is {} {unit}, outside ±1e9 {unit}: numbers there are {:.1e} apart",
        shortest(q),
        q.abs().next_up() - q.abs()
    );
    let help = match unit {
        "rad" => "take whole turns off it: the joint is at the same place",
        _ => "place the robot near the world's origin",
    };
    Err(field.refuse(RefusalKind::OutOfRange, message, Some(help.to_owned())))
}

/// `{ x = …, y = …, z = …, rpy = […] }`, all numbers.
fn start_pose(field: &Field<'_>, q: &mut [f64]) -> Read<()> {
    let table = field.table(&START_POSE)?;
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        q[k] = table.number(axis)?;
        if let Some(field) = table.get(axis) {
            must_be_near(&field, q[k], "m")?;
        }
    }
    let [roll, pitch, yaw] = table.vector("rpy")?;
    q[3..].copy_from_slice(&Quaternion::from_rpy([roll, pitch, yaw]).0);
    Ok(())
}

/// Names of locked joints.
fn locked<'a>(field: &Field<'a>, robot: &Robot) -> Read<HashSet<&'a str>> {
    let right = "an array of names of joints";
    let names = all(field.items(right)?.iter().map(|item| {
        let name = item.text()?;
        if robot.own_joints().any(|joint| joint.name == name) {
            return Ok(name);
        }
        let known: Vec<&str> = robot.own_joints().map(|joint| joint.name).collect();
        Err(match robot.why_no_coordinate(name) {
            Some(why) => item.refuse(RefusalKind::Rule, format!("names a joint that cannot be locked: {why}"), None),
            None => {
                let message = format!("names no joint: {:?}", shorten(name));
                item.refuse(RefusalKind::UnknownName, message, Some(names::suggest(name, known.iter().copied())))
            }
        })
    }))?;
    Ok(names.into_iter().collect())
}

/// The actuator force of a joint.
fn force(field: &Field<'_>, joint: &OwnJoint<'_>, end: Option<f64>) -> Read<Vec<SignalPlan>> {
    if joint.kind != JointKind::Floating {
        let unit = joint.units().force;
        return Ok(vec![feedback::read(field, Wanted { unit, range: Range::ANY, smooth: false, end })?]);
    }
    let table = field.table(&FORCES)?;
    all(FORCES.names().into_iter().map(|name| match table.get(name) {
        Some(field) => signal(&field, false, end),
        None => Ok(zero(&field.node.place)),
    }))
}
