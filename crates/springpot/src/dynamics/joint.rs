//! What a joint does, in the z-aligned frame of its link: the only place besides the recursions that tells joints apart.

use crate::model::{JointMotion, Model};
use crate::spatial::{Placement, Scalar, Vec3};

/// The link frame of joint `j` at coordinate `q` in the frame of its parent link.
#[inline]
pub(super) fn placement<T: Scalar>(model: &Model, j: usize, q: T) -> Placement<T> {
    let at_zero = Placement::from_f64(model.joint_placement(j));
    match model.motion(j) {
        JointMotion::Revolute => {
            let (sin, cos) = q.sin_cos();
            Placement { rotation: at_zero.rotation.turned_about_z(sin, cos), ..at_zero }
        }
        JointMotion::Prismatic => {
            Placement { translation: at_zero.rotation.z_axis().times_plus(q, at_zero.translation), ..at_zero }
        }
    }
}

/// ∂r_P/∂q_j = T_j(P) for a point P that the joint carries: e × (r_P − O) or e, with the joint's axis e and origin O.
#[inline]
pub(super) fn point_column<T: Scalar>(model: &Model, j: usize, link: &Placement<T>, point: Vec3<T>) -> Vec3<T> {
    let axis = link.rotation.z_axis();
    match model.motion(j) {
        JointMotion::Revolute => axis.cross(point - link.translation),
        JointMotion::Prismatic => axis,
    }
}

/// ∂ω/∂v_j = Om_j of a link that the joint carries: e for a revolute joint, else 0.
#[inline]
pub(super) fn angular_column<T: Scalar>(model: &Model, j: usize, link: &Placement<T>) -> Vec3<T> {
    match model.motion(j) {
        JointMotion::Revolute => link.rotation.z_axis(),
        JointMotion::Prismatic => Vec3::ZERO,
    }
}

/// The joints that carry `link`, from the link to the world.
#[inline]
pub(super) fn path_to_world(model: &Model, link: usize) -> impl Iterator<Item = usize> + '_ {
    path_to(model, link, 0)
}

/// The joints that carry `link` but not its ancestor `end`, from the link inwards.
#[inline]
pub(super) fn path_to(model: &Model, link: usize, end: usize) -> impl Iterator<Item = usize> + '_ {
    let mut link = link;
    std::iter::from_fn(move || {
        if link == end {
            return None;
        }
        let j = link - 1;
        link = model.parent_link(j);
        Some(j)
    })
}

/// The last link that carries both `a` and `b`; parents come first, so the larger index always steps inwards.
#[inline]
pub(super) fn common_link(model: &Model, mut a: usize, mut b: usize) -> usize {
    while a != b {
        if a > b {
            a = model.parent_link(a - 1);
        } else {
            b = model.parent_link(b - 1);
        }
    }
    a
}
