//! Inverse dynamics by the recursive Newton–Euler algorithm.

use super::forces::pair::{self, PairForce};
use super::joint;
use super::kinematics::Kinematics;
use super::workspace::Workspace;
use crate::model::{Model, Site};
use crate::spatial::{Force, Inertia, Motion, Placement, Scalar, Vec3};

/// Actuator forces τ = M(q) a + C(q, v) v + g(q) − ΣQ, N·m or N, with Q_b = −F ∂l/∂q_b of every pair force.
///
/// `q` (nq), `v`, `a`, `tau` (nv). Joint damping and friction are no part of it. A pair of length 0 gives NaN; see
/// [`Pair::check`](super::Pair::check). Source: Featherstone, Rigid Body Dynamics Algorithms, 2008, table 5.1.
#[inline(always)]
pub fn rnea_into<T: Scalar>(
    model: &Model,
    q: &[T],
    v: &[T],
    a: &[T],
    pairs: &[PairForce<T>],
    workspace: &mut Workspace<T>,
    tau: &mut [T],
) {
    let (v, a) = (&v[..model.nv()], &a[..model.nv()]);
    inverse_dynamics(model, [q, v], Some(a), pairs, None, workspace, tau);
}

/// [`rnea_into`] where the `kinematics` at `q` (nq) and v are at hand: nothing of them is worked out again.
#[inline(always)]
pub fn rnea_at_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    q: &[T],
    a: &[T],
    pairs: &[PairForce<T>],
    workspace: &mut Workspace<T>,
    tau: &mut [T],
) {
    let (v, a) = (kinematics.joint_velocities(), &a[..model.nv()]);
    inverse_dynamics(model, [q, v], Some(a), pairs, Some(kinematics), workspace, tau);
}

/// Nonlinear effects C(q, v) v + g(q) − ΣQ, N·m or N: what the actuators hold without acceleration, [`rnea_into`] at a = 0.
#[inline(always)]
pub fn nonlinear_effects_into<T: Scalar>(
    model: &Model,
    q: &[T],
    v: &[T],
    pairs: &[PairForce<T>],
    workspace: &mut Workspace<T>,
    tau: &mut [T],
) {
    inverse_dynamics(model, [q, &v[..model.nv()]], None, pairs, None, workspace, tau);
}

/// [`nonlinear_effects_into`], allocating.
pub fn nonlinear_effects<T: Scalar>(model: &Model, q: &[T], v: &[T], pairs: &[PairForce<T>]) -> Vec<T> {
    let mut tau = vec![T::ZERO; model.nv()];
    nonlinear_effects_into(model, q, v, pairs, &mut Workspace::new(model), &mut tau);
    tau
}

#[inline(always)]
fn inverse_dynamics<T: Scalar>(
    model: &Model,
    [q, v]: [&[T]; 2],
    a: Option<&[T]>,
    pairs: &[PairForce<T>],
    kinematics: Option<&Kinematics<T>>,
    ws: &mut Workspace<T>,
    tau: &mut [T],
) {
    let n = model.joint_count();
    let (q, tau) = (&q[..model.nq()], &mut tau[..model.nv()]);
    if kinematics.is_none() {
        ws.stands.read(model, q);
    }
    ws.velocity[0] = Motion::ZERO;
    // A frame that accelerates upwards feels gravity.
    ws.acceleration[0] = Motion { angular: Vec3::ZERO, linear: -Vec3::from_f64(model.gravity().into()) };
    ws.force[0] = Force::ZERO;
    for j in 0..n {
        let parent = model.parent_link(j);
        let local = match kinematics {
            Some(known) => known.locals()[j],
            None => ws.stands.placement(model, j, q),
        };
        let mut velocity = local.motion_to_child(ws.velocity[parent]);
        let mut acceleration = local.motion_to_child(ws.acceleration[parent]);
        joint::advance(model, j, &mut velocity, &mut acceleration, v, a);
        let inertia = Inertia::from_f64(model.link_inertia(j));
        ws.force[j + 1] = inertia * acceleration + velocity.cross_force(inertia * velocity);
        ws.velocity[j + 1] = velocity;
        ws.acceleration[j + 1] = acceleration;
        ws.local[j] = local;
    }
    if !pairs.is_empty() {
        match kinematics {
            Some(kinematics) => ws.world.copy_from_slice(kinematics.placements()),
            None => place_links(model, ws),
        }
        subtract_pair_forces(pairs, ws);
    }
    tau.fill(T::ZERO);
    for j in (0..n).rev() {
        let force = ws.force[j + 1];
        joint::add_effort(model, j, force, tau);
        let on_parent = ws.local[j].force_to_parent(force);
        ws.force[model.parent_link(j)] += on_parent;
    }
    if let Some(a) = a {
        for ((tau, &a), &rotor) in tau.iter_mut().zip(a).zip(model.felt_rotors()) {
            *tau = a.times_plus(T::from_f64(rotor), *tau);
        }
    }
}

/// [`rnea_into`], allocating.
pub fn rnea<T: Scalar>(model: &Model, q: &[T], v: &[T], a: &[T], pairs: &[PairForce<T>]) -> Vec<T> {
    let mut tau = vec![T::ZERO; model.nv()];
    rnea_into(model, q, v, a, pairs, &mut Workspace::new(model), &mut tau);
    tau
}

/// World placements of all links from those in their parents.
#[inline(always)]
fn place_links<T: Scalar>(model: &Model, ws: &mut Workspace<T>) {
    ws.world[0] = Placement::IDENTITY;
    for j in 0..model.joint_count() {
        ws.world[j + 1] = ws.world[model.parent_link(j)] * ws.local[j];
    }
}

/// Takes what the pairs do off the forces that the joints must supply, so that one backward pass serves any number of pairs.
#[inline(always)]
fn subtract_pair_forces<T: Scalar>(pairs: &[PairForce<T>], ws: &mut Workspace<T>) {
    for pair in pairs {
        let (from, to) = (pair.from.link(), pair.to.link());
        let pull = pair::pull(pair, placed(&ws.world, &pair.from), placed(&ws.world, &pair.to));
        ws.force[from] -= Force::at_point(ws.world[from].rotation.unrotate(pull), Vec3::from_f64(pair.from.point()));
        ws.force[to] += Force::at_point(ws.world[to].rotation.unrotate(pull), Vec3::from_f64(pair.to.point()));
    }
}

/// World position of a point.
#[inline(always)]
fn placed<T: Scalar>(world: &[Placement<T>], site: &Site) -> Vec3<T> {
    world[site.link()].point(Vec3::from_f64(site.point()))
}
