//! `[robot]`: bodies, joints, gripper.

use super::names;
use super::plan::{BodyPlaces, Gripper};
use super::reader::{Field, Read, Refused, Table, all};
use super::refusal::{Place, RefusalKind};
use crate::model::{Anchor, BodySpec, JointKind, JointSpec, Limits, Model, ModelBuilder, ModelError, Parent};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

/// Most bodies of a robot.
const MAX_BODIES: usize = 1_000;
const STANDARD_GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];
const BODY_KEYS: [&str; 6] = ["name", "parent", "joint", "mass", "com", "inertia"];
const JOINT_KEYS: [&str; 7] = ["name", "kind", "axis", "origin", "rpy", "damping", "friction"];
const INERTIA_KEYS: [&str; 6] = ["xx", "yy", "zz", "xy", "xz", "yz"];
const KINDS: [&str; 3] = ["revolute", "prismatic", "fixed"];

/// The robot as it is described.
pub(crate) struct Robot {
    pub(crate) gravity: [f64; 3],
    pub(crate) bodies: Vec<BodySpec>,
    pub(crate) places: Vec<BodyPlaces>,
    pub(crate) model: Arc<Model>,
    pub(crate) gripper: Option<Gripper>,
    index: HashMap<String, usize>,
}

/// Reads `[robot]`.
pub(crate) fn read(root: &Table<'_>) -> Read<Robot> {
    let field = root.require("robot", "[robot] and a [[robot.body]] for each body")?;
    let urdf_only = |key: &str| match key {
        "urdf" | "floating_base" | "ignore_mimic" | "package_path" => {
            Some((RefusalKind::NotYet, format!("`{key}`: this version reads no URDF files, only [[robot.body]]")))
        }
        _ => None,
    };
    let table = Table::open_with(root.ctx, field.node, "[robot]", &["gravity", "body", "gripper"], urdf_only)?;
    let gravity = table.get("gravity").map_or(Ok(STANDARD_GRAVITY), |field| field.vector("m/s^2"));
    if field.node.get("urdf").is_some() {
        return Err(Refused);
    }
    let bodies = table.require("body", "a [[robot.body]] for each body")?;
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
        return Err(root.ctx.refuse(refusal.help("give a body a revolute or prismatic joint")));
    }
    let gravity = gravity?;
    let model = build(gravity, &bodies).map_err(|error| {
        let place = match error.subject() {
            Some(subject) => places.get(subject.body).map(|places| places.at(subject.field.key())),
            None => None,
        };
        let refusal = place.unwrap_or(&table.node.place).refuse(RefusalKind::Rule, error.to_string());
        root.ctx.refuse(refusal.label("not physical"))
    })?;
    let mut robot = Robot { gravity, bodies, places, model: Arc::new(model), gripper: None, index };
    if let Some(field) = table.get("gripper") {
        robot.gripper = Some(gripper(&field, &robot)?);
    }
    Ok(robot)
}

/// Builds the model; what makes no physical sense is an error.
fn build(gravity: [f64; 3], bodies: &[BodySpec]) -> Result<Model, ModelError> {
    let mut builder = ModelBuilder::new(gravity);
    for body in bodies {
        builder.push(body.clone())?;
    }
    builder.finish()
}

impl Robot {
    /// Reads `{ body = …, point = … }`, where the body may be the world.
    pub(crate) fn anchor(&self, field: &Field<'_>) -> Read<(String, Anchor)> {
        let table = field.table(&["body", "point"])?;
        let body = table.require("body", "body = \"NAME\" or body = \"world\"").and_then(|body| {
            let name = body.text()?;
            match self.index.get(name) {
                _ if name == "world" => Ok((name.to_owned(), Parent::World)),
                Some(&index) => Ok((name.to_owned(), Parent::Body(index))),
                None => Err(unknown_body(&body, name, self.names().chain(["world"]))),
            }
        });
        let point = table.require("point", "point = [x, y, z] in the body's joint frame, m");
        let point = point.and_then(|point| point.vector("m"))?;
        let (name, body) = body?;
        Ok((name, Anchor { body, point }))
    }

