//! Functions with their reference values, and what tests do to samples.

use serde_json::Value;
use springpot::fractional::gamma::{gamma, reciprocal_gamma};
use springpot::fractional::scheme::Samples;
use springpot::fractional::{Definition, Method, derivative};

pub(crate) type Function = fn(f64) -> f64;

/// The functions of testdata/fractional/{derivatives, orders}.json.
pub(crate) const FUNCTIONS: [(&str, Function); 5] = [
    ("0.7*sin(8t)+0.1*t", |t| 0.7 * (8.0 * t).sin() + 0.1 * t),
    ("1+sin(3t)", |t| 1.0 + (3.0 * t).sin()),
    ("cos(3t)", |t| (3.0 * t).cos()),
    ("exp(-t)", |t| (-t).exp()),
    ("exp(-0.3t)*cos(5t)", |t| (-0.3 * t).exp() * (5.0 * t).cos()),
];

/// D^order of one function at one time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reference {
    pub(crate) t: f64,
    pub(crate) order: f64,
    caputo: f64,
    rl: f64,
}

impl Reference {
    pub(crate) fn value(&self, definition: Definition) -> f64 {
        if definition == Definition::Caputo { self.caputo } else { self.rl }
    }
}

/// All rows of both files for one function, grouped by order.
pub(crate) fn references(function: &str) -> Vec<Vec<Reference>> {
    let mut groups: Vec<Vec<Reference>> = Vec::new();
    for (file, key) in [("derivatives", "alpha"), ("orders", "order")] {
        let path = format!("{}/../../testdata/fractional/{file}.json", env!("CARGO_MANIFEST_DIR"));
        let file: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
        for row in file["functions"][function].as_array().into_iter().flatten() {
            let number = |key: &str| {
                row[key].as_str().map_or_else(|| row[key].as_f64().unwrap(), |text| text.parse::<f64>().unwrap())
            };
            let (t, order, caputo, rl) = (number("t"), number(key), number("caputo"), number("rl"));
            let row = Reference { t, order, caputo, rl };
            match groups.iter_mut().find(|group| group[0].order == order) {
                Some(group) => group.push(row),
                None => groups.push(vec![row]),
            }
        }
    }
    groups
}

/// `count` + 1 equal steps up to `end`.
pub(crate) fn even(count: usize, end: f64) -> Vec<f64> {
    (0..=count).map(|k| end * k as f64 / count as f64).collect()
}

/// `count` + 1 times up to `end` with random gaps, a few of them a thousand times shorter than the rest.
pub(crate) fn uneven(count: usize, end: f64, seed: u64) -> Vec<f64> {
    let mut random = Random(seed);
    let mut t = vec![0.0];
    for k in 0..count {
        let gap = 0.5 + random.next();
        t.push(t[k] + if k % 37 == 20 { 1e-3 * gap } else { gap });
    }
    let scale = end / t[count];
    t.iter().map(|t| t * scale).collect()
}

/// A linear congruential generator of numbers in [0, 1) (D. Knuth's MMIX).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

pub(crate) fn of(t: &[f64], x: &[f64], order: f64, definition: Definition, method: Method) -> Vec<f64> {
    derivative(&Samples { t, x, rate: None }, order, definition, method).unwrap()
}

/// Riemann–Liouville D^order t^power.
pub(crate) fn of_power(power: f64, order: f64, t: f64) -> f64 {
    gamma(power + 1.0) * reciprocal_gamma(power + 1.0 - order) * t.powf(power - order)
}

pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().filter(|v| !v.is_nan()).fold(0.0, |largest, v| largest.max(v.abs()))
}

/// max |a − b|/max |b| over the rows where b is a number.
pub(crate) fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let rows = a.iter().zip(b).filter(|(_, b)| !b.is_nan());
    rows.map(|(a, b)| (a - b).abs()).fold(0.0, |m: f64, d| if d > m || d.is_nan() { d } else { m }) / largest(b)
}

/// Orders of every kind: both limits, near integers, integers.
pub(crate) const ORDERS: [f64; 15] =
    [-2.0, -1.7, -1.0, -0.99, -0.5, -0.01, 0.0, 0.01, 0.5, 0.99, 1.0, 1.01, 1.5, 1.99, 2.0];
