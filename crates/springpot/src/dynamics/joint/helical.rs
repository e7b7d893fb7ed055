//! Screws: turns about z that shift along it, by `pitch` (m/rad).

use crate::spatial::{ArticulatedInertia, Force, Inertia, Motion, Placement, Scalar, Vec3};

use super::{prismatic, revolute};

#[inline(always)]
pub(super) fn placement<T: Scalar>(at_zero: Placement<T>, pitch: f64, [angle, sine, cosine]: [T; 3]) -> Placement<T> {
    prismatic::placement(revolute::placement(at_zero, sine, cosine), angle * T::from_f64(pitch))
}

#[inline(always)]
pub(super) fn velocity<T: Scalar>(carried: Motion<T>, axis: Vec3<T>, pitch: f64, speed: T) -> Motion<T> {
    prismatic::velocity(revolute::velocity(carried, axis, speed), axis, speed * T::from_f64(pitch))
}

/// The turn adds to what turns the axis nothing that turns it: both parts are as if they were alone.
#[inline(always)]
pub(super) fn acceleration<T: Scalar>(
    carried: Motion<T>,
    omega: Vec3<T>,
    axis: Vec3<T>,
    pitch: f64,
    [speed, push]: [T; 2],
) -> Motion<T> {
    let turned = revolute::acceleration(carried, omega, axis, [speed, push]);
    let pitch = T::from_f64(pitch);
    prismatic::acceleration(turned, omega, axis, [speed * pitch, push * pitch])
}

#[inline(always)]
pub(super) fn advance<T: Scalar>(
    velocity: &mut Motion<T>,
    acceleration: &mut Motion<T>,
    pitch: f64,
    [speed, push]: [T; 2],
) {
    let pitch = T::from_f64(pitch);
    revolute::advance(velocity, acceleration, speed, push);
    prismatic::advance(velocity, acceleration, speed * pitch, push * pitch);
}

#[inline(always)]
pub(super) fn effort<T: Scalar>(force: Force<T>, pitch: f64) -> T {
    prismatic::effort(force).times_plus(T::from_f64(pitch), revolute::effort(force))
}

#[inline(always)]
pub(super) fn bias<T: Scalar>(velocity: Motion<T>, turning: Vec3<T>, pitch: f64) -> Motion<T> {
    revolute::bias(velocity, turning) + prismatic::bias(velocity, turning * T::from_f64(pitch))
}

#[inline(always)]
pub(super) fn unit_motion<T: Scalar>(axis: Vec3<T>, arm: Vec3<T>, pitch: f64) -> Motion<T> {
    Motion { angular: axis, linear: axis.times_plus(T::from_f64(pitch), arm.cross(axis)) }
}

#[inline(always)]
pub(super) fn point_column<T: Scalar>(axis: Vec3<T>, arm: Vec3<T>, pitch: f64) -> Vec3<T> {
    axis.times_plus(T::from_f64(pitch), axis.cross(arm))
}

#[inline(always)]
pub(super) fn point_column_rate<T: Scalar>(
    [axis, rate]: [Vec3<T>; 2],
    [arm, arm_rate]: [Vec3<T>; 2],
    pitch: f64,
) -> Vec3<T> {
    rate.times_plus(T::from_f64(pitch), revolute::point_column_rate(axis, rate, arm, arm_rate))
}

#[inline(always)]
pub(super) fn load<T: Scalar>(inertia: &ArticulatedInertia<T>, unit: Motion<T>) -> Force<T> {
    inertia.times(unit)
}

#[inline(always)]
pub(super) fn momentum<T: Scalar>(inertia: &Inertia<T>, unit: Motion<T>) -> Force<T> {
    *inertia * unit
}

#[inline(always)]
pub(super) fn felt<T: Scalar>(axis: Vec3<T>, momentum: Force<T>, pitch: f64) -> T {
    revolute::felt(axis, momentum) + prismatic::felt(axis * T::from_f64(pitch), momentum)
}
