//! Arithmetic of values with their first two derivatives, and the functions of expressions on them.

/// Value and first two time derivatives of a signal.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Jet {
    /// Value.
    pub value: f64,
    /// First time derivative.
    pub first: f64,
    /// Second time derivative.
    pub second: f64,
}

/// What an expression is evaluated on: plain numbers, or jets.
pub(super) trait Value: Copy {
    fn constant(value: f64) -> Self;
    fn value(self) -> f64;
    fn neg(self) -> Self;
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    fn pow(self, exponent: Self) -> Self;
    fn scale(self, factor: f64) -> Self {
        Self::constant(factor).mul(self)
    }
    fn shift(self, by: f64) -> Self {
        self.add(Self::constant(by))
    }
    /// The angle of the point (x, self).
    fn atan2(self, x: Self) -> Self;
    /// f(self) from f, f', f'' at the value; the derivatives are not asked for where they are not needed.
    fn apply(self, value: f64, derivatives: impl FnOnce() -> (f64, f64)) -> Self;
    /// Whether it is below zero just after now, as far as this type can tell.
    fn is_below_zero(self) -> bool;
    /// Whether it falls just after now, as far as this type can tell.
    fn is_falling(self) -> bool;
}

/// x^n, exact where it can be; 0^0 = 1.
pub(super) fn power(base: f64, exponent: f64) -> f64 {
    match exponent {
        1.0 => base,
        2.0 => base * base,
        3.0 => base * base * base,
        _ => base.powf(exponent),
    }
}

impl Value for f64 {
    fn constant(value: f64) -> Self {
        value
    }
    fn value(self) -> f64 {
        self
    }
    fn neg(self) -> Self {
        -self
    }
    fn add(self, other: Self) -> Self {
        self + other
    }
    fn sub(self, other: Self) -> Self {
        self - other
    }
    fn mul(self, other: Self) -> Self {
        self * other
    }
    fn div(self, other: Self) -> Self {
        self / other
    }
    fn pow(self, exponent: Self) -> Self {
        power(self, exponent)
    }
    fn atan2(self, x: Self) -> Self {
        f64::atan2(self, x)
    }
    fn apply(self, value: f64, _: impl FnOnce() -> (f64, f64)) -> Self {
        value
    }
    fn is_below_zero(self) -> bool {
        self < 0.0
    }
    fn is_falling(self) -> bool {
        false
    }
}

impl Jet {
    /// A value that does not change.
    pub const fn constant(value: f64) -> Self {
        Self { value, first: 0.0, second: 0.0 }
    }

    /// The time itself.
    pub const fn time(t: f64) -> Self {
        Self { value: t, first: 1.0, second: 0.0 }
    }

    fn is_still(self) -> bool {
        self.first == 0.0 && self.second == 0.0
    }
}

