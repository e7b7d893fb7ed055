//! What changed inertias and a changed field of gravity ask of the joints.

use super::joint;
use super::kinematics::Kinematics;
use super::moments::reference;
use super::workspace::Workspace;
use crate::model::Model;
use crate::spatial::{Force, Inertia, Motion, Vec3};

/// Adds what the link of `joint` with the inertia `change` in place of its own asks of the joints, ∂τ/∂I · ΔI, N·m or N, by the index of
/// each velocity: linear in `change`, without gravity where that is 0.
///
/// `workspace` is that of [`rnea_derivatives_into`](super::rnea_derivatives_into), which was called last with it, in the same state: with v and
/// a of the link (less gravity) there, the force ΔI a + v ×* ΔI v goes to all that carry it.
pub(crate) fn add_inertia_effort(
    model: &Model,
    kinematics: &Kinematics,
    workspace: &Workspace,
    joint: usize,
    change: &Inertia,
    mut add: impl FnMut(usize, f64),
) {
    let link = kinematics.link(joint + 1);
    let inertia = change.rotated(&link.rotation).shifted(link.translation - reference(kinematics));
    let (velocity, acceleration) = (workspace.velocity[joint + 1], workspace.acceleration[joint + 1]);
    let force = inertia * acceleration + velocity.cross_force(inertia * velocity);
    carry(model, workspace, joint, force, &mut add);
}

/// Adds what a field of gravity that changes by `change`, m/s², world axes, asks of the joints, as [`add_inertia_effort`] does.
pub(crate) fn add_gravity_effort(
    model: &Model,
    workspace: &Workspace,
    change: [f64; 3],
    mut add: impl FnMut(usize, f64),
) {
    let upwards = Motion { angular: Vec3::ZERO, linear: -Vec3(change) };
    for joint in 0..model.joint_count() {
        // All that the joint carries.
        let force = workspace.composite[joint] * upwards;
        for k in model.degrees_of(joint) {
            add(model.degrees()[k].index, workspace.axes.unit[k].dot(force));
        }
    }
}

/// Hands a force on the link of `joint` to its own degrees and to those that carry it.
fn carry(model: &Model, workspace: &Workspace, joint: usize, force: Force, add: &mut impl FnMut(usize, f64)) {
    let Some(last) = model.degrees_of(joint).last() else { return };
    for k in [last].into_iter().chain(joint::carriers(model, last)) {
        add(model.degrees()[k].index, workspace.axes.unit[k].dot(force));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::{RneaDerivatives, rnea, rnea_derivatives_into};
    use crate::model::{BodySpec, JointSpec, ModelBuilder, Parent};
    use crate::spatial::Symmetric3;

    /// Two limbs on one body, a floating one among the joints.
    fn robot() -> Model {
        let mut builder = ModelBuilder::new([0.2, -0.1, -9.81]);
        let (axis, origin) = ([0.3, -0.5, 1.0], [0.1, 0.2, -0.3]);
        let joints = [
            JointSpec::floating("j0", origin),
            JointSpec::revolute("j1", axis, origin),
            JointSpec::prismatic("j2", axis, origin),
            JointSpec::revolute("j3", axis, origin),
        ];
        for (k, (joint, parent)) in joints.into_iter().zip([None, Some(0), Some(1), Some(0)]).enumerate() {
            let body = BodySpec {
                name: format!("b{k}"),
                parent: parent.map_or(Parent::World, Parent::Body),
                joint,
                mass: 1.0 + k as f64,
                com: [0.1, -0.2, 0.05],
                inertia: [[0.2, 0.01, 0.0], [0.01, 0.3, 0.02], [0.0, 0.02, 0.25]],
            };
            builder.push(body).unwrap();
        }
        builder.finish().unwrap()
    }

    #[test]
    fn efforts_are_those_of_the_changed_robot() {
        let model = robot();
        let (n, mut seed) = (model.nv(), 1u64);
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let step: Vec<f64> = (0..n).map(|_| random()).collect();
        let q = model.integrate(&model.neutral(), &step);
        let (v, a): (Vec<f64>, Vec<f64>) = (0..n).map(|_| (2.0 * random(), 3.0 * random())).unzip();
        let kinematics = Kinematics::at_velocity(&model, &q, &v);
        let (mut workspace, mut slopes) = (Workspace::new(&model), RneaDerivatives::new(&model));
        rnea_derivatives_into(&model, &kinematics, &a, &[], &mut workspace, &mut slopes);
        let bodies = model.body_names().len();
        for joint in 0..model.joint_count() {
            let change = Inertia {
                mass: random(),
                first_moment: Vec3([random(), random(), random()]),
                rotational: Symmetric3::from_upper([
                    [random(), random(), random()],
                    [0.0, random(), random()],
                    [0.0, 0.0, random()],
                ]),
            };
            let mut changes = vec![Inertia::ZERO; bodies];
            changes[model.body_names().iter().position(|name| **name == format!("b{joint}")).unwrap()] = change;
            let moved = model.with_inertias(&changes, &vec![0.0; model.joint_count()]);
            let expected = rnea(&moved, &q, &v, &a, &[]);
            let mut found = vec![0.0; n];
            let link = moved.link_inertia(joint);
            add_inertia_effort(&model, &kinematics, &workspace, joint, link, |k, value| found[k] += value);
            for (found, expected) in found.iter().zip(&expected) {
                assert!((found - expected).abs() < 1e-12, "{joint}: {found} {expected}");
            }
        }
        let zero = vec![0.0; n];
        let field = [0.4, -0.3, 0.7];
        let expected = rnea(&model.with_gravity(field), &q, &zero, &zero, &[]);
        let mut found = zero;
        add_gravity_effort(&model, &workspace, field, |k, value| found[k] += value);
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-12, "gravity: {found} {expected}");
        }
    }
}
