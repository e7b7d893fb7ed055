//! The centre of mass.

use super::gravity::first_moments_beyond;
use super::{Kinematics, Workspace};
use crate::model::{JointMotion, Model};
use crate::spatial::{Scalar, Vec3};

/// World position of the centre of mass of all that moves, m; needs positions. Does not allocate.
///
/// Bodies fixed to the world are left out. NaN for a robot without mass (one that has inertia tensors only).
pub fn com<T: Scalar>(model: &Model, kinematics: &Kinematics<T>) -> Vec3<T> {
    let (mut first, mut mass) = (Vec3::ZERO, 0.0);
    for j in 0..model.nv() {
        let (link, inertia) = (kinematics.link(j + 1), model.link_inertia(j));
        let own = link.rotation * Vec3::from_f64(inertia.first_moment);
        first += link.translation.times_plus(T::from_f64(inertia.mass), own);
        mass += inertia.mass;
    }
    first * (T::ONE / T::from_f64(mass))
}

/// Jacobian of the centre of mass, dr_C/dt = J v: column b is m_b/m T_b(C_b), with the mass m_b and the centre C_b of all that
/// joint b carries. World axes, m/rad or 1.
///
/// `jacobian` is 3 × nv, row-major; needs positions. NaN for a robot without mass.
pub fn com_jacobian_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    workspace: &mut Workspace<T>,
    jacobian: &mut [T],
) {
    let n = model.nv();
    assert_eq!(jacobian.len(), 3 * n, "the Jacobian is 3 x nv");
    let first = &mut workspace.columns[..n];
    first_moments_beyond(model, kinematics, first);
    let total: f64 = (0..n).filter(|&j| model.parent_link(j) == 0).map(|j| model.subtree_mass(j)).sum();
    let inverse = T::ONE / T::from_f64(total);
    for j in 0..n {
        let axis = kinematics.link(j + 1).rotation.z_axis();
        let column = match model.motion(j) {
            JointMotion::Revolute => axis.cross(first[j]) * inverse,
            JointMotion::Prismatic => axis * (T::from_f64(model.subtree_mass(j)) * inverse),
        };
        let [x, y, z] = column.0;
        (jacobian[j], jacobian[n + j], jacobian[2 * n + j]) = (x, y, z);
    }
}

/// [`com_jacobian_into`], allocating.
pub fn com_jacobian<T: Scalar>(model: &Model, kinematics: &Kinematics<T>) -> Vec<T> {
    let mut jacobian = vec![T::ZERO; 3 * model.nv()];
    com_jacobian_into(model, kinematics, &mut Workspace::new(model), &mut jacobian);
    jacobian
}
