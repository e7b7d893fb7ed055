//! Spatial motions: velocities and accelerations of a frame.

use std::ops::{Add, AddAssign, Mul};

use super::force::Force;
use super::rotation::Rotation;
use super::scalar::Scalar;
use super::vector::Vec3;

/// Angular part and linear part at the origin of the frame in which it is expressed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion<T = f64> {
    /// Angular velocity (rad/s) or acceleration (rad/s²).
    pub angular: Vec3<T>,
    /// Linear velocity (m/s) or acceleration (m/s²) of the origin.
    pub linear: Vec3<T>,
}

impl<T: Scalar> Motion<T> {
    /// No motion.
    pub const ZERO: Self = Self { angular: Vec3::ZERO, linear: Vec3::ZERO };

    /// The same motion at another point, which is seen at `arm` from the present origin; the axes stay: (ω, v + ω × arm).
    #[inline(always)]
    pub fn shifted(self, arm: Vec3<T>) -> Self {
        Self { angular: self.angular, linear: self.linear + self.angular.cross(arm) }
    }

    /// The same motion in the axes into which `r` leads; the origin stays.
    #[inline(always)]
    pub fn rotated(self, r: &Rotation<T>) -> Self {
        Self { angular: *r * self.angular, linear: *r * self.linear }
    }

    /// The cross product with a motion, v × m = (ω × ω_m, ω × v_m + v × ω_m): how `m`, fixed in a frame that moves with v,
    /// changes.
    #[inline(always)]
    pub fn cross(self, m: Self) -> Self {
        Self {
            angular: self.angular.cross(m.angular),
            linear: self.angular.cross(m.linear) + self.linear.cross(m.angular),
        }
    }

    /// The cross product with a force, v ×* f = (ω × f, ω × n + v × f) in the order (linear, angular).
    #[inline(always)]
    pub fn cross_force(self, f: Force<T>) -> Force<T> {
        Force {
            linear: self.angular.cross(f.linear),
            angular: self.angular.cross(f.angular) + self.linear.cross(f.linear),
        }
    }

    /// Power f · v, W, of a force at the same origin.
    #[inline(always)]
    pub fn dot(self, f: Force<T>) -> T {
        self.angular.dot(f.angular) + self.linear.dot(f.linear)
    }
}

impl<T: Scalar> Add for Motion<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { angular: self.angular + other.angular, linear: self.linear + other.linear }
    }
}

impl<T: Scalar> AddAssign for Motion<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Scalar> Mul<T> for Motion<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: T) -> Self {
        Self { angular: self.angular * factor, linear: self.linear * factor }
    }
}
