//! `[motion.controller]`: what drives the joints of a robot that moves by itself.

use super::gripper_path;
use super::joints::{ByJoint, Parts};
use super::shaping;
use crate::keys::{self, CONTROLLER, ControllerKind, Gained, Gains, REFERENCE};
use crate::reader::{Field, Read, Table, all};
use crate::robot::{OwnJoint, Robot};
use crate::signals::feedback;
use crate::signals::of_time::Wanted;
use crate::text::document::shorten;
use crate::text::names;
use crate::text::refusal::{Place, RefusalKind, Remark};
use serde_json::{Map, Value, json};
use springpot::control::{AntiWindup, Controlled, Controller, Limit, Profile, Reference, Sampling};
use springpot::law::Range;
use springpot::model::{Dimension, Model, Space};
use springpot::motion::gripper_path::{Course, GripperPoint};
use springpot::motion::{JointPath, Trajectory};
use springpot::signal::Signal;
use std::sync::Arc;

/// Shares of a period by which a delay may miss a multiple of it.
const WHOLE: f64 = 1e-9;

/// Most samples that wait for their delay.
const LONGEST_DELAY: f64 = 1e6;

/// A controller as it was read.
#[derive(Debug, Clone)]
pub(super) struct ControllerPlan {
    controlled: Controlled,
    /// Where the time between its samples stands.
    sample: Option<Place>,
    /// In place of the reference, where it has to be solved for.
    path: Option<Arc<gripper_path::Path>>,
    /// Where its limits stand.
    limits: Option<Place>,
    /// Where it stands, and its reference.
    place: Place,
    reference: Place,
    /// Where the reference says something of each joint.
    signals: Vec<(String, Place)>,
    /// Whether the reference says how the gripper is to be turned.
    pub(super) has_orientation: bool,
    /// As the record of a run has it.
    pub(super) record: Value,
}

impl ControllerPlan {
    /// Where the time between two samples stands, and what it is, s.
    pub(super) fn sample(&self) -> Option<(&Place, f64)> {
        self.sample.as_ref().zip(self.controlled.sampling.map(|sampling| sampling.period))
    }

    /// Largest forces by joint, N·m or N, and where they are said.
    pub(super) fn limits(&self) -> Option<(&Place, Vec<(String, f64)>)> {
        let listed = self.record["limits"].as_object()?;
        let each = listed.iter().filter_map(|(joint, value)| Some((joint.clone(), value.as_f64()?)));
        Some((self.limits.as_ref()?, each.collect()))
    }

    /// Its kind, what it follows, when it acts.
    pub(super) fn words(&self) -> String {
        let word = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        let mut words = format!("{}, follows {}", word(&self.record["kind"]), word(&self.record["reference"]["kind"]));
        let kept = [
            ("filter", "derivative filtered"),
            ("set_point_weight", "set point weighted"),
            ("feed_forward", "fed forward"),
            ("noise", "noisy"),
            ("quantization", "quantized"),
            ("limits", "torques limited"),
            ("rate_limits", "rates limited"),
        ];
        for (key, said) in kept {
            if self.record.get(key).is_some() {
                words += &format!(", {said}");
            }
        }
        match self.controlled.sampling {
            None => words,
            Some(Sampling { period, delay: 0 }) => format!("{words}, every {period} s"),
            Some(Sampling { period, delay }) => {
                format!("{words}, every {period} s, {} s late", period * delay as f64)
            }
        }
    }

    /// Where it stands.
    pub(super) fn place(&self) -> &Place {
        &self.place
    }

    /// Where its reference says what `what` is to do, `joint "elbow"`; where the reference stands, if it says it of none alone.
    pub(super) fn reference_place(&self, what: &str) -> &Place {
        let own = self.signals.iter().find(|(joint, _)| what == format!("joint \"{joint}\""));
        own.map_or(&self.reference, |(_, place)| place)
    }

    /// Where its reference stands, if it is a path of the gripper.
    pub(super) fn path_place(&self) -> Option<&Place> {
        self.path.as_ref().map(|_| &self.reference)
    }

    pub(super) fn made(&self, model: &Model, course: &Course<'_>) -> Controlled {
        let mut controlled = self.controlled.clone();
        if let Some(path) = &self.path {
            controlled.reference = Reference::new(path.trajectory(model, course));
        }
        controlled
    }
}

