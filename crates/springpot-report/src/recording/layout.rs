//! Which columns of a row go into which messages.

use super::definition::{self, Schema};
use super::names::{self, Names};
use super::{COLUMNS, GRIPPER, JOINTS};
use crate::page::ViewColumn;
use crate::scene::{Kinematics, Scene};
use std::collections::{BTreeMap, HashMap};

/// Where everything of a row goes.
#[derive(Debug)]
pub(super) struct Layout {
    /// Joints of one coordinate.
    pub(super) joints: Vec<JointRow>,
    /// Names of the bodies as frames.
    pub(super) frames: Vec<String>,
    /// The frame of bodies without a parent.
    pub(super) base: String,
    /// Indices of the columns of the gripper's position.
    pub(super) gripper: Option<[usize; 3]>,
    /// Elements, and last of all the remaining columns.
    pub(super) groups: Vec<Group>,
    /// By column, where it is: topic and field.
    pub(super) places: BTreeMap<String, String>,
}

/// A joint of a row.
#[derive(Debug)]
pub(super) struct JointRow {
    pub(super) name: String,
    /// Index of its body.
    pub(super) body: usize,
    /// Index of the column of the velocity that moves it.
    pub(super) velocity: Option<usize>,
    /// Index of the column of its force, if it has a coordinate of its own.
    pub(super) effort: Option<usize>,
}

/// Columns that are one message.
#[derive(Debug)]
pub(super) struct Group {
    pub(super) topic: String,
    pub(super) schema: Schema,
    /// Indices of the columns in the order of the fields.
    pub(super) columns: Vec<usize>,
}

impl Layout {
    pub(super) fn new(scene: &Scene, columns: &[ViewColumn], elements: &[String], tree: &Kinematics) -> Self {
        let indices: HashMap<&str, usize> = columns.iter().enumerate().map(|(k, column)| (&*column.name, k)).collect();
        let column = |name: &str| indices.get(name).copied();
        let mut places = BTreeMap::new();
        let mut is_free = vec![true; columns.len()];
        let mut claim = |k: usize, topic: &str, field: &str| {
            is_free[k] = false;
            places.insert(columns[k].name.clone(), format!("{topic} {field}"));
        };

        let mut joints: Vec<JointRow> = Vec::new();
        let mut joint_names = Names::default();
        for (body, on) in scene.bodies.iter().enumerate() {
            let Some(drive) = tree.drive(body) else { continue };
            let leader = columns[drive.column].name.strip_prefix("q.").unwrap_or_default();
            let is_own = on.joint.follows.is_none();
            let rate =
                scene.bodies.iter().find(|body| body.joint.name == leader).and_then(|body| body.joint.rate.as_deref());
            let rate = rate.unwrap_or(leader);
            let effort = column(&format!("tau.{rate}")).filter(|_| is_own);
            let velocity = column(&format!("v.{rate}"));
            let place = joints.len();
            joints.push(JointRow { name: joint_names.take(names::frame(&on.joint.name)), body, velocity, effort });
            if is_own {
                claim(drive.column, JOINTS, &format!("position[{place}]"));
                velocity.into_iter().for_each(|k| claim(k, JOINTS, &format!("velocity[{place}]")));
                effort.into_iter().for_each(|k| claim(k, JOINTS, &format!("effort[{place}]")));
            }
        }

        let gripper = match ["x", "y", "z"].map(|axis| column(&format!("gripper.{axis}"))) {
            [Some(x), Some(y), Some(z)] => Some([x, y, z]),
            _ => None,
        };
        for (k, axis) in gripper.iter().flatten().zip(["x", "y", "z"]) {
            claim(*k, GRIPPER, &format!("point.{axis}"));
        }

        let (mut topics, mut kinds, mut groups) = (Names::default(), Names::with(&["Columns", "Event"]), Vec::new());
        let of = owners(columns, elements, &is_free);
        for (element, own) in elements.iter().zip(of) {
            if own.is_empty() {
                continue;
            }
            let topic = format!("/elements/{}", topics.take(names::token(element)));
            let named = own.iter().map(|k| (columns[*k].name[element.len() + 1..].to_owned(), &columns[*k]));
            let (schema, fields) = definition::columns(&kinds.take(names::kind(element)), element, named);
            for (k, field) in own.iter().zip(&fields) {
                is_free[*k] = false;
                places.insert(columns[*k].name.clone(), format!("{topic} {field}"));
            }
            groups.push(Group { topic, schema, columns: own });
        }
        let rest: Vec<usize> = (0..columns.len()).filter(|k| is_free[*k]).collect();
        let named = rest.iter().map(|k| (columns[*k].name.clone(), &columns[*k]));
        let (schema, fields) = definition::columns("Columns", "all columns that no other topic has", named);
        for (k, field) in rest.iter().zip(&fields) {
            places.insert(columns[*k].name.clone(), format!("{COLUMNS} {field}"));
        }
        groups.push(Group { topic: COLUMNS.to_owned(), schema, columns: rest });

        let mut frames = Names::with(&[super::WORLD]);
        let base = match &scene.root {
            Some(root) if root.name != super::WORLD => frames.take(names::frame(&root.name)),
            _ => super::WORLD.to_owned(),
        };
        let frames = scene.bodies.iter().map(|body| frames.take(names::frame(&body.name))).collect();
        Self { joints, frames, base, gripper, groups, places }
    }

    /// Whether any joint has a column of its force.
    pub(super) fn has_efforts(&self) -> bool {
        self.joints.iter().any(|joint| joint.effort.is_some())
    }

    /// Whether any joint has a column of its velocity.
    pub(super) fn has_velocities(&self) -> bool {
        self.joints.iter().any(|joint| joint.velocity.is_some())
    }
}

/// By element, the free columns that begin with its name: of two such names the longer one has them.
fn owners(columns: &[ViewColumn], elements: &[String], is_free: &[bool]) -> Vec<Vec<usize>> {
    let mut own = vec![Vec::new(); elements.len()];
    let places: HashMap<&str, usize> = elements.iter().enumerate().map(|(k, name)| (&**name, k)).collect();
    for (k, column) in columns.iter().enumerate().filter(|(k, _)| is_free[*k]) {
        let dots = column.name.rmatch_indices('.').map(|(dot, _)| &column.name[..dot]);
        if let Some(element) = dots.into_iter().find_map(|name| places.get(name)) {
            own[*element].push(k);
        }
    }
    own
}
