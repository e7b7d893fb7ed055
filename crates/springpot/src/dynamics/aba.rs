//! Forward dynamics by the articulated-body algorithm.

use super::cholesky::{cholesky_into, cholesky_solve_into};
use super::crba::crba_into;
use super::forces::pair::{self, PairForce};
use super::forces::wrench::add_wrench;
use super::joint;
use super::kinematics::Kinematics;
use super::moments::motions_at_rest;
use super::workspace::Workspace;
use crate::model::Model;
use crate::spatial::{ArticulatedInertia, Force, Inertia, Motion, Scalar, Vec3};

/// Accelerations a = M(q)⁻¹ (τ + ΣQ − C(q, v) v − g(q)), rad/s² or m/s², with Q_b = −F ∂l/∂q_b of every pair force.
///
/// `tau`, `a` (nv); needs velocities. Joint damping and friction are no part of it; loads from outside enter through τ, see
/// [`add_wrench`](super::add_wrench). A pair of length 0 gives NaN, and so does a configuration in which the mass matrix is
/// singular. Source: Featherstone, Rigid Body Dynamics Algorithms, 2008, table 7.1; here in world axes about each link's own
/// origin, so that no inertia is turned twice and distal bodies keep their digits.
#[inline(always)]
pub fn aba_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    tau: &[T],
    pairs: &[PairForce<T>],
    workspace: &mut Workspace<T>,
    a: &mut [T],
) {
    let (v, tau, a) = (kinematics.joint_velocities(), &tau[..model.nv()], &mut a[..model.nv()]);
    if !model.is_free_of_followers() {
        return coupled(model, kinematics, tau, pairs, workspace, a);
    }
    let (n, degrees) = (model.joint_count(), model.degrees());
    let ws = workspace;
    let (force, articulated) = (&mut ws.force[..=n], &mut ws.articulated.inertia[..n]);
    let (bias, column) = (&mut ws.articulated.bias[..n], &mut ws.articulated.column[..degrees.len()]);
    let (inverse_pivot, effort) =
        (&mut ws.articulated.inverse_pivot[..degrees.len()], &mut ws.articulated.effort[..degrees.len()]);
    force[0] = Force::ZERO;
    for j in 0..n {
        let (link, velocity) = (kinematics.link(j + 1), kinematics.link_velocity(j + 1));
        let inertia = Inertia::from_f64(model.link_inertia(j)).rotated(&link.rotation);
        force[j + 1] = velocity.cross_force(inertia * velocity);
        articulated[j] = ArticulatedInertia::from_rigid(&inertia);
        bias[j] = joint::bias(model, j, link, velocity, v);
    }
    for pair in pairs {
        let pull = pair::pull(pair, kinematics.position(&pair.from), kinematics.position(&pair.to));
        force[pair.from.link()] -= Force::at_point(pull, kinematics.arm(&pair.from));
        force[pair.to.link()] += Force::at_point(pull, kinematics.arm(&pair.to));
    }
    for j in (0..n).rev() {
        let link = kinematics.link(j + 1);
        let (mut inertia, mut load) = (articulated[j], force[j + 1]);
        let own = model.degrees_of(j);
        for k in own.clone().rev() {
            let unit = joint::unit_motion(model, &degrees[k], link, Vec3::ZERO);
            let u = joint::load(&degrees[k], &inertia, unit);
            (column[k], inverse_pivot[k]) = (u, T::ONE / (unit.dot(u) + T::from_f64(model.rotors()[k])));
            effort[k] = tau[k] - unit.dot(load);
            if k > own.start || model.parent_link(j) > 0 {
                inertia = inertia.minus_outer(u, inverse_pivot[k]);
                load += u * (effort[k] * inverse_pivot[k]);
            }
        }
        if let Some(parent) = model.parent_link(j).checked_sub(1) {
            let arm = link.translation - kinematics.link(parent + 1).translation;
            let carried = load + inertia.times(bias[j]);
            force[parent + 1] += carried.shifted(arm);
            articulated[parent] += inertia.shifted(arm);
        }
    }
    let acceleration = &mut ws.acceleration[..=n];
    acceleration[0] = Motion { angular: Vec3::ZERO, linear: -Vec3::from_f64(model.gravity().into()) };
    for j in 0..n {
        let (link, parent) = (kinematics.link(j + 1), model.parent_link(j));
        let arm = link.translation - kinematics.link(parent).translation;
        let mut here = acceleration[parent].shifted(arm) + bias[j];
        for k in model.degrees_of(j) {
            a[k] = (effort[k] - here.dot(column[k])) * inverse_pivot[k];
            here += joint::unit_motion(model, &degrees[k], link, Vec3::ZERO) * a[k];
        }
        acceleration[j + 1] = here;
    }
}

/// Where joints follow one another, the forces of several branches meet in one coordinate: M a = τ − (C v + g − ΣQ), with M
/// factorised.
#[inline(always)]
fn coupled<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    tau: &[T],
    pairs: &[PairForce<T>],
    workspace: &mut Workspace<T>,
    a: &mut [T],
) {
    motions_at_rest(model, kinematics, workspace);
    a.copy_from_slice(tau);
    for j in (0..model.joint_count()).rev() {
        let load = workspace.force[j + 1];
        for k in model.degrees_of(j) {
            a[model.degrees()[k].index] -= workspace.axes.unit[k].dot(load);
        }
        workspace.force[model.parent_link(j)] += load;
    }
    for pair in pairs {
        let pull = pair::pull(pair, kinematics.position(&pair.from), kinematics.position(&pair.to));
        for (site, force) in [(&pair.from, pull), (&pair.to, -pull)] {
            add_wrench(model, kinematics, site, Force { linear: force, angular: Vec3::ZERO }, a);
        }
    }
    let mut mass = std::mem::take(&mut workspace.mass);
    crba_into(model, kinematics, workspace, &mut mass);
    cholesky_into(model, &mut mass);
    cholesky_solve_into(model, &mass, a);
    workspace.mass = mass;
}

/// [`aba_into`] at `q` (nq), `v`, `tau` (nv), allocating.
pub fn aba<T: Scalar>(model: &Model, q: &[T], v: &[T], tau: &[T], pairs: &[PairForce<T>]) -> Vec<T> {
    let mut a = vec![T::ZERO; model.nv()];
    let kinematics = Kinematics::at_velocity(model, q, v);
    aba_into(model, &kinematics, tau, pairs, &mut Workspace::new(model), &mut a);
    a
}
