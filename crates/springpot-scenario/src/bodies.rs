//! `[[robot.body]]`: a robot body by body.

use super::constants;
use super::keys::{BODY, FRICTION, INERTIA, JOINT, keys_of};
use super::plan::BodyPlaces;
use super::reader::{Field, Read, Refused, Table, all};
use super::refusal::RefusalKind;
use super::robot::{Parts, checked_name, unique, unknown_body};
use springpot::model::{
    BodySpec, Dimension, FrictionLaw, JointKind, JointSpec, Limits, Model, ModelBuilder, ModelError, Parent,
};
use std::collections::HashMap;
use std::sync::Arc;

/// Most bodies of a robot.
const MAX_BODIES: usize = 1_000;

/// Reads every `[[robot.body]]`; `table` is `[robot]`.
pub(super) fn read(table: &Table<'_>, bodies: &Field<'_>, gravity: Read<[f64; 3]>) -> Read<Parts> {
    let items = bodies.items("an array of tables: [[robot.body]]")?;
    if items.is_empty() {
        return Err(bodies.refuse(RefusalKind::Missing, "is empty", Some("write a [[robot.body]]".to_owned())));
    }
    if items.len() > MAX_BODIES {
        let message = format!("holds {} bodies; at most {MAX_BODIES} are taken", items.len());
        return Err(bodies.refuse(RefusalKind::TooLarge, message, None));
    }
    let index = body_names(&items)?;
    let joints = joint_names(&items);
    let read = all(items.iter().enumerate().map(|(i, item)| body(item, i, &index)));
    let (bodies, places): (Vec<_>, Vec<_>) = read?.into_iter().unzip();
    joints?;
    if bodies.iter().all(|body| body.joint.kind == JointKind::Fixed) {
        let message = "[robot] has no joint that moves: all are fixed";
        let refusal = table.node.place.refuse(RefusalKind::Missing, message);
        return Err(table.ctx.refuse(refusal.help("give a body a joint of another kind, such as \"revolute\"")));
    }
    let model = build(gravity?, &bodies).map_err(|error| {
        let place = match error.subject() {
            Some(subject) => places.get(subject.body).map(|places: &BodyPlaces| places.at(subject.field.key())),
            None => None,
        };
        let refusal = place.unwrap_or(&table.node.place).refuse(RefusalKind::Rule, error.to_string());
        let is_of_inertia = error.subject().is_some_and(|subject| subject.field.key() == "inertia");
        let help = "inertia is about the centre of mass, in kg*m^2: look at the point it was given for, its axes and its units";
        table.ctx.refuse(refusal.label("not physical").help_if(is_of_inertia.then(|| help.to_owned())))
    })?;
    Ok(Parts { bodies, places, model: Arc::new(model), urdf: None })
}

/// Builds the model; what makes no physical sense is an error.
fn build(gravity: [f64; 3], bodies: &[BodySpec]) -> Result<Model, ModelError> {
    let mut builder = ModelBuilder::new(gravity);
    for body in bodies {
        builder.push(body.clone())?;
    }
    builder.finish()
}

