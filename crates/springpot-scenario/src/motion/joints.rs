//! What several kinds of motion say by joint: which joints, and how one moves.

use crate::feedback;
use crate::keys::{POSE, Shape};
use crate::plan::SignalPlan;
use crate::reader::{Field, Read, Table, all};
use crate::refusal::{Place, RefusalKind};
use crate::robot::{OwnJoint, Robot};
use crate::signals::Wanted;
use serde_json::{Value, json};
use springpot::law::Range;
use springpot::model::JointKind;
use springpot::motion::{JointPath, PosePath};
use springpot::signal::Signal;

fn wanted(unit: &str, end: Option<f64>) -> Wanted<'_> {
    Wanted { unit, range: Range::ANY, smooth: true, end }
}

/// A signal in the unit of its key; `smooth` as in [`Wanted`].
pub(super) fn signal(field: &Field<'_>, smooth: bool, end: Option<f64>) -> Read<SignalPlan> {
    let unit = match field.row.map(|row| row.shape) {
        Some(Shape::Signal(unit) | Shape::Signals(unit)) => unit,
        _ => "",
    };
    feedback::read_of_time(field, Wanted { smooth, ..wanted(unit, end) })
}

/// What stands for a signal that is left out.
pub(super) fn zero(place: &Place) -> SignalPlan {
    let (signal, written) = (Signal::constant(0.0), "0".to_owned());
    SignalPlan { signal, constant: Some(0.0), written, place: place.clone(), feedback: None }
}

/// How one joint moves, and the record of it.
pub(super) fn path_of_joint(field: &Field<'_>, joint: &OwnJoint<'_>, end: Option<f64>) -> Read<(JointPath, Value)> {
    match joint.kind {
        JointKind::Floating => pose(field, end),
        _ => feedback::read_of_time(field, wanted(joint.unit(), end)).map(coordinate),
    }
}

/// A joint of one degree.
pub(super) fn coordinate(signal: SignalPlan) -> (JointPath, Value) {
    let record = signal.record();
    (JointPath::Coordinate(signal.signal), record)
}

/// A floating joint.
pub(super) fn posed(position: [SignalPlan; 3], rpy: [SignalPlan; 3]) -> (JointPath, Value) {
    let [x, y, z] = position.each_ref().map(SignalPlan::record);
    let record = json!({ "x": x, "y": y, "z": z, "rpy": rpy.each_ref().map(SignalPlan::record) });
    let [position, rpy] = [position, rpy].map(|signals| signals.map(|signal| signal.signal));
    (JointPath::Pose(Box::new(PosePath { position, rpy })), record)
}

/// The pose of a floating joint; what is left out is 0.
fn pose(field: &Field<'_>, end: Option<f64>) -> Read<(JointPath, Value)> {
    if field.node.entries().is_none() {
        let right = "a table { x = …, y = …, z = …, rpy = [roll, pitch, yaw] }, since the joint is floating";
        return Err(field.wrong_type(right));
    }
    let table = field.table(&POSE)?;
    let zero = || zero(&field.node.place);
    let axis = |key| table.get(key).map_or_else(|| Ok(zero()), |field| signal(&field, true, end));
    let position = [axis("x"), axis("y"), axis("z")];
    let rpy = table.get("rpy").map_or_else(|| Ok([zero(), zero(), zero()]), |field| rpy(&field, end));
    let [x, y, z] = position;
    Ok(posed([x?, y?, z?], rpy?))
}

/// Roll, pitch and yaw.
pub(super) fn rpy(field: &Field<'_>, end: Option<f64>) -> Read<[SignalPlan; 3]> {
    let right = "an array of three signals: roll, pitch, yaw";
    let items = field.items(right)?;
    let signals = all(items.iter().map(|item| signal(item, true, end)))?;
    signals.try_into().map_err(|signals: Vec<_>| {
        let message = format!("has {} entries, but must be {right}", signals.len());
        field.refuse(RefusalKind::WrongType, message, Some("write [roll, pitch, yaw]".to_owned()))
    })
}

/// Opens a table whose keys are names of joints that have coordinates of their own.
pub(super) fn open_joints<'a>(field: &Field<'a>, robot: &Robot) -> Read<Table<'a>> {
    let names: Vec<&str> = robot.own_joints().map(|joint| joint.name).collect();
    let reason = |key: &str| robot.why_no_coordinate(key).map(|why| (RefusalKind::Rule, why));
    Table::open_with(field.ctx, field.node, field.to_string(), &names, reason)
}
