//! Masses of the bodies: from `<inertial>` or from shapes, and what `<compiler>` makes of them.

use super::attitude::{self, placement};
use super::error::DescriptionError;
use super::given::{Given, Reader};
use super::settings::Settings;
use crate::linalg::{Lu, symmetric_eigenvectors};
use crate::model::kind::JointKind;
use crate::model::spec::{BodySpec, JointSpec, Parent};
use crate::spatial::{Inertia, Placement, Rotation, Symmetric3, Vec3};

const KNOWN: [&str; 4] = ["pos", "mass", "diaginertia", "fullinertia"];

/// Mass, kg, its centre in the frame of the body, m, and the moments about it in the axes of the body, kg·m².
#[derive(Debug, Clone, Copy)]
pub(super) struct Mass {
    mass: f64,
    centre: Vec3,
    central: Symmetric3,
}

impl Mass {
    /// Of what shapes add up to.
    pub(super) fn of(inertia: &Inertia) -> Self {
        let Inertia { mass, first_moment, .. } = *inertia;
        let centre = if mass > 0.0 { Vec3(first_moment.0.map(|x| x / mass)) } else { Vec3::ZERO };
        Self { mass, centre, central: inertia.about_com() }
    }
}

/// An `<inertial>`.
pub(super) fn inertial(
    reader: &mut Reader<'_>,
    given: &Given<'_>,
    settings: &Settings,
) -> Result<Mass, DescriptionError> {
    reader.check_attributes(given.element, given.owner, &[&KNOWN, &attitude::WAYS]);
    if given.attribute("mass").is_none() {
        return Err(reader.refuse(given.element.at, given.owner, "has an <inertial> without mass"));
    }
    let mass = given.not_negative(reader, "mass")?;
    let place = placement(reader, given, settings)?;
    let central = match (given.array(reader, "fullinertia")?, given.array(reader, "diaginertia")?) {
        (Some([xx, yy, zz, xy, xz, yz]), _) => Symmetric3 { xx, yy, zz, xy, xz, yz },
        (None, Some([xx, yy, zz])) => Symmetric3 { xx, yy, zz, ..Symmetric3::ZERO },
        (None, None) => Symmetric3::ZERO,
    };
    Ok(Mass { mass, centre: place.translation, central: central.rotated(&place.rotation) })
}

/// Gives a body its mass; its moments are at least what the file says, and their mean where no distribution of mass has them.
pub(super) fn give(spec: &mut BodySpec, own: &Mass, settings: &Settings) {
    (spec.mass, spec.com, spec.inertia) = (own.mass, own.centre.0, own.central.to_matrix());
    let [least_mass, least] = settings.least;
    spec.mass = spec.mass.max(least_mass);
    if least == 0.0 && !settings.balances {
        return;
    }
    let (mut moments, axes) = symmetric_eigenvectors(spec.inertia);
    let bounded = moments.map(|moment| moment.max(least));
    let mut changes = bounded != moments;
    moments = bounded;
    let largest = moments.iter().fold(0.0, |largest: f64, moment| largest.max(*moment));
    let sum: f64 = moments.iter().sum();
    if settings.balances && sum - largest < largest {
        (moments, changes) = ([sum / 3.0; 3], true);
    }
    if changes {
        let entry = |i: usize, j: usize| (0..3).map(|k| axes[i][k] * moments[k] * axes[j][k]).sum();
        spec.inertia = [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j)));
    }
}

/// Makes all bodies together as heavy as the file says.
pub(super) fn scale(bodies: &mut [BodySpec], settings: &Settings) {
    let mass: f64 = bodies.iter().map(|body| body.mass).sum();
    let Some(total) = settings.total_mass.filter(|_| mass > 0.0) else { return };
    let factor = total / mass;
    for body in bodies {
        body.mass *= factor;
        body.inertia = body.inertia.map(|row| row.map(|entry| factor * entry));
    }
}

