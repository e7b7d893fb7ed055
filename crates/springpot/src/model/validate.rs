//! Whether a described body makes physical sense.

use super::error::{Field, ModelError};
use super::kind::JointKind;
use super::spec::{BodySpec, FrictionLaw, JointSpec, Limits, Parent, unit};
use crate::linalg::symmetric_eigenvalues;
use crate::names::is_name;

/// Refuses a principal moment below minus this share of the largest one.
const POSITIVE_TOLERANCE: f64 = 1e-12;
/// Refuses a largest principal moment that exceeds the sum of the others by more than this share of itself.
const TRIANGLE_TOLERANCE: f64 = 1e-9;
/// Refuses off-diagonals that differ by more than this share of the largest entry.
const SYMMETRY_TOLERANCE: f64 = 1e-12;

/// Refuses two axes at an angle whose sine is not above this.
const PARALLEL: f64 = 1e-8;

/// What kind of description is checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rules {
    /// Bodies with identifiers for names, each physical by itself.
    Body,
    /// Links of a URDF: any names; a link is physical together with what is fixed to it.
    UrdfLink,
}

/// Checks all that concerns the body numbered `body` alone (names against other bodies are the builder's business).
pub(super) fn body(body: usize, spec: &BodySpec, rules: Rules, takes_any_inertia: bool) -> Result<(), ModelError> {
    if rules == Rules::Body {
        names(body, spec)?;
    }
    if let Parent::Body(parent) = spec.parent
        && parent >= body
    {
        return Err(ModelError::ParentNotEarlier { body, name: spec.name.clone(), parent });
    }
    numbers(body, spec)?;
    axes(body, &spec.joint)?;
    // What a URDF fixes to another link is judged together with it.
    if rules == Rules::UrdfLink && spec.joint.kind == JointKind::Fixed {
        return Ok(());
    }
    match inertia(body, &spec.name, spec.inertia, 0.0, rules == Rules::Body) {
        Err(error) if takes_any_inertia && error.is_of_no_mass() => Ok(()),
        judged => judged,
    }
}

/// Refuses axes without direction, or without two of them, and a lead of 0.
fn axes(body: usize, joint: &JointSpec) -> Result<(), ModelError> {
    let name = || joint.name.clone();
    if joint.kind.has_axis() && joint.axis == [0.0; 3] {
        return Err(ModelError::ZeroAxis { body, joint: name(), field: Field::Axis });
    }
    if joint.kind.has_axis2() {
        if joint.axis2 == [0.0; 3] {
            return Err(ModelError::ZeroAxis { body, joint: name(), field: Field::Axis2 });
        }
        let [first, second] = [unit(joint.axis), unit(joint.axis2)];
        if first.cross(second).norm() <= PARALLEL {
            return Err(ModelError::ParallelAxes { body, joint: name() });
        }
    }
    if joint.kind.has_lead() && joint.lead == 0.0 {
        return Err(ModelError::NoLead { body, joint: name() });
    }
    Ok(())
}

fn names(body: usize, spec: &BodySpec) -> Result<(), ModelError> {
    for (field, name) in [(Field::Name, &spec.name), (Field::JointName, &spec.joint.name)] {
        if !is_name(name) {
            return Err(ModelError::InvalidName { body, field, name: name.clone() });
        }
    }
    if spec.name == "world" {
        return Err(ModelError::ReservedName { body });
    }
    Ok(())
}

fn numbers(body: usize, spec: &BodySpec) -> Result<(), ModelError> {
    let joint = &spec.joint;
    let mimic = joint.mimic.as_ref().map_or([1.0, 0.0], |mimic| [mimic.multiplier, mimic.offset]);
    let speeds = joint.friction_law.map(|law| match law {
        FrictionLaw::Smooth { speed } => speed,
        FrictionLaw::Sticking => f64::MIN_POSITIVE,
    });
    let fields: [(Field, &[f64]); 14] = [
        (Field::Axis, &joint.axis),
        (Field::Axis2, &joint.axis2),
        (Field::Lead, &[joint.lead]),
        (Field::Origin, &joint.origin),
        (Field::Rpy, &joint.rpy),
        (Field::Damping, &joint.damping),
        (Field::Friction, &joint.friction),
        (Field::FrictionSpeed, &speeds),
        (Field::Armature, &joint.armature),
        (Field::Armature, &[joint.armature_all]),
        (Field::Mimic, &mimic),
        (Field::Mass, &[spec.mass]),
        (Field::Com, &spec.com),
        (Field::Inertia, spec.inertia.as_flattened()),
    ];
    for (field, values) in fields {
        if let Some(&value) = values.iter().find(|value| !value.is_finite()) {
            return Err(ModelError::NotFinite { body, name: spec.name.clone(), field, value });
        }
    }
    let not_negative: [(Field, &[f64]); 5] = [
        (Field::Damping, &joint.damping),
        (Field::Friction, &joint.friction),
        (Field::Armature, &joint.armature),
        (Field::Armature, &[joint.armature_all]),
        (Field::Mass, &[spec.mass]),
    ];
    for (field, values) in not_negative {
        if let Some(&value) = values.iter().find(|value| **value < 0.0) {
            return Err(ModelError::Negative { body, name: spec.name.clone(), field, value });
        }
    }
    if let Some(&speed) = speeds.iter().find(|speed| **speed <= 0.0) {
        return Err(ModelError::FrictionSpeed { body, name: spec.name.clone(), speed });
    }
    for limits in &joint.limits {
        let Limits { lower, upper, velocity, effort } = *limits;
        if !(lower <= upper && lower < f64::INFINITY && upper > f64::NEG_INFINITY) {
            return Err(ModelError::LimitOrder { body, joint: joint.name.clone(), lower, upper });
        }
        for (field, value) in [(Field::Velocity, velocity), (Field::Effort, effort)] {
            if value.is_nan() || value <= 0.0 {
                return Err(ModelError::LimitNotPositive { body, joint: joint.name.clone(), field, value });
            }
        }
    }
    Ok(())
}

/// Checks an inertia tensor about a centre of mass, whose entries are known to `rounding`; the triangle inequality only where
/// it is asked for.
pub(super) fn inertia(
    body: usize,
    name: &str,
    m: [[f64; 3]; 3],
    rounding: f64,
    triangle: bool,
) -> Result<(), ModelError> {
    let name = || name.to_owned();
    let scale = m.iter().flatten().fold(0.0, |s: f64, x| s.max(x.abs()));
    for (row, column) in [(0, 1), (0, 2), (1, 2)] {
        let (upper, lower) = (m[row][column], m[column][row]);
        if (upper - lower).abs() > SYMMETRY_TOLERANCE * scale {
            return Err(ModelError::AsymmetricInertia { body, name: name(), row, column, upper, lower });
        }
    }
    let [smallest, middle, largest] = symmetric_eigenvalues(m);
    if smallest < -POSITIVE_TOLERANCE * largest.abs() - rounding {
        return Err(ModelError::InertiaNotPositive { body, name: name(), smallest });
    }
    let others = smallest + middle;
    if triangle && largest - others > TRIANGLE_TOLERANCE * largest + 3.0 * rounding {
        return Err(ModelError::TriangleInequality { body, name: name(), largest, others });
    }
    Ok(())
}
