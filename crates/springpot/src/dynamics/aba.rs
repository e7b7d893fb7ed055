//! Forward dynamics by the articulated-body algorithm.

use super::{Kinematics, PairForce, Workspace, pair};
use crate::model::{JointMotion, Model};
use crate::spatial::{ArticulatedInertia, Force, Inertia, Motion, Scalar, Vec3};

/// Accelerations a = M(q)⁻¹ (τ + ΣQ − C(q, v) v − g(q)), rad/s² or m/s², with Q_b = −F ∂l/∂q_b of every pair force.
///
/// `tau`, `a` (nv); needs velocities. Joint damping and friction are no part of it; loads from outside enter through τ, see
/// [`add_wrench`](super::add_wrench). A pair of length 0 gives NaN, and so does a configuration in which the mass matrix is
/// singular. Source: Featherstone, Rigid Body Dynamics Algorithms, 2008, table 7.1; here in world axes about each link's own
/// origin, so that no inertia is turned twice and distal bodies keep their digits.
pub fn aba_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    tau: &[T],
    pairs: &[PairForce<T>],
    workspace: &mut Workspace<T>,
    a: &mut [T],
) {
    let n = model.nv();
    let (v, tau, a) = (&kinematics.joint_velocities()[..n], &tau[..n], &mut a[..n]);
    let ws = workspace;
    let (force, articulated) = (&mut ws.force[..=n], &mut ws.articulated[..n]);
    let (bias, column) = (&mut ws.bias[..n], &mut ws.column[..n]);
    let (inverse_pivot, effort) = (&mut ws.inverse_pivot[..n], &mut ws.effort[..n]);
    force[0] = Force::ZERO;
    for j in 0..n {
        let (link, velocity) = (kinematics.link(j + 1), kinematics.link_velocity(j + 1));
        let inertia = Inertia::from_f64(model.link_inertia(j)).rotated(&link.rotation);
        force[j + 1] = velocity.cross_force(inertia * velocity);
        articulated[j] = ArticulatedInertia::from_rigid(&inertia);
        // v × S q̇
        let turning = link.rotation.z_axis() * v[j];
        bias[j] = match model.motion(j) {
            JointMotion::Revolute => {
                Motion { angular: velocity.angular.cross(turning), linear: velocity.linear.cross(turning) }
            }
            JointMotion::Prismatic => Motion { angular: Vec3::ZERO, linear: velocity.angular.cross(turning) },
        };
    }
    for pair in pairs {
        let pull = pair::pull(pair, |site| kinematics.position(site));
        force[pair.from.link()] -= Force::at_point(pull, kinematics.arm(&pair.from));
        force[pair.to.link()] += Force::at_point(pull, kinematics.arm(&pair.to));
    }
    for j in (0..n).rev() {
        let link = kinematics.link(j + 1);
        let (axis, inertia, load) = (link.rotation.z_axis(), articulated[j], force[j + 1]);
        let (u, pivot, felt) = match model.motion(j) {
            JointMotion::Revolute => {
                let u = inertia.times_angular(axis);
                (u, axis.dot(u.angular), axis.dot(load.angular))
            }
            JointMotion::Prismatic => {
                let u = inertia.times_linear(axis);
                (u, axis.dot(u.linear), axis.dot(load.linear))
            }
        };
        (column[j], inverse_pivot[j], effort[j]) = (u, T::ONE / pivot, tau[j] - felt);
        if let Some(parent) = model.parent_link(j).checked_sub(1) {
            let arm = link.translation - kinematics.link(parent + 1).translation;
            let yielding = inertia.minus_outer(u, inverse_pivot[j]);
            let carried = load + yielding.times(bias[j]) + u * (effort[j] * inverse_pivot[j]);
            force[parent + 1] += carried.shifted(arm);
            articulated[parent] += yielding.shifted(arm);
        }
    }
    let acceleration = &mut ws.acceleration[..=n];
    acceleration[0] = Motion { angular: Vec3::ZERO, linear: -Vec3::from_f64(model.gravity().into()) };
    for j in 0..n {
        let (link, parent) = (kinematics.link(j + 1), model.parent_link(j));
        let arm = link.translation - kinematics.link(parent).translation;
        let mut here = acceleration[parent].shifted(arm) + bias[j];
        a[j] = (effort[j] - here.dot(column[j])) * inverse_pivot[j];
        let along = link.rotation.z_axis() * a[j];
        match model.motion(j) {
            JointMotion::Revolute => here.angular += along,
            JointMotion::Prismatic => here.linear += along,
        }
        acceleration[j + 1] = here;
    }
}

/// [`aba_into`] at `q` (nq), `v`, `tau` (nv), allocating.
pub fn aba<T: Scalar>(model: &Model, q: &[T], v: &[T], tau: &[T], pairs: &[PairForce<T>]) -> Vec<T> {
    let mut a = vec![T::ZERO; model.nv()];
    let kinematics = Kinematics::at_velocity(model, q, v);
    aba_into(model, &kinematics, tau, pairs, &mut Workspace::new(model), &mut a);
    a
}
