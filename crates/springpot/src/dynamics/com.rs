//! The centre of mass.

use super::gravity::first_moments_beyond;
use super::joint;
use super::kinematics::Kinematics;
use super::workspace::Workspace;
use crate::model::Model;
use crate::spatial::{Scalar, Vec3};

/// World position of the centre of mass of all that moves, m; needs positions. Does not allocate.
///
/// Bodies fixed to the world are left out. NaN for a robot without mass (one that has inertia tensors only).
#[inline(always)]
pub fn com<T: Scalar>(model: &Model, kinematics: &Kinematics<T>) -> Vec3<T> {
    let (mut first, mut mass) = (Vec3::ZERO, 0.0);
    for j in 0..model.joint_count() {
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
#[inline(always)]
pub fn com_jacobian_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    workspace: &mut Workspace<T>,
    jacobian: &mut [T],
) {
    let n = model.nv();
    assert_eq!(jacobian.len(), 3 * n, "the Jacobian is 3 x nv");
    let joints = model.joint_count();
    let first = &mut workspace.columns[..joints];
    first_moments_beyond(model, kinematics, first);
    let total: f64 = (0..joints).filter(|&j| model.parent_link(j) == 0).map(|j| model.subtree_mass(j)).sum();
    let inverse = T::ONE / T::from_f64(total);
    jacobian.fill(T::ZERO);
    for degree in model.degrees() {
        let moved = joint::first_moment_column(model, degree, kinematics.link(degree.link), first[degree.link - 1]);
        let column = (moved * inverse).0;
        for row in 0..3 {
            jacobian[row * n + degree.index] += column[row];
        }
    }
}

/// [`com_jacobian_into`], allocating.
pub fn com_jacobian<T: Scalar>(model: &Model, kinematics: &Kinematics<T>) -> Vec<T> {
    let mut jacobian = vec![T::ZERO; 3 * model.nv()];
    com_jacobian_into(model, kinematics, &mut Workspace::new(model), &mut jacobian);
    jacobian
}
