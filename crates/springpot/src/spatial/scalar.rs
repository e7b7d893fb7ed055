//! The one scalar generic of the workspace.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

mod sincos;

mod sealed {
    use crate::spatial::columns::ColumnWork;

    pub trait Sealed: Sized {
        /// Works on rows of numbers, so many columns at a time as the processor can; lanes are as wide as that already.
        fn in_columns(work: impl ColumnWork<Self>);
    }

    impl Sealed for f64 {
        fn in_columns(work: impl ColumnWork<Self>) {
            crate::spatial::dispatch::in_columns(work);
        }
    }

    impl<T: super::Scalar> Sealed for crate::spatial::along::Along<T> {
        #[inline(always)]
        fn in_columns(work: impl ColumnWork<Self>) {
            work.run::<Self>();
        }
    }

    #[cfg(target_arch = "x86_64")]
    impl<R: crate::spatial::lanes::Register, const JOINS: bool> Sealed for crate::spatial::lanes::Lanes<R, JOINS> {
        #[inline(always)]
        fn in_columns(work: impl ColumnWork<Self>) {
            work.run::<Self>();
        }
    }
}

/// A number of the rigid-body algorithms: one state's `f64`, or several states side by side.
///
/// There is no ordering on purpose: an algorithm that never branches on a scalar's value runs unchanged on several
/// states at once. The trait is sealed.
pub trait Scalar:
    sealed::Sealed
    + Copy
    + Debug
    + Default
    + PartialEq
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;

    /// The constant `x` (the same in every state).
    fn from_f64(x: f64) -> Self;

    /// Square root; NaN below zero.
    fn sqrt(self) -> Self;

    /// (sin, cos) of an angle in radians.
    fn sin_cos(self) -> (Self, Self);

    /// The sines and cosines of many angles in radians; slices of one length.
    #[inline(always)]
    fn sin_cos_each(angles: &[Self], sines: &mut [Self], cosines: &mut [Self]) {
        for ((angle, sine), cosine) in angles.iter().zip(sines).zip(cosines) {
            (*sine, *cosine) = angle.sin_cos();
        }
    }

    /// self · factor + term, in one rounding or two as suits the type.
    #[inline(always)]
    fn times_plus(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }
}

impl Scalar for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;

    #[inline(always)]
    fn from_f64(x: f64) -> Self {
        x
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        if self.abs() <= sincos::LARGEST { sincos::sin_cos(self) } else { f64::sin_cos(self) }
    }

    #[inline(always)]
    fn sin_cos_each(angles: &[Self], sines: &mut [Self], cosines: &mut [Self]) {
        // Without the branch of `sin_cos` the compiler takes several angles at a time.
        for ((&angle, sine), cosine) in angles.iter().zip(&mut *sines).zip(&mut *cosines) {
            (*sine, *cosine) = sincos::sin_cos(angle);
        }
        for ((angle, sine), cosine) in angles.iter().zip(sines).zip(cosines) {
            if angle.abs() > sincos::LARGEST {
                (*sine, *cosine) = angle.sin_cos();
            }
        }
    }

    #[inline(always)]
    fn times_plus(self, factor: Self, term: Self) -> Self {
        if cfg!(target_feature = "fma") { self.mul_add(factor, term) } else { self * factor + term }
    }
}