/// Names of the bodies, before anything else of them is read, so that references can be checked.
fn body_names(items: &[Field<'_>]) -> Read<HashMap<String, usize>> {
    let mut seen = HashMap::new();
    let mut index = HashMap::new();
    let mut result = Ok(());
    for (i, item) in items.iter().enumerate() {
        let Some(node) = item.node.get("name") else { continue };
        let field = Field { key: "name", row: None, node, owner: format!("body {}", i + 1).into(), ..item.clone() };
        let read = checked_name(&field).and_then(|name| {
            unique(&mut seen, &field, name)?;
            if name == "world" {
                let help = "the world is the inertial frame; choose another name".to_owned();
                return Err(field.refuse(RefusalKind::BadName, "is \"world\", which is taken", Some(help)));
            }
            index.insert(name.to_owned(), i);
            Ok(())
        });
        result = result.and(read);
    }
    result.map(|()| index)
}

fn joint_names(items: &[Field<'_>]) -> Read<()> {
    let mut seen = HashMap::new();
    all(items.iter().filter_map(|item| {
        let node = item.node.get("joint")?.get("name")?;
        let body = item.node.get("name")?.text()?;
        let field =
            Field { key: "name", row: None, node, owner: format!("the joint of body {body:?}").into(), ..item.clone() };
        Some(checked_name(&field).and_then(|name| unique(&mut seen, &field, name)))
    }))
    .map(|_| ())
}

fn body(item: &Field<'_>, i: usize, index: &HashMap<String, usize>) -> Read<(BodySpec, BodyPlaces)> {
    let name = item.node.get("name").and_then(|node| node.text());
    let what = name.map_or_else(|| format!("body {}", i + 1), |name| format!("body {name:?}"));
    let table = Table::of(item.ctx, item.node, what, &BODY)?;
    let mut places = BodyPlaces { table: item.node.place.clone(), fields: Vec::new() };
    for field in table.fields().filter(|field| BODY.get(field.key).is_some()) {
        places.fields.push((field.key.to_owned(), field.node.place.clone()));
    }
    let name = table.require("name").and_then(|field| field.text());
    let parent = match table.get("parent") {
        Some(field) => parent(&field, i, index),
        None if i == 0 => Ok(Parent::World),
        None => Ok(Parent::Body(i - 1)),
    };
    let joint = table.require("joint").and_then(|field| joint(&field, name.ok(), &mut places));
    let mass = table.number("mass");
    let com = table.vector("com");
    let inertia = table.get("inertia").map_or(Ok([[0.0; 3]; 3]), |field| inertia(&field));
    let spec =
        BodySpec { name: name?.to_owned(), parent: parent?, joint: joint?, mass: mass?, com: com?, inertia: inertia? };
    Ok((spec, places))
}

fn parent(field: &Field<'_>, i: usize, index: &HashMap<String, usize>) -> Read<Parent> {
    let name = field.text()?;
    match index.get(name) {
        _ if name == "world" => Ok(Parent::World),
        Some(&parent) if parent < i => Ok(Parent::Body(parent)),
        Some(&parent) => {
            let which = if parent == i { "the body itself" } else { "a later body" };
            let message = format!("is {name:?}, {which}");
            let help = "a parent stands before its children; write \"world\" or an earlier body".to_owned();
            Err(field.refuse(RefusalKind::Rule, message, Some(help)))
        }
        None => {
            let mut earlier: Vec<(&String, &usize)> = index.iter().filter(|(_, at)| **at < i).collect();
            earlier.sort_by_key(|(_, at)| **at);
            let earlier: Vec<&str> = earlier.iter().map(|(name, _)| name.as_str()).chain(["world"]).collect();
            Err(unknown_body(field, name, earlier.iter().copied()))
        }
    }
}

fn joint(field: &Field<'_>, body: Option<&str>, places: &mut BodyPlaces) -> Read<JointSpec> {
    let kind = field.node.get("kind").and_then(|node| node.text()).and_then(kind_named);
    let what = body.map_or_else(|| field.to_string(), |body| format!("the joint of body {body:?}"));
    let plain = kind.filter(|kind| !kind.has_axis());
    let reason = |key: &str| {
        if matches!(key, "lower" | "upper" | "limit" | "limits" | "effort" | "velocity") {
            let why = "limits of joints are those of a URDF file, where [robot] limits makes end stops of them; here an element with joint = \"NAME\" and network = \"stop(k, lower, upper)\" is one";
            return Some((RefusalKind::UnknownKey, format!("`{key}` of {what} is no key of a joint: {why}")));
        }
        let why = match plain? {
            JointKind::Floating => "a floating joint moves freely in all six directions",
            _ => "a fixed joint does not move",
        };
        let message = || format!("`{key}` of {what} has no meaning: {why}");
        JOINT.is_of_a_kind(key).then(|| (RefusalKind::Rule, message()))
    };
    let of_kind = keys_of(kind.unwrap_or(JointKind::Revolute));
    let table = Table::of_kind(field.ctx, field.node, what.clone(), (&JOINT, of_kind), reason)?;
    for field in table.fields() {
        places.fields.push((format!("joint.{}", field.key), field.node.place.clone()));
    }
    let name = table.require("name").and_then(|field| field.text());
    let kind = table.require("kind").and_then(|field| kind_named(field.word("kind of joint")?).ok_or(Refused));
    let axis = match kind {
        Ok(kind) if !kind.has_axis() => Ok([0.0, 0.0, 1.0]),
        Ok(_) => table.require("axis").and_then(|field| axis(&field)),
        // Of an unknown kind nobody knows whether it needs one.
        Err(Refused) => table.get("axis").map_or(Err(Refused), |field| axis(&field)),
    };
    let origin = table.vector("origin");
    let rpy = table.vector("rpy");
    let slides = kind.is_ok_and(|kind| kind.dimension() == Some(Dimension::Length));
    let damping = table.joint_number("damping", slides);
    let friction = match table.get("friction") {
        Some(field) => friction(&field, slides, places),
        None => Ok((0.0, FrictionLaw::default())),
    };
    let (friction, friction_law) = friction?;
    Ok(JointSpec {
        name: name?.to_owned(),
        kind: kind?,
        axis: axis?,
        origin: origin?,
        rpy: rpy?,
        damping: damping?,
        friction,
        friction_law,
        limits: Limits::NONE,
        mimic: None,
    })
}

/// A number, or `{ force = …, speed = …, stick = … }`.
fn friction(field: &Field<'_>, slides: bool, places: &mut BodyPlaces) -> Read<(f64, FrictionLaw)> {
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
}

fn kind_named(name: &str) -> Option<JointKind> {
    JointKind::ALL.into_iter().find(|kind| kind.name() == name)
}

fn axis(field: &Field<'_>) -> Read<[f64; 3]> {
    let axis = field.components()?;
    if axis != [0.0; 3] {
        return Ok(axis);
    }
    let message = format!("is {}, which has no direction", field.node.written());
    Err(field.refuse(RefusalKind::OutOfRange, message, Some("write a direction such as [0, 0, 1]".to_owned())))
}

fn inertia(field: &Field<'_>) -> Read<[[f64; 3]; 3]> {
    let table = field.table(&INERTIA)?;
    let (xx, yy, zz) = (table.number("xx"), table.number("yy"), table.number("zz"));
    let (xy, xz, yz) = (table.number("xy")?, table.number("xz")?, table.number("yz")?);
    Ok([[xx?, xy, xz], [xy, yy?, yz], [xz, yz, zz?]])
}
