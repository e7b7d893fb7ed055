//! `<joint>` and `<freejoint>`.

use super::attitude::direction;
use super::element::At;
use super::error::DescriptionError;
use super::given::{Given, Reader};
use super::settings::Settings;
use super::warning::DescriptionWarningKind;
use crate::model::kind::JointKind;
use crate::model::spec::{JointSpec, Limits};
use crate::spatial::{Placement, Rotation, Vec3};

const TYPES: [&str; 4] = ["free", "ball", "slide", "hinge"];

const KNOWN: [&str; 27] = [
    "name",
    "class",
    "type",
    "group",
    "pos",
    "axis",
    "springdamper",
    "limited",
    "actuatorfrclimited",
    "solreflimit",
    "solimplimit",
    "solreffriction",
    "solimpfriction",
    "stiffness",
    "range",
    "actuatorfrcrange",
    "actuatorgravcomp",
    "margin",
    "ref",
    "springref",
    "armature",
    "damping",
    "frictionloss",
    "user",
    "align",
    "stiffnesspoly",
    "dampingpoly",
];

/// A joint of a body.
#[derive(Debug)]
pub(super) struct Joint {
    pub(super) at: At,
    /// Its point in the body's frame, about which it turns.
    pub(super) anchor: Vec3,
    /// Without origin.
    pub(super) spec: JointSpec,
    /// Coordinate where the body stands as the file places it, rad or m.
    pub(super) reference: f64,
    /// Stiffness, N·m/rad or N/m, and the coordinate at which its spring is slack.
    pub(super) spring: Option<[f64; 2]>,
    /// Time constant, s, and damping ratio of its spring and damper, whose values follow from the inertia.
    pub(super) tuned: Option<[f64; 2]>,
}

/// Reads a joint of this name, seen from `offset` in the body.
pub(super) fn read(
    reader: &mut Reader<'_>,
    given: &Given<'_>,
    settings: &Settings,
    name: String,
    offset: &Placement,
) -> Result<Joint, DescriptionError> {
    let (element, owner) = (given.element, given.owner);
    reader.check_attributes(element, owner, &[&KNOWN]);
    let kind = match element.tag.as_str() {
        "freejoint" => "free",
        _ => given.word(reader, "type", &TYPES)?.unwrap_or("hinge"),
    };
    if given.word(reader, "align", &["true", "false", "auto"])? == Some("true") {
        let why = "has align=\"true\", which moves the frame of its body and is not supported";
        return Err(reader.refuse(element.at, owner, why));
    }
    let plain = |spec: JointSpec, anchor: Vec3| Joint {
        at: element.at,
        anchor,
        spec,
        reference: 0.0,
        spring: None,
        tuned: None,
    };
    let anchor = offset.point(given.array(reader, "pos")?.map_or(Vec3::ZERO, Vec3));
    if kind == "free" || kind == "ball" {
        let armature = given.not_negative(reader, "armature")?;
        for what in ["damping", "stiffness", "frictionloss"] {
            if given.numbers(reader, what, 1..=3)?.unwrap_or_default().iter().any(|number| *number != 0.0) {
                let what = format!("{what} of {kind} joints");
                reader.warn(DescriptionWarningKind::InSimulator, owner, element.at, what);
            }
        }
        let mut joint = match kind {
            "free" => plain(JointSpec::floating(name, [0.0; 3]), Vec3::ZERO),
            _ => plain(JointSpec::spherical(name, [0.0; 3]), anchor),
        };
        joint.spec.armature_all = armature;
        return Ok(joint);
    }
    let turns = kind == "hinge";
    let scaled = |x: f64| if turns { settings.angle(x) } else { x };
    let axis = Vec3(given.array(reader, "axis")?.unwrap_or([0.0, 0.0, 1.0]));
    if axis.norm() < 1e-10 {
        return Err(reader.refuse(element.at, owner, "has an axis without direction"));
    }
    let axis = offset.rotation * direction(axis);
    let mut spec =
        if turns { JointSpec::revolute(name, axis.0, [0.0; 3]) } else { JointSpec::prismatic(name, axis.0, [0.0; 3]) };
    spec.damping[0] = linear(reader, given, "damping")?;
    spec.friction[0] = given.not_negative(reader, "frictionloss")?;
    spec.armature[0] = given.not_negative(reader, "armature")?;
    spec.limits[0] = limits(reader, given, settings, scaled)?;
    let tuned = given.array(reader, "springdamper")?.filter(|[time, ratio]| *time > 0.0 && *ratio > 0.0);
    let stiffness = linear(reader, given, "stiffness")?;
    let slack = scaled(given.number(reader, "springref")?.unwrap_or(0.0));
    let spring = (stiffness > 0.0 || tuned.is_some()).then_some([stiffness, slack]);
    // Where it slides from moves nothing.
    let anchor = if turns { anchor } else { Vec3::ZERO };
    let reference = scaled(given.number(reader, "ref")?.unwrap_or(0.0));
    Ok(Joint { at: element.at, anchor, spec, reference, spring, tuned })
}

/// A number, not below 0, whose higher powers are not taken.
fn linear(reader: &mut Reader<'_>, given: &Given<'_>, name: &'static str) -> Result<f64, DescriptionError> {
    let numbers = given.numbers(reader, name, 1..=3)?.unwrap_or_default();
    let [first, rest @ ..] = &numbers[..] else { return Ok(0.0) };
    if *first < 0.0 {
        let why = format!("has a {name} of {first}; it must be 0 or more");
        return Err(reader.refuse(given.element.at, given.owner, why));
    }
    if rest.iter().any(|number| *number != 0.0) {
        let what = format!("{name} beyond its first number");
        reader.warn(DescriptionWarningKind::InSimulator, given.owner, given.element.at, what);
    }
    Ok(*first)
}

fn limits(
    reader: &mut Reader<'_>,
    given: &Given<'_>,
    settings: &Settings,
    scaled: impl Fn(f64) -> f64,
) -> Result<Limits, DescriptionError> {
    let range: Option<[f64; 2]> = given.array(reader, "range")?;
    let is_limited = match given.word(reader, "limited", &["true", "false", "auto"])? {
        Some("true") => true,
        Some("false") => false,
        _ => settings.limits_by_range && range.is_some(),
    };
    let Some([lower, upper]) = range.filter(|_| is_limited) else { return Ok(Limits::NONE) };
    if lower >= upper {
        let (owner, at) = (given.owner, given.element.at);
        reader.warn(DescriptionWarningKind::SenselessLimit, owner, at, format!("{lower} {upper}"));
        return Ok(Limits::NONE);
    }
    Ok(Limits { lower: scaled(lower), upper: scaled(upper), ..Limits::NONE })
}

impl Joint {
    /// Whether it moves freely in space.
    pub(super) fn is_free(&self) -> bool {
        self.spec.kind == JointKind::Floating
    }

    /// What its reference takes off its coordinate: a turn about its axis, or a way along it.
    pub(super) fn before_reference(&self) -> Placement {
        let axis = Vec3(self.spec.axis);
        match self.spec.kind {
            JointKind::Revolute => {
                Placement { rotation: Rotation::from_axis_angle(axis, -self.reference), translation: Vec3::ZERO }
            }
            JointKind::Prismatic => {
                let translation = Vec3(axis.0.map(|x| -self.reference * x));
                Placement { rotation: Rotation::IDENTITY, translation }
            }
            _ => Placement::IDENTITY,
        }
    }
}
