//! Which numbers of a scenario may be parameters, and what each of them moves: one row for a family of keys.

use super::control::{duration, gain, limit, reference, to};
use super::gather::{Gather, Moved, Scene, Slope};
use crate::changes::path::Step;
use crate::plan::events::EventPlan;
use springpot::actuation::Drive;
use springpot::control::FeedbackSlope;
use springpot::elements::Component;
use springpot::law::{Heat, Shift};
use springpot::model::JointKind;
use springpot::observe::{ElementQuantity, Quantity};
use springpot::spatial::{Quaternion, Rotation};
use springpot::system::{Action, Motion, Setting};

/// A step of a path that a row is about.
#[derive(Debug, Clone, Copy)]
enum At {
    /// This key.
    Key(&'static str),
    /// Any key.
    Any,
    /// An item of an array.
    Item,
}

/// What stands for a number that a file leaves out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum LeftOut {
    /// It must be there.
    Nothing,
    /// 0.
    Zero,
    /// 1.
    One,
    /// The components of this.
    Vector([f64; 3]),
    /// What the law says.
    OfLaw,
}

/// Numbers of one kind.
#[derive(Debug)]
pub(super) struct Row {
    path: &'static [At],
    pub(super) left_out: LeftOut,
    /// Whether functions of time may stand there.
    pub(super) is_signal: bool,
    pub(super) moves: fn(&mut Gather, &Scene<'_>, &[Step], Slope) -> Moved,
}

const fn row(
    path: &'static [At],
    left_out: LeftOut,
    moves: fn(&mut Gather, &Scene<'_>, &[Step], Slope) -> Moved,
) -> Row {
    Row { path, left_out, is_signal: false, moves }
}

/// Where functions of time may stand.
const fn signal(row: Row) -> Row {
    Row { is_signal: true, ..row }
}

use At::{Any, Item, Key};
use LeftOut::{Nothing, OfLaw, One, Vector, Zero};

const NONE: LeftOut = Vector([0.0; 3]);

/// All of them. What no row is about cannot be a parameter.
static ROWS: &[Row] = &[
    row(&[Key("robot"), Key("gravity"), Item], Vector([0.0, 0.0, -9.81]), gravity),
    row(&[Key("robot"), Key("gripper"), Key("point"), Item], Nothing, gripper),
    row(&[Key("robot"), Key("limits"), Key("stiffness")], Nothing, stop),
    row(&[Key("robot"), Key("limits"), Key("damping")], Zero, stop),
    row(&[Key("robot"), Key("body"), Item, Key("mass")], Nothing, mass),
    row(&[Key("robot"), Key("body"), Item, Key("com"), Item], NONE, com),
    row(&[Key("robot"), Key("body"), Item, Key("inertia"), Any], Zero, inertia),
    row(&[Key("robot"), Key("body"), Item, Key("joint"), Key("origin"), Item], NONE, origin),
    row(&[Key("robot"), Key("body"), Item, Key("joint"), Key("rpy"), Item], NONE, joint_rpy),
    row(&[Key("robot"), Key("body"), Item, Key("joint"), Key("axis"), Item], Vector([0.0, 0.0, 1.0]), axis),
    row(&[Key("robot"), Key("body"), Item, Key("joint"), Key("damping")], Zero, damping),
    row(&[Key("robot"), Key("body"), Item, Key("joint"), Key("damping"), Any], Zero, damping),
    row(&[Key("robot"), Key("body"), Item, Key("joint"), Key("friction")], Zero, friction),
    row(&[Key("robot"), Key("body"), Item, Key("joint"), Key("friction"), Key("force")], Nothing, friction),
    row(&[Key("robot"), Key("body"), Item, Key("joint"), Key("friction"), Any], Zero, friction),
    row(&[Key("robot"), Key("body"), Item, Key("joint"), Key("friction"), Any, Key("force")], Nothing, friction),
    row(&[Key("robot"), Key("body"), Item, Key("joint"), Key("armature")], Zero, armature),
    row(&[Key("robot"), Key("body"), Item, Key("joint"), Key("armature"), Any], Zero, armature),
    row(&[Key("robot"), Key("body"), Item, Key("joint"), Key("lower")], Nothing, end),
    row(&[Key("robot"), Key("body"), Item, Key("joint"), Key("upper")], Nothing, end),
    row(&[Key("robot"), Key("body"), Item, Key("joint"), Key("lower"), Any], Nothing, end),
    row(&[Key("robot"), Key("body"), Item, Key("joint"), Key("upper"), Any], Nothing, end),
    row(&[Key("element"), Item, Key("parameters"), Any], OfLaw, law),
    row(&[Key("element"), Item, Key("parameters"), Any, Item], Nothing, law),
    row(&[Key("element"), Item, Key("bushing"), Any, Key("parameters"), Any], OfLaw, law),
    row(&[Key("element"), Item, Key("bushing"), Any, Key("parameters"), Any, Item], Nothing, law),
    row(&[Key("element"), Item, Key("shift"), Any], Nothing, heat),
    row(&[Key("element"), Item, Key("thermal"), Any], Nothing, heat),
    row(&[Key("element"), Item, Key("expansion"), Any], Nothing, heat),
    row(&[Key("element"), Item, Key("bushing"), Any, Key("shift"), Any], Nothing, heat),
    row(&[Key("element"), Item, Key("bushing"), Any, Key("thermal"), Any], Nothing, heat),
    row(&[Key("element"), Item, Key("bushing"), Any, Key("expansion"), Any], Nothing, heat),
    row(&[Key("element"), Item, Key("rest_length")], Nothing, rest),
    row(&[Key("element"), Item, Key("rest")], Zero, rest),
    row(&[Key("element"), Item, Key("past"), Key("held")], Nothing, age),
    row(&[Key("element"), Item, Key("bushing"), Any, Key("rest")], Zero, rest),
    row(&[Key("element"), Item, Key("from"), Key("point"), Item], Nothing, end_point),
    row(&[Key("element"), Item, Key("to"), Key("point"), Item], Nothing, end_point),
    row(&[Key("element"), Item, Key("via"), Item, Key("point"), Item], Nothing, via_point),
    row(&[Key("element"), Item, Key("from"), Key("rpy"), Item], NONE, end_rpy),
    row(&[Key("element"), Item, Key("to"), Key("rpy"), Item], NONE, end_rpy),
    signal(row(&[Key("element"), Item, Key("inputs"), Any], Nothing, input)),
    signal(row(&[Key("element"), Item, Key("bushing"), Any, Key("inputs"), Any], Nothing, input)),
    row(&[Key("motion"), Key("start"), Key("q"), Any], Zero, start_q),
    row(&[Key("motion"), Key("start"), Key("q"), Any, Any], Zero, start_q),
    row(&[Key("motion"), Key("start"), Key("q"), Any, Key("rpy"), Item], NONE, start_q),
    row(&[Key("motion"), Key("start"), Key("v"), Any], Zero, start_v),
    row(&[Key("motion"), Key("start"), Key("v"), Any, Any], Zero, start_v),
    signal(row(&[Key("motion"), Key("torque"), Any], Zero, torque)),
    signal(row(&[Key("motion"), Key("torque"), Any, Any], Zero, torque)),
    signal(row(&[Key("event"), Item, Key("when")], Nothing, event_function)),
    row(&[Key("event"), Item, Key("action"), Key("set"), Any], Nothing, event_value),
    row(&[Key("motion"), Key("controller"), Key("kp")], Nothing, gain),
    row(&[Key("motion"), Key("controller"), Key("kp"), Any], Zero, gain),
    row(&[Key("motion"), Key("controller"), Key("kp"), Any, Any], Zero, gain),
    row(&[Key("motion"), Key("controller"), Key("kd")], Zero, gain),
    row(&[Key("motion"), Key("controller"), Key("kd"), Any], Zero, gain),
    row(&[Key("motion"), Key("controller"), Key("kd"), Any, Any], Zero, gain),
    row(&[Key("motion"), Key("controller"), Key("ki")], Zero, gain),
    row(&[Key("motion"), Key("controller"), Key("ki"), Any], Zero, gain),
    row(&[Key("motion"), Key("controller"), Key("ki"), Any, Any], Zero, gain),
    row(&[Key("motion"), Key("controller"), Key("lambda")], One, gain),
    row(&[Key("motion"), Key("controller"), Key("lambda"), Any], One, gain),
    row(&[Key("motion"), Key("controller"), Key("lambda"), Any, Any], One, gain),
    row(&[Key("motion"), Key("controller"), Key("mu")], One, gain),
    row(&[Key("motion"), Key("controller"), Key("mu"), Any], One, gain),
    row(&[Key("motion"), Key("controller"), Key("mu"), Any, Any], One, gain),
    row(&[Key("motion"), Key("controller"), Key("limits"), Any], Nothing, limit),
    row(&[Key("motion"), Key("controller"), Key("limits"), Any, Any], Nothing, limit),
    row(&[Key("motion"), Key("controller"), Key("rate_limits"), Any], Nothing, limit),
    row(&[Key("motion"), Key("controller"), Key("rate_limits"), Any, Any], Nothing, limit),
    row(&[Key("motion"), Key("controller"), Key("reference"), Key("duration")], Nothing, duration),
    row(&[Key("motion"), Key("controller"), Key("reference"), Key("to"), Any], Nothing, to),
    row(&[Key("motion"), Key("controller"), Key("reference"), Key("to"), Any, Any], Nothing, to),
    signal(row(&[Key("motion"), Key("controller"), Key("reference"), Any], Nothing, reference)),
    signal(row(&[Key("motion"), Key("controller"), Key("reference"), Any, Any], Nothing, reference)),
];

/// The row of the number that `steps` lead to.
pub(super) fn find(steps: &[Step]) -> Option<&'static Row> {
    let fits = |row: &&Row| {
        row.path.len() == steps.len()
            && row.path.iter().zip(steps).all(|(at, step)| match (at, step) {
                (Key(wanted), Step::Key(key)) => wanted == key,
                (Any, Step::Key(_)) => true,
                (Item, Step::Index(_)) => true,
                // Of an array that is not there.
                (Item, Step::Key(key)) => key.parse::<usize>().is_ok(),
                _ => false,
            })
    };
    ROWS.iter().find(fits)
}

/// Which item a step leads to.
fn item(step: &Step) -> usize {
    match step {
        Step::Index(index) => *index,
        Step::Key(key) => key.parse().unwrap_or(usize::MAX),
    }
}

pub(super) fn key(step: &Step) -> &str {
    match step {
        Step::Key(key) => key,
        Step::Index(_) => "",
    }
}

/// The direction of component `k`.
fn unit(k: usize) -> [f64; 3] {
    std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 })
}