/// The joints of a robot, where they start, and which of them forces drive.
pub(super) struct Joints<'r> {
    pub(super) robot: &'r Robot,
    /// q(0).
    pub(super) start: &'r [f64],
    pub(super) is_driven: &'r dyn Fn(&OwnJoint<'_>) -> bool,
    /// How a joint moves whose motion is prescribed.
    pub(super) moved: &'r dyn Fn(&str) -> Option<JointPath>,
}

impl<'r> Joints<'r> {
    /// The joints that a controller drives, each with its place in v.
    pub(super) fn driven(&self) -> impl Iterator<Item = (usize, OwnJoint<'r>)> {
        let model = self.robot.model();
        let joints = model.own_joints().zip(self.robot.own_joints());
        let driven = joints.filter(|(_, joint)| joint.units().is_some() && (self.is_driven)(joint));
        driven.map(|(j, joint)| (model.v_range(j).start, joint))
    }

    /// Opens a table by joints that a controller drives; one value may stand for all coordinates of a joint.
    pub(super) fn open(&self, field: &Field<'r>) -> Read<ByJoint<'r>> {
        let mut names: Vec<&str> = self.driven().map(|(_, joint)| joint.joint).collect();
        names.dedup();
        let reason = |key: &str| {
            if let Some(why) = self.robot.why_no_coordinate(key) {
                return Some((RefusalKind::Rule, why));
            }
            let own = self.robot.own_joints().find(|joint| joint.joint == key)?;
            let why = if own.units().is_some() { "no force drives it" } else { "it has several degrees of freedom" };
            Some((RefusalKind::Rule, format!("joint {key:?} is none that the controller drives: {why}")))
        };
        let table = Table::open_with(field.ctx, field.node, field.to_string(), &names, reason)?;
        ByJoint::inside(table, self.robot, Parts::Coordinates, true)
    }
}

/// Reads the controller of these joints.
pub(super) fn read(field: &Field<'_>, joints: &Joints<'_>, end: Option<f64>) -> Read<ControllerPlan> {
    let kind = kind_of(field, &CONTROLLER, "kind of controller")?;
    let table = Table::of_kind(field.ctx, field.node, "[motion.controller]", (&CONTROLLER, kind), |key| {
        let row = CONTROLLER.get(key)?;
        let kinds = names::either(row.only.iter().map(|kind| format!("{kind:?}")));
        Some((RefusalKind::Rule, format!("`{key}` of [motion.controller] belongs to kind = {kinds}")))
    })?;
    if joints.driven().next().is_none() {
        let message = format!("kind = {kind:?} drives no joint: of this robot none of one degree is driven by forces");
        let help = "leave [motion.controller] out; a floating joint is driven by `torque`, others where they are not locked or prescribed";
        return Err(field.ctx.refuse(field.node.place.refuse(RefusalKind::Rule, message).help(help)));
    }
    let mut record = Map::new();
    record.insert("kind".to_owned(), json!(kind));
    let kind = ControllerKind::named(kind);
    let law = law(&table, kind, joints, &mut record);
    let reference = table.require("reference").and_then(|field| reference(&field, kind, joints, end));
    let limits = limits(&table, joints, &mut record);
    let anti_windup = match table.get("anti_windup").map(|field| field.word("rule")).transpose()? {
        Some(keys::NONE) => AntiWindup::None,
        _ => AntiWindup::Conditional,
    };
    let sampling = sampling(&table, &mut record);
    let shaping = shaping::shaping(&table, joints, &mut record);
    let feed_forward = shaping::feed_forward(&table, joints, end, &mut record);
    let (law, (reference, path, referred), limits, sampling) = (law?, reference?, limits?, sampling?);
    let measurement = shaping::measurement(&table, joints, sampling.as_ref(), &mut record);
    let (shaping, feed_forward, measurement) = (shaping?, feed_forward?, measurement?);
    let (own, written) = (field.node.place.clone(), table.get("reference"));
    let has_orientation = written.as_ref().is_some_and(|field| field.node.get("rpy").is_some());
    let entries = written.as_ref().and_then(|field| field.node.entries()).unwrap_or_default();
    let signals = entries.iter().map(|entry| (entry.key.clone(), entry.node.place.clone())).collect();
    let to = written.map_or_else(|| own.clone(), |field| field.node.place.clone());
    if kind.integrates() {
        let word = if anti_windup == AntiWindup::None { keys::NONE } else { keys::CONDITIONAL };
        record.insert("anti_windup".to_owned(), json!(word));
    }
    record.insert("reference".to_owned(), referred);
    let controlled = Controlled { law, reference, limits, anti_windup, sampling, shaping, feed_forward, measurement };
    let sample = table.get("sample").map(|field| field.node.place.clone());
    let limits = table.get("limits").map(|field| field.node.place.clone());
    Ok(ControllerPlan {
        limits,
        controlled,
        sample,
        path,
        place: own,
        reference: to,
        signals,
        has_orientation,
        record: record.into(),
    })
}

/// The word under `kind` of a table.
fn kind_of<'a>(field: &Field<'a>, keys: &'static keys::Keys, what: &str) -> Read<&'a str> {
    if field.node.entries().is_none() {
        return Err(field.wrong_type("a table with a `kind`"));
    }
    let row = keys.get("kind");
    let Some(node) = field.node.get("kind") else {
        let refusal = field.node.place.refuse(RefusalKind::Missing, format!("{field} has no `kind`"));
        return Err(field
            .ctx
            .refuse(refusal.help(format!("write {}", row.map(|row| row.right()).unwrap_or_default()))));
    };
    Field { key: "kind", row, node, owner: field.to_string().into(), ctx: field.ctx }.word(what)
}

fn law(
    table: &Table<'_>,
    kind: &ControllerKind,
    joints: &Joints<'_>,
    record: &mut Map<String, Value>,
) -> Read<Arc<dyn Controller>> {
    match kind.gains {
        Gains::AtGripper(units) => at_gripper(table, kind, units, joints, record),
        Gains::OfJoints(units) => of_joints(table, kind, units, joints, record),
    }
}

/// A law whose gains act at the gripper.
fn at_gripper(
    table: &Table<'_>,
    kind: &ControllerKind,
    [of_error, of_rate]: [&str; 2],
    joints: &Joints<'_>,
    record: &mut Map<String, Value>,
) -> Read<Arc<dyn Controller>> {
    if joints.robot.gripper.is_none() {
        let message = format!("kind = {:?} needs a gripper, but the robot has none", kind.name);
        let refusal = table.node.place.refuse(RefusalKind::Missing, message);
        return Err(table.ctx.refuse(refusal.help("write [robot.gripper] with body = \"NAME\" and point = [x, y, z]")));
    }
    let gain = |key: &'static str, unit: &str| match table.get(key) {
        None => table.number(key),
        Some(field) if field.node.entries().is_some() && !crate::reader::constants::is_expression(field.node) => {
            let message = format!("is a table by joints, but {} acts at the gripper", kind.name);
            Err(field.refuse(RefusalKind::WrongType, message, Some(format!("write a number (in {unit})"))))
        }
        Some(field) => not_negative(&field, unit, &|_| 1.0, 0),
    };
    if table.get("kp").is_none() {
        return Err(table.lacks("kp"));
    }
    let (kp, kd) = (gain("kp", of_error)?, gain("kd", of_rate)?);
    warn_of_no_gain(table, kind, [&[kp][..], &[kd]]);
    record.extend([("kp".to_owned(), json!(kp)), ("kd".to_owned(), json!(kd))]);
    Ok((kind.law)(Gained { kp: vec![kp], kd: vec![kd], ..Gained::default() }))
}

