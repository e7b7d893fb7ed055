//! `[[robot.body]]`: a robot body by body.

use super::joint;
use crate::keys::{BODY, INERTIA};
use crate::reader::named::{checked_name, unique};
use crate::reader::{Field, Read, Table, all};
use crate::robot::described::BodyPlaces;
use crate::robot::described::{Parts, unknown_body};
use crate::text::refusal::RefusalKind;
use springpot::model::{BodySpec, JointKind, Model, ModelBuilder, ModelError, Parent};
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
    let kinds = joint::kinds(&items);
    let read = all(items.iter().enumerate().map(|(i, item)| body(item, i, &index, &kinds)));
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

fn body(
    item: &Field<'_>,
    i: usize,
    index: &HashMap<String, usize>,
    kinds: &joint::Kinds<'_>,
) -> Read<(BodySpec, BodyPlaces)> {
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
    let joint = table.require("joint").and_then(|field| joint::read(&field, name.ok(), kinds, &mut places));
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

fn inertia(field: &Field<'_>) -> Read<[[f64; 3]; 3]> {
    let table = field.table(&INERTIA)?;
    let (xx, yy, zz) = (table.number("xx"), table.number("yy"), table.number("zz"));
    let (xy, xz, yz) = (table.number("xy")?, table.number("xz")?, table.number("yz")?);
    Ok([[xx?, xy, xz], [xy, yy?, yz], [xz, yz, zz?]])
}