impl Value for Jet {
    fn constant(value: f64) -> Self {
        Self::constant(value)
    }
    fn value(self) -> f64 {
        self.value
    }
    fn neg(self) -> Self {
        Self { value: -self.value, first: -self.first, second: -self.second }
    }
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, first: self.first + other.first, second: self.second + other.second }
    }
    fn sub(self, other: Self) -> Self {
        self.add(other.neg())
    }
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            first: self.first * other.value + self.value * other.first,
            second: self.second * other.value + 2.0 * self.first * other.first + self.value * other.second,
        }
    }
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        let first = (self.first - value * other.first) / other.value;
        let second = (self.second - 2.0 * first * other.first - value * other.second) / other.value;
        Self { value, first, second }
    }

    fn pow(self, exponent: Self) -> Self {
        let n = exponent.value;
        let value = power(self.value, n);
        if exponent.is_still() {
            // A vanishing coefficient wins over an infinite power: t² at 0 has the derivatives 0 and 2.
            let term =
                |coefficient: f64, n: f64| if coefficient == 0.0 { 0.0 } else { coefficient * power(self.value, n) };
            return self.apply(value, || (term(n, n - 1.0), term(n * (n - 1.0), n - 2.0)));
        }
        if self.value == 0.0 && self.is_still() && n > 0.0 {
            return Self::constant(value);
        }
        let logarithm = Value::mul(exponent, self.apply(self.value.ln(), || reciprocal(self.value)));
        Self {
            value,
            first: value * logarithm.first,
            second: value * (logarithm.first * logarithm.first + logarithm.second),
        }
    }

    fn atan2(self, x: Self) -> Self {
        let square = x.value * x.value + self.value * self.value;
        let first = (x.value * self.first - self.value * x.first) / square;
        let turned = x.value * self.second - self.value * x.second;
        let second = (turned - 2.0 * first * (x.value * x.first + self.value * self.first)) / square;
        Self { value: self.value.atan2(x.value), first, second }
    }

    fn apply(self, value: f64, derivatives: impl FnOnce() -> (f64, f64)) -> Self {
        // An argument at rest has derivatives zero even where the function's own are infinite: sqrt(max(0, t)) for t < 0.
        if self.is_still() {
            return Self::constant(value);
        }
        let (first, second) = derivatives();
        let bend = if second == 0.0 { 0.0 } else { second * (self.first * self.first) };
        let slope = if self.second == 0.0 { 0.0 } else { first * self.second };
        Self { value, first: first * self.first, second: bend + slope }
    }

    fn is_below_zero(self) -> bool {
        if self.value != 0.0 {
            self.value < 0.0
        } else if self.first != 0.0 {
            self.first < 0.0
        } else {
            self.second < 0.0
        }
    }

    fn is_falling(self) -> bool {
        if self.first != 0.0 { self.first < 0.0 } else { self.second < 0.0 }
    }
}

pub(super) fn reciprocal(u: f64) -> (f64, f64) {
    (1.0 / u, -1.0 / (u * u))
}

/// A smooth function of one argument.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Smooth {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    Log,
    Sqrt,
}

impl Smooth {
    /// Whether it has a kink where its argument touches the end of its domain and turns.
    pub(super) fn may_touch(self) -> bool {
        matches!(self, Self::Sqrt | Self::Asin | Self::Acos)
    }

    pub(super) fn apply<V: Value>(self, argument: V) -> V {
        let u = argument.value();
        match self {
            Self::Sin => argument.apply(u.sin(), || (u.cos(), -u.sin())),
            Self::Cos => argument.apply(u.cos(), || (-u.sin(), -u.cos())),
            Self::Tan => {
                let tan = u.tan();
                let slope = 1.0 + tan * tan;
                argument.apply(tan, || (slope, 2.0 * tan * slope))
            }
            Self::Asin => argument.apply(u.asin(), || arc(u)),
            Self::Acos => argument.apply(u.acos(), || {
                let (first, second) = arc(u);
                (-first, -second)
            }),
            Self::Atan => {
                let slope = 1.0 / (1.0 + u * u);
                argument.apply(u.atan(), || (slope, -2.0 * u * slope * slope))
            }
            Self::Sinh => argument.apply(u.sinh(), || (u.cosh(), u.sinh())),
            Self::Cosh => argument.apply(u.cosh(), || (u.sinh(), u.cosh())),
            Self::Tanh => {
                let tanh = u.tanh();
                // 1 − tanh² would lose everything where the slope is small.
                argument.apply(tanh, || {
                    let slope = u.cosh().recip().powi(2);
                    (slope, -2.0 * tanh * slope)
                })
            }
            Self::Exp => {
                let exp = u.exp();
                argument.apply(exp, || (exp, exp))
            }
            Self::Log => argument.apply(u.ln(), || reciprocal(u)),
            Self::Sqrt => {
                let root = u.sqrt();
                argument.apply(root, || (0.5 / root, -0.25 / (u * root)))
            }
        }
    }
}

/// Derivatives of arcsin.
fn arc(u: f64) -> (f64, f64) {
    let square = (1.0 - u) * (1.0 + u);
    let slope = 1.0 / square.sqrt();
    (slope, u * slope / square)
}