/// A law whose gains are those of joints that turn and that slide, in these units.
fn of_joints(
    table: &Table<'_>,
    kind: &ControllerKind,
    [turns, slides]: [&'static [&'static str]; 2],
    joints: &Joints<'_>,
    record: &mut Map<String, Value>,
) -> Read<Arc<dyn Controller>> {
    if table.get("kp").is_none() {
        return Err(table.lacks("kp"));
    }
    if kind.drives_all
        && let Some(joint) = joints.robot.own_joints().find(|joint| joint.units().is_none())
    {
        let (is, name) = (joints.robot.kind_of(&joint).name(), kind.name);
        let message = format!("kind = {name:?} drives joints of one degree, but joint {:?} is {is}", joint.name);
        return Err(table.ctx.refuse(table.node.place.refuse(RefusalKind::Rule, message)));
    }
    let order = |key: &'static str| -> Read<Vec<f64>> {
        if !kind.has_orders {
            return Ok(vec![1.0; joints.robot.model().nv()]);
        }
        by_joint(table, key, joints, 1.0, &|field, _, _| {
            let value = field.number("")?;
            if value > 0.0 && value <= 1.0 {
                return Ok(value);
            }
            let message = format!("is {value}, but an order is above 0 and at most 1");
            Err(field.refuse(RefusalKind::OutOfRange, message, Some("write 0.5, or 1 for the whole order".to_owned())))
        })
    };
    let (lambda, mu) = (order("lambda")?, order("mu")?);
    let gain = |key: &'static str, which: usize| {
        by_joint(table, key, joints, 0.0, &|field, joint, velocity| {
            let slide = joint.space.dimension() == Some(Dimension::Length);
            let unit = if slide { slides[which] } else { turns[which] };
            let exponent = |k: usize| if which == 2 { lambda[k] } else { mu[k] };
            not_negative(field, unit, &exponent, velocity)
        })
    };
    let (kp, kd) = (gain("kp", 0)?, gain("kd", 1)?);
    let ki = if kind.integrates() { gain("ki", 2)? } else { Vec::new() };
    warn_of_no_gain(table, kind, [&kp[..], &kd, &ki]);
    let mut list = |key: &str, values: &[f64]| shaping::list(record, key, joints, values);
    list("kp", &kp);
    list("kd", &kd);
    if kind.integrates() {
        list("ki", &ki);
    }
    if kind.has_orders {
        list("lambda", &lambda);
        list("mu", &mu);
    }
    let compensate_elements = kind.compensates && table.flag("compensate_elements")?;
    if kind.compensates {
        record.insert("compensate_elements".to_owned(), json!(compensate_elements));
    }
    Ok((kind.law)(Gained { kp, kd, ki, lambda, mu, compensate_elements }))
}

