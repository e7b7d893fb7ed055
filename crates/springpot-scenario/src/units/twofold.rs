//! Numbers of twice the working precision, as the unevaluated sum of two `f64`.
//!
//! Why not `f64`: of numbers with up to six digits it would give another one than the nearest for 10 % in h, 15 % in min, 22 % in deg, 25 %
//! in degC, 39 % in degF and 19 % in mm/min, by up to two units in the last place; 0.2 degC would be 273.34999999999997 K.
//!
//! Error-free transformations after T. J. Dekker, "A floating-point technique for extending the available precision",
//! Numerische Mathematik 18 (1971) 224–242, with the product's error from a fused multiply-add.

/// `high + low` with |low| ≤ ½ ulp(high): 106 bits, relative error of an operation about 1e-31.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Twofold {
    high: f64,
    low: f64,
}

impl Twofold {
    pub(super) const ONE: Self = Self::from_f64(1.0);
    pub(super) const TEN: Self = Self::from_f64(10.0);
    /// π to 106 bits.
    pub(super) const PI: Self = Self { high: std::f64::consts::PI, low: 1.224_646_799_147_353_2e-16 };

    pub(super) const fn from_f64(value: f64) -> Self {
        Self { high: value, low: 0.0 }
    }

    /// Exact for integers below 2^106.
    pub(super) fn from_integer(value: u128) -> Self {
        let high = value as f64;
        let low = value.wrapping_sub(high as u128) as i128 as f64;
        Self { high, low }
    }

    pub(super) fn to_f64(self) -> f64 {
        self.high + self.low
    }

    fn normalized(high: f64, low: f64) -> Self {
        let sum = high + low;
        Self { high: sum, low: low - (sum - high) }
    }

    pub(super) fn add(self, other: Self) -> Self {
        let sum = self.high + other.high;
        let part = sum - self.high;
        let error = (self.high - (sum - part)) + (other.high - part);
        Self::normalized(sum, error + self.low + other.low)
    }

    pub(super) fn negated(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }

    pub(super) fn mul(self, other: Self) -> Self {
        let product = self.high * other.high;
        let error = self.high.mul_add(other.high, -product);
        Self::normalized(product, error + (self.high * other.low + self.low * other.high))
    }

    pub(super) fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self.add(other.mul(Self::from_f64(first)).negated());
        let second = rest.high / other.high;
        let rest = rest.add(other.mul(Self::from_f64(second)).negated());
        Self::normalized(first, second).add(Self::from_f64(rest.high / other.high))
    }

    pub(super) fn powi(self, exponent: u32) -> Self {
        let (mut result, mut square, mut left) = (Self::ONE, self, exponent);
        while left > 0 {
            if left & 1 == 1 {
                result = result.mul(square);
            }
            left >>= 1;
            if left > 0 {
                square = square.mul(square);
            }
        }
        result
    }

    /// value·10^exponent.
    pub(super) fn scaled_by_ten(self, exponent: i32) -> Self {
        let power = Self::TEN.powi(exponent.unsigned_abs());
        if exponent < 0 { self.div(power) } else { self.mul(power) }
    }
}

#[cfg(test)]
mod tests {
    use super::Twofold;

    #[test]
    fn keeps_106_bits() {
        let third = Twofold::ONE.div(Twofold::from_f64(3.0));
        let back = third.mul(Twofold::from_f64(3.0)).add(Twofold::ONE.negated());
        assert!(back.to_f64().abs() < 1e-31, "{back:?}");
        let big = 1_u128 << 105 | 1;
        let difference = Twofold::from_integer(big).add(Twofold::from_integer(1 << 105).negated());
        assert_eq!(difference.to_f64(), 1.0);
        assert_eq!(Twofold::TEN.powi(22).to_f64(), 1e22);
        assert_eq!(Twofold::from_f64(70.0).scaled_by_ten(-2).to_f64(), 0.7);
    }

    #[test]
    fn pi_is_right_to_106_bits() {
        // sin(π_high) = π − π_high, to the precision of the sine.
        assert_eq!(Twofold::PI.low, std::f64::consts::PI.sin());
    }
}
