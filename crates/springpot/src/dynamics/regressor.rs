//! What inertias and gravity ask of the joints: linear in the numbers of the bodies.

use super::joint;
use super::kinematics::Kinematics;
use super::moments::{motions, reference};
use super::workspace::Workspace;
use crate::model::Model;
use crate::spatial::{Inertia, Motion, Placement, Scalar, Symmetric3, Vec3};

/// Numbers of a body in the order of [`joint_torque_regressor_into`].
pub const BODY_NUMBERS: usize = 10;

/// Joint torque regressor Y(q, v, a): τ = Y π + rotors · a, with τ of [`rnea_into`](super::rnea_into) without pairs and the numbers π of all bodies.
///
/// `regressor` is nv × 10·bodies, row-major (all entries are written); needs velocities; `a` (nv). Bodies stand in the order of
/// [`Model::body_names`], each with its mass, first moment (x, y, z) and inertia about the origin of the body's frame (xx, xy, yy, xz, yz, zz), in its
/// axes: [`body_numbers`]. Columns of bodies fixed to the world are 0. A rotor, the armature of its joint, asks for itself times a alone.
/// Source: C. G. Atkeson, C. H. An and J. M. Hollerbach, Estimation of inertial parameters of manipulator loads and links, Int. J. Rob. Res. 5(3), 1986.
#[inline(always)]
pub fn joint_torque_regressor_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    a: &[T],
    workspace: &mut Workspace<T>,
    regressor: &mut [T],
) {
    let (n, width) = (model.nv(), BODY_NUMBERS * model.frames().len());
    assert_eq!(regressor.len(), n * width, "the regressor is nv x 10 bodies");
    regressor.fill(T::ZERO);
    if n == 0 {
        return;
    }
    motions(model, kinematics, Some(&a[..n]), workspace, |_| true);
    for (body, frame) in model.frames().iter().enumerate() {
        let Some(joint) = frame.link().checked_sub(1) else { continue };
        let mut units = [Inertia::ZERO; BODY_NUMBERS];
        for which in 0..BODY_NUMBERS {
            units[which] = unit_number(which).to_parent(frame.placement());
        }
        let columns = (&mut *regressor, width, body * BODY_NUMBERS);
        add_inertia_efforts(model, kinematics, workspace, (joint, &units), |_| true, columns);
    }
}

/// [`joint_torque_regressor_into`], allocating.
pub fn joint_torque_regressor<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, a: &[T]) -> Vec<T> {
    let mut regressor = vec![T::ZERO; model.nv() * BODY_NUMBERS * model.frames().len()];
    joint_torque_regressor_into(model, kinematics, a, &mut Workspace::new(model), &mut regressor);
    regressor
}

/// The numbers of all bodies that [`joint_torque_regressor_into`] has columns for: 10 a body, kg, kg·m and kg·m².
pub fn body_numbers(model: &Model) -> Vec<f64> {
    let numbers = |inertia: &Inertia| {
        let (Vec3([x, y, z]), j) = (inertia.first_moment, inertia.rotational);
        [inertia.mass, x, y, z, j.xx, j.xy, j.yy, j.xz, j.yz, j.zz]
    };
    model.body_inertias().iter().flat_map(numbers).collect()
}

/// An inertia of which one number is 1 and the others are 0.
#[inline(always)]
fn unit_number(which: usize) -> Inertia {
    let mut of = [0.0; BODY_NUMBERS];
    of[which] = 1.0;
    let [mass, x, y, z, xx, xy, yy, xz, yz, zz] = of;
    Inertia { mass, first_moment: Vec3([x, y, z]), rotational: Symmetric3 { xx, yy, zz, xy, xz, yz } }
}

/// Adds what the link of `joint` with each of these inertias in place of its own asks of the joints, ∂τ/∂I · ΔI, N·m or N, to the columns from `first`
/// on of `efforts`, which has a row of `count` for each velocity, where that is `wanted`: linear in the changes, without gravity where that is 0.
///
/// `workspace` is that of [`rnea_derivatives_into`](super::rnea_derivatives_into), which was called last with it, in the same state. With the velocity
/// (ω, v) and the acceleration (α, a) of the link (less gravity) in its own frame, in which ΔI stands still, and d = a + ω × v, a link of mass m,
/// first moment h and rotational inertia J asks for the force m d + α × h + ω × (ω × h) and the moment h × d + J α + ω × J ω; along the unit motion
/// (e, u) of a degree that carries it, that is m y + h·y_h + Σ J_ik (y_J)_ik with y of the motion alone (C. G. Atkeson, C. H. An & J. M. Hollerbach 1986).
#[inline(always)]
pub(crate) fn add_inertia_efforts<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    workspace: &Workspace<T>,
    (joint, changes): (usize, &[Inertia]),
    wanted: impl Fn(usize) -> bool,
    (efforts, count, first): (&mut [T], usize, usize),
) {
    let Some(last) = model.degrees_of(joint).last() else { return };
    let link = LinkMotion::of(kinematics, workspace, joint);
    for k in [last].into_iter().chain(joint::carriers(model, last)) {
        let index = model.degrees()[k].index;
        if wanted(index) {
            link.add_along(workspace.axes.unit[k], changes, efforts[index * count + first..].iter_mut());
        }
    }
}