fn gravity(gather: &mut Gather, _: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    let by = slope.number()?;
    let component = gather.gravity.get_mut(item(&steps[2])).ok_or("it has three components")?;
    *component += by;
    gather.moves_gravity = true;
    Ok(())
}

fn gripper(gather: &mut Gather, _: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    gather.shift(super::extended::Site::Gripper, unit(item(&steps[3])), slope.number()?);
    Ok(())
}

fn mass(gather: &mut Gather, _: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    gather.body(item(&steps[2])).mass += slope.number()?;
    Ok(())
}

fn com(gather: &mut Gather, _: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    let by = slope.number()?;
    *gather.body(item(&steps[2])).com.get_mut(item(&steps[4])).ok_or("it has three components")? += by;
    Ok(())
}

fn inertia(gather: &mut Gather, _: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    let (row, column) = match key(&steps[4]) {
        "xx" => (0, 0),
        "yy" => (1, 1),
        "zz" => (2, 2),
        "xy" => (0, 1),
        "xz" => (0, 2),
        "yz" => (1, 2),
        _ => return Err("an inertia has xx, yy, zz, xy, xz and yz".to_owned()),
    };
    let (inertia, by) = (&mut gather.body(item(&steps[2])).inertia, slope.number()?);
    inertia[row][column] += by;
    if row != column {
        inertia[column][row] += by;
    }
    Ok(())
}

