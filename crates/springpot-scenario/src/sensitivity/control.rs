//! What numbers of a controller, of its reference and of feedback move.

use super::constants::Constants;
use super::gather::{Gather, Moved, Scene, Slope};
use super::rows::{key, velocity};
use crate::changes::path::Step;
use crate::keys::{GRIPPER_PATH, MOVE, TRAPEZOID};
use crate::plan::control::senses;
use crate::signals::plan::FeedbackText;
use serde_json::Value;
use springpot::actuation::Drive;
use springpot::control::{ControllerNumber, FeedbackSlope, Profile};
use springpot::signal::{Expression, Signal};
use springpot::system::Motion;

/// A gain or an order: of the gripper, of one joint, or of all that the controller drives.
pub(super) fn gain(gather: &mut Gather, scene: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    let (by, name) = (slope.number()?, key(&steps[2]));
    let controlled = scene.system.control.controller.as_ref().ok_or("there is no controller")?;
    let law = controlled.variation().ok_or("no derivative is known of its controller")?;
    let number = |velocity| ControllerNumber { name: name.to_owned(), velocity };
    let numbers: Vec<ControllerNumber> = if law.has(&number(None)) {
        vec![number(None)]
    } else if steps.len() > 3 {
        vec![number(Some(velocity(scene, &steps[3..])?))]
    } else {
        driven(scene).map(|velocity| number(Some(velocity))).collect()
    };
    for number in numbers {
        if !law.has(&number) {
            let is_order = matches!(name, "lambda" | "mu");
            return Err(match is_order {
                true => "it is 1: the derivative there needs a memory that the run has not: start at 0.99".to_owned(),
                false => format!("no derivative is known of its `{name}`"),
            });
        }
        gather.controller.push((number, by));
    }
    Ok(())
}

/// The velocities that a controller drives.
fn driven(scene: &Scene<'_>) -> impl Iterator<Item = usize> {
    let model = &scene.system.model;
    let is_driven = |k: &usize| matches!(scene.drive(*k), Some(Drive::Force(_)));
    (0..model.nv()).filter(|&k| model.coordinate_of(k).is_some()).filter(is_driven)
}

/// A largest force, or how fast it may change.
pub(super) fn limit(gather: &mut Gather, scene: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    let (velocity, by) = (velocity(scene, &steps[3..])?, slope.number()?);
    let limits = if key(&steps[2]) == "limits" { &mut gather.limits } else { &mut gather.rate_limits };
    limits.push((velocity, by));
    Ok(())
}

/// The controller's reference, as the record of a run has it.
fn record(scene: &Scene<'_>) -> Value {
    scene.plan.motion.resolved()["controller"]["reference"].take()
}

/// A move: its duration, and the share of its way as a function of time.
fn course(record: &Value) -> Option<(f64, Profile)> {
    let is_trapezoid = record["profile"] == TRAPEZOID;
    Some((record["duration"].as_f64()?, if is_trapezoid { Profile::Trapezoid } else { Profile::Quintic }))
}

/// Where a move ends, by joint.
pub(super) fn to(gather: &mut Gather, scene: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    let (velocity, by) = (velocity(scene, &steps[4..])?, slope.number()?);
    let (duration, profile) = course(&record(scene)).ok_or("the reference is no move")?;
    gather.reference.push((velocity, profile.signal(0.0, by, duration)));
    Ok(())
}

