//! The gravity vector.

use super::joint;
use super::kinematics::Kinematics;
use super::workspace::Workspace;
use crate::model::Model;
use crate::spatial::{Scalar, Vec3};

/// Gravity vector g(q) = ∂V/∂q = −Σ_i m_i g·T_c(C_i), N·m or N, on the side of the inertia forces: the generalized force of
/// gravity is Q = −g(q).
///
/// `out` is nv; needs positions. A joint feels the weight of all it carries: −Om·(H × g) or −m e·g, with the first moments H
/// about the joint's origin.
#[inline(always)]
pub fn gravity_into<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, workspace: &mut Workspace<T>, out: &mut [T]) {
    let out = &mut out[..model.nv()];
    let field = Vec3::from_f64(model.gravity().into());
    let first = &mut workspace.columns[..model.joint_count()];
    first_moments_beyond(model, kinematics, first);
    out.fill(T::ZERO);
    for degree in model.degrees() {
        let moved = joint::first_moment_column(model, degree, kinematics.link(degree.link), first[degree.link - 1]);
        out[degree.index] -= moved.dot(field);
    }
}

/// [`gravity_into`], allocating.
pub fn gravity<T: Scalar>(model: &Model, kinematics: &Kinematics<T>) -> Vec<T> {
    let mut out = vec![T::ZERO; model.nv()];
    gravity_into(model, kinematics, &mut Workspace::new(model), &mut out);
    out
}

/// First moments of all that each joint carries, about the joint's own origin, in world axes, kg·m.
#[inline(always)]
pub(super) fn first_moments_beyond<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, first: &mut [Vec3<T>]) {
    let n = model.joint_count();
    let first = &mut first[..n];
    for j in 0..n {
        first[j] = kinematics.link(j + 1).rotation * Vec3::from_f64(model.link_inertia(j).first_moment);
    }
    for j in (0..n).rev() {
        if let Some(parent) = model.parent_link(j).checked_sub(1) {
            let arm = kinematics.link(j + 1).translation - kinematics.link(parent + 1).translation;
            let carried = arm.times_plus(T::from_f64(model.subtree_mass(j)), first[j]);
            first[parent] += carried;
        }
    }
}
