//! Numbers with their derivative along one direction.

use super::scalar::Scalar;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// value + slope·ε with ε² = 0: an algorithm on such numbers gives the derivatives of its results beside them, to rounding.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Along<T> {
    pub(crate) value: T,
    pub(crate) slope: T,
}

impl<T: Scalar> Along<T> {
    /// A number that stays.
    #[inline(always)]
    pub(crate) fn still(value: T) -> Self {
        Self { value, slope: T::ZERO }
    }
}

impl<T: Scalar> Add for Along<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: self.slope + other.slope }
    }
}

impl<T: Scalar> Sub for Along<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, slope: self.slope - other.slope }
    }
}

impl<T: Scalar> Mul for Along<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self { value: self.value * other.value, slope: self.slope.times_plus(other.value, self.value * other.slope) }
    }
}

impl<T: Scalar> Div for Along<T> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, slope: (self.slope - value * other.slope) / other.value }
    }
}

impl<T: Scalar> Neg for Along<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { value: -self.value, slope: -self.slope }
    }
}

impl<T: Scalar> AddAssign for Along<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Scalar> SubAssign for Along<T> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<T: Scalar> Scalar for Along<T> {
    const ZERO: Self = Self { value: T::ZERO, slope: T::ZERO };
    const ONE: Self = Self { value: T::ONE, slope: T::ZERO };

    #[inline(always)]
    fn from_f64(x: f64) -> Self {
        Self::still(T::from_f64(x))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        Self { value, slope: self.slope / (value + value) }
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = self.value.sin_cos();
        (Self { value: sine, slope: cosine * self.slope }, Self { value: cosine, slope: -sine * self.slope })
    }

    #[inline(always)]
    fn times_plus(self, factor: Self, term: Self) -> Self {
        let along = self.slope.times_plus(factor.value, term.slope);
        Self {
            value: self.value.times_plus(factor.value, term.value),
            slope: self.value.times_plus(factor.slope, along),
        }
    }
}
