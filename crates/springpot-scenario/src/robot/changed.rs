//! `[[robot.joint]]`: what a scenario says of joints of a URDF file.

use super::joint::{axis2, lead, mark, numbers};
use crate::keys::CHANGED_JOINT;
use crate::reader::named::unique;
use crate::reader::{Field, Read, Table, all};
use crate::robot::described::BodyPlaces;
use crate::text::document::shorten;
use crate::text::names;
use crate::text::refusal::RefusalKind;
use springpot::model::{BodySpec, JointKind, JointSpec, Limits, MOST_COORDINATES};
use std::collections::HashMap;

/// Changes the joints of `bodies` as `field` says; `places` are to know where.
pub(crate) fn change(field: &Field<'_>, bodies: &mut [BodySpec], places: &mut [BodyPlaces]) -> Read<()> {
    let mut seen = HashMap::new();
    let items = field.items("an array of tables: [[robot.joint]]")?;
    all(items.iter().map(|item| {
        let name = item.node.get("name").and_then(|node| node.text());
        let what = name.map_or_else(|| "[[robot.joint]]".to_owned(), |name| format!("[[robot.joint]] {name:?}"));
        let written = item.node.get("kind").and_then(|node| node.text());
        let own = name.and_then(|name| bodies.iter().position(|body| body.joint.name == name));
        let kind = match written {
            Some(word) => JointKind::named(word),
            None => own.map(|own| bodies[own].joint.kind),
        };
        let reason = |key: &str| CHANGED_JOINT.without_meaning(key, &what, kind?);
        let keys = (&CHANGED_JOINT, kind.unwrap_or(JointKind::Revolute).name());
        let table = Table::of_kind(item.ctx, item.node, what.clone(), keys, reason)?;
        let name = table.require("name")?;
        unique(&mut seen, &name, name.text()?)?;
        let Some(own) = own else {
            let message = format!("names no joint of the file: {:?}", shorten(name.text()?));
            let known = bodies.iter().map(|body| body.joint.name.as_str());
            return Err(name.refuse(RefusalKind::UnknownName, message, Some(names::suggest(name.text()?, known))));
        };
        if let Some(field) = table.get("kind") {
            field.word("kind of joint")?;
        }
        places[own]
            .fields
            .extend(table.fields().map(|field| (format!("joint.{}", field.key), field.node.place.clone())));
        let joint = &bodies[own].joint;
        let follower = bodies.iter().find(|body| body.joint.mimic.as_ref().is_some_and(|m| m.joint == joint.name));
        if let (Some(field), Some(kind), Some(follower)) =
            (table.get("kind"), kind.filter(|kind| kind.nv() != 1), follower)
        {
            let message = format!(
                "is {:?}, but joint {:?} follows this one in the file: a joint follows one coordinate",
                kind.name(),
                follower.joint.name
            );
            let help = "give it a kind of one coordinate, or write ignore_mimic = true in [robot]".to_owned();
            return Err(field.refuse(RefusalKind::Rule, message, Some(help)));
        }
        let joint = &mut bodies[own].joint;
        if let (Some(kind), Some(field)) = (kind, table.get("kind")) {
            if kind.has_axis() && !joint.kind.has_axis() {
                let message =
                    format!("is {:?}, but the joint is {} in the file and has no axis", kind.name(), joint.kind.name());
                return Err(field.refuse(RefusalKind::Rule, message, None));
            }
            retype(joint, kind);
            (joint.axis2, joint.lead) = (axis2(&table, kind)?, lead(&table, kind)?);
        }
        joint.armature = numbers(&table, "armature", joint.kind, 0.0)?;
        mark(&table, ("armature", joint.kind), Some(&joint.armature), &mut places[own]);
        Ok(())
    }))
    .map(|_| ())
}

/// Gives a joint another kind: what it says of its one coordinate stays where the new one measures the same.
fn retype(joint: &mut JointSpec, kind: JointKind) {
    if joint.kind.dimension() != kind.dimension() || kind.dimension().is_none() {
        joint.damping = [0.0; MOST_COORDINATES];
        joint.friction = [0.0; MOST_COORDINATES];
        joint.limits = [Limits::NONE; MOST_COORDINATES];
    }
    joint.kind = kind;
}
