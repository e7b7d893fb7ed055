//! `springpot info --json`: everything as data, SI.

use crate::plain;
use crate::robot::Robot;
use serde::Serialize;
use springpot::model::description::{DescriptionWarning, Owner};
use springpot::model::{BodySpec, DescribedJoint, JointSpec, Label, Limits, Parent};
use springpot::spatial::Placement;
use std::ops::Range;
use std::path::Path;

/// A robot. Numbers that are not finite (no limit) become null.
#[derive(Serialize)]
struct Info<'a> {
    name: &'a str,
    file: String,
    gravity: [f64; 3],
    nq: usize,
    nv: usize,
    mass: f64,
    fixed_mass: f64,
    /// Names of the numbers of q and v.
    q: Vec<String>,
    v: Vec<String>,
    base: &'a str,
    gripper: Option<Gripper<'a>>,
    joints: Vec<Joint<'a>>,
    frames: Vec<Frame<'a>>,
    links: Vec<Link<'a>>,
    warnings: Vec<Warning<'a>>,
}

#[derive(Serialize)]
struct Gripper<'a> {
    body: &'a str,
    point: [f64; 3],
}

/// A joint that moves.
#[derive(Serialize)]
struct Joint<'a> {
    name: &'a str,
    kind: &'static str,
    parent: &'a str,
    link: &'a str,
    #[serde(flatten)]
    geometry: Geometry,
    /// Indices of its own numbers in q and v; none where it follows another joint.
    q: Vec<usize>,
    v: Vec<usize>,
    follows: Option<Follows<'a>>,
    limits: Each<JointLimits>,
    damping: Each<f64>,
    friction: Each<f64>,
    armature: Each<f64>,
    /// Mass of the link with all that is fixed to it, and with all that it carries.
    mass: f64,
    subtree_mass: f64,
}

/// Where it is and along what it moves, in the frame of its parent.
#[derive(Serialize)]
struct Geometry {
    axis: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    axis2: Option<[f64; 3]>,
    /// Advance per turn.
    #[serde(skip_serializing_if = "Option::is_none")]
    lead: Option<f64>,
    origin: [f64; 3],
    rpy: [f64; 3],
}

/// Of a joint of one coordinate, or of each of several in their order.
#[derive(Serialize)]
#[serde(untagged)]
enum Each<T> {
    One(T),
    Several(Vec<T>),
}

#[derive(Serialize)]
struct Follows<'a> {
    joint: &'a str,
    multiplier: f64,
    offset: f64,
}

#[derive(Serialize)]
struct JointLimits {
    lower: f64,
    upper: f64,
    velocity: f64,
    effort: f64,
}

/// A link on a fixed joint.
#[derive(Serialize)]
struct Frame<'a> {
    name: &'a str,
    joint: &'a str,
    parent: &'a str,
    carrier: &'a str,
    /// In the frame of the carrier.
    #[serde(rename = "R")]
    rotation: [[f64; 3]; 3],
    #[serde(rename = "p")]
    translation: [f64; 3],
}

/// A link as it is described.
#[derive(Serialize)]
struct Link<'a> {
    name: &'a str,
    joint: &'a str,
    mass: f64,
    com: [f64; 3],
    inertia: [[f64; 3]; 3],
}

#[derive(Serialize)]
struct Warning<'a> {
    message: String,
    places: Vec<Place<'a>>,
}

#[derive(Serialize)]
struct Place<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    link: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    joint: Option<&'a str>,
    line: usize,
    what: &'a str,
}

