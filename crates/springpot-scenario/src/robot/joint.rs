//! `joint` of a body.

use crate::keys::{FRICTION, JOINT, Keys, MIMIC};
use crate::reader::constants;
use crate::reader::{Field, Read, Refused, Table};
use crate::robot::described::BodyPlaces;
use crate::text::document::shortest;
use crate::text::names;
use crate::text::refusal::RefusalKind;
use crate::units;
use springpot::model::{AxisNeed, Dimension, FrictionLaw, JointKind, JointSpec, Limits, MOST_COORDINATES, Mimic};
use std::collections::HashMap;
use std::f64::consts::TAU;

/// Farthest advance in a turn, m.
const FARTHEST: f64 = 1e9;

/// The kind of each joint by its name, as far as it is written.
pub(super) type Kinds<'a> = HashMap<&'a str, JointKind>;

/// The kinds of all joints before anything else of them is read.
pub(super) fn kinds<'a>(bodies: &[Field<'a>]) -> Kinds<'a> {
    let joints = bodies.iter().filter_map(|body| body.node.get("joint"));
    let named =
        joints.filter_map(|joint| Some((joint.get("name")?.text()?, JointKind::named(joint.get("kind")?.text()?)?)));
    named.collect()
}

/// Reads the joint of the body called `body`; `kinds` are those of all joints.
pub(super) fn read(
    field: &Field<'_>,
    body: Option<&str>,
    kinds: &Kinds<'_>,
    places: &mut BodyPlaces,
) -> Read<JointSpec> {
    let kind = field.node.get("kind").and_then(|node| node.text()).and_then(JointKind::named);
    let what = body.map_or_else(|| field.to_string(), |body| format!("the joint of body {body:?}"));
    let reason = |key: &str| {
        if matches!(key, "limit" | "limits") {
            let why = "what a joint is built for is said by `lower`, `upper`, `velocity` and `effort`";
            return Some((RefusalKind::UnknownKey, format!("`{key}` of {what} is no key of a joint: {why}")));
        }
        JOINT.without_meaning(key, &what, kind?)
    };
    let of_kind = kind.unwrap_or(JointKind::Revolute).name();
    let table = Table::of_kind(field.ctx, field.node, what.clone(), (&JOINT, of_kind), reason)?;
    for field in table.fields() {
        places.fields.push((format!("joint.{}", field.key), field.node.place.clone()));
    }
    let name = table.require("name").and_then(|field| field.text());
    let kind = table.require("kind").and_then(|field| JointKind::named(field.word("kind of joint")?).ok_or(Refused));
    let axis = match kind.map(JointKind::axis) {
        Ok(AxisNeed::None) => Ok([0.0, 0.0, 1.0]),
        Ok(AxisNeed::Z) => table.get("axis").map_or(Ok([0.0, 0.0, 1.0]), |field| axis(&field)),
        Ok(AxisNeed::Required) => table.require("axis").and_then(|field| axis(&field)),
        // Of an unknown kind nobody knows whether it needs one.
        Err(Refused) => table.get("axis").map_or(Err(Refused), |field| axis(&field)),
    };
    let origin = table.vector("origin");
    let rpy = table.vector("rpy");
    let kind = kind?;
    let axis2 = axis2(&table, kind);
    let lead = lead(&table, kind);
    let damping = numbers(&table, "damping", kind, 0.0);
    let friction = friction(&table, kind, places);
    let armature = numbers(&table, "armature", kind, 0.0);
    let limits = limits(&table, kind);
    // Of a joint of several coordinates that is refused already.
    let follows = table.get("mimic").filter(|_| kind.nv() == 1);
    let mimic = follows.map(|field| mimic(&field, kind, kinds)).transpose();
    for (key, values) in [("damping", &damping), ("armature", &armature)] {
        mark(&table, (key, kind), values.as_ref().ok(), places);
    }
    let friction = friction?;
    Ok(JointSpec {
        name: name?.to_owned(),
        kind,
        axis: axis?,
        axis2: axis2?,
        lead: lead?,
        origin: origin?,
        rpy: rpy?,
        damping: damping?,
        friction: friction.map(|(force, _)| force),
        friction_law: friction.map(|(_, law)| law),
        armature_all: 0.0,
        armature: armature?,
        limits: limits?,
        mimic: mimic?,
    })
}

