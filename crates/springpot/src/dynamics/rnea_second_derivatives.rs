//! Second derivatives of the inverse dynamics.

use super::kinematics::Kinematics;
use super::rnea_derivatives::{RneaDerivatives, differentiate_all};
use super::workspace::Workspace;
use crate::model::{JointMotion, Model};
use crate::spatial::along::Along;
use crate::spatial::{Rotation, Scalar};

/// Second derivatives of τ = RNEA(q, v, a), each nv × nv × nv, row-major: ∂/∂y_e of ∂τ_b/∂x_c at (b·nv + c)·nv + e.
///
/// Derivatives by q go along the velocities: of the value at q ⊕ δ e_e by δ, twice, first along c. Where all joints have one degree that is
/// ∂²τ_b/∂q_c∂q_e, symmetric in c and e.
#[derive(Debug, Clone, PartialEq)]
pub struct RneaSecondDerivatives<T = f64> {
    /// ∂/∂q_e of ∂τ_b/∂q_c.
    pub d_q_q: Vec<T>,
    /// ∂/∂q_e of ∂τ_b/∂v_c.
    pub d_v_q: Vec<T>,
    /// ∂²τ_b/∂v_c∂v_e, symmetric in c and e: 2 Γ_ce,b where all joints have one degree.
    pub d_v_v: Vec<T>,
    /// ∂/∂q_e of ∂τ_b/∂a_c, the derivative of the mass matrix.
    pub d_a_q: Vec<T>,
}

impl<T: Scalar> RneaSecondDerivatives<T> {
    /// Room for the derivatives of `model`.
    pub fn new(model: &Model) -> Self {
        let zero = || vec![T::ZERO; model.nv().pow(3)];
        Self { d_q_q: zero(), d_v_q: zero(), d_v_v: zero(), d_a_q: zero() }
    }
}

/// Where second derivatives are worked out.
#[derive(Debug, Clone)]
pub(super) struct SecondRoom<T> {
    kinematics: Kinematics<Along<T>>,
    workspace: Workspace<Along<T>>,
    slopes: RneaDerivatives<Along<T>>,
    q: Vec<Along<T>>,
    v: Vec<Along<T>>,
    a: Vec<Along<T>>,
}

impl<T: Scalar> SecondRoom<T> {
    #[inline(always)]
    pub(super) fn new(model: &Model) -> Self {
        let still = |count: usize| vec![Along::ZERO; count];
        Self {
            kinematics: Kinematics::neutral(model),
            workspace: Workspace::new(model),
            slopes: RneaDerivatives::new(model),
            q: still(model.nq()),
            v: still(model.nv()),
            a: still(model.nv()),
        }
    }
}

/// All second derivatives of the inverse dynamics at `q` (nq), `v`, `a` (nv); all entries of `derivatives` are written.
///
/// The first derivatives, [`rnea_derivatives_into`](super::rnea_derivatives_into), are differentiated along each coordinate and each velocity, by numbers
/// that carry their slope along: 2 nv times their operations, three times as many each. Exact to rounding for all kinds of joints.
pub fn rnea_second_derivatives<T: Scalar>(model: &Model, q: &[T], v: &[T], a: &[T]) -> RneaSecondDerivatives<T> {
    let mut derivatives = RneaSecondDerivatives::new(model);
    second_derivatives_into(model, [q, v, a], &mut SecondRoom::new(model), &mut derivatives);
    derivatives
}

#[inline(always)]
pub(super) fn second_derivatives_into<T: Scalar>(
    model: &Model,
    [q, v, a]: [&[T]; 3],
    room: &mut SecondRoom<T>,
    derivatives: &mut RneaSecondDerivatives<T>,
) {
    let n = model.nv();
    for (own, given) in [(&mut room.q, q), (&mut room.v, v), (&mut room.a, a)] {
        for (own, given) in own.iter_mut().zip(given) {
            *own = Along::still(*given);
        }
    }
    for e in 0..n {
        seed(model, e, q, &mut room.q);
        work(model, room);
        for own in &mut room.q {
            own.slope = T::ZERO;
        }
        put(&room.slopes.d_q, &mut derivatives.d_q_q, n, e);
        put(&room.slopes.d_v, &mut derivatives.d_v_q, n, e);
        put(&room.slopes.d_a, &mut derivatives.d_a_q, n, e);
    }
    for e in 0..n {
        room.v[e].slope = T::ONE;
        work(model, room);
        room.v[e].slope = T::ZERO;
        put(&room.slopes.d_v, &mut derivatives.d_v_v, n, e);
    }
}

#[inline(always)]
fn work<T: Scalar>(model: &Model, room: &mut SecondRoom<T>) {
    let SecondRoom { kinematics, workspace, slopes, q, v, a } = room;
    kinematics.set_moving(model, q, v);
    differentiate_all(model, kinematics, a, workspace, slopes);
}

#[inline(always)]
fn put<T: Scalar>(from: &[Along<T>], to: &mut [T], n: usize, e: usize) {
    for k in 0..n * n {
        to[k * n + e] = from[k].slope;
    }
}

/// dq/dδ of q ⊕ δ e_e.
#[inline(always)]
fn seed<T: Scalar>(model: &Model, e: usize, q: &[T], along: &mut [Along<T>]) {
    if let Some(coordinate) = model.coordinate_of(e) {
        along[coordinate].slope = T::ONE;
        return;
    }
    for j in 0..model.joint_count() {
        let own = model.coordinates(j);
        let (attitude, shifts) = match model.motion(j) {
            JointMotion::Spherical => (own.q, 0),
            JointMotion::Floating => (own.q + 3, 3),
            JointMotion::Revolute | JointMotion::Prismatic | JointMotion::Helical => continue,
        };
        if !(own.v..own.v + shifts + 3).contains(&e) {
            continue;
        }
        let (which, [x, y, z, w]) = (e - own.v, [q[attitude], q[attitude + 1], q[attitude + 2], q[attitude + 3]]);
        if which < shifts {
            let moved = Rotation::from_quaternion_components([x, y, z, w]).column(which);
            for k in 0..3 {
                along[own.q + k].slope = moved.0[k];
            }
            return;
        }
        // q' = q (ω, 0)/2 in the axes of the link.
        let half = T::from_f64(0.5);
        let turned = match which - shifts {
            0 => [w, z, -y, -x],
            1 => [-z, w, x, -y],
            _ => [y, -x, w, -z],
        };
        for k in 0..4 {
            along[attitude + k].slope = turned[k] * half;
        }
        return;
    }
}
