//! `[robot]`: bodies or a URDF file, gravity, gripper.

mod bodies;
mod changed;
pub(crate) mod described;
mod joint;
pub(crate) mod urdf;

use self::described::{Parts, unknown_body};
use crate::keys::{ANCHOR, END_STOPS, FROM_MJCF, FROM_URDF, ROBOT};
use crate::reader::{Field, Read, Table};
use crate::robot::described::{EndStops, Gripper};
use crate::text::names;
use crate::text::refusal::RefusalKind;
use springpot::model::{Anchor, Dimension, JointKind, Model, Parent, Space, Units};
use std::collections::HashMap;

const RIGHT: &str = "urdf = \"arm.urdf\", mjcf = \"arm.xml\", or a [[robot.body]] for each body";

/// The robot as it is described.
pub(crate) struct Robot {
    pub(crate) gravity: [f64; 3],
    pub(crate) parts: Parts,
    pub(crate) gripper: Option<Gripper>,
    pub(crate) end_stops: Option<EndStops>,
    /// Kind of every joint by its name, fixed ones included.
    joint_kinds: HashMap<String, JointKind>,
}

/// A joint of the model that has coordinates of its own: a joint as it is described, or one coordinate of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OwnJoint<'a> {
    /// `q1`, or `u.first` where the joint has several coordinates that are numbers.
    pub(crate) name: &'a str,
    /// The same of the velocity.
    pub(crate) velocity: &'a str,
    /// Name of the joint as it is described.
    pub(crate) joint: &'a str,
    pub(crate) space: Space,
}

impl<'a> OwnJoint<'a> {
    /// Units, if it has one coordinate.
    pub(crate) fn units(&self) -> Option<Units> {
        self.space.dimension().map(Dimension::units)
    }

    /// The coordinate as tables by joint call it inside that of its joint; `None` where the joint has no other number.
    pub(crate) fn coordinate_part(&self) -> Option<&'a str> {
        self.name.strip_prefix(self.joint)?.strip_prefix('.')
    }

    /// The same of the velocity.
    pub(crate) fn velocity_part(&self) -> Option<&'a str> {
        self.velocity.strip_prefix(self.joint)?.strip_prefix('.')
    }
}

/// Reads `[robot]`.
pub(crate) fn read(root: &Table<'_>) -> Read<Robot> {
    let field = root.require("robot")?;
    let has = |key: &str| field.node.get(key).is_some();
    let kind = match (has("urdf"), has("mjcf")) {
        (true, _) => FROM_URDF,
        (false, true) => FROM_MJCF,
        (false, false) => "",
    };
    let file_only = |key: &str| {
        let help = match key {
            "floating_base" if kind == FROM_MJCF => "; its <freejoint> says what floats",
            "floating_base" => "; give the first [[robot.body]] a joint of kind = \"floating\" instead",
            "accept_inertia" => "; correct the inertia of the [[robot.body]] instead",
            _ => "",
        };
        let message = || format!("`{key}` of [robot] belongs to `urdf`, and this robot has none{help}");
        ROBOT.is_of_a_kind(key).then(|| (RefusalKind::Rule, message()))
    };
    let table = Table::of_kind(root.ctx, field.node, "[robot]", (&ROBOT, kind), file_only)?;
    let mut gravity = table.vector("gravity");
    let file = match (table.get("urdf"), table.get("mjcf")) {
        (Some(_), Some(mjcf)) => {
            let help = "a robot is one file: leave one of them out".to_owned();
            return Err(mjcf.refuse(RefusalKind::Rule, "stands beside `urdf`", Some(help)));
        }
        (urdf, mjcf) => urdf.or(mjcf),
    };
    let parts = match (file, table.get("body")) {
        (Some(file), Some(bodies)) => {
            let help = "a robot is a file or [[robot.body]] blocks: leave one of them out".to_owned();
            return Err(bodies.refuse(RefusalKind::Rule, format!("stands beside `{}`", file.key), Some(help)));
        }
        (Some(file), None) => {
            let parts = urdf::read(&table, &file, gravity)?;
            gravity = Ok(parts.model.gravity());
            parts
        }
        (None, Some(bodies)) => bodies::read(&table, &bodies, gravity)?,
        (None, None) => return Err(table.missing("body", RIGHT)),
    };
    let joint_kinds = parts.bodies.iter().map(|body| (body.joint.name.clone(), body.joint.kind)).collect();
    let mut robot = Robot { gravity: gravity?, parts, gripper: None, end_stops: None, joint_kinds };
    if let Some(field) = table.get("limits") {
        robot.end_stops = Some(end_stops(&field, &robot)?);
    }
    if let Some(field) = table.get("gripper") {
        robot.gripper = Some(gripper(&field, &robot)?);
    }
    Ok(robot)
}

impl Robot {
    pub(crate) fn model(&self) -> &Model {
        &self.parts.model
    }

    /// Reads `body` and `point`, where the body may be the world.
    pub(crate) fn anchor(&self, table: &Table<'_>) -> Read<(String, Anchor)> {
        let body = table.require("body").and_then(|body| {
            let name = body.text()?;
            match self.model().find_body(name) {
                Some(found) => Ok((name.to_owned(), found)),
                None => Err(unknown_body(&body, name, self.body_names().chain(self.world_names()))),
            }
        });
        let point = table.require("point");
        let point = point.and_then(|point| point.components())?;
        let (name, body) = body?;
        Ok((name, Anchor { body, point }))
    }

