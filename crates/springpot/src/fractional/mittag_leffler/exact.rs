//! ak + b with what rounding leaves of it: near whole numbers 1/Γ and the sine are all rounding without.

use crate::fractional::gamma::gamma;
use std::f64::consts::PI;

/// An unevaluated sum; |low| is at most half an ulp of high.
#[derive(Debug, Clone, Copy)]
pub(super) struct Exact {
    high: f64,
    low: f64,
}

impl Exact {
    /// ak + b.
    pub(super) fn new(a: f64, k: usize, b: f64) -> Self {
        let k = k as f64;
        let product = a * k;
        let lost = a.mul_add(k, -product);
        let high = product + b;
        let from_b = high - product;
        let low = (product - (high - from_b)) + (b - from_b) + lost;
        // Where product and b cancel, what was lost is all that remains.
        let sum = high + low;
        Self { high: sum, low: (high - sum) + low }
    }

    /// sin πx and cos πx, to a relative accuracy.
    pub(super) fn sin_cos_pi(self) -> (f64, f64) {
        let half = 0.5 * (2.0 * self.high).round();
        let (sine, cosine) = (PI * ((self.high - half) + self.low)).sin_cos();
        match (2.0 * half).rem_euclid(4.0) {
            0.0 => (sine, cosine),
            1.0 => (cosine, -sine),
            2.0 => (-sine, -cosine),
            _ => (-cosine, sine),
        }
    }

    /// 1/Γ(x), relatively accurate up to the zeros at 0, −1, …
    pub(super) fn reciprocal_gamma(self) -> f64 {
        if self.high >= 0.5 {
            return 1.0 / gamma(self.high);
        }
        self.sin_cos_pi().0 * gamma(1.0 - self.high) / PI
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_keep_their_distance() {
        // 1/Γ(−m + ε) = (−1)^m m! ε (1 − ψ(m+1) ε + …).
        for (m, factorial) in [(0usize, 1.0), (1, 1.0), (4, 24.0), (10, 3_628_800.0)] {
            for epsilon in [1e-9, -1e-12, 1e-200, 0.0] {
                // −m + ε may be no f64; the sum of both parts is.
                let x = Exact { high: -(m as f64), low: epsilon };
                let sign = if m % 2 == 0 { 1.0 } else { -1.0 };
                let expected = sign * factorial * epsilon;
                assert!((x.reciprocal_gamma() - expected).abs() <= 3e-9 * expected.abs(), "{m} {epsilon}");
            }
        }
        for (x, sine, cosine) in [
            (7.0, 0.0, -1.0),
            (-2.5, -1.0, 0.0),
            (0.25, 0.5f64.sqrt(), 0.5f64.sqrt()),
            (1.75, -0.5f64.sqrt(), 0.5f64.sqrt()),
        ] {
            let (s, c) = Exact::new(x, 1, 0.0).sin_cos_pi();
            assert!((s - sine).abs() < 2e-16 && (c - cosine).abs() < 2e-16, "{x}: {s} {c}");
        }
    }

    #[test]
    fn products_and_sums_are_exact() {
        // 0.1 is 0.1 + 5.551115123125783e-18.
        let x = Exact::new(0.1, 30, -3.0);
        assert_eq!((x.high + x.low, x.high), (30.0 * 5.551_115_123_125_783e-18, 30.0 * 5.551_115_123_125_783e-18));
        assert_eq!(Exact::new(1.0, 20, -20.0).reciprocal_gamma(), 0.0);
    }
}
