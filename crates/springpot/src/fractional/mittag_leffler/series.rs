//! The power series for small arguments, where every digit counts: near zeros of 1/Γ(b) the value is as small as z.

use super::Complex64;
use crate::fractional::gamma::reciprocal_gamma;

/// Number of terms: 0.05²⁰ is below rounding even against the coefficients of tenth derivatives.
const TERMS: usize = 20;

/// Σ_k (k+n)!/k! z^k/Γ(a(k + n) + b).
#[derive(Debug, Clone, Copy)]
pub(super) struct Series {
    coefficients: [f64; TERMS],
}

impl Series {
    /// Largest |z| for which the series is taken.
    pub(super) const REACH: f64 = 0.05;

    pub(super) fn new(a: f64, b: f64, n: usize) -> Self {
        let coefficients = std::array::from_fn(|k| {
            let factor: f64 = (k + 1..=k + n).map(|j| j as f64).product();
            factor * reciprocal_gamma(a * (k + n) as f64 + b)
        });
        Self { coefficients }
    }

    pub(super) fn real(&self, x: f64) -> f64 {
        self.coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
    }

    pub(super) fn complex(&self, z: Complex64) -> Complex64 {
        self.coefficients.iter().rev().fold(Complex64::ZERO, |sum, c| sum * z + c)
    }
}
