//! A robot as it is described: what its readers return.

use crate::reader::{Field, Refused};
use crate::text::document::shorten;
use crate::text::names;
use crate::text::refusal::{Place, RefusalKind};
use springpot::model::description::RobotDescription;
use springpot::model::{Anchor, BodySpec, Model};
use std::sync::Arc;

/// The robot of a scenario by itself.
#[derive(Debug, Clone)]
pub struct RobotPlan {
    /// Gravity in the world frame, m/s².
    pub gravity: [f64; 3],
    /// The bodies, parents before children.
    pub bodies: Vec<BodySpec>,
    /// The robot built of them.
    pub model: Arc<Model>,
    /// The URDF file that the bodies come from, if they do.
    pub urdf: Option<DescriptionPlan>,
    /// The gripper, if there is one.
    pub gripper: Option<Gripper>,
}

/// Where the fields of a body stand in the scenario.
#[derive(Debug, Clone)]
pub struct BodyPlaces {
    /// The body's table.
    pub table: Place,
    /// The fields that were written, by dotted key: `mass`, `joint.axis`, …
    pub fields: Vec<(String, Place)>,
}

impl BodyPlaces {
    /// Place of the field with the dotted key `key`; the body's table where the field was left out.
    pub fn at(&self, key: &str) -> &Place {
        self.fields.iter().find(|(field, _)| field == key).map_or(&self.table, |(_, place)| place)
    }
}

/// A URDF file and how it was read.
#[derive(Debug, Clone)]
pub struct DescriptionPlan {
    /// The path as written in the scenario, to whose folder it is relative.
    pub written: String,
    /// Whether mimic joints have coordinates of their own.
    pub ignore_mimic: bool,
    /// Folders that are packages or hold some, as written.
    pub package_path: Vec<String>,
    /// What the file says; its warnings are among those of [`crate::Cases::warnings`].
    pub robot: Arc<RobotDescription>,
}

/// Limits of joints as stops, SI of each joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndStops {
    /// Stiffness, N·m/rad or N/m.
    pub stiffness: f64,
    /// Damping, N·m·s/rad or N·s/m.
    pub damping: f64,
}

/// The point that a gripper path is about, and whose coordinates are columns.
#[derive(Debug, Clone)]
pub struct Gripper {
    /// Name of the body that carries it.
    pub body: String,
    /// The point.
    pub anchor: Anchor,
}

/// Bodies and the model built of them, from either source.
pub(crate) struct Parts {
    pub(crate) bodies: Vec<BodySpec>,
    pub(crate) places: Vec<BodyPlaces>,
    pub(crate) model: Arc<Model>,
    pub(crate) urdf: Option<DescriptionPlan>,
}

pub(super) fn unknown_body<'a>(field: &Field<'_>, name: &str, names: impl Iterator<Item = &'a str> + Clone) -> Refused {
    let message = format!("names no body: {:?}", shorten(name));
    field.refuse(RefusalKind::UnknownName, message, Some(names::suggest(name, names)))
}
