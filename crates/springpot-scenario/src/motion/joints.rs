//! What several kinds of motion say by joint: which joints, and how one moves.

use crate::keys::{FLOATING, Keys, POSE, SIGNAL, SPHERICAL};
use crate::reader::constants;
use crate::reader::{Field, Read, Table, all};
use crate::robot::{OwnJoint, Robot};
use crate::signals::feedback;
use crate::signals::of_time::Wanted;
use crate::signals::plan::SignalPlan;
use crate::text::refusal::{Place, RefusalKind};
use serde_json::{Value, json};
use springpot::law::Range;
use springpot::model::{JointKind, Space};
use springpot::motion::{JointPath, PosePath};
use springpot::signal::Signal;

fn wanted(unit: &str, end: Option<f64>) -> Wanted<'_> {
    Wanted { unit, range: Range::ANY, smooth: true, end }
}

/// A signal in the unit of its key; `smooth` as in [`Wanted`].
pub(super) fn signal(field: &Field<'_>, smooth: bool, end: Option<f64>) -> Read<SignalPlan> {
    let unit = field.row.map_or("", |row| row.shape.signal_unit());
    feedback::read_of_time(field, Wanted { smooth, ..wanted(unit, end) })
}

/// What stands for a signal that is left out.
pub(super) fn zero(place: &Place) -> SignalPlan {
    let (signal, written) = (Signal::constant(0.0), "0".to_owned());
    SignalPlan { signal, constant: Some(0.0), written, place: place.clone(), feedback: None }
}

/// How one joint moves, and the record of it; `field` is what is said of it, 0 where that is nothing.
pub(super) fn path_of_joint(
    field: Option<Field<'_>>,
    place: &Place,
    joint: &OwnJoint<'_>,
    end: Option<f64>,
) -> Read<(JointPath, Value)> {
    let Some(field) = field else { return Ok(at_zero(place, joint.space)) };
    match (joint.space, joint.units()) {
        (Space::Line(_) | Space::Circle, units) => {
            let unit = units.map_or("", |units| units.coordinate);
            feedback::read_of_time(&field, wanted(unit, end)).map(coordinate)
        }
        (Space::Attitude, _) => {
            let table = open_free(&field, &POSE, joint.space, "{ rpy = [roll, pitch, yaw] }")?;
            turn(&table, end).map(attitude)
        }
        (Space::Pose, _) => {
            let table = open_free(&field, &POSE, joint.space, "{ x = …, y = …, z = …, rpy = [roll, pitch, yaw] }")?;
            let axis =
                |key| table.get(key).map_or_else(|| Ok(zero(table_place(&table))), |field| signal(&field, true, end));
            let position = [axis("x"), axis("y"), axis("z")];
            let rpy = turn(&table, end);
            let [x, y, z] = position;
            Ok(posed([x?, y?, z?], rpy?))
        }
    }
}

fn table_place<'a>(table: &Table<'a>) -> &'a Place {
    &table.node.place
}

/// A joint that stays at 0.
fn at_zero(place: &Place, space: Space) -> (JointPath, Value) {
    let still = || [zero(place), zero(place), zero(place)];
    match space {
        Space::Line(_) | Space::Circle => coordinate(zero(place)),
        Space::Attitude => attitude(still()),
        Space::Pose => posed(still(), still()),
    }
}

/// A joint of one coordinate.
pub(super) fn coordinate(signal: SignalPlan) -> (JointPath, Value) {
    let record = signal.record();
    (JointPath::Coordinate(signal.signal), record)
}

/// A spherical joint.
pub(super) fn attitude(rpy: [SignalPlan; 3]) -> (JointPath, Value) {
    let record = json!({ "rpy": rpy.each_ref().map(SignalPlan::record) });
    (JointPath::Attitude(Box::new(rpy.map(|signal| signal.signal))), record)
}

/// A floating joint.
pub(super) fn posed(position: [SignalPlan; 3], rpy: [SignalPlan; 3]) -> (JointPath, Value) {
    let [x, y, z] = position.each_ref().map(SignalPlan::record);
    let record = json!({ "x": x, "y": y, "z": z, "rpy": rpy.each_ref().map(SignalPlan::record) });
    let [position, rpy] = [position, rpy].map(|signals| signals.map(|signal| signal.signal));
    (JointPath::Pose(Box::new(PosePath { position, rpy })), record)
}