    /// The body that carries `body` rigidly and moves by its own joint, or the world.
    pub(crate) fn carrier(&self, mut body: Parent) -> Parent {
        while let Parent::Body(index) = body {
            if self.bodies[index].joint.kind != JointKind::Fixed {
                break;
            }
            body = self.bodies[index].parent;
        }
        body
    }

    /// The moving joints, in the order of q.
    pub(crate) fn joints(&self) -> Vec<&JointSpec> {
        self.bodies.iter().map(|body| &body.joint).filter(|joint| joint.kind != JointKind::Fixed).collect()
    }

    /// Whether a joint of that name exists and is fixed.
    pub(crate) fn is_fixed_joint(&self, name: &str) -> bool {
        self.bodies.iter().any(|body| body.joint.name == name && body.joint.kind == JointKind::Fixed)
    }

    fn names(&self) -> impl Iterator<Item = &str> + Clone {
        self.bodies.iter().map(|body| body.name.as_str())
    }
}

fn unknown_body<'a>(field: &Field<'_>, name: &str, names: impl Iterator<Item = &'a str> + Clone) -> Refused {
    let message = format!("names no body: {:?}", super::document::shorten(name));
    field.refuse(RefusalKind::UnknownName, message, Some(names::suggest(name, names)))
}

/// Refuses a name that breaks the rule of names.
pub(crate) fn checked_name<'a>(field: &Field<'a>) -> Read<&'a str> {
    let name = field.text()?;
    if names::is_name(name) {
        return Ok(name);
    }
    let message = format!("is {}, which is not a name", field.node.written());
    let help = "a name starts with a letter or _, then letters, digits, _ and - follow".to_owned();
    Err(field.refuse(RefusalKind::BadName, message, Some(help)))
}

/// Notes where `name` was used first, or refuses the second use.
pub(crate) fn unique(seen: &mut HashMap<String, Place>, field: &Field<'_>, name: &str) -> Read<()> {
    match seen.entry(name.to_owned()) {
        Entry::Vacant(entry) => {
            entry.insert(field.node.place.clone());
            Ok(())
        }
        Entry::Occupied(entry) => {
            let message = format!("is {:?}, which is taken on line {}", name, entry.get().position().0);
            Err(field.refuse(RefusalKind::BadName, message, Some("names are unique; choose another".to_owned())))
        }
    }
}

/// Names of the bodies, before anything else of them is read, so that references can be checked.
fn body_names(items: &[Field<'_>]) -> Read<HashMap<String, usize>> {
    let mut seen = HashMap::new();
    let mut index = HashMap::new();
    let mut result = Ok(());
    for (i, item) in items.iter().enumerate() {
        let Some(node) = item.node.get("name") else { continue };
        let field = Field { key: "name", node, owner: format!("body {}", i + 1).into(), ..item.clone() };
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
        let field = Field { key: "name", node, owner: format!("the joint of body {body:?}").into(), ..item.clone() };
        Some(checked_name(&field).and_then(|name| unique(&mut seen, &field, name)))
    }))
    .map(|_| ())
}