/// Says that a controller does not look at the error.
fn warn_of_no_gain<const N: usize>(table: &Table<'_>, kind: &ControllerKind, gains: [&[f64]; N]) {
    if gains.iter().any(|gains| gains.iter().any(|gain| *gain != 0.0)) {
        return;
    }
    let place = table.get("kp").map_or(&table.node.place, |field| &field.node.place);
    let remark = Remark::at(place, format!("all gains of [motion.controller] are 0: {}", kind.without_gains));
    table.ctx.warn(remark.help("write kp and kd above 0, or leave [motion.controller] out"));
}

/// A gain; `order` is that of the velocity, by which its unit may have an exponent.
fn not_negative(field: &Field<'_>, unit: &str, order: &dyn Fn(usize) -> f64, velocity: usize) -> Read<f64> {
    let value = field.number_with(unit, &|name| matches!(name, "order" | "lambda" | "mu").then(|| order(velocity)))?;
    if value >= 0.0 {
        return Ok(value);
    }
    let message = format!("is {}, but a gain is not negative", field.node.label());
    Err(field.refuse(
        RefusalKind::OutOfRange,
        message,
        Some("e = q_d − q already has the sign of what is missing".to_owned()),
    ))
}

/// A value for each velocity (nv): one for all joints that are driven, or by joint; `left_out` where there is none.
pub(super) fn by_joint(
    table: &Table<'_>,
    key: &'static str,
    joints: &Joints<'_>,
    left_out: f64,
    read: &dyn Fn(&Field<'_>, &OwnJoint<'_>, usize) -> Read<f64>,
) -> Read<Vec<f64>> {
    let mut values = vec![left_out; joints.robot.model().nv()];
    let Some(field) = table.get(key) else { return Ok(values) };
    let is_table = field.node.entries().is_some() && !crate::reader::constants::is_expression(field.node);
    let given = if is_table { Some(joints.open(&field)?) } else { None };
    let driven: Vec<_> = joints.driven().collect();
    for (velocity, joint) in &driven {
        let own = match &given {
            None => Some(field.clone()),
            Some(given) => given.get(joint),
        };
        if let Some(own) = own {
            values[*velocity] = read(&own, joint, *velocity)?;
        }
    }
    Ok(values)
}