/// What the joint of each body has to move where the bodies stand at these coordinates of joints, 0 of others, kg·m² or kg: 1/(M⁻¹)_kk of joints of
/// one coordinate, 0 of others. `None` where M is singular.
pub(super) fn felt(bodies: &[BodySpec], start: &[(String, Vec<f64>)]) -> Option<Vec<f64>> {
    let mut places: Vec<Placement> = Vec::with_capacity(bodies.len());
    let mut carried: Vec<Inertia> = Vec::with_capacity(bodies.len());
    // Of every velocity its body, what it does to a body at the origin of the world, and its armature.
    let mut ways: Vec<(usize, [Vec3; 2], f64)> = Vec::new();
    for (index, BodySpec { parent, joint, mass, com, inertia, .. }) in bodies.iter().enumerate() {
        let above = match parent {
            Parent::World => Placement::IDENTITY,
            Parent::Body(parent) => places[*parent],
        };
        let at = start.iter().find(|(name, _)| *name == joint.name).map(|(_, at)| &at[..]);
        let offset = Placement { rotation: Rotation::from_rpy(joint.rpy), translation: Vec3(joint.origin) };
        let place = above * offset * moved(joint, at);
        let own = Inertia::from_central(*mass, Vec3(*com), Symmetric3::from_upper(*inertia));
        carried.push(own.to_parent(&place));
        places.push(place);
        let axes = [0, 1, 2].map(|k| place.rotation.column(k));
        let turns = |axis: Vec3| [place.translation.cross(axis), axis];
        let slides = |axis: Vec3| [axis, Vec3::ZERO];
        let axis = place.rotation * Vec3(joint.axis);
        let own: Vec<[Vec3; 2]> = match joint.kind {
            JointKind::Revolute => vec![turns(axis)],
            JointKind::Prismatic => vec![slides(axis)],
            JointKind::Spherical => axes.map(turns).into(),
            JointKind::Floating => axes.map(slides).into_iter().chain(axes.map(turns)).collect(),
            _ => Vec::new(),
        };
        let armature = if joint.kind.nv() == 1 { joint.armature[0] } else { joint.armature_all };
        ways.extend(own.into_iter().map(|way| (index, way, armature)));
    }
    for k in (0..bodies.len()).rev() {
        if let Parent::Body(parent) = bodies[k].parent {
            let own = carried[k];
            carried[parent] += own;
        }
    }
    let is_on = |mut body: usize, other: usize| {
        while body > other {
            let Parent::Body(parent) = bodies[body].parent else { return false };
            body = parent;
        }
        body == other
    };
    let n = ways.len();
    let mut lu = Lu::default();
    let is_regular = lu.factor(n, |matrix| {
        for (row, (body, [linear, angular], armature)) in ways.iter().enumerate() {
            for (column, (other, [v, omega], _)) in ways.iter().enumerate() {
                if is_on(*body, *other) || is_on(*other, *body) {
                    let both = &carried[*body.max(other)];
                    let (shifted, turned) = (both.shifted_by(*v), both.turned_by(*omega));
                    matrix[row * n + column] =
                        linear.dot(shifted.linear + turned.linear) + angular.dot(shifted.angular + turned.angular);
                }
            }
            matrix[row * n + row] += armature;
        }
    });
    let mut felt = vec![0.0; bodies.len()];
    for (k, (body, ..)) in ways.iter().enumerate().filter(|_| is_regular) {
        let mut column = vec![0.0; n];
        column[k] = 1.0;
        lu.solve(&mut column);
        if bodies[*body].joint.kind.nv() == 1 {
            felt[*body] = 1.0 / column[k];
        }
    }
    is_regular.then_some(felt)
}

/// What a joint does at these coordinates; nothing without them.
fn moved(joint: &JointSpec, at: Option<&[f64]>) -> Placement {
    let axis = Vec3(joint.axis);
    match (joint.kind, at) {
        (JointKind::Revolute, Some([angle])) => {
            Placement { rotation: Rotation::from_axis_angle(axis, *angle), ..Placement::IDENTITY }
        }
        (JointKind::Prismatic, Some([way])) => {
            Placement { translation: Vec3(axis.0.map(|x| way * x)), ..Placement::IDENTITY }
        }
        (JointKind::Floating, Some(&[x, y, z, roll, pitch, yaw])) => {
            Placement { rotation: Rotation::from_rpy([roll, pitch, yaw]), translation: Vec3([x, y, z]) }
        }
        _ => Placement::IDENTITY,
    }
}
