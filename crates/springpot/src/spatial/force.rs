//! Spatial forces: wrenches and momenta.

use std::ops::{Add, AddAssign, Mul, SubAssign};

use super::scalar::Scalar;
use super::vector::Vec3;

/// A wrench (or a momentum): linear part, and moment about the origin of the frame in which it is expressed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Force<T = f64> {
    /// Force, N (or linear momentum, kg·m/s).
    pub linear: Vec3<T>,
    /// Moment about the origin, N·m (or angular momentum, kg·m²/s).
    pub angular: Vec3<T>,
}

impl<T: Scalar> Force<T> {
    /// No force.
    pub const ZERO: Self = Self { linear: Vec3::ZERO, angular: Vec3::ZERO };

    /// The wrench of a force that acts at `point`.
    #[inline(always)]
    pub fn at_point(force: Vec3<T>, point: Vec3<T>) -> Self {
        Self { linear: force, angular: point.cross(force) }
    }

    /// The same wrench about another point, from which the present origin is seen at `arm`; the axes stay: (f, n + arm × f).
    #[inline(always)]
    pub fn shifted(self, arm: Vec3<T>) -> Self {
        Self { linear: self.linear, angular: self.angular + arm.cross(self.linear) }
    }
}

impl<T: Scalar> Add for Force<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { linear: self.linear + other.linear, angular: self.angular + other.angular }
    }
}

impl<T: Scalar> AddAssign for Force<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Scalar> SubAssign for Force<T> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        self.linear -= other.linear;
        self.angular -= other.angular;
    }
}

impl<T: Scalar> Mul<T> for Force<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: T) -> Self {
        Self { linear: self.linear * factor, angular: self.angular * factor }
    }
}