    /// The body that carries `body` rigidly and moves by its own joint, or the world.
    pub(crate) fn carrier(&self, mut body: Parent) -> Parent {
        while let Parent::Body(index) = body {
            let spec = &self.parts.bodies[index];
            if spec.joint.kind != JointKind::Fixed {
                break;
            }
            body = spec.parent;
        }
        body
    }

    /// The joints of the model that have coordinates of their own, in the order of q.
    pub(crate) fn own_joints(&self) -> impl Iterator<Item = OwnJoint<'_>> {
        let model = self.model();
        model.own_joints().map(|j| OwnJoint {
            name: &model.joint_names()[j],
            velocity: &model.velocity_names()[j],
            joint: &model.described_joint(j).name,
            space: model.joint_space(j),
        })
    }

    /// What the joint is that has this coordinate.
    pub(crate) fn kind_of(&self, joint: &OwnJoint<'_>) -> JointKind {
        self.joint_kinds.get(joint.joint).copied().unwrap_or(JointKind::Fixed)
    }

    /// Names of the joints as they are described that have coordinates of their own, in the order of q.
    pub(crate) fn joints_as_described(&self) -> Vec<&str> {
        let mut names: Vec<&str> = self.own_joints().map(|joint| joint.joint).collect();
        names.dedup();
        names
    }

    /// Why a joint of that name has no coordinate; `None` where it has one, or does not exist.
    pub(crate) fn why_no_coordinate(&self, name: &str) -> Option<String> {
        if let Some(own) = self.own_joints().find(|own| own.name == name && own.coordinate_part().is_some()) {
            let part = own.coordinate_part().unwrap_or_default();
            return Some(format!(
                "{name:?} is a coordinate of joint {:?}: write {} = {{ {part} = … }}",
                own.joint, own.joint
            ));
        }
        if *self.joint_kinds.get(name)? == JointKind::Fixed {
            return Some(format!("joint {name:?} is fixed and has no coordinate"));
        }
        let model = self.model();
        let (leader, ratio, offset) = model.followed(model.joint_index(name)?)?;
        let leader = &model.joint_names()[leader];
        let mut rule = String::new();
        if (ratio, offset) != (1.0, 0.0) {
            rule = format!(" ({ratio}*{leader} {} {})", if offset < 0.0 { '-' } else { '+' }, offset.abs());
        }
        Some(format!("joint {name:?} follows {leader:?}{rule} and has no coordinate of its own"))
    }

    fn body_names(&self) -> impl Iterator<Item = &str> + Clone {
        self.parts.bodies.iter().map(|body| body.name.as_str())
    }

    /// The root link of a robot on a fixed base, then "world".
    fn world_names(&self) -> impl Iterator<Item = &str> + Clone {
        let urdf = self.parts.urdf.as_ref().filter(|urdf| !urdf.robot.floating_base);
        let root = urdf.map(|urdf| urdf.robot.root.name.as_str()).filter(|name| *name != "world");
        root.into_iter().chain(["world"])
    }
}

/// Limits of joints as stops, where some joint has any.
fn end_stops(field: &Field<'_>, robot: &Robot) -> Read<EndStops> {
    let table = field.table(&END_STOPS)?;
    let (stiffness, damping) = (table.number("stiffness"), table.number("damping"));
    let model = robot.model();
    let mut limits = (0..model.joint_count()).map(|joint| model.limits(joint));
    if !limits.any(|limits| limits.lower.is_finite() || limits.upper.is_finite()) {
        let message = "stands where no joint of the robot has a smallest or largest coordinate";
        return Err(field.refuse(RefusalKind::Rule, message, Some("leave it out".to_owned())));
    }
    let (stiffness, damping) = (stiffness?, damping?);
    if damping < 0.0 {
        let field = table.require("damping")?;
        let message = format!("is {damping}, less than 0");
        return Err(field.refuse(RefusalKind::OutOfRange, message, Some("write 0 or a positive number".to_owned())));
    }
    Ok(EndStops { stiffness, damping })
}

fn gripper(field: &Field<'_>, robot: &Robot) -> Read<Gripper> {
    let (body, anchor) = robot.anchor(&field.table(&ANCHOR)?)?;
    if robot.carrier(anchor.body) == Parent::World {
        let message = match anchor.body {
            Parent::World if body == "world" => "is on the world, which does not move".to_owned(),
            Parent::World => format!("is on {body:?}, the root link, which is the world and does not move"),
            Parent::Body(_) => format!("is on {body:?}, which is fixed to the world and does not move"),
        };
        let moves = |index: &usize| robot.carrier(Parent::Body(*index)) != Parent::World;
        let moving = (0..robot.parts.bodies.len()).filter(moves).map(|index| robot.parts.bodies[index].name.as_str());
        let help = format!("write one of {}", names::list(moving));
        return Err(field.refuse(RefusalKind::Rule, message, Some(help)));
    }
    Ok(Gripper { body, anchor })
}
