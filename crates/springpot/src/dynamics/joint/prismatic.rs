//! Shifts: a joint that shifts along the z axis of its link, a degree of freedom that shifts along any.

use crate::spatial::{ArticulatedInertia, Force, Inertia, Motion, Placement, Scalar, Vec3};

#[inline(always)]
pub(super) fn placement<T: Scalar>(at_zero: Placement<T>, coordinate: T) -> Placement<T> {
    Placement { translation: at_zero.rotation.z_axis().times_plus(coordinate, at_zero.translation), ..at_zero }
}

#[inline(always)]
pub(super) fn velocity<T: Scalar>(carried: Motion<T>, axis: Vec3<T>, speed: T) -> Motion<T> {
    Motion { linear: axis.times_plus(speed, carried.linear), ..carried }
}

#[inline(always)]
pub(super) fn acceleration<T: Scalar>(
    carried: Motion<T>,
    omega: Vec3<T>,
    axis: Vec3<T>,
    [speed, push]: [T; 2],
) -> Motion<T> {
    let gyration = omega.cross(axis);
    let twice = T::from_f64(2.0) * speed;
    Motion { linear: axis.times_plus(push, gyration.times_plus(twice, carried.linear)), ..carried }
}

#[inline(always)]
pub(super) fn advance<T: Scalar>(velocity: &mut Motion<T>, acceleration: &mut Motion<T>, speed: T, push: T) {
    let [wx, wy, _] = velocity.angular.0;
    velocity.linear.0[2] += speed;
    acceleration.linear += Vec3([wy * speed, -(wx * speed), push]);
}

#[inline(always)]
pub(super) fn effort<T: Scalar>(force: Force<T>) -> T {
    force.linear.0[2]
}

#[inline(always)]
pub(super) fn bias<T: Scalar>(velocity: Motion<T>, sliding: Vec3<T>) -> Motion<T> {
    Motion { angular: Vec3::ZERO, linear: velocity.angular.cross(sliding) }
}

#[inline(always)]
pub(super) fn unit_motion<T: Scalar>(axis: Vec3<T>) -> Motion<T> {
    Motion { angular: Vec3::ZERO, linear: axis }
}

#[inline(always)]
pub(super) fn load<T: Scalar>(inertia: &ArticulatedInertia<T>, unit: Motion<T>) -> Force<T> {
    inertia.times_linear(unit.linear)
}

#[inline(always)]
pub(super) fn momentum<T: Scalar>(inertia: &Inertia<T>, unit: Motion<T>) -> Force<T> {
    inertia.shifted_by(unit.linear)
}

#[inline(always)]
pub(super) fn felt<T: Scalar>(axis: Vec3<T>, momentum: Force<T>) -> T {
    axis.dot(momentum.linear)
}
