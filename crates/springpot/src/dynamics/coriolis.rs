//! The Coriolis matrix.

use super::joint;
use super::kinematics::Kinematics;
use super::moments::motions_at_rest;
use super::workspace::Workspace;
use crate::model::Model;
use crate::spatial::Scalar;

/// Coriolis matrix C(q, v), so that C v are the Coriolis and centrifugal forces and Ṁ − 2 C is antisymmetric: the one that
/// belongs to the Christoffel symbols, C_ca = Γ_ab,c v^b, where all joints have one degree.
///
/// C = Σ_i J_iᵀ (I_i J̇_i + B_i J_i) with B_i = ½((v_i×*) I_i − I_i (v_i×) + (I_i v_i)×̄*) and (f×̄*) w = w ×* f, world axes.
/// `coriolis` is nv × nv, row-major (all entries are written); needs velocities. Source: Echeandia and Wensing, Numerical
/// methods to compute the Coriolis matrix and Christoffel symbols for rigid-body systems, J. Comput. Nonlinear Dyn. 16, 2021.
#[inline(always)]
pub fn coriolis_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    workspace: &mut Workspace<T>,
    coriolis: &mut [T],
) {
    let (n, degrees) = (model.nv(), model.degrees());
    assert_eq!(coriolis.len(), n * n, "the Coriolis matrix is nv x nv");
    coriolis.fill(T::ZERO);
    if n == 0 {
        return;
    }
    motions_at_rest(model, kinematics, workspace);
    let ws = workspace;
    for j in (0..model.joint_count()).rev() {
        let (inner, outer) = ws.composite.split_at_mut(j);
        let (inner_sway, outer_sway) = ws.body_coriolis.split_at_mut(j);
        let (composite, sway) = (&outer[0], &outer_sway[0]);
        for k in model.degrees_of(j) {
            let (unit, rate) = (ws.axes.unit[k], ws.axes.own_rate[k]);
            let column = *composite * rate + sway.times(unit.angular);
            let (momentum, transposed) = (*composite * unit, sway.transposed_times(unit));
            let own = degrees[k].index;
            coriolis[own * n + own] += unit.dot(column);
            for c in joint::carriers(model, k) {
                let carrier = degrees[c].index;
                coriolis[carrier * n + own] += ws.axes.unit[c].dot(column);
                coriolis[own * n + carrier] +=
                    ws.axes.own_rate[c].dot(momentum) + ws.axes.unit[c].angular.dot(transposed);
            }
        }
        if let Some(parent) = model.parent_link(j).checked_sub(1) {
            inner[parent] += *composite;
            inner_sway[parent] += *sway;
        }
    }
}

/// [`coriolis_into`], allocating.
pub fn coriolis<T: Scalar>(model: &Model, kinematics: &Kinematics<T>) -> Vec<T> {
    let n = model.nv();
    let mut coriolis = vec![T::ZERO; n * n];
    coriolis_into(model, kinematics, &mut Workspace::new(model), &mut coriolis);
    coriolis
}