fn origin(gather: &mut Gather, _: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    gather.shift(super::extended::Site::Joint(item(&steps[2])), unit(item(&steps[5])), slope.number()?);
    Ok(())
}

fn joint_rpy(gather: &mut Gather, scene: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    let body = item(&steps[2]);
    let rpy = scene.plan.bodies[body].joint.rpy;
    gather.turn(super::extended::Site::Joint(body), turn_of(rpy, item(&steps[5])), slope.number()?);
    Ok(())
}

/// About what a frame turns, in the axes that it is turned against, where roll, pitch or yaw change.
fn turn_of([_, pitch, yaw]: [f64; 3], k: usize) -> [f64; 3] {
    let ((sin_p, cos_p), (sin_y, cos_y)) = (pitch.sin_cos(), yaw.sin_cos());
    match k {
        0 => [cos_y * cos_p, sin_y * cos_p, -sin_p],
        1 => [-sin_y, cos_y, 0.0],
        _ => [0.0, 0.0, 1.0],
    }
}

/// A turn of the axis before the joint, and its inverse behind it, where the axis is that of the whole joint.
fn axis(gather: &mut Gather, scene: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    use super::extended::{Site, rotated};
    let body = item(&steps[2]);
    let joint = &scene.plan.bodies[body].joint;
    let is_of_one_axis = matches!(
        joint.kind,
        JointKind::Revolute
            | JointKind::Continuous
            | JointKind::Prismatic
            | JointKind::Helical
            | JointKind::Cylindrical
    );
    if !is_of_one_axis {
        return Err(format!("no derivative is known of the axis of {} joints", joint.kind.name()));
    }
    let (by, k) = (slope.number()?, item(&steps[5]));
    let length = joint.axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    let n = joint.axis.map(|x| x / length);
    let across: [f64; 3] = std::array::from_fn(|i| (unit(k)[i] - n[i] * n[k]) / length);
    let turn =
        [n[1] * across[2] - n[2] * across[1], n[2] * across[0] - n[0] * across[2], n[0] * across[1] - n[1] * across[0]];
    let size = turn.iter().map(|x| x * x).sum::<f64>().sqrt();
    if size > 0.0 {
        let turn = turn.map(|x| x / size);
        gather.turn(Site::Joint(body), rotated(joint.rpy, turn), by * size);
        gather.turn(Site::Behind(body), turn, -by * size);
    }
    Ok(())
}