fn limits(table: &Table<'_>, joints: &Joints<'_>, record: &mut Map<String, Value>) -> Read<Vec<Limit>> {
    let mut limits = vec![Limit::default(); joints.robot.model().nv()];
    for (key, per) in [("limits", ""), ("rate_limits", "/s")] {
        let Some(field) = table.get(key) else { continue };
        let given = joints.open(&field)?;
        let driven: Vec<_> = joints.driven().collect();
        let read = all(driven.iter().filter_map(|(k, joint)| Some((k, joint, given.get(joint)?))).map(
            |(k, joint, field)| {
                let value = field.number(&format!("{}{per}", joint.units().map_or("", |units| units.force)))?;
                if value > 0.0 {
                    return Ok((*k, joint.name, value));
                }
                let message =
                    format!("is {}, but a limit is positive: it bounds the size of the force", field.node.label());
                Err(field.refuse(RefusalKind::OutOfRange, message, Some("write the largest size".to_owned())))
            },
        ))?;
        let mut listed = Map::new();
        for (k, name, value) in read {
            *(if per.is_empty() { &mut limits[k].torque } else { &mut limits[k].rate }) = value;
            listed.insert(name.to_owned(), json!(value));
        }
        record.insert(key.to_owned(), listed.into());
    }
    Ok(limits)
}

fn sampling(table: &Table<'_>, record: &mut Map<String, Value>) -> Read<Option<Sampling>> {
    let sample = table.get("sample").map(|field| field.quantity()).transpose()?;
    let delay = table.get("delay");
    let Some(period) = sample else {
        return match delay {
            Some(field) if field.quantity()? != 0.0 => {
                let message = "needs a `sample`, of which it is a multiple";
                Err(field.refuse(RefusalKind::Rule, message, Some("write sample = \"1 ms\"".to_owned())))
            }
            _ => Ok(None),
        };
    };
    let mut periods = 0;
    if let Some(field) = delay {
        let value = field.quantity()?;
        let whole = (value / period).round();
        if value < 0.0 {
            let message = format!("is {}, but a delay is not negative", field.node.label());
            return Err(field.refuse(RefusalKind::OutOfRange, message, Some(format!("write 0, or {period} (s)"))));
        }
        if whole > LONGEST_DELAY {
            let message =
                format!("is {}, {whole:e} times `sample`; at most {LONGEST_DELAY} are taken", field.node.label());
            let help = "take a longer sample, or a shorter delay".to_owned();
            return Err(field.refuse(RefusalKind::TooLarge, message, Some(help)));
        }
        if (value / period - whole).abs() > WHOLE * whole.max(1.0) {
            let message = format!("is {}, which is no multiple of `sample`, {period} s", field.node.label());
            let near = whole * period;
            return Err(field.refuse(RefusalKind::Rule, message, Some(format!("write {near} (s), or another sample"))));
        }
        periods = whole as usize;
    }
    record.insert("sample".to_owned(), json!(period));
    record.insert("delay".to_owned(), json!(periods as f64 * period));
    Ok(Some(Sampling { period, delay: periods }))
}

type Referred = (Reference, Option<Arc<gripper_path::Path>>, Value);

