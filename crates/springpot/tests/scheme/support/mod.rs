//! Reference derivatives of testdata/fractional/derivatives.json.

use serde_json::Value;
use springpot::fractional::Kind;

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
