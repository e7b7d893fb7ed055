//! Reference files of testdata.

use serde_json::Value;

/// A file of testdata.
pub(crate) fn file(path: &str) -> Value {
    let path = format!("{}/../../testdata/{path}", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// A number of a file: there they are texts of many digits.
pub(crate) fn number(value: &Value) -> f64 {
    value.as_str().unwrap_or_else(|| panic!("{value} is no text")).parse().unwrap()
}

/// An array of numbers.
pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(number).collect()
}

/// Column `index` of an array of arrays.
pub(crate) fn column(value: &Value, index: usize) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|row| number(&row[index])).collect()
}