/// What a law of that kind aims at.
fn reference(field: &Field<'_>, law: &ControllerKind, joints: &Joints<'_>, end: Option<f64>) -> Read<Referred> {
    let kind = kind_of(field, &REFERENCE, "kind of reference")?;
    let wrong = |key: &str| -> Option<(RefusalKind, String)> {
        if let Some(row) = REFERENCE.get(key).filter(|row| !row.only.is_empty()) {
            let kinds = names::either(row.only.iter().map(|kind| format!("{kind:?}")));
            return Some((RefusalKind::Rule, format!("`{key}` of {field} belongs to kind = {kinds}")));
        }
        joints.robot.why_no_coordinate(key).map(|why| (RefusalKind::Rule, why))
    };
    if kind == keys::GRIPPER_PATH {
        let table = Table::of_kind(field.ctx, field.node, field.to_string(), (&REFERENCE, kind), wrong)?;
        let guess = table.get("guess").is_some();
        let (mut record, mut path) = gripper_path::path(&table, joints.robot, end)?;
        if !guess {
            path.start_from(joints.start);
        }
        record.insert("kind".to_owned(), json!(kind));
        if matches!(law.gains, Gains::AtGripper(_)) {
            // It asks where the gripper is to be, and for no joints.
            let point = Trajectory::source(GripperPoint(path.position().clone()));
            return Ok((Reference::new(point), None, record.into()));
        }
        return Ok((still(joints), Some(Arc::new(path)), record.into()));
    }
    if kind == keys::MOVE {
        let table = Table::of_kind(field.ctx, field.node, field.to_string(), (&REFERENCE, kind), wrong)?;
        return to_a_point(&table, joints);
    }
    let names: Vec<&str> = std::iter::once("kind").chain(joints.robot.joints_as_described()).collect();
    let table = Table::open_with(field.ctx, field.node, field.to_string(), &names, wrong)?;
    let table = ByJoint::inside(table, joints.robot, Parts::Coordinates, true)?;
    let missing: Vec<&str> =
        joints.driven().filter(|(_, joint)| table.get(joint).is_none()).map(|(_, joint)| joint.name).collect();
    if !missing.is_empty() {
        let message = format!("{field} has no signal for {}", names::list(missing.iter().copied()));
        let refusal = field.node.place.refuse(RefusalKind::Missing, message).label("missing joints");
        return Err(field.ctx.refuse(refusal.help("write a signal for every joint that the controller drives")));
    }
    let mut record = Map::new();
    record.insert("kind".to_owned(), json!(kind));
    let model = joints.robot.model();
    let paths = all(model.own_joints().zip(joints.robot.own_joints()).map(|(j, joint)| {
        let start = Signal::constant(joints.start[model.q_range(j).start]);
        let Some((field, units)) = table.get(&joint).zip(joint.units()) else { return Ok((start, None)) };
        let wanted = Wanted { unit: units.coordinate, range: Range::ANY, smooth: true, end };
        let plan = feedback::read_of_time(&field, wanted)?;
        Ok((plan.signal.clone(), Some((joint.name.to_owned(), plan.record()))))
    }))?;
    let (signals, records): (Vec<Signal>, Vec<_>) = paths.into_iter().unzip();
    record.extend(records.into_iter().flatten());
    Ok((of_signals(joints, signals), None, record.into()))
}

/// A reference that stays where the robot starts.
fn still(joints: &Joints<'_>) -> Reference {
    let model = joints.robot.model();
    let places = model.own_joints().map(|j| Signal::constant(joints.start[model.q_range(j).start]));
    of_signals(joints, places.collect())
}

/// A reference by signals of all joints with coordinates of their own; joints that are prescribed follow themselves, others of several degrees stay
/// where they are.
fn of_signals(joints: &Joints<'_>, signals: Vec<Signal>) -> Reference {
    let own = joints.robot.own_joints().zip(signals);
    let still = || std::array::from_fn(|_| Signal::constant(0.0));
    let paths = own.map(|(joint, signal)| match joint.space {
        _ if let Some(path) = (joints.moved)(joint.name) => path,
        Space::Line(_) | Space::Circle => JointPath::Coordinate(signal),
        Space::Attitude => JointPath::Attitude(Box::new(still())),
        Space::Pose => JointPath::Pose(Box::new(springpot::motion::PosePath { position: still(), rpy: still() })),
    });
    Reference::new(Trajectory::Prescribed(paths.collect()))
}

/// A move from where the robot starts.
fn to_a_point(table: &Table<'_>, joints: &Joints<'_>) -> Read<Referred> {
    let to = table.require("to").and_then(|field| ByJoint::open(&field, joints.robot, Parts::Coordinates));
    let duration = table.require("duration").and_then(|field| field.quantity());
    let profile = table.word("profile", "profile").map(|word| (word, profile(word)));
    let (to, duration, (word, profile)) = (to?, duration?, profile?);
    let model = joints.robot.model();
    let mut targets = Map::new();
    let signals = all(model.own_joints().zip(joints.robot.own_joints()).map(|(j, joint)| {
        let start = joints.start[model.q_range(j).start];
        let Some(field) = to.get(&joint) else { return Ok(Signal::constant(start)) };
        let Some(units) = joint.units().filter(|_| (joints.is_driven)(&joint)) else {
            let message = format!("names joint {:?}, which the controller does not drive", shorten(joint.name));
            return Err(field.refuse(RefusalKind::Rule, message, Some("leave it out".to_owned())));
        };
        let end = field.number(units.coordinate)?;
        targets.insert(joint.name.to_owned(), json!(end));
        Ok(profile.signal(start, end, duration))
    }))?;
    let record = json!({ "kind": keys::MOVE, "to": targets, "duration": duration, "profile": word });
    Ok((of_signals(joints, signals), None, record))
}

fn profile(word: &str) -> Profile {
    if word == keys::TRAPEZOID { Profile::Trapezoid } else { Profile::Quintic }
}
