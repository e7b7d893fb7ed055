//! Turns: a joint that turns about the z axis of its link, a degree of freedom that turns about any.

use crate::spatial::{ArticulatedInertia, Force, Inertia, Motion, Placement, Scalar, Vec3};

#[inline(always)]
pub(super) fn placement<T: Scalar>(at_zero: Placement<T>, sine: T, cosine: T) -> Placement<T> {
    Placement { rotation: at_zero.rotation.turned_about_z(sine, cosine), ..at_zero }
}

#[inline(always)]
pub(super) fn velocity<T: Scalar>(carried: Motion<T>, axis: Vec3<T>, speed: T) -> Motion<T> {
    Motion { angular: axis.times_plus(speed, carried.angular), ..carried }
}

#[inline(always)]
pub(super) fn acceleration<T: Scalar>(
    carried: Motion<T>,
    omega: Vec3<T>,
    axis: Vec3<T>,
    [speed, push]: [T; 2],
) -> Motion<T> {
    let gyration = omega.cross(axis);
    Motion { angular: axis.times_plus(push, gyration.times_plus(speed, carried.angular)), ..carried }
}

#[inline(always)]
pub(super) fn advance<T: Scalar>(velocity: &mut Motion<T>, acceleration: &mut Motion<T>, speed: T, push: T) {
    let ([wx, wy, _], [ux, uy, _]) = (velocity.angular.0, velocity.linear.0);
    velocity.angular.0[2] += speed;
    acceleration.angular += Vec3([wy * speed, -(wx * speed), push]);
    acceleration.linear += Vec3([uy * speed, -(ux * speed), T::ZERO]);
}

#[inline(always)]
pub(super) fn effort<T: Scalar>(force: Force<T>) -> T {
    force.angular.0[2]
}

#[inline(always)]
pub(super) fn bias<T: Scalar>(velocity: Motion<T>, turning: Vec3<T>) -> Motion<T> {
    Motion { angular: velocity.angular.cross(turning), linear: velocity.linear.cross(turning) }
}

#[inline(always)]
pub(super) fn unit_motion<T: Scalar>(axis: Vec3<T>, arm: Vec3<T>) -> Motion<T> {
    Motion { angular: axis, linear: arm.cross(axis) }
}

#[inline(always)]
pub(super) fn point_column<T: Scalar>(axis: Vec3<T>, arm: Vec3<T>) -> Vec3<T> {
    axis.cross(arm)
}

#[inline(always)]
pub(super) fn point_column_rate<T: Scalar>(axis: Vec3<T>, rate: Vec3<T>, arm: Vec3<T>, arm_rate: Vec3<T>) -> Vec3<T> {
    rate.cross(arm) + axis.cross(arm_rate)
}

#[inline(always)]
pub(super) fn load<T: Scalar>(inertia: &ArticulatedInertia<T>, unit: Motion<T>) -> Force<T> {
    inertia.times_angular(unit.angular)
}

#[inline(always)]
pub(super) fn momentum<T: Scalar>(inertia: &Inertia<T>, unit: Motion<T>) -> Force<T> {
    inertia.turned_by(unit.angular)
}

#[inline(always)]
pub(super) fn felt<T: Scalar>(axis: Vec3<T>, momentum: Force<T>) -> T {
    axis.dot(momentum.angular)
}