fn body(item: &Field<'_>, i: usize, index: &HashMap<String, usize>) -> Read<(BodySpec, BodyPlaces)> {
    let name = item.node.get("name").and_then(|node| node.text());
    let what = name.map_or_else(|| format!("body {}", i + 1), |name| format!("body {name:?}"));
    let table = Table::open(item.ctx, item.node, what, &BODY_KEYS)?;
    let mut places = BodyPlaces { table: item.node.place.clone(), fields: Vec::new() };
    for field in table.fields().filter(|field| BODY_KEYS.contains(&field.key)) {
        places.fields.push((field.key.to_owned(), field.node.place.clone()));
    }
    let name = table.require("name", "name = \"…\"").and_then(|field| field.text());
    let parent = match table.get("parent") {
        Some(field) => parent(&field, i, index),
        None if i == 0 => Ok(Parent::World),
        None => Ok(Parent::Body(i - 1)),
    };
    let joint = table
        .require("joint", "joint = { name = \"…\", kind = \"revolute\", axis = [0, 0, 1], origin = [0, 0, 0] }")
        .and_then(|field| joint(&field, name.ok(), &mut places));
    let mass = table.require("mass", "mass = 1.0 (in kg)").and_then(|field| field.number("kg"));
    let com = table.get("com").map_or(Ok([0.0; 3]), |field| field.vector("m"));
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
    let kind = field.node.get("kind").and_then(|node| node.text());
    let what = body.map_or_else(|| field.to_string(), |body| format!("the joint of body {body:?}"));
    let reason = |key: &str| {
        (kind == Some("fixed") && matches!(key, "axis" | "damping" | "friction"))
            .then(|| (RefusalKind::Rule, format!("`{key}` of {what} has no meaning: a fixed joint does not move")))
    };
    let known = if kind == Some("fixed") { &["name", "kind", "origin", "rpy"][..] } else { &JOINT_KEYS[..] };
    let table = Table::open_with(field.ctx, field.node, what.clone(), known, reason)?;
    for field in table.fields() {
        places.fields.push((format!("joint.{}", field.key), field.node.place.clone()));
    }
    let name = table.require("name", "name = \"…\"").and_then(|field| field.text());
    let kind = table.require("kind", "kind = \"revolute\", \"prismatic\" or \"fixed\"").and_then(|field| {
        match field.text()? {
            "revolute" => Ok(JointKind::Revolute),
            "prismatic" => Ok(JointKind::Prismatic),
            "fixed" => Ok(JointKind::Fixed),
            other => {
                let message = format!("is {:?}, which is no kind of joint", super::document::shorten(other));
                Err(field.refuse(RefusalKind::UnknownName, message, Some(names::suggest(other, KINDS))))
            }
        }
    });
    let axis = match kind {
        Ok(JointKind::Fixed) => Ok([0.0, 0.0, 1.0]),
        _ => table.require("axis", "axis = [0, 0, 1]").and_then(|field| axis(&field)),
    };
    let origin = table.get("origin").map_or(Ok([0.0; 3]), |field| field.vector("m"));
    let rpy = table.get("rpy").map_or(Ok([0.0; 3]), |field| field.vector("rad"));
    let (damping_unit, friction_unit) = match kind {
        Ok(JointKind::Prismatic) => ("N*s/m", "N"),
        _ => ("N*m*s/rad", "N*m"),
    };
    let damping = table.get("damping").map_or(Ok(0.0), |field| field.number(damping_unit));
    let friction = table.get("friction").map_or(Ok(0.0), |field| field.number(friction_unit));
    Ok(JointSpec {
        name: name?.to_owned(),
        kind: kind?,
        axis: axis?,
        origin: origin?,
        rpy: rpy?,
        damping: damping?,
        friction: friction?,
        limits: Limits::NONE,
        mimic: None,
    })
}

fn axis(field: &Field<'_>) -> Read<[f64; 3]> {
    let axis = field.vector("")?;
    if axis != [0.0; 3] {
        return Ok(axis);
    }
    let message = format!("is {}, which has no direction", field.node.written());
    Err(field.refuse(RefusalKind::OutOfRange, message, Some("write a direction such as [0, 0, 1]".to_owned())))
}

fn inertia(field: &Field<'_>) -> Read<[[f64; 3]; 3]> {
    const UNIT: &str = "kg*m^2";
    let table = field.table(&INERTIA_KEYS)?;
    let diagonal = |key| table.require(key, "xx, yy and zz, in kg*m^2").and_then(|field| field.number(UNIT));
    let off = |key| table.get(key).map_or(Ok(0.0), |field| field.number(UNIT));
    let (xx, yy, zz) = (diagonal("xx"), diagonal("yy"), diagonal("zz"));
    let (xy, xz, yz) = (off("xy")?, off("xz")?, off("yz")?);
    Ok([[xx?, xy, xz], [xy, yy?, yz], [xz, yz, zz?]])
}

fn gripper(field: &Field<'_>, robot: &Robot) -> Read<Gripper> {
    let (body, anchor) = robot.anchor(field)?;
    if anchor.body == Parent::World {
        let message = "is on the world, which does not move";
        let help = format!("write one of {}", names::list(robot.names()));
        return Err(field.refuse(RefusalKind::Rule, message, Some(help)));
    }
    Ok(Gripper { body, anchor })
}
