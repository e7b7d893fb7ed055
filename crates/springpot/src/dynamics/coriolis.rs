//! The Coriolis matrix.

use super::moments::{Sway, reference, unit_motion};
use super::{Kinematics, Workspace, joint};
use crate::model::Model;
use crate::spatial::{Inertia, Motion, Scalar};

/// Coriolis matrix C(q, v), so that C v are the Coriolis and centrifugal forces and Ṁ − 2 C is antisymmetric: the one that
/// belongs to the Christoffel symbols, C_ca = Γ_ab,c v^b.
///
/// C = Σ_i J_iᵀ (I_i J̇_i + B_i J_i) with B_i = ½((v_i×*) I_i − I_i (v_i×) + (I_i v_i)×̄*) and (f×̄*) w = w ×* f, world axes.
/// `coriolis` is nv × nv, row-major (all entries are written); needs velocities. Source: Echeandia and Wensing, Numerical
/// methods to compute the Coriolis matrix and Christoffel symbols for rigid-body systems, J. Comput. Nonlinear Dyn. 16, 2021.
pub fn coriolis_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    workspace: &mut Workspace<T>,
    coriolis: &mut [T],
) {
    let n = model.nv();
    assert_eq!(coriolis.len(), n * n, "the Coriolis matrix is nv x nv");
    coriolis.fill(T::ZERO);
    if n == 0 {
        return;
    }
    let origin = reference(kinematics);
    let v = kinematics.joint_velocities();
    let ws = workspace;
    ws.velocity[0] = Motion::ZERO;
    for j in 0..n {
        let (link, parent) = (kinematics.link(j + 1), model.parent_link(j));
        let arm = link.translation - origin;
        let unit = unit_motion(model, j, link, arm);
        // A joint's axis is fixed in its parent too, so that J̇ = v_parent × J.
        ws.unit_rate[j] = ws.velocity[parent].cross(unit);
        let velocity = ws.velocity[parent] + unit * v[j];
        let inertia = Inertia::from_f64(model.link_inertia(j)).rotated(&link.rotation).shifted(arm);
        ws.sway[j] = Sway::new(&inertia, velocity, inertia * velocity);
        (ws.unit[j], ws.velocity[j + 1], ws.composite[j]) = (unit, velocity, inertia);
    }
    for j in (0..n).rev() {
        let (unit, rate, composite, sway) = (ws.unit[j], ws.unit_rate[j], ws.composite[j], ws.sway[j]);
        let column = composite * rate + sway.times(unit.angular);
        let (momentum, transposed) = (composite * unit, sway.transposed_times(unit));
        coriolis[j * n + j] = unit.dot(column);
        for k in joint::path_to_world(model, model.parent_link(j)) {
            coriolis[k * n + j] = ws.unit[k].dot(column);
            coriolis[j * n + k] = ws.unit_rate[k].dot(momentum) + ws.unit[k].angular.dot(transposed);
        }
        if let Some(parent) = model.parent_link(j).checked_sub(1) {
            ws.composite[parent] += composite;
            ws.sway[parent] += sway;
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