/// What `only` of the tables of joints that turn freely calls those that have this space.
fn free_kind(space: Space) -> Option<JointKind> {
    match space {
        Space::Line(_) | Space::Circle => None,
        Space::Attitude => Some(SPHERICAL),
        Space::Pose => Some(FLOATING),
    }
}

/// Opens what is said of a joint that turns freely, a table with those of `keys` that it has; `right` is such a table.
pub(super) fn open_free<'a>(field: &Field<'a>, keys: &'static Keys, space: Space, right: &str) -> Read<Table<'a>> {
    let kind = free_kind(space);
    let name = kind.map_or("", JointKind::name);
    if field.node.entries().is_none() {
        return Err(field.wrong_type(&format!("a table {right}, since the joint is {name}")));
    }
    Table::of_kind(field.ctx, field.node, field.to_string(), (keys, name), |key| {
        keys.without_meaning(key, &field.to_string(), kind?)
    })
}

/// Roll, pitch and yaw of a table; 0 where they are left out.
fn turn(table: &Table<'_>, end: Option<f64>) -> Read<[SignalPlan; 3]> {
    let zero = || zero(&table.node.place);
    table.get("rpy").map_or_else(|| Ok([zero(), zero(), zero()]), |field| rpy(&field, end))
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

/// What a table by joints calls the numbers of joints of several.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Parts {
    /// As their coordinates: x, rz.
    Coordinates,
    /// As their velocities: vx, wz.
    Velocities,
}

/// A table whose keys are joints that have coordinates of their own; of joints of several numbers each is a table of them.
pub(super) struct ByJoint<'a> {
    outer: Table<'a>,
    /// Tables inside it, by joint.
    inner: Vec<(&'a str, Table<'a>)>,
    parts: Parts,
}

impl<'a> ByJoint<'a> {
    /// Opens the table of a field.
    pub(super) fn open(field: &Field<'a>, robot: &'a Robot, parts: Parts) -> Read<Self> {
        let reason = |key: &str| robot.why_no_coordinate(key).map(|why| (RefusalKind::Rule, why));
        let names = robot.joints_as_described();
        let outer = Table::open_with(field.ctx, field.node, field.to_string(), &names, reason)?;
        Self::inside(outer, robot, parts, false)
    }

    /// Of a table that is open; `has_whole` where one value may stand for all numbers of a joint.
    pub(super) fn inside(outer: Table<'a>, robot: &'a Robot, parts: Parts, has_whole: bool) -> Read<Self> {
        let mut inner = Vec::new();
        for joint in robot.joints_as_described() {
            let numbers: Vec<&str> =
                robot.own_joints().filter(|own| own.joint == joint).filter_map(|own| part(&own, parts)).collect();
            let Some(field) = outer.get(joint).filter(|_| !numbers.is_empty()) else { continue };
            if has_whole && is_one_value(&field) {
                continue;
            }
            inner.push((joint, Table::open(field.ctx, field.node, field.to_string(), &numbers)?));
        }
        Ok(Self { outer, inner, parts })
    }

    /// Whether it names the joint, or the joint that has this coordinate.
    pub(super) fn names(&self, joint: &OwnJoint<'a>) -> bool {
        self.outer.get(joint.joint).is_some()
    }

    /// What it says of a joint or of one of its numbers.
    pub(super) fn get(&self, joint: &OwnJoint<'a>) -> Option<Field<'a>> {
        match self.inner.iter().find(|(name, _)| *name == joint.joint) {
            Some((_, table)) => table.get(part(joint, self.parts)?),
            None => self.outer.get(joint.joint),
        }
    }

    /// Whether something misspelled stands for the joint.
    pub(super) fn suspects(&self, joint: &OwnJoint<'_>) -> bool {
        let inner = self.inner.iter().find(|(name, _)| *name == joint.joint);
        self.outer.suspects(joint.joint)
            || inner.zip(part(joint, self.parts)).is_some_and(|((_, table), part)| table.suspects(part))
    }

    /// Where it stands.
    pub(super) fn place(&self) -> &'a Place {
        &self.outer.node.place
    }
}

fn part<'a>(joint: &OwnJoint<'a>, parts: Parts) -> Option<&'a str> {
    match parts {
        Parts::Coordinates => joint.coordinate_part(),
        Parts::Velocities => joint.velocity_part(),
    }
}

/// Whether what stands there is a number or a signal, and no table of several.
fn is_one_value(field: &Field<'_>) -> bool {
    let Some(entries) = field.node.entries() else { return true };
    constants::is_expression(field.node) || entries.iter().any(|entry| SIGNAL.get(&entry.key).is_some())
}
