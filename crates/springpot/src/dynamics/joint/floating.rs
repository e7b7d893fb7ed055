//! A joint that floats: free in all six directions, with a quaternion for its attitude.

use crate::model::Model;
use crate::spatial::{Force, Motion, Placement, Rotation, Scalar, Vec3};

/// Apart, so that joints of one degree keep a short path.
#[inline(always)]
pub(super) fn placement<T: Scalar>(model: &Model, j: usize, q: &[T]) -> Placement<T> {
    let first = model.coordinates(j).q;
    let q = &q[first..first + 7];
    let own = Placement {
        rotation: Rotation::from_quaternion_components([q[3], q[4], q[5], q[6]]),
        translation: Vec3([q[0], q[1], q[2]]),
    };
    Placement::from_f64(model.joint_placement(j)) * own
}

/// The velocity (or acceleration) of the joint, in the axes of its link.
#[inline(always)]
pub(super) fn twist<T: Scalar>(v: &[T]) -> Motion<T> {
    let v = &v[..6];
    Motion { linear: Vec3([v[0], v[1], v[2]]), angular: Vec3([v[3], v[4], v[5]]) }
}

#[inline(always)]
pub(super) fn velocity<T: Scalar>(carried: Motion<T>, link: &Rotation<T>, own: Motion<T>) -> Motion<T> {
    carried + own.rotated(link)
}

#[inline(always)]
pub(super) fn acceleration<T: Scalar>(
    carried: Motion<T>,
    omega: Vec3<T>,
    link: &Rotation<T>,
    [own, push]: [Motion<T>; 2],
) -> Motion<T> {
    let (own, push) = (own.rotated(link), push.rotated(link));
    let both = omega + omega + own.angular;
    Motion {
        angular: carried.angular + omega.cross(own.angular) + push.angular,
        linear: carried.linear + both.cross(own.linear) + push.linear,
    }
}

#[inline(always)]
pub(super) fn advance<T: Scalar>(
    velocity: &mut Motion<T>,
    acceleration: &mut Motion<T>,
    own: Motion<T>,
    push: Motion<T>,
) {
    *acceleration += velocity.cross(own);
    *acceleration += push;
    *velocity += own;
}

#[inline(always)]
pub(super) fn write_effort<T: Scalar>(force: Force<T>, tau: &mut [T]) {
    tau[..3].copy_from_slice(&force.linear.0);
    tau[3..6].copy_from_slice(&force.angular.0);
}

#[inline(always)]
pub(super) fn bias<T: Scalar>(velocity: Motion<T>, link: &Rotation<T>, own: Motion<T>) -> Motion<T> {
    velocity.cross(own.rotated(link))
}