/// `axis2` of a kind that has one.
pub(super) fn axis2(table: &Table<'_>, kind: JointKind) -> Read<[f64; 3]> {
    if kind.has_axis2() { axis(&table.require("axis2")?) } else { Ok([0.0; 3]) }
}

/// `lead` of a kind that has one.
pub(super) fn lead(table: &Table<'_>, kind: JointKind) -> Read<f64> {
    if !kind.has_lead() {
        return Ok(0.0);
    }
    let field = table.require("lead")?;
    let lead = field.quantity()?;
    let unit = field.node.text().and_then(units::split_quantity).map_or("", |(_, unit)| unit);
    if unit.contains("rad") || unit.contains("deg") {
        let message = format!(
            "is {}, the advance in an angle, but `lead` is that in a whole turn, a length",
            field.node.written()
        );
        let help = format!("write the advance in each turn: lead = \"{} m\"", shortest(lead * TAU));
        return Err(field.refuse(RefusalKind::BadQuantity, message, Some(help)));
    }
    if lead.abs() > FARTHEST {
        let message = format!("is {} m in each turn, outside ±1e9 m", shortest(lead));
        let help = "write the advance in each turn, such as \"5 mm\"".to_owned();
        return Err(field.refuse(RefusalKind::OutOfRange, message, Some(help)));
    }
    if lead != 0.0 {
        return Ok(lead);
    }
    let message = "is 0, but a helical joint advances by its lead in each turn";
    let help = "write the advance per turn, such as \"5 mm\", or kind = \"revolute\"".to_owned();
    Err(field.refuse(RefusalKind::OutOfRange, message, Some(help)))
}

fn axis(field: &Field<'_>) -> Read<[f64; 3]> {
    let axis = field.components()?;
    if axis != [0.0; 3] {
        return Ok(axis);
    }
    let message = format!("is {}, which has no direction", field.node.written());
    Err(field.refuse(RefusalKind::OutOfRange, message, Some("write a direction such as [0, 0, 1]".to_owned())))
}