/// How a link moves, in its own frame.
pub(super) struct LinkMotion<'a, T> {
    link: &'a Placement<T>,
    /// From the reference point.
    arm: Vec3<T>,
    omega: Vec3<T>,
    alpha: Vec3<T>,
    /// a + ω × v.
    d: Vec3<T>,
}

impl<'a, T: Scalar> LinkMotion<'a, T> {
    /// Of the link of `joint`, with the workspace of [`add_inertia_efforts`].
    #[inline(always)]
    pub(super) fn of(kinematics: &'a Kinematics<T>, workspace: &Workspace<T>, joint: usize) -> Self {
        let link = kinematics.link(joint + 1);
        let arm = link.translation - reference(kinematics);
        let velocity = inside(link, arm, workspace.velocity[joint + 1]);
        let acceleration = inside(link, arm, workspace.acceleration[joint + 1]);
        let (omega, alpha) = (velocity.angular, acceleration.angular);
        Self { link, arm, omega, alpha, d: acceleration.linear + omega.cross(velocity.linear) }
    }

    /// Adds what the link with each of these inertias asks for along a motion about the reference point to as many numbers.
    #[inline(always)]
    pub(super) fn add_along<'e>(&self, along: Motion<T>, changes: &[Inertia], efforts: impl Iterator<Item = &'e mut T>)
    where
        T: 'e,
    {
        let Self { link, arm, omega, alpha, d } = *self;
        let Motion { angular: e, linear: u } = inside(link, arm, along);
        let (of_mass, of_moment) = (u.dot(d), u.cross(alpha) + omega.cross(omega.cross(u)) + d.cross(e));
        let (Vec3([ex, ey, ez]), Vec3([ax, ay, az])) = (e, alpha);
        let (Vec3([wx, wy, wz]), Vec3([ox, oy, oz])) = (e.cross(omega), omega);
        let [xx, yy, zz] = [ex * ax + wx * ox, ey * ay + wy * oy, ez * az + wz * oz];
        let xy = ex * ay + ey * ax + wx * oy + wy * ox;
        let xz = ex * az + ez * ax + wx * oz + wz * ox;
        let yz = ey * az + ez * ay + wy * oz + wz * oy;
        for (effort, change) in efforts.zip(changes) {
            let Inertia { mass, first_moment, rotational: j } = Inertia::from_f64(change);
            let turned = j.xx * xx + j.yy * yy + j.zz * zz + j.xy * xy + j.xz * xz + j.yz * yz;
            *effort += mass * of_mass + first_moment.dot(of_moment) + turned;
        }
    }
}

/// A motion about the reference point, seen from `arm` away in the axes of a link.
#[inline(always)]
fn inside<T: Scalar>(link: &Placement<T>, arm: Vec3<T>, motion: Motion<T>) -> Motion<T> {
    let there = motion.shifted(arm);
    Motion { angular: link.rotation.unrotate(there.angular), linear: link.rotation.unrotate(there.linear) }
}

/// Adds what a field of gravity that changes by each of these, m/s², world axes, asks of the joints, as [`add_inertia_efforts`] does: all that a joint
/// carries, of mass m and first moment h, takes −(m u + e × h) · Δg along the unit motion (e, u).
#[inline(always)]
pub(crate) fn add_gravity_efforts<T: Scalar>(
    model: &Model,
    workspace: &Workspace<T>,
    changes: &[[f64; 3]],
    wanted: impl Fn(usize) -> bool,
    (efforts, count, first): (&mut [T], usize, usize),
) {
    if changes.is_empty() {
        return;
    }
    for joint in 0..model.joint_count() {
        for k in model.degrees_of(joint) {
            let index = model.degrees()[k].index;
            if !wanted(index) {
                continue;
            }
            let (Inertia { mass, first_moment, .. }, unit) = (workspace.composite[joint], workspace.axes.unit[k]);
            let lifted = unit.linear * mass + unit.angular.cross(first_moment);
            for (effort, change) in efforts[index * count + first..].iter_mut().zip(changes) {
                *effort -= lifted.dot(Vec3::from_f64(Vec3(*change)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::{RneaDerivatives, rnea, rnea_derivatives_into};
    use crate::model::{BodySpec, JointSpec, ModelBuilder, Parent};

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
            let mut found = vec![0.0; 3 * n];
            let changes = [Inertia::ZERO, *moved.link_inertia(joint)];
            let efforts = (&mut found[..], 3, 1);
            add_inertia_efforts(&model, &kinematics, &workspace, (joint, &changes), |_| true, efforts);
            for (found, expected) in found.chunks_exact(3).zip(&expected) {
                assert!((found[2] - expected).abs() < 1e-12, "{joint}: {found:?} {expected}");
                assert!(found[0] == 0.0 && found[1] == 0.0);
            }
        }
        let zero = vec![0.0; n];
        let field = [0.4, -0.3, 0.7];
        let expected = rnea(&model.with_gravity(field), &q, &zero, &zero, &[]);
        let mut found = zero;
        add_gravity_efforts(&model, &workspace, &[field], |_| true, (&mut found, 1, 0));
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-12, "gravity: {found} {expected}");
        }
    }
}
