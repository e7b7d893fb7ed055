//! Three-vectors.

use std::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};

use super::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// A three-vector in right-handed Cartesian components.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Vec3<T = f64>(pub [T; 3]);

impl<T: Scalar> Vec3<T> {
    /// The zero vector.
    pub const ZERO: Self = Self([T::ZERO; 3]);

    /// The vector with the given components.
    #[inline(always)]
    pub fn new(x: T, y: T, z: T) -> Self {
        Self([x, y, z])
    }

    /// A constant vector (the same in every state).
    #[inline(always)]
    pub fn from_f64(v: Vec3<f64>) -> Self {
        let [x, y, z] = v.0;
        Self([T::from_f64(x), T::from_f64(y), T::from_f64(z)])
    }

    /// Scalar product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> T {
        let ([a0, a1, a2], [b0, b1, b2]) = (self.0, other.0);
        a2.times_plus(b2, a1.times_plus(b1, a0 * b0))
    }

    /// Vector product self × other.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        let ([a0, a1, a2], [b0, b1, b2]) = (self.0, other.0);
        Self([a1.times_plus(b2, -(a2 * b1)), a2.times_plus(b0, -(a0 * b2)), a0.times_plus(b1, -(a1 * b0))])
    }

    /// self · factor + term.
    #[inline(always)]
    pub fn times_plus(self, factor: T, term: Self) -> Self {
        let ([a0, a1, a2], [t0, t1, t2]) = (self.0, term.0);
        Self([a0.times_plus(factor, t0), a1.times_plus(factor, t1), a2.times_plus(factor, t2)])
    }

    /// Euclidean length.
    #[inline(always)]
    pub fn norm(self) -> T {
        self.dot(self).sqrt()
    }
}

impl Vec3<f64> {
    /// Whether all three components are finite.
    pub fn is_finite(self) -> bool {
        self.0.iter().all(|x| x.is_finite())
    }
}

impl<T> From<[T; 3]> for Vec3<T> {
    #[inline(always)]
    fn from(components: [T; 3]) -> Self {
        Self(components)
    }
}

impl<T: Scalar> Add for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self([self.0[0] + other.0[0], self.0[1] + other.0[1], self.0[2] + other.0[2]])
    }
}

impl<T: Scalar> Sub for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self([self.0[0] - other.0[0], self.0[1] - other.0[1], self.0[2] - other.0[2]])
    }
}

impl<T: Scalar> Neg for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let [x, y, z] = self.0;
        Self([-x, -y, -z])
    }
}

impl<T: Scalar> Mul<T> for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: T) -> Self {
        let [x, y, z] = self.0;
        Self([x * factor, y * factor, z * factor])
    }
}

impl<T: Scalar> AddAssign for Vec3<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Scalar> SubAssign for Vec3<T> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