/// What `read` makes of each coordinate of a joint: of one value for all, or of a table by coordinates; `left_out` where there is
/// none. A table with keys of `whole` is one value.
fn by_coordinate<T: Copy>(
    field: Option<Field<'_>>,
    kind: JointKind,
    whole: Option<&Keys>,
    left_out: T,
    mut read: impl FnMut(&Field<'_>, bool) -> Read<T>,
) -> Read<[T; MOST_COORDINATES]> {
    let mut values = [left_out; MOST_COORDINATES];
    let Some(field) = field else { return Ok(values) };
    let slides = |dimension| dimension == Dimension::Length;
    let entries = field.node.entries().filter(|_| !constants::is_expression(field.node)).unwrap_or_default();
    let unit = field.node.text().and_then(units::split_quantity).map_or("", |(_, unit)| unit);
    let has_both = [true, false].iter().all(|wanted| kind.numbers().any(|(_, dimension)| slides(dimension) == *wanted));
    if has_both && !unit.is_empty() {
        let names: Vec<String> = kind.numbers().map(|(name, _)| format!("{name} = …")).collect();
        let message = format!(
            "is {}, but a {} joint shifts and turns: one unit does not fit both",
            field.node.written(),
            kind.name()
        );
        let help = format!("write {{ {} }}, each in its unit", names.join(", "));
        return Err(field.refuse(RefusalKind::BadQuantity, message, Some(help)));
    }
    let is_whole = entries.iter().any(|entry| whole.is_some_and(|keys| keys.get(&entry.key).is_some()));
    if entries.is_empty() || is_whole || kind.dimension().is_some() {
        for (value, (_, dimension)) in values.iter_mut().zip(kind.numbers()) {
            *value = read(&field, slides(dimension))?;
        }
        return Ok(values);
    }
    let names: Vec<&str> = kind.numbers().map(|(name, _)| name).collect();
    let table = Table::open(field.ctx, field.node, field.to_string(), &names)?;
    let mut outcome = Ok(());
    for (value, (name, dimension)) in values.iter_mut().zip(kind.numbers()) {
        let Some(own) = table.get(name) else { continue };
        match read(&Field { row: field.row, ..own }, slides(dimension)) {
            Ok(read) => *value = read,
            Err(Refused) => outcome = Err(Refused),
        }
    }
    outcome.map(|()| values)
}

/// The numbers under `key`, one for each coordinate.
pub(super) fn numbers(
    table: &Table<'_>,
    key: &'static str,
    kind: JointKind,
    left_out: f64,
) -> Read<[f64; MOST_COORDINATES]> {
    by_coordinate(table.get(key), kind, None, left_out, |field, slides| field.joint_quantity(slides))
}

/// Has what is wrong with a negative number of a table said where it stands.
pub(super) fn mark(
    table: &Table<'_>,
    (key, kind): (&'static str, JointKind),
    values: Option<&[f64; MOST_COORDINATES]>,
    places: &mut BodyPlaces,
) {
    let Some((field, values)) = table.get(key).zip(values) else { return };
    let wrong = kind.numbers().zip(values).find(|(_, value)| **value < 0.0);
    let own = wrong.and_then(|((name, _), _)| field.node.get(name));
    let place = own.map_or(&field.node.place, |node| &node.place);
    places.fields.insert(0, (format!("joint.{key}"), place.clone()));
}

fn limits(table: &Table<'_>, kind: JointKind) -> Read<[Limits; MOST_COORDINATES]> {
    let Limits { lower, upper, velocity, effort } = Limits::NONE;
    let each = [("lower", lower), ("upper", upper), ("velocity", velocity), ("effort", effort)];
    let [lower, upper, velocity, effort] = each.map(|(key, left_out)| numbers(table, key, kind, left_out));
    let (lower, upper, velocity, effort) = (lower?, upper?, velocity?, effort?);
    let of = |k: usize| Limits { lower: lower[k], upper: upper[k], velocity: velocity[k], effort: effort[k] };
    for (k, (name, _)) in kind.numbers().enumerate() {
        let Limits { lower, upper, .. } = of(k);
        if lower > upper {
            let part = if name.is_empty() { String::new() } else { format!(" for {name}") };
            let message = format!("is {lower}{part}, above `upper`, {upper}");
            let field = table.require("lower")?;
            return Err(field.refuse(
                RefusalKind::Rule,
                message,
                Some("write the smaller of the two as `lower`".to_owned()),
            ));
        }
    }
    Ok(std::array::from_fn(of))
}

/// For each coordinate a number, or `{ force = …, speed = …, stick = … }`.
fn friction(
    table: &Table<'_>,
    kind: JointKind,
    places: &mut BodyPlaces,
) -> Read<[(f64, FrictionLaw); MOST_COORDINATES]> {
    let none = (0.0, FrictionLaw::default());
    by_coordinate(table.get("friction"), kind, Some(&FRICTION), none, |field, slides| {
        if field.node.entries().is_none() || constants::is_expression(field.node) {
            return Ok((field.joint_quantity(slides)?, FrictionLaw::default()));
        }
        let table = field.table(&FRICTION)?;
        for field in table.fields() {
            // What is wrong with the force is said of the whole.
            let key = if field.key == "force" { String::new() } else { format!(".{}", field.key) };
            places.fields.insert(0, (format!("joint.friction{key}"), field.node.place.clone()));
        }
        let right = if slides { "force = \"0.2 N\"" } else { "force = \"0.2 N*m\"" };
        let force = table.require_with("force", right).and_then(|field| field.joint_quantity(slides));
        let speed = table.joint_number("speed", slides);
        let stick = table.flag("stick");
        let (force, speed, stick) = (force?, speed?, stick?);
        Ok((force, if stick { FrictionLaw::Sticking } else { FrictionLaw::Smooth { speed } }))
    })
}

/// `{ joint = …, multiplier = …, offset = … }`.
fn mimic(field: &Field<'_>, kind: JointKind, kinds: &Kinds<'_>) -> Read<Mimic> {
    let table = field.table(&MIMIC)?;
    let own = kind.dimension();
    let leader = table.require("joint").and_then(|field| leader(&field, kinds));
    let offset = table.joint_number("offset", own == Some(Dimension::Length));
    let (joint, dimension) = leader?;
    let unit = match (own, dimension) {
        (Some(Dimension::Length), Dimension::Angle) => "m/rad",
        (Some(Dimension::Angle), Dimension::Length) => "rad/m",
        _ => "",
    };
    let multiplier = table.get("multiplier").map_or(Ok(1.0), |field| field.number(unit));
    Ok(Mimic { joint, multiplier: multiplier?, offset: offset? })
}

/// The joint that one follows, or the coordinate of a joint of several, and what it measures.
fn leader(field: &Field<'_>, kinds: &Kinds<'_>) -> Read<(String, Dimension)> {
    let name = field.text()?;
    let coordinates = |(joint, kind): (&&str, &JointKind)| {
        let joint = (*joint).to_owned();
        let called = move |part: &str| if part.is_empty() { joint.clone() } else { format!("{joint}.{part}") };
        kind.numbers().map(move |(part, dimension)| (called(part), dimension)).collect::<Vec<_>>()
    };
    let mut known: Vec<(String, Dimension)> = kinds.iter().flat_map(coordinates).collect();
    known.sort_by(|(one, _), (other, _)| one.cmp(other));
    if let Some(found) = known.iter().find(|(known, _)| known == name) {
        return Ok(found.clone());
    }
    if let Some(kind) = kinds.get(name) {
        let message = format!("is {name:?}, which is {}: a joint follows one coordinate", kind.name());
        let parts: Vec<String> = kind.numbers().map(|(part, _)| format!("\"{name}.{part}\"")).collect();
        let help = if parts.is_empty() {
            "follow a joint that has one".to_owned()
        } else {
            format!("write one of {}", parts.join(", "))
        };
        return Err(field.refuse(RefusalKind::Rule, message, Some(help)));
    }
    // A velocity, or a number of a quaternion.
    let parted = name.rsplit_once('.').and_then(|(joint, part)| Some((joint, part, *kinds.get(joint)?)));
    if let Some((joint, part, kind)) = parted {
        let message =
            format!("is {name:?}, no coordinate of {joint:?} that a joint can follow: the joint is {}", kind.name());
        let rate = kind.rates().position(|rate| rate == part).and_then(|at| kind.numbers().nth(at));
        let parts: Vec<String> = match rate {
            Some((own, _)) => vec![own.to_owned()],
            None => kind.numbers().map(|(own, _)| own.to_owned()).collect(),
        };
        let right: Vec<String> = parts.iter().map(|own| format!("`{joint}.{own}`")).collect();
        let help = match right.is_empty() {
            true => "follow a joint that has one coordinate".to_owned(),
            false => format!("did you mean {}?", right.join(" or ")),
        };
        return Err(field.refuse(RefusalKind::UnknownName, message, Some(help)));
    }
    let message = format!("names no joint: {:?}", crate::text::document::shorten(name));
    let names = known.iter().map(|(name, _)| name.as_str());
    Err(field.refuse(RefusalKind::UnknownName, message, Some(names::suggest(name, names))))
}