/// The joints of the model that a key of a joint is about: all, or that of one coordinate.
fn joints(scene: &Scene<'_>, steps: &[Step]) -> Result<Vec<usize>, String> {
    let joint = &scene.plan.bodies[item(&steps[2])].joint.name;
    let described = scene.plan.model.described_joints().iter().find(|described| described.name == *joint);
    let all = described.map_or(0..0, |described| described.joints.clone());
    let part = steps.get(5).map(key).filter(|part| *part != "force");
    let Some(part) = part else { return Ok(all.collect()) };
    let name = format!("{joint}.{part}");
    let found: Vec<usize> = all.filter(|&j| scene.plan.model.joint_names()[j] == name).collect();
    if found.is_empty() { Err("no derivative by it is known".to_owned()) } else { Ok(found) }
}

/// Stiffness or damping of all ends of joints.
fn stop(gather: &mut Gather, scene: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    let by = slope.number()?;
    let number = usize::from(key(&steps[2]) == "damping");
    (0..scene.plan.model.joint_count()).for_each(|joint| gather.stop(joint)[number] += by);
    Ok(())
}

/// An end of a joint.
fn end(gather: &mut Gather, scene: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    let by = slope.number()?;
    let number = if key(&steps[4]) == "lower" { 2 } else { 3 };
    joints(scene, steps)?.into_iter().for_each(|joint| gather.stop(joint)[number] += by);
    Ok(())
}

fn damping(gather: &mut Gather, scene: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    let by = slope.number()?;
    gather.damping.extend(joints(scene, steps)?.into_iter().map(|joint| (joint, by)));
    Ok(())
}

fn friction(gather: &mut Gather, scene: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    let by = slope.number()?;
    gather.friction.extend(joints(scene, steps)?.into_iter().map(|joint| (joint, by)));
    Ok(())
}

fn armature(gather: &mut Gather, scene: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    let by = slope.number()?;
    gather.armature.extend(joints(scene, steps)?.into_iter().map(|joint| (joint, by)));
    Ok(())
}

/// The elements that act of the one that a path leads into: itself, or components of a bushing.
fn elements(scene: &Scene<'_>, steps: &[Step]) -> Vec<usize> {
    let item = scene.document.get("element").and_then(|all| all.items()?.get(item(&steps[1])));
    let Some(name) = item.and_then(|item| item.get("name")?.text()) else { return Vec::new() };
    let component = match steps.get(2..4) {
        Some([Step::Key(bushing), Step::Key(component)]) if bushing == "bushing" => Some(component),
        _ => None,
    };
    let is_meant = |own: &str| match component {
        Some(component) => own == format!("{name}.{component}"),
        None => own == name || Component::ALL.iter().any(|component| own == format!("{name}.{}", component.name())),
    };
    (0..scene.plan.elements.len()).filter(|&e| is_meant(&scene.plan.elements[e].element.name)).collect()
}

