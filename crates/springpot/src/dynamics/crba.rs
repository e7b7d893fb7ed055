//! The mass matrix by composite inertias.

use super::{Kinematics, Workspace, joint};
use crate::model::{JointMotion, Model};
use crate::spatial::{Force, Inertia, Scalar, Vec3};

/// Mass matrix M(q), the basic metric tensor a_ab = Σ_i m_i T_a(C_i)·T_b(C_i) + Om_a·J_i Om_b.
///
/// `mass` is nv × nv, row-major, symmetric (both triangles are written), kg·m², kg·m or kg; needs positions. With b beyond
/// a, column b is the momentum of all that joint b carries when it moves at unit speed, and a_ab is what joint a feels of it;
/// joints on different branches do not couple.
pub fn crba_into<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, workspace: &mut Workspace<T>, mass: &mut [T]) {
    let n = model.nv();
    assert_eq!(mass.len(), n * n, "the mass matrix is nv x nv");
    composites(model, kinematics, &mut workspace.composite);
    mass.fill(T::ZERO);
    for b in 0..n {
        let link = kinematics.link(b + 1);
        let momentum = unit_momentum(model, b, link.rotation.z_axis(), &workspace.composite[b]);
        for a in joint::path_to_world(model, b + 1) {
            let carrier = kinematics.link(a + 1);
            let axis = carrier.rotation.z_axis();
            let entry = match model.motion(a) {
                JointMotion::Revolute => {
                    let arm = link.translation - carrier.translation;
                    axis.dot(momentum.angular + arm.cross(momentum.linear))
                }
                JointMotion::Prismatic => axis.dot(momentum.linear),
            };
            mass[a * n + b] = entry;
            mass[b * n + a] = entry;
        }
    }
}

/// [`crba_into`], allocating.
pub fn crba<T: Scalar>(model: &Model, kinematics: &Kinematics<T>) -> Vec<T> {
    let n = model.nv();
    let mut mass = vec![T::ZERO; n * n];
    crba_into(model, kinematics, &mut Workspace::new(model), &mut mass);
    mass
}

/// The inertia of all that each joint carries, about the joint's own origin, in world axes.
pub(super) fn composites<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, composite: &mut [Inertia<T>]) {
    let n = model.nv();
    let composite = &mut composite[..n];
    for j in 0..n {
        composite[j] = Inertia::from_f64(model.link_inertia(j)).rotated(&kinematics.link(j + 1).rotation);
    }
    for j in (0..n).rev() {
        if let Some(parent) = model.parent_link(j).checked_sub(1) {
            let arm = kinematics.link(j + 1).translation - kinematics.link(parent + 1).translation;
            let carried = composite[j].shifted(arm);
            composite[parent] += carried;
        }
    }
}

/// Momentum, about the joint's origin, of a body that the joint moves at unit speed along or about `axis`.
#[inline]
fn unit_momentum<T: Scalar>(model: &Model, j: usize, axis: Vec3<T>, inertia: &Inertia<T>) -> Force<T> {
    match model.motion(j) {
        JointMotion::Revolute => Force { linear: axis.cross(inertia.first_moment), angular: inertia.rotational * axis },
        JointMotion::Prismatic => Force { linear: axis * inertia.mass, angular: inertia.first_moment.cross(axis) },
    }
}
