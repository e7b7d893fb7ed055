//! Numbers with their derivative by one parameter.

use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// value + slope·ε with ε² = 0: what is worked out of such numbers has its exact derivative beside it.
///
/// Source: Clifford, Preliminary sketch of biquaternions, Proc. London Math. Soc. s1-4, 1873.
///
/// ```
/// use springpot::dual::{Dual, Real};
///
/// // d(k·x²)/dx at x = 3.
/// let x = Dual { value: 3.0, slope: 1.0 };
/// assert_eq!(Dual::from(5.0) * x.powf(2.0.into()), Dual { value: 45.0, slope: 30.0 });
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Dual {
    /// The number.
    pub value: f64,
    /// Its derivative.
    pub slope: f64,
}

/// What formulas are made of that are asked for numbers, and for numbers with a derivative.
///
/// Where a formula branches it does so by [`Real::value`]: at a kink the derivative is that of the branch taken.
pub trait Real:
    Copy
    + std::fmt::Debug
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + Sum
{
    /// Whether there are derivatives.
    const HAS_SLOPE: bool;

    /// The number without its derivative.
    fn value(self) -> f64;

    /// Its derivative; 0 of a plain number.
    fn slope(self) -> f64;

    /// The number, its derivative where that is asked for.
    fn of(number: Dual) -> Self;

    /// |x|; at 0 the derivative is 0.
    fn abs(self) -> Self;

    /// x^n; the derivative by n is that of positive x.
    fn powf(self, n: Self) -> Self;

    /// e^x.
    fn exp(self) -> Self;

    /// tanh x.
    fn tanh(self) -> Self;

    /// √x.
    fn sqrt(self) -> Self;
}

impl Dual {
    /// A number that changes one to one.
    pub fn variable(value: f64) -> Self {
        Self { value, slope: 1.0 }
    }

    /// Numbers without their derivatives.
    pub fn values(numbers: &[Self]) -> Vec<f64> {
        numbers.iter().map(|number| number.value).collect()
    }

    /// f(x) from its value and its derivative at x.
    pub(crate) fn through(self, value: f64, derivative: f64) -> Self {
        Self { value, slope: if self.slope == 0.0 { 0.0 } else { derivative * self.slope } }
    }
}

impl From<f64> for Dual {
    fn from(value: f64) -> Self {
        Self { value, slope: 0.0 }
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: self.slope + other.slope }
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, slope: self.slope - other.slope }
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self { value: self.value * other.value, slope: self.slope * other.value + self.value * other.slope }
    }
}

impl Div for Dual {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, slope: (self.slope - value * other.slope) / other.value }
    }
}

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, slope: -self.slope }
    }
}

impl AddAssign for Dual {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Dual {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl Sum for Dual {
    fn sum<I: Iterator<Item = Self>>(numbers: I) -> Self {
        numbers.fold(Self::default(), |sum, number| sum + number)
    }
}

impl Real for f64 {
    const HAS_SLOPE: bool = false;

    fn value(self) -> f64 {
        self
    }

    fn slope(self) -> f64 {
        0.0
    }

    fn of(number: Dual) -> Self {
        number.value
    }

    fn abs(self) -> Self {
        f64::abs(self)
    }

    fn powf(self, n: Self) -> Self {
        f64::powf(self, n)
    }

    fn exp(self) -> Self {
        f64::exp(self)
    }

    fn tanh(self) -> Self {
        f64::tanh(self)
    }

    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
}

impl Real for Dual {
    const HAS_SLOPE: bool = true;

    fn value(self) -> f64 {
        self.value
    }

    fn slope(self) -> f64 {
        self.slope
    }

    fn of(number: Dual) -> Self {
        number
    }

    fn abs(self) -> Self {
        let sign = if self.value == 0.0 { 0.0 } else { self.value.signum() };
        self.through(self.value.abs(), sign)
    }

    fn powf(self, n: Self) -> Self {
        let value = self.value.powf(n.value);
        let by_base = if n.value == 0.0 { 0.0 } else { n.value * self.value.powf(n.value - 1.0) };
        let by_power = if n.slope == 0.0 || self.value <= 0.0 { 0.0 } else { n.slope * value * self.value.ln() };
        let Self { slope, .. } = self.through(value, by_base);
        Self { value, slope: slope + by_power }
    }

    fn exp(self) -> Self {
        let value = self.value.exp();
        self.through(value, value)
    }

    fn tanh(self) -> Self {
        let value = self.value.tanh();
        self.through(value, 1.0 - value * value)
    }

    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        self.through(value, 0.5 / value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every function against a fourth-order difference.
    #[test]
    fn slopes_are_derivatives() {
        let functions: [fn(Dual) -> Dual; 8] = [
            |x| x * x - x / (x + Dual::from(2.0)),
            |x| x.powf(Dual::from(1.7)),
            |x| Dual::from(1.3).powf(x),
            |x| x.powf(x),
            |x| (-x).exp() * x.tanh(),
            |x| x.sqrt() + (x - Dual::from(5.0)).abs(),
            |x| [x, x * x].into_iter().sum(),
            |x| {
                let mut y = x;
                y += x * x;
                y -= Dual::from(1.0) / x;
                y
            },
        ];
        for (k, f) in functions.iter().enumerate() {
            for x in [0.3, 1.1, 2.7] {
                let at = |x: f64| f(x.into()).value;
                let d = 1e-3;
                let difference = (8.0 * (at(x + d) - at(x - d)) - (at(x + 2.0 * d) - at(x - 2.0 * d))) / (12.0 * d);
                let slope = f(Dual::variable(x)).slope;
                assert!((slope - difference).abs() < 1e-9 * (1.0 + slope.abs()), "{k} at {x}: {slope} {difference}");
            }
        }
    }

    #[test]
    fn what_does_not_change_has_no_slope() {
        // Nor where its derivative is infinite.
        assert_eq!(Dual::from(0.0).sqrt().slope, 0.0);
        assert_eq!(Dual::from(0.0).powf(Dual::from(0.5)).slope, 0.0);
        assert_eq!(Dual::variable(0.0).abs().slope, 0.0);
    }
}
