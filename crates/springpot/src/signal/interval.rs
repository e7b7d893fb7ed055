//! Intervals: bounds of what an expression does between two times.
//!
//! Bounds are those of real arithmetic up to rounding: ends are rounded to nearest, not outwards, since what is asked of them is
//! seen at 1e-12 and rounding is at 1e-16.

/// All numbers from `lo` to `hi`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Interval {
    pub(super) lo: f64,
    pub(super) hi: f64,
}

impl Interval {
    pub(super) const ZERO: Self = Self::point(0.0);
    /// Nothing is known.
    pub(super) const WHOLE: Self = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY };

    pub(super) const fn new(lo: f64, hi: f64) -> Self {
        Self { lo, hi }
    }

    pub(super) const fn point(value: f64) -> Self {
        Self { lo: value, hi: value }
    }

    /// From bounds of which one may be NaN: then nothing is known.
    fn of(lo: f64, hi: f64) -> Self {
        if lo <= hi { Self { lo, hi } } else { Self::WHOLE }
    }

    pub(super) fn is_zero(self) -> bool {
        self.lo == 0.0 && self.hi == 0.0
    }

    pub(super) fn contains_zero(self) -> bool {
        self.lo <= 0.0 && 0.0 <= self.hi
    }

    /// The largest absolute value.
    pub(super) fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// Half its width.
    pub(super) fn radius(self) -> f64 {
        0.5 * (self.hi - self.lo)
    }

    pub(super) fn hull(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// What both hold; `self` where rounding left nothing.
    pub(super) fn meet(self, other: Self) -> Self {
        let met = Self { lo: self.lo.max(other.lo), hi: self.hi.min(other.hi) };
        if met.lo <= met.hi { met } else { self }
    }

    pub(super) fn neg(self) -> Self {
        Self { lo: -self.hi, hi: -self.lo }
    }

    pub(super) fn add(self, other: Self) -> Self {
        Self::of(self.lo + other.lo, self.hi + other.hi)
    }

    pub(super) fn sub(self, other: Self) -> Self {
        self.add(other.neg())
    }

    pub(super) fn scale(self, factor: f64) -> Self {
        if factor >= 0.0 {
            Self { lo: times(self.lo, factor), hi: times(self.hi, factor) }
        } else {
            Self { lo: times(self.hi, factor), hi: times(self.lo, factor) }
        }
    }

    pub(super) fn mul(self, other: Self) -> Self {
        if self.lo == self.hi {
            return other.scale(self.lo);
        }
        if other.lo == other.hi {
            return self.scale(other.lo);
        }
        let corners =
            [times(self.lo, other.lo), times(self.lo, other.hi), times(self.hi, other.lo), times(self.hi, other.hi)];
        let lo = corners[0].min(corners[1]).min(corners[2].min(corners[3]));
        let hi = corners[0].max(corners[1]).max(corners[2].max(corners[3]));
        Self { lo, hi }
    }

    pub(super) fn square(self) -> Self {
        let (a, b) = (self.lo * self.lo, self.hi * self.hi);
        Self { lo: if self.contains_zero() { 0.0 } else { a.min(b) }, hi: a.max(b) }
    }

    pub(super) fn div(self, other: Self) -> Self {
        if self.is_zero() && !other.is_zero() {
            return Self::ZERO;
        }
        if other.contains_zero() {
            return Self::WHOLE;
        }
        self.mul(Self { lo: 1.0 / other.hi, hi: 1.0 / other.lo })
    }

    /// Of a function that rises.
    pub(super) fn rising(self, function: impl Fn(f64) -> f64) -> Self {
        Self::of(function(self.lo), function(self.hi))
    }

    pub(super) fn sin(self) -> Self {
        Self { lo: self.lo - std::f64::consts::FRAC_PI_2, hi: self.hi - std::f64::consts::FRAC_PI_2 }.cos()
    }

    pub(super) fn cos(self) -> Self {
        use std::f64::consts::{PI, TAU};
        let width = self.hi - self.lo;
        // Beyond 2^53 turns a double holds no phase.
        if !(width < TAU && self.magnitude() < 1e15) {
            return Self::new(-1.0, 1.0);
        }
        let (a, b) = (self.lo.cos(), self.hi.cos());
        let holds = |phase: f64| ((self.hi - phase) / TAU).floor() > ((self.lo - phase) / TAU).floor();
        Self { lo: if holds(PI) { -1.0 } else { a.min(b) }, hi: if holds(0.0) { 1.0 } else { a.max(b) } }
    }

    pub(super) fn cosh(self) -> Self {
        let (a, b) = (self.lo.cosh(), self.hi.cosh());
        Self::of(if self.contains_zero() { 1.0 } else { a.min(b) }, a.max(b))
    }
}

/// A product in which 0 wins over infinity, as bounds ask for.
fn times(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { 0.0 } else { a * b }
}

#[cfg(test)]
mod tests {
    use super::Interval;

    #[test]
    fn products_and_quotients_bound_all_their_corners() {
        let ends = [-3.0, -1.0, -0.5, 0.0, 0.25, 2.0];
        for (a, b) in ends.iter().flat_map(|a| ends.iter().map(move |b| (*a, *b))).filter(|(a, b)| a <= b) {
            for (c, d) in ends.iter().flat_map(|c| ends.iter().map(move |d| (*c, *d))).filter(|(c, d)| c <= d) {
                let (x, y) = (Interval::new(a, b), Interval::new(c, d));
                for (p, q) in [(a, c), (a, d), (b, c), (b, d), (0.5 * (a + b), 0.5 * (c + d))] {
                    let product = x.mul(y);
                    assert!(product.lo <= p * q && p * q <= product.hi);
                    let quotient = x.div(y);
                    assert!(q == 0.0 || (quotient.lo <= p / q && p / q <= quotient.hi), "{x:?} {y:?} {quotient:?}");
                }
            }
        }
    }

    #[test]
    fn waves_reach_their_crests_inside() {
        for k in 0..400 {
            let (lo, width) = (-20.0 + 0.1 * f64::from(k), 0.05 * f64::from(k % 150));
            let (sine, cosine) = (Interval::new(lo, lo + width).sin(), Interval::new(lo, lo + width).cos());
            for i in 0..=50 {
                let x = lo + width * f64::from(i) / 50.0;
                assert!(sine.lo <= x.sin() + 1e-14 && x.sin() <= sine.hi + 1e-14, "{lo} {width} {x}");
                assert!(cosine.lo <= x.cos() + 1e-14 && x.cos() <= cosine.hi + 1e-14, "{lo} {width} {x}");
            }
            if width < 1.0 {
                assert!(cosine.radius() <= 0.5 * width + 1e-15);
            }
        }
    }
}
