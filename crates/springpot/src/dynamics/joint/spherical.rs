//! A joint that turns freely about its origin, with a quaternion for its attitude. It moves as a floating one that does not shift.

use crate::model::Model;
use crate::spatial::{Force, Motion, Placement, Rotation, Scalar, Vec3};

/// Apart, so that joints of one degree keep a short path.
#[inline(always)]
pub(super) fn placement<T: Scalar>(model: &Model, j: usize, q: &[T]) -> Placement<T> {
    let first = model.coordinates(j).q;
    let q = &q[first..first + 4];
    let at_zero = Placement::from_f64(model.joint_placement(j));
    Placement { rotation: at_zero.rotation * Rotation::from_quaternion_components([q[0], q[1], q[2], q[3]]), ..at_zero }
}

/// The velocity (or acceleration) of the joint, in the axes of its link.
#[inline(always)]
pub(super) fn twist<T: Scalar>(v: &[T]) -> Motion<T> {
    let v = &v[..3];
    Motion { linear: Vec3::ZERO, angular: Vec3([v[0], v[1], v[2]]) }
}

#[inline(always)]
pub(super) fn write_effort<T: Scalar>(force: Force<T>, tau: &mut [T]) {
    tau[..3].copy_from_slice(&force.angular.0);
}
