//! Forward dynamics: where the robot starts and what drives its joints.

use super::controller::{self, ControllerPlan, Joints};
use super::idle;
use super::joints::{ByJoint, Parts, open_free, path_of_joint, zero};
use super::{Made, ready};
use crate::keys::{FORCES, START, START_POSE, START_VELOCITIES};
use crate::reader::{Field, Read, Table, all};
use crate::robot::{OwnJoint, Robot};
use crate::signals::feedback::{self};
use crate::signals::of_time::Wanted;
use crate::signals::plan::SignalPlan;
use crate::signals::plan::TorqueTexts;
use crate::text::document::{shorten, shortest};
use crate::text::names;
use crate::text::refusal::{RefusalKind, Remark};
use serde_json::{Map, Value, json};
use springpot::actuation::{Drive, Forward};
use springpot::law::Range;
use springpot::model::Space;
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
    let torque = table.get("torque").map(|field| ByJoint::open(&field, robot, Parts::Velocities)).transpose();
    let prescribed = table.get("prescribed").map(|field| ByJoint::open(&field, robot, Parts::Coordinates)).transpose();
    let locked = table.get("locked").map_or_else(|| Ok(HashSet::new()), |field| locked(&field, robot));
    let (torque, prescribed, locked) = (torque?, prescribed?, locked?);
    if let Some(field) = table.get("start") {
        warn_of_led(&field.table(&START)?, robot, |joint| match locked.contains(joint.name) {
            true => Some("locked"),
            false => prescribed.as_ref().is_some_and(|table| table.names(joint)).then_some("prescribed"),
        })?;
    }
    let place = &table.node.place;
    let mut feedback = TorqueTexts::new();
    let is_moved = |joint: &OwnJoint<'_>| {
        let own = robot.own_joints().find(|own| own.name == joint.name);
        prescribed.as_ref().zip(own).is_some_and(|(table, own)| table.names(&own))
    };
    let is_led = |joint: &OwnJoint<'_>| locked.contains(joint.name) || is_moved(joint);
    let is_idle = |joint: &OwnJoint<'_>| {
        let own = robot.own_joints().find(|own| own.name == joint.name);
        let given = torque.as_ref().zip(own).is_some_and(|(table, own)| table.get(&own).is_some());
        !given && !is_led(joint)
    };
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
        let force_on = torque.as_ref().and_then(|table| table.get(&joint));
        let (is_locked, moved) = (locked.contains(joint.name), is_moved(&joint));
        let driven = force_on.is_some();
        if usize::from(driven) + usize::from(moved) + usize::from(is_locked) > 1 {
            let kinds = [("torque", driven), ("prescribed", moved), ("locked", is_locked)];
            let which: Vec<&str> = kinds.iter().filter(|(_, is)| *is).map(|(kind, _)| *kind).collect();
            let message = format!("[motion] moves joint {:?} in more than one way: {}", joint.name, which.join(", "));
            let refusal = place.refuse(RefusalKind::Rule, message);
            let help = match joint.coordinate_part() {
                Some(_) if moved => format!(
                    "leave joint {:?} in one of them: what {} of `prescribed` leaves out is moved too, and stays at 0",
                    joint.joint, joint.joint
                ),
                _ => "leave it in one of them".to_owned(),
            };
            return Err(table.ctx.refuse(refusal.help(help)));
        }
        if is_locked {
            return Ok((Drive::Locked, json!("locked")));
        }
        if let Some(table) = prescribed.as_ref().filter(|_| moved) {
            let (path, record) = path_of_joint(table.get(&joint), table.place(), &joint, end)?;
            return Ok((Drive::Prescribed(path), json!({ "prescribed": record })));
        }
        if still.contains(&index_of(robot, joint.name)) {
            return Ok(coast(robot, index_of(robot, joint.name), started));
        }
        let forces = match force_on {
            Some(field) => force(&field, &joint, end)?,
            None => (0..joint.space.nv()).map(|_| zero(place)).collect(),
        };
        let first = robot.model().v_range(index_of(robot, joint.name)).start;
        let texts = forces.iter().enumerate().filter_map(|(k, force)| Some((first + k, force.feedback.clone()?)));
        feedback.extend(texts);
        Ok(driven_by(forces))
    }));
    let (q, v) = start?.unwrap_or_else(|| (robot.model().neutral(), vec![0.0; robot.model().nv()]));
    let controller = table.get("controller");
    let is_forced = |joint: &OwnJoint<'_>| !is_led(joint);
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
fn warn_of_led<'a>(
    start: &Table<'a>,
    robot: &'a Robot,
    led: impl Fn(&OwnJoint<'a>) -> Option<&'static str>,
) -> Read<()> {
    for (key, parts) in [("q", Parts::Coordinates), ("v", Parts::Velocities)] {
        let Some(field) = start.get(key) else { continue };
        let table = ByJoint::open(&field, robot, parts)?;
        for joint in robot.own_joints() {
            // Locked joints stay where they start.
            let Some((field, how)) = table.get(&joint).zip(led(&joint)) else { continue };
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
    let positions = table.get("q").map(|field| ByJoint::open(&field, robot, Parts::Coordinates)).transpose();
    let velocities = table.get("v").map(|field| ByJoint::open(&field, robot, Parts::Velocities)).transpose();
    let (positions, velocities) = (positions?, velocities?);
    all(model.own_joints().zip(robot.own_joints()).map(|(j, joint)| {
        if let Some(field) = positions.as_ref().and_then(|table| table.get(&joint)) {
            let q = &mut q[model.q_range(j)];
            match joint.units() {
                Some(units) => {
                    q[0] = field.number(units.coordinate)?;
                    must_be_near(&field, q[0], units.coordinate)?;
                }
                None => start_pose(&field, joint.space, q)?,
            }
        }
        if let Some(field) = velocities.as_ref().and_then(|table| table.get(&joint)) {
            let v = &mut v[model.v_range(j)];
            match joint.units() {
                Some(units) => v[0] = field.number(units.velocity)?,
                None => {
                    let table = open_free(&field, &START_VELOCITIES, joint.space, "of velocities")?;
                    for (v, (name, _)) in v.iter_mut().zip(joint.space.velocities()) {
                        *v = table.number(name)?;
                    }
                }
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

/// `{ x = …, y = …, z = …, rpy = […] }`, all numbers; of a spherical joint the last alone.
fn start_pose(field: &Field<'_>, space: Space, q: &mut [f64]) -> Read<()> {
    let table = open_free(field, &START_POSE, space, "such as { rpy = [roll, pitch, yaw] }")?;
    let first = space.quaternion().unwrap_or(q.len());
    for (k, (axis, _)) in space.coordinates().iter().enumerate().take(first) {
        q[k] = table.number(axis)?;
        if let Some(field) = table.get(axis) {
            must_be_near(&field, q[k], "m")?;
        }
    }
    let [roll, pitch, yaw] = table.vector("rpy")?;
    q[first..].copy_from_slice(&Quaternion::from_rpy([roll, pitch, yaw]).0);
    Ok(())
}

/// Locked joints of the model; a name stands for all coordinates of a joint, or for one.
fn locked<'a>(field: &Field<'_>, robot: &'a Robot) -> Read<HashSet<&'a str>> {
    let right = "an array of names of joints";
    let names = all(field.items(right)?.iter().map(|item| {
        let name = item.text()?;
        let named: Vec<&str> =
            robot.own_joints().filter(|own| own.joint == name || own.name == name).map(|own| own.name).collect();
        if !named.is_empty() {
            return Ok(named);
        }
        let known = robot.joints_as_described();
        Err(match robot.why_no_coordinate(name) {
            Some(why) => item.refuse(RefusalKind::Rule, format!("names a joint that cannot be locked: {why}"), None),
            None => {
                let message = format!("names no joint: {:?}", shorten(name));
                item.refuse(RefusalKind::UnknownName, message, Some(names::suggest(name, known.iter().copied())))
            }
        })
    }))?;
    Ok(names.into_iter().flatten().collect())
}

/// The actuator force of a joint.
fn force(field: &Field<'_>, joint: &OwnJoint<'_>, end: Option<f64>) -> Read<Vec<SignalPlan>> {
    if let Some(units) = joint.units() {
        return Ok(vec![feedback::read(field, Wanted { unit: units.force, range: Range::ANY, smooth: false, end })?]);
    }
    let table = open_free(field, &FORCES, joint.space, "of forces and torques")?;
    all(joint.space.velocities().iter().map(|&(name, _)| match table.get(name) {
        Some(field) => {
            let unit = field.row.map_or("", |row| row.shape.signal_unit());
            feedback::read(&field, Wanted { unit, range: Range::ANY, smooth: false, end })
        }
        None => Ok(zero(&field.node.place)),
    }))
}
