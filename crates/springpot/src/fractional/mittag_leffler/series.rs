//! The power series for small arguments, where every digit counts: near zeros of 1/Γ(b) the value is as small as z.

use super::Complex64;
use super::exact::Exact;

/// Number of terms: 0.05²⁰ is below rounding even against the coefficients of tenth derivatives.
const TERMS: usize = 20;

/// Number of terms where the series goes as far as it can.
const MOST_TERMS: usize = 64;

/// Σ_k (k+n)!/k! z^k/Γ(a(k + n) + b).
#[derive(Debug, Clone)]
pub(super) struct Series {
    coefficients: [f64; TERMS],
}

impl Series {
    /// Largest |z| for which the series is taken.
    pub(super) const REACH: f64 = 0.05;

    pub(super) fn new(a: f64, b: f64, n: usize) -> Self {
        Self { coefficients: std::array::from_fn(|k| coefficient(a, b, n, k)) }
    }

    pub(super) fn real(&self, x: f64) -> f64 {
        self.coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
    }

    pub(super) fn complex(&self, z: Complex64) -> Complex64 {
        self.coefficients.iter().rev().fold(Complex64::ZERO, |sum, c| sum * z + c)
    }
}

/// The series with as many terms as may serve, for as far as it loses no digits: the smaller z^{1/a}, the better.
#[derive(Debug, Clone)]
pub(super) struct LongSeries {
    coefficients: Vec<f64>,
}

impl LongSeries {
    pub(super) fn new(a: f64, b: f64, n: usize) -> Self {
        Self { coefficients: (0..MOST_TERMS).map(|k| coefficient(a, b, n, k)).collect() }
    }

    /// The value where rounding and the terms left out stay some times below 1e-12·max(|value|, 1e-3).
    pub(super) fn value(&self, z: Complex64) -> Option<Complex64> {
        let radius = z.norm();
        let last = self.coefficients[MOST_TERMS - 1].abs() * radius.powi(MOST_TERMS as i32 - 1);
        let (mut value, mut size) = (Complex64::ZERO, 0.0);
        for c in self.coefficients.iter().rev() {
            value = value * z + c;
            size = size * radius + c.abs();
        }
        let least = value.norm().max(1e-3);
        let met = size.is_finite() && size <= 300.0 * least && last <= 1e-15 * least;
        met.then_some(value)
    }
}

fn coefficient(a: f64, b: f64, n: usize, k: usize) -> f64 {
    let factor: f64 = (k + 1..=k + n).map(|j| j as f64).product();
    factor * Exact::new(a, k + n, b).reciprocal_gamma()
}
