//! Reference derivatives of testdata/fractional/derivatives.json, schemes, grids and closed forms.

use serde_json::Value;
use springpot::fractional::Kind;
use springpot::fractional::gamma::{gamma, reciprocal_gamma};
use springpot::fractional::scheme::{Samples, Scheme};

pub(crate) const KINDS: [Kind; 2] = [Kind::Caputo, Kind::RiemannLiouville];

/// One reference value of a named function.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reference {
    pub(crate) t: f64,
    pub(crate) alpha: f64,
    pub(crate) caputo: f64,
    pub(crate) rl: f64,
}

impl Reference {
    pub(crate) fn value(&self, kind: Kind) -> f64 {
        match kind {
            Kind::Caputo => self.caputo,
            Kind::RiemannLiouville => self.rl,
        }
    }
}

pub(crate) fn file() -> Value {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/fractional/derivatives.json");
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

pub(crate) fn number(row: &Value, key: &str) -> f64 {
    row[key].as_str().unwrap().parse().unwrap()
}

/// All rows of one function.
pub(crate) fn references(file: &Value, function: &str) -> Vec<Reference> {
    let rows = file["functions"][function].as_array().unwrap();
    let read = |row: &Value| Reference {
        t: number(row, "t"),
        alpha: number(row, "alpha"),
        caputo: number(row, "caputo"),
        rl: number(row, "rl"),
    };
    rows.iter().map(read).collect()
}

/// Riemann–Liouville derivative of sin ωt, −1 < order < 2, at any t > 0.
///
/// The poles of s^a ω/(s² + ω²) give the steady state, its branch cut an integral over decays:
/// ω^a sin(ωt + aπ/2) − sin(πa)/π ∫₀^∞ r^a ω/(r² + ω²) e^−rt dr, r = e^y, by the trapezoidal rule in y.
pub(crate) fn derivative_of_sine(t: f64, omega: f64, order: f64) -> f64 {
    let pi = std::f64::consts::PI;
    let (spacing, least) = (0.2, -40.0 / (order + 1.0));
    let points = ((8.0 - least) / spacing) as i32;
    let decays = (0..points).map(|k| {
        let r = (least + spacing * f64::from(k)).exp();
        r.powf(order + 1.0) * omega / (r * r + omega * omega) * (-r * t).exp()
    });
    let fade = (pi * order).sin() / pi * spacing * decays.sum::<f64>();
    omega.powf(order) * (omega * t + 0.5 * pi * order).sin() - fade
}

pub(crate) fn derivative(scheme: Scheme, t: &[f64], x: &[f64], alpha: f64, kind: Kind) -> Vec<f64> {
    scheme.differentiate(&Samples { t, x, rate: None }, alpha, kind).unwrap()
}

pub(crate) fn all_schemes() -> Vec<Scheme> {
    let plain = [
        Scheme::GrunwaldLetnikov,
        Scheme::ShortGrunwaldLetnikov(30),
        Scheme::L1,
        Scheme::L12,
        Scheme::Expansion2004(40),
        Scheme::Expansion2008(40),
    ];
    (1..=6).map(Scheme::Fbdf).chain(plain).collect()
}

pub(crate) fn any_grid_schemes() -> [Scheme; 4] {
    [Scheme::L1, Scheme::L12, Scheme::Expansion2004(40), Scheme::Expansion2008(40)]
}

/// D^alpha t^k; with Caputo 0 for k < alpha.
pub(crate) fn power(k: f64, t: f64, alpha: f64, kind: Kind) -> f64 {
    if kind == Kind::Caputo && k < alpha.ceil() {
        return 0.0;
    }
    gamma(k + 1.0) * reciprocal_gamma(k + 1.0 - alpha) * t.powf(k - alpha)
}

/// A grid without any two equal steps.
pub(crate) fn uneven(steps: usize) -> Vec<f64> {
    (0..=steps).map(|k| k as f64 * 0.01 + 0.004 * (1.3 * k as f64).sin()).collect()
}

pub(crate) fn uniform(steps: usize) -> Vec<f64> {
    (0..=steps).map(|k| k as f64 * 0.01).collect()
}

pub(crate) fn assert_close(got: &[f64], wanted: impl IntoIterator<Item = f64>, tolerance: f64, what: &str) {
    let mut count = 0;
    for (n, (got, wanted)) in got.iter().zip(wanted).enumerate().skip(1) {
        assert!((got - wanted).abs() <= tolerance, "{what}, row {n}: {got} instead of {wanted}");
        count += 1;
    }
    assert_eq!(count, got.len() - 1, "{what}");
}