pub(super) fn text(robot: &Robot, file: &Path) -> String {
    let model = &robot.model;
    let names = |labels: Vec<Label>| labels.into_iter().map(|label| label.name).collect();
    let info = Info {
        name: &robot.name,
        file: file.display().to_string(),
        gravity: model.gravity(),
        nq: model.nq(),
        nv: model.nv(),
        mass: robot.moving_mass(),
        fixed_mass: robot.fixed_mass(),
        q: names(model.q_labels()),
        v: names(model.v_labels()),
        base: &robot.base.0,
        gripper: robot.gripper.as_ref().map(|(body, point)| Gripper { body, point: *point }),
        joints: model.described_joints().iter().map(|described| joint(robot, described)).collect(),
        frames: robot.fixed_bodies().filter_map(|(index, body)| frame(robot, index, body)).collect(),
        links: robot.bodies.iter().map(link).collect(),
        warnings: robot.warnings.iter().map(warning).collect(),
    };
    let text = serde_json::to_string(&info).expect("names are text and numbers are numbers or null");
    format!("{}\n", plain::json(&text))
}

fn joint<'a>(robot: &'a Robot, described: &DescribedJoint) -> Joint<'a> {
    let (model, Range { start, end }) = (&robot.model, described.joints.clone());
    let j = end - 1;
    let body = &robot.bodies[model.joint_body(j)];
    let spec = &body.joint;
    let followed = model.followed(j);
    let own = |range: Range<usize>| if followed.is_none() { range.collect() } else { Vec::new() };
    let limits = |k: usize| {
        let Limits { lower, upper, velocity, effort } = spec.limits[k];
        JointLimits { lower, upper, velocity, effort }
    };
    Joint {
        name: &spec.name,
        kind: spec.kind.name(),
        parent: robot.body_name(body.parent),
        link: &body.name,
        geometry: Geometry {
            axis: spec.kind.has_axis().then_some(spec.axis),
            axis2: spec.kind.has_axis2().then_some(spec.axis2),
            lead: spec.kind.has_lead().then_some(spec.lead),
            origin: spec.origin,
            rpy: spec.rpy,
        },
        q: own(model.q_range(start).start..model.q_range(j).end),
        v: own(model.v_range(start).start..model.v_range(j).end),
        follows: followed.map(|(leader, multiplier, offset)| Follows {
            joint: &model.joint_names()[leader],
            multiplier,
            offset,
        }),
        limits: each(spec, limits),
        damping: each(spec, |k| spec.damping[k]),
        friction: each(spec, |k| spec.friction[k]),
        armature: each(spec, |k| spec.armature[k]),
        mass: model.link_inertia(j).mass,
        subtree_mass: model.subtree_mass(j),
    }
}

fn each<T>(joint: &JointSpec, of: impl Fn(usize) -> T) -> Each<T> {
    match joint.kind.numbers().count() {
        0 | 1 => Each::One(of(0)),
        several => Each::Several((0..several).map(of).collect()),
    }
}

fn frame<'a>(robot: &'a Robot, index: usize, body: &'a BodySpec) -> Option<Frame<'a>> {
    let own = robot.model.frame(Parent::Body(index)).ok()?;
    let carrier = robot.carrier(own.link());
    // Links turn their axis to z; a frame is told in the carrier's own axes.
    let of_carrier = *robot.model.frame(carrier).ok()?.placement();
    let Placement { rotation, translation } = *own.placement();
    Some(Frame {
        name: &body.name,
        joint: &body.joint.name,
        parent: robot.body_name(body.parent),
        carrier: robot.body_name(carrier),
        rotation: (of_carrier.rotation.transpose() * rotation).0,
        translation: of_carrier.rotation.unrotate(translation - of_carrier.translation).0,
    })
}

fn link(body: &BodySpec) -> Link<'_> {
    let BodySpec { name, joint, mass, com, inertia, .. } = body;
    Link { name, joint: &joint.name, mass: *mass, com: *com, inertia: *inertia }
}

fn warning(warning: &DescriptionWarning) -> Warning<'_> {
    let places = warning.places.iter().map(|place| {
        let (link, joint) = match &place.owner {
            Owner::Robot | Owner::Mujoco | Owner::Geom(_) | Owner::Mesh(_) => (None, None),
            Owner::Link(name) | Owner::Body(name) => (Some(name.as_str()), None),
            Owner::Joint(name) => (None, Some(name.as_str())),
        };
        Place { link, joint, line: place.line, what: &place.what }
    });
    Warning { message: warning.to_string(), places: places.collect() }
}
