//! What rounding does to a signal: values with bounds of their errors (Higham, Accuracy and Stability of Numerical Algorithms, 3.3).

use super::jet::Value;

/// Unit roundoff of a double.
const UNIT: f64 = 0.5 * f64::EPSILON;

/// A value, and a first-order bound of what rounding has made of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rounded {
    value: f64,
    pub(super) error: f64,
}

impl Rounded {
    /// A time or a state, which is itself a rounded sum.
    pub(super) fn read(value: f64) -> Self {
        Self::of(value, 0.0)
    }

    /// A result whose operands bring in `error`.
    fn of(value: f64, error: f64) -> Self {
        Self { value, error: error + UNIT * value.abs() }
    }
}

impl Value for Rounded {
    fn constant(value: f64) -> Self {
        Self { value, error: 0.0 }
    }
    fn value(self) -> f64 {
        self.value
    }
    fn neg(self) -> Self {
        Self { value: -self.value, ..self }
    }
    fn add(self, other: Self) -> Self {
        Self::of(self.value + other.value, self.error + other.error)
    }
    fn sub(self, other: Self) -> Self {
        self.add(other.neg())
    }
    fn mul(self, other: Self) -> Self {
        Self::of(self.value * other.value, self.value.abs() * other.error + other.value.abs() * self.error)
    }
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self::of(value, (self.error + value.abs() * other.error) / other.value.abs())
    }

    fn pow(self, exponent: Self) -> Self {
        let (value, n) = (self.value.pow(exponent.value), exponent.value);
        let by_base = if self.error == 0.0 { 0.0 } else { (n * self.value.powf(n - 1.0)).abs() * self.error };
        let by_exponent = if exponent.error == 0.0 { 0.0 } else { (value * self.value.ln()).abs() * exponent.error };
        Self::of(value, by_base + by_exponent)
    }

    fn atan2(self, x: Self) -> Self {
        let square = x.value * x.value + self.value * self.value;
        let error = (x.value.abs() * self.error + self.value.abs() * x.error) / square;
        Self::of(self.value.atan2(x.value), if square > 0.0 { error } else { 0.0 })
    }

    fn apply(self, value: f64, derivatives: impl FnOnce() -> (f64, f64)) -> Self {
        if self.error == 0.0 {
            return Self::of(value, 0.0);
        }
        let (slope, _) = derivatives();
        // Roots are as steep as nothing where they begin.
        Self::of(value, if slope.is_finite() { slope.abs() * self.error } else { self.error.sqrt() })
    }

    fn is_below_zero(self) -> bool {
        self.value < 0.0
    }
    fn is_falling(self) -> bool {
        false
    }
}

#[cfg(test)]
mod tests {
    use crate::signal::Signal;

    /// What the largest of the operands loses, not what is left of them.
    #[test]
    fn what_cancels_is_known() {
        let rounding = |text: &str, t: f64| Signal::expression(text.parse().unwrap()).rounding(t);
        let u = 0.5 * f64::EPSILON;
        for t in [1e-9, 1e-5, 0.1] {
            let lost = rounding("1 - cos(t)", t);
            assert!((u..4.0 * u).contains(&lost), "{t}: {lost}");
            let own = rounding("t^2", t);
            assert!(own <= 8.0 * u * t * t, "{t}: {own}");
            let ramp = rounding("max(0, t - 1)", 1.0 + t);
            assert!((u..4.0 * u).contains(&ramp), "{t}: {ramp}");
        }
        assert_eq!(rounding("max(0, t - 1)", 0.5), 0.0);
        assert_eq!(rounding("3", 0.5), 0.0);
        assert_eq!(Signal::constant(3.0).rounding(0.5), 0.0);
        assert!(rounding("sqrt(t)", 0.0).is_finite());
    }

    /// Two ways to the same number differ by no more than their bounds.
    #[test]
    fn what_differs_is_within_the_bounds() {
        let pairs = [
            ("1 - cos(t)", "2*sin(t/2)^2"),
            ("exp(t) - 1 - t", "exp(t) - (1 + t)"),
            ("(1 + t)^5 - 1", "t*(5 + t*(10 + t*(10 + t*(5 + t))))"),
            ("tanh(3*t) - 3*t/(1 + t)", "(exp(6*t) - 1)/(exp(6*t) + 1) - 3/(1/t + 1)"),
        ];
        let signal = |text: &str| Signal::expression(text.parse().unwrap());
        let mut seen = 0;
        for (a, b) in pairs {
            let (a, b) = (signal(a), signal(b));
            for k in 1..400 {
                let t = 1e-12 * 1.06_f64.powi(k);
                let apart = (a.value(t) - b.value(t)).abs();
                assert!(apart <= a.rounding(t) + b.rounding(t), "{a:?} at {t}: {apart}");
                seen += usize::from(apart > 0.05 * (a.rounding(t) + b.rounding(t)));
            }
        }
        assert!(seen > 400, "{seen}: the bounds are no more than what happens");
    }
}
