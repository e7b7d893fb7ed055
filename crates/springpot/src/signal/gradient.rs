//! Arithmetic of values with their derivatives by two variables.

use super::jet::{Value, power, reciprocal};

/// A value and its derivatives by two variables.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Gradient {
    /// Value.
    pub(crate) value: f64,
    /// Derivatives.
    pub(crate) by: [f64; 2],
}

impl Gradient {
    /// a·self + b·other in its derivatives.
    fn with(self, value: f64, a: f64, other: Self, b: f64) -> Self {
        Self { value, by: [0, 1].map(|k| a * self.by[k] + b * other.by[k]) }
    }

    fn is_still(self) -> bool {
        self.by == [0.0; 2]
    }
}

impl Value for Gradient {
    fn constant(value: f64) -> Self {
        Self { value, by: [0.0; 2] }
    }
    fn value(self) -> f64 {
        self.value
    }
    fn neg(self) -> Self {
        Self { value: -self.value, by: self.by.map(|slope| -slope) }
    }
    fn add(self, other: Self) -> Self {
        self.with(self.value + other.value, 1.0, other, 1.0)
    }
    fn sub(self, other: Self) -> Self {
        self.with(self.value - other.value, 1.0, other, -1.0)
    }
    fn mul(self, other: Self) -> Self {
        self.with(self.value * other.value, other.value, other, self.value)
    }
    fn scale(self, factor: f64) -> Self {
        Self { value: factor * self.value, by: self.by.map(|slope| factor * slope) }
    }
    fn shift(self, by: f64) -> Self {
        Self { value: self.value + by, ..self }
    }
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, by: [0, 1].map(|k| (self.by[k] - value * other.by[k]) / other.value) }
    }
    fn pow(self, exponent: Self) -> Self {
        let n = exponent.value;
        let value = power(self.value, n);
        if exponent.is_still() {
            // A vanishing coefficient wins over an infinite power.
            return self.apply(value, || (if n == 0.0 { 0.0 } else { n * power(self.value, n - 1.0) }, 0.0));
        }
        if self.value == 0.0 && self.is_still() && n > 0.0 {
            return Self::constant(value);
        }
        let logarithm = Value::mul(exponent, self.apply(self.value.ln(), || reciprocal(self.value)));
        Self { value, by: logarithm.by.map(|slope| value * slope) }
    }
    fn atan2(self, x: Self) -> Self {
        let square = x.value * x.value + self.value * self.value;
        self.with(self.value.atan2(x.value), x.value / square, x, -self.value / square)
    }
    fn apply(self, value: f64, derivatives: impl FnOnce() -> (f64, f64)) -> Self {
        // What is still has no slope where the function's own is infinite.
        if self.is_still() {
            return Self::constant(value);
        }
        let (first, _) = derivatives();
        Self { value, by: self.by.map(|slope| if slope == 0.0 { 0.0 } else { first * slope }) }
    }
    fn is_below_zero(self) -> bool {
        self.value < 0.0
    }
    fn is_falling(self) -> bool {
        false
    }
}