fn law(gather: &mut Gather, scene: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    let by = slope.number()?;
    let name = match steps {
        [.., Step::Key(list), Step::Index(k)] => format!("{list}.{k}"),
        [.., last] => key(last).to_owned(),
        [] => String::new(),
    };
    for e in elements(scene, steps) {
        let plan = &scene.plan.elements[e];
        let Some(k) = plan.element.entry.params.iter().position(|param| param.name == name) else {
            return Err(format!("law {} has no number `{name}`", plan.element.entry.quoted()));
        };
        let is_order = name == "alpha" || name.starts_with("alpha_") && plan.element.entry.params[k].unit.is_empty();
        let is_at_an_end = plan.parameters[k] == 0.0 || plan.parameters[k] == 1.0;
        if is_order && is_at_an_end && is_the_order(plan, &name) {
            let why = "the derivative there needs a memory that the run has not: start at 0.01 or 0.99";
            return Err(format!("it is {}: {why}", plan.parameters[k]));
        }
        if plan.element.scheme.is_some() {
            return Err("its element has a named `scheme`, of which no derivative is known".to_owned());
        }
        gather.law(e, plan.parameters.len())[k] += by;
    }
    Ok(())
}

/// What temperature does: the shift, the thermal state, the expansion.
fn heat(gather: &mut Gather, scene: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    let by = slope.number()?;
    let (table, name) = (key(&steps[steps.len() - 2]), key(&steps[steps.len() - 1]));
    let is_written = |name: &str| {
        let mut node: &crate::text::document::Node = scene.document;
        for step in steps.iter().take(steps.len() - 1) {
            node = match step {
                Step::Key(key) => node.get(key)?,
                Step::Index(index) => node.items()?.get(*index)?,
            };
        }
        node.get(name)
    };
    for e in elements(scene, steps) {
        let starts_with_ambient = is_written("start").is_none();
        let Some(own) = gather.heat(e, scene.plan) else { return Err("no temperature acts on it".to_owned()) };
        let Heat { shift, thermal, expansion } = own;
        let number = match (table, name, shift, thermal, expansion) {
            ("shift", "C1", Some(Shift::Wlf { c1, .. }), ..) => c1,
            ("shift", "C2", Some(Shift::Wlf { c2, .. }), ..) => c2,
            ("shift", "energy", Some(Shift::Arrhenius { energy, .. }), ..) => energy,
            ("shift", "T_ref", Some(Shift::Wlf { reference, .. } | Shift::Arrhenius { reference, .. }), ..) => {
                reference
            }
            ("thermal", "capacity", _, Some(thermal), _) => &mut thermal.capacity,
            ("thermal", "conductance", _, Some(thermal), _) => &mut thermal.conductance,
            ("thermal", "ambient", _, Some(thermal), _) => {
                // What is left out starts as warm as that.
                if starts_with_ambient {
                    thermal.start += by;
                }
                &mut thermal.ambient
            }
            ("thermal", "start", _, Some(thermal), _) => &mut thermal.start,
            ("expansion", "coefficient", _, _, Some(expansion)) => &mut expansion.coefficient,
            ("expansion", "T_ref", _, _, Some(expansion)) => &mut expansion.reference,
            _ => return Err("no derivative by it is known".to_owned()),
        };
        *number += by;
    }
    Ok(())
}

/// Whether a parameter of this name is an order: units have it as an exponent.
fn is_the_order(plan: &crate::ElementPlan, name: &str) -> bool {
    plan.element.entry.params.iter().any(|param| param.unit.contains(&format!("^{name}")))
}

/// The value of a parameter of the same law, which units may name as an exponent.
pub(super) fn exponent(scene: &Scene<'_>, steps: &[Step], name: &str) -> Option<f64> {
    let [Step::Key(section), _, ..] = steps else { return None };
    if section != "element" {
        return None;
    }
    let plan = &scene.plan.elements[*elements(scene, steps).first()?];
    let k = plan.element.entry.params.iter().position(|param| param.name == name)?;
    plan.parameters.get(k).copied()
}

fn rest(gather: &mut Gather, scene: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    let by = slope.number()?;
    gather.rest.extend(elements(scene, steps).into_iter().map(|e| (e, by)));
    Ok(())
}

