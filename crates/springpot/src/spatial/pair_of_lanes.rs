//! Two states side by side, in tests only: it shows that the algorithms take any scalar of the trait.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use super::scalar::Scalar;

/// Two numbers that never meet.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Two(pub(crate) [f64; 2]);

impl super::scalar::sealed::Sealed for Two {}

macro_rules! lane_by_lane {
    ($($op:ident $method:ident),*) => {$(
        impl $op for Two {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self([self.0[0].$method(other.0[0]), self.0[1].$method(other.0[1])])
            }
        }
    )*};
}
lane_by_lane!(Add add, Sub sub, Mul mul, Div div);

impl Neg for Two {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(|x| -x))
    }
}

impl AddAssign for Two {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Two {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl Scalar for Two {
    const ZERO: Self = Self([0.0; 2]);
    const ONE: Self = Self([1.0; 2]);

    fn from_f64(x: f64) -> Self {
        Self([x; 2])
    }

    fn sqrt(self) -> Self {
        Self(self.0.map(f64::sqrt))
    }

    fn sin_cos(self) -> (Self, Self) {
        let [a, b] = self.0.map(<f64 as Scalar>::sin_cos);
        (Self([a.0, b.0]), Self([a.1, b.1]))
    }

    fn times_plus(self, factor: Self, term: Self) -> Self {
        Self([0, 1].map(|k| Scalar::times_plus(self.0[k], factor.0[k], term.0[k])))
    }
}
