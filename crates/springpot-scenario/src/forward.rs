//! `[motion] kind = "forward"`: where the robot starts and what drives its joints.

use super::document::shorten;
use super::keys::{FORCES, MOTION, START, START_POSE, START_VELOCITIES};
use super::motion::{open_joints, path_of_joint, signal};
use super::names;
use super::plan::{DrivePlan, ForwardPlan, MotionPlan, SignalPlan};
use super::reader::{Field, Read, Table, all};
use super::refusal::RefusalKind;
use super::robot::{OwnJoint, Robot};
use super::signals::{self, Wanted};
use springpot::law::Range;
use springpot::model::JointKind;
use springpot::signal::Signal;
use springpot::spatial::Quaternion;
use std::collections::HashSet;

/// Reads a motion of kind "forward".
pub(super) fn read(field: &Field<'_>, robot: &Robot, end: Option<f64>) -> Read<MotionPlan> {
    let table = Table::of_kind(field.ctx, field.node, "[motion]", (&MOTION, "forward"), |_| None)?;
    let start = table.get("start").map(|field| start(&field, robot)).transpose();
    let torque = table.get("torque").map(|field| open_joints(&field, robot)).transpose();
    let prescribed = table.get("prescribed").map(|field| open_joints(&field, robot)).transpose();
    let locked = table.get("locked").map_or_else(|| Ok(HashSet::new()), |field| locked(&field, robot));
    let (torque, prescribed, locked) = (torque?, prescribed?, locked?);
    let place = &field.node.place;
    let drives = all(robot.own_joints().map(|joint| {
        let given = |table: &Option<Table<'_>>| table.as_ref().and_then(|table| table.get(joint.name)).is_some();
        let is_locked = locked.contains(joint.name);
        let (driven, moved) = (given(&torque), given(&prescribed));
        if usize::from(driven) + usize::from(moved) + usize::from(is_locked) > 1 {
            let kinds = [("torque", driven), ("prescribed", moved), ("locked", is_locked)];
            let which: Vec<&str> = kinds.iter().filter(|(_, is)| *is).map(|(kind, _)| *kind).collect();
            let message = format!("[motion] moves joint {:?} in more than one way: {}", joint.name, which.join(", "));
            let refusal = place.refuse(RefusalKind::Rule, message);
            return Err(field.ctx.refuse(refusal.help("leave it in one of them")));
        }
        if is_locked {
            return Ok(DrivePlan::Locked);
        }
        if let Some(field) = prescribed.as_ref().and_then(|table| table.get(joint.name)) {
            return path_of_joint(&field, &joint, end).map(DrivePlan::Prescribed);
        }
        match torque.as_ref().and_then(|table| table.get(joint.name)) {
            Some(field) => force(&field, &joint, end).map(DrivePlan::Force),
            None => Ok(DrivePlan::Force((0..joint.kind.nv()).map(|_| zero(field)).collect())),
        }
    }));
    let (q, v) = start?.unwrap_or_else(|| (robot.model().neutral(), vec![0.0; robot.model().nv()]));
    Ok(MotionPlan::Forward(Box::new(ForwardPlan { q, v, drives: drives?, place: place.clone() })))
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

/// `{ x = …, y = …, z = …, rpy = […] }`, all numbers.
fn start_pose(field: &Field<'_>, q: &mut [f64]) -> Read<()> {
    let table = field.table(&START_POSE)?;
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        q[k] = table.number(axis)?;
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
        return Ok(vec![signals::read(field, Wanted { unit, range: Range::ANY, smooth: false, end })?]);
    }
    let table = field.table(&FORCES)?;
    all(FORCES.names().into_iter().map(|name| match table.get(name) {
        Some(field) => signal(&field, false, end),
        None => Ok(zero(field)),
    }))
}

/// What stands for a signal that is left out.
pub(super) fn zero(field: &Field<'_>) -> SignalPlan {
    SignalPlan {
        signal: Signal::constant(0.0),
        constant: Some(0.0),
        written: "0".to_owned(),
        place: field.node.place.clone(),
    }
}