/// For how long elements were held.
fn age(gather: &mut Gather, scene: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    let by = slope.number()?;
    gather.age.extend(elements(scene, steps).into_iter().map(|e| (e, by)));
    Ok(())
}

fn end_point(gather: &mut Gather, scene: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    let (by, is_first) = (slope.number()?, key(&steps[2]) == "from");
    for e in elements(scene, steps) {
        gather.shift(scene.end(e, is_first), unit(item(&steps[4])), by);
    }
    Ok(())
}

fn via_point(gather: &mut Gather, scene: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    let by = slope.number()?;
    for e in elements(scene, steps) {
        gather.shift(super::extended::Site::Point(e, 1 + item(&steps[3])), unit(item(&steps[5])), by);
    }
    Ok(())
}

fn end_rpy(gather: &mut Gather, scene: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    let (by, is_first) = (slope.number()?, key(&steps[2]) == "from");
    for e in elements(scene, steps) {
        gather.turn(scene.end(e, is_first), turn_of(scene.rpy(e, is_first), item(&steps[4])), by);
    }
    Ok(())
}

fn input(gather: &mut Gather, scene: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    let name = steps.last().map_or("", key);
    for e in elements(scene, steps) {
        let inputs = &scene.plan.elements[e].element.entry.inputs;
        let input = inputs.iter().position(|input| input.name == name).ok_or("its law has no such input")?;
        match slope.clone() {
            Slope::Feedback(constants) => {
                let text = scene.plan.elements[e].inputs[input].feedback.as_deref();
                gather.fed_back.push((e, input, super::control::feedback(scene, text, &constants)?));
            }
            slope => gather.input(e, input, slope)?,
        }
    }
    Ok(())
}

/// The velocity that a path by joint leads to: that of a joint of one degree, or one of those of a joint that turns freely.
pub(super) fn velocity(scene: &Scene<'_>, steps: &[Step]) -> Result<usize, String> {
    let name = steps.iter().map(key).collect::<Vec<_>>().join(".");
    let model = &scene.plan.model;
    let joint = model.own_joints().find(|&j| model.joint_names()[j] == name);
    if let Some(j) = joint.filter(|&j| model.joint_space(j).dimension().is_some()) {
        return Ok(model.v_range(j).start);
    }
    let of_part = || {
        let (joint, part) = (free_joint(scene, steps)?, key(steps.get(1)?));
        let place = model.joint_space(joint).velocities().iter().position(|(name, _)| *name == part)?;
        Some(model.v_range(joint).start + place)
    };
    of_part().ok_or_else(|| "no derivative by it is known".to_owned())
}

/// The joint that turns freely which a path by joint leads to.
fn free_joint(scene: &Scene<'_>, steps: &[Step]) -> Option<usize> {
    let model = &scene.plan.model;
    let joint = model.own_joints().find(|&j| model.joint_names()[j] == key(&steps[0]));
    joint.filter(|&j| model.joint_space(j).quaternion().is_some())
}

/// How a joint that turns freely starts otherwise where one of its numbers is larger by 1: its velocities, in its own axes.
fn free_start(scene: &Scene<'_>, joint: usize, steps: &[Step]) -> Result<Vec<(usize, f64)>, String> {
    let (model, Motion::Forward(forward)) = (&scene.plan.model, &scene.system.motion) else {
        return Err("the motion is given in advance".to_owned());
    };
    let (q, first) = (&forward.q[model.q_range(joint)], model.v_range(joint).start);
    let turn = model.joint_space(joint).quaternion().unwrap_or(0);
    let Rotation(turned) = Rotation::from_quaternion(Quaternion([q[turn], q[turn + 1], q[turn + 2], q[turn + 3]]));
    if let Some(axis) = ["x", "y", "z"].iter().position(|axis| *axis == key(&steps[1])).filter(|_| turn == 3) {
        return Ok((0..3).map(|k| (first + k, turned[axis][k])).collect());
    }
    // R = Rz(yaw) Ry(pitch) Rx(roll).
    let (sine, level) = (-turned[2][0], turned[2][1].hypot(turned[2][2]));
    let by = match (key(&steps[1]), steps.get(2).map(item)) {
        ("rpy", Some(0)) => [1.0, 0.0, 0.0],
        ("rpy", Some(1)) if level > UPRIGHT => [0.0, turned[2][2] / level, -turned[2][1] / level],
        ("rpy", Some(1)) => return Err("at a pitch of 90 deg roll and yaw are one angle".to_owned()),
        ("rpy", Some(2)) => [-sine, turned[2][1], turned[2][2]],
        _ => return Err("no derivative by it is known".to_owned()),
    };
    Ok(by.iter().enumerate().map(|(k, by)| (first + turn + k, *by)).collect())
}