/// How long a move takes: −(to − from) S'(w) w/T, w = min(t/T, 1).
pub(super) fn duration(gather: &mut Gather, scene: &Scene<'_>, _: &[Step], slope: Slope) -> Moved {
    let (by, record) = (slope.number()?, record(scene));
    let (duration, profile) = course(&record).ok_or("the reference is no move")?;
    let slope = match profile {
        Profile::Quintic => "-30*min(t*r,1)^3*(1-min(t*r,1))^2",
        Profile::Trapezoid => "-4.5*min(t*r,1)*(min(t*r,1)-max(0,min(t*r,1)-1/3)-max(0,min(t*r,1)-2/3))",
    };
    let law = scene.system.control.controller.as_ref().map(|controlled| &controlled.law);
    if profile == Profile::Trapezoid && law.is_some_and(|law| law.follows_accelerations()) {
        return Err("the controller follows accelerations, which jump at times that it moves".to_owned());
    }
    let slope = Expression::parse_with(slope, &[("r".to_owned(), duration.recip())]).expect("an expression of its own");
    let slope = Signal::expression(slope);
    for velocity in driven(scene) {
        let (Some(from), Some(to)) = (start(scene, velocity), end(scene, &record, velocity)) else { continue };
        gather.reference.push((velocity, Signal::scaled(slope.clone(), by * (to - from) / duration, 0.0)));
    }
    Ok(())
}

/// Where the coordinate of a velocity starts.
fn start(scene: &Scene<'_>, velocity: usize) -> Option<f64> {
    let Motion::Forward(forward) = &scene.system.motion else { return None };
    forward.q.get(scene.system.model.coordinate_of(velocity)?).copied()
}

/// Where a move brings it, if it is moved.
fn end(scene: &Scene<'_>, record: &Value, velocity: usize) -> Option<f64> {
    let model = &scene.plan.model;
    let joint = model.own_joints().find(|&j| model.v_range(j).contains(&velocity))?;
    record["to"][&*model.joint_names()[joint]].as_f64()
}

/// A signal of a joint, or a coordinate of the gripper where the controller acts there.
pub(super) fn reference(gather: &mut Gather, scene: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    if record(scene)["kind"] == GRIPPER_PATH {
        if solves_path(scene) {
            return Err("no derivative is known of paths of the gripper that are solved for the joints".to_owned());
        }
        let axis = ["x", "y", "z"].iter().position(|axis| *axis == key(&steps[3]));
        gather.point.push((axis.ok_or("no derivative by it is known")?, slope.signal()?));
        return Ok(());
    }
    gather.reference.push((velocity(scene, &steps[3..])?, slope.signal()?));
    Ok(())
}

/// A reference that begins where the robot starts: `by` is what changes of that, of one velocity.
pub(super) fn follow_start(gather: &mut Gather, scene: &Scene<'_>, velocity: usize, by: f64) -> Moved {
    if scene.system.control.controller.is_none() {
        return Ok(());
    }
    let record = record(scene);
    if record["kind"] == GRIPPER_PATH {
        return Ok(());
    }
    if record["kind"] == MOVE && end(scene, &record, velocity).is_some() {
        let (duration, profile) = course(&record).ok_or("the reference is no move")?;
        gather.reference.push((velocity, profile.signal(by, 0.0, duration)));
        return Ok(());
    }
    let model = &scene.plan.model;
    let said = model.own_joints().find(|&j| model.v_range(j).contains(&velocity)).is_some_and(|joint| {
        let names = [&*model.joint_names()[joint], &*model.described_joint(joint).name];
        names.iter().any(|name| !record[*name].is_null())
    });
    if !said {
        gather.reference.push((velocity, Signal::constant(by)));
    }
    Ok(())
}

/// Whether the reference is a path of the gripper that is solved for the joints.
pub(super) fn solves_path(scene: &Scene<'_>) -> bool {
    let Some(controlled) = &scene.system.control.controller else { return false };
    let number = ControllerNumber { name: "kp".to_owned(), velocity: None };
    let acts_there = controlled.law.variation().is_some_and(|law| law.has(&number));
    record(scene)["kind"] == GRIPPER_PATH && !acts_there
}

/// Feedback in which constants change.
pub(super) fn feedback(
    scene: &Scene<'_>,
    text: Option<&FeedbackText>,
    constants: &Constants,
) -> Result<FeedbackSlope, String> {
    let text = text.ok_or("no derivative is known of what follows from the state")?;
    let names = senses(scene.plan);
    let names: Vec<&str> = names.iter().map(|(name, _)| name.as_str()).collect();
    let source = text.node.text().unwrap_or_default();
    FeedbackSlope::new(source, constants, &names, text.scale).map_err(|error| error.to_string())
}