/// Cosine of the pitch beyond which roll and yaw are told apart.
const UPRIGHT: f64 = 1e-9;

/// Why the start of a joint that nothing moves cannot be a parameter.
const COASTS: &str = "no derivative is known of joints that go on as they start, since they carry no mass";

fn start_q(gather: &mut Gather, scene: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    if let Some(joint) = free_joint(scene, &steps[3..]).filter(|_| steps.len() > 4) {
        let by = slope.number()?;
        for (velocity, own) in free_start(scene, joint, &steps[3..])? {
            match scene.drive(velocity) {
                Some(Drive::Prescribed(_)) if scene.says("prescribed", velocity) => {}
                Some(Drive::Prescribed(_)) => return Err(COASTS.to_owned()),
                _ => gather.q.push((velocity, by * own)),
            }
        }
        return Ok(());
    }
    let velocity = velocity(scene, &steps[3..])?;
    // Where a joint starts that is prescribed, its path says.
    match scene.drive(velocity) {
        Some(Drive::Prescribed(_)) if scene.says("prescribed", velocity) => return Ok(()),
        Some(Drive::Prescribed(_)) => return Err(COASTS.to_owned()),
        _ => {}
    }
    let by = slope.number()?;
    gather.q.push((velocity, by));
    super::control::follow_start(gather, scene, velocity, by)
}

fn start_v(gather: &mut Gather, scene: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    let velocity = velocity(scene, &steps[3..])?;
    match scene.drive(velocity) {
        Some(Drive::Prescribed(_)) if scene.says("prescribed", velocity) => return Ok(()),
        Some(Drive::Locked) if scene.says("locked", velocity) => return Ok(()),
        Some(Drive::Prescribed(_) | Drive::Locked) => return Err(COASTS.to_owned()),
        _ => {}
    }
    gather.v.push((velocity, slope.number()?));
    Ok(())
}

fn torque(gather: &mut Gather, scene: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    let velocity = velocity(scene, &steps[2..])?;
    match slope {
        Slope::Feedback(constants) => {
            let text = scene.plan.motion.feedback().iter().find(|(own, _)| *own == velocity).map(|(_, text)| &**text);
            gather.torques.push((velocity, super::control::feedback(scene, text, &constants)?));
        }
        slope => gather.drive(velocity, slope)?,
    }
    Ok(())
}

/// The function of an event.
fn event_function(gather: &mut Gather, scene: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    let event = item(&steps[1]);
    let Slope::Feedback(constants) = slope else { return gather.when_of_time(event, slope) };
    let plan = scene.plan.events.get(event).ok_or("there is no such event")?;
    let columns = EventPlan::columns(scene.plan);
    let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
    let by = FeedbackSlope::new(&plan.event.when.to_string(), &constants, &columns, 1.0);
    gather.when.push((event, by.map_err(|error| error.to_string())?));
    Ok(())
}

/// A value that an event sets.
fn event_value(gather: &mut Gather, scene: &Scene<'_>, steps: &[Step], slope: Slope) -> Moved {
    let (event, column) = (item(&steps[1]), key(&steps[4]));
    let observables = scene.plan.acting_observables();
    let is_named = |of: &Quantity| observables.named(*of).to_string() == column;
    let Some(of) = observables.quantities().into_iter().find(is_named) else { return Ok(()) };
    let Some(Action::Set(settings)) = scene.plan.events.get(event).map(|event| &event.event.action) else {
        return Err("its event sets nothing".to_owned());
    };
    let is_set = |setting: &Setting| match *setting {
        Setting::Input { element, input, .. } => of == Quantity::Element(element, ElementQuantity::InputValue(input)),
        Setting::Torque { velocity, .. } => of == Quantity::Torque(velocity),
    };
    let setting = settings.iter().position(is_set).ok_or("its event does not set that")?;
    gather.set.push((event, setting, slope.number()?));
    Ok(())
}
