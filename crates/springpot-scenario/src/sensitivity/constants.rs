//! What follows from a constant: other constants, numbers and functions of time.

use super::gather::Slope;
use crate::changes::path::Step;
use crate::text::document::{Node, Value};
use crate::units::{self, Unit};
use springpot::signal::{Expression, Signal, Slope as SignalSlope, SlopeError};

/// Sections that say nothing to the equations at a time t.
const SILENT: [&str; 9] =
    ["title", "constants", "sweep", "figure", "output", "parameter", "sensitivity", "data", "fit"];

/// Sections that say which rows there are and what is made of them.
const OF_ROWS: [&str; 3] = ["time", "solver", "metric"];

/// Keys whose texts are no expressions.
const TEXTS: [&str; 21] = [
    "name",
    "of",
    "body",
    "parent",
    "joint",
    "kind",
    "law",
    "network",
    "derivative",
    "scheme",
    "past",
    "unit",
    "csv",
    "column",
    "time",
    "time_unit",
    "separator",
    "outside",
    "urdf",
    "mjcf",
    "direction",
];

/// Name, value and slope of every constant.
pub(crate) type Constants = Vec<(String, f64, f64)>;

/// By how much each constant changes with the one called `name`, where they have these values.
///
/// # Errors
/// An expression that has no derivative.
pub(crate) fn slopes(document: &Node, name: &str, values: &[(String, f64)]) -> Result<Constants, String> {
    let mut constants = Constants::new();
    let entries = document.get("constants").and_then(|constants| constants.entries()).unwrap_or_default();
    for (entry, (_, value)) in entries.iter().zip(values) {
        let slope = match entry.node.get("expression").and_then(|text| text.text()) {
            _ if entry.key == name => 1.0,
            Some(text) => number(text, entry.node.get("unit"), &constants)
                .map_err(|error| format!("`constants.{}` follows from it, and {error}", entry.key))?,
            None => 0.0,
        };
        constants.push((entry.key.clone(), *value, slope));
    }
    Ok(constants)
}

/// The derivative of a number that is an expression.
fn number(text: &str, unit: Option<&std::sync::Arc<Node>>, constants: &Constants) -> Result<f64, SlopeError> {
    let slope = Expression::slope(text, constants)?;
    if !slope.jumps.is_empty() {
        return Err(SlopeError::Switch { function: "step" });
    }
    Ok(slope.function.value(0.0) * scale(unit))
}

fn scale(unit: Option<&std::sync::Arc<Node>>) -> f64 {
    let unit = unit.and_then(|unit| Unit::parse(unit.text()?, &|_| None).ok());
    unit.map_or(1.0, |unit| unit.scale())
}

/// Everything that changes with `constants`: where it stands, and by how much, or why nobody knows.
pub(crate) fn followers(document: &Node, constants: &Constants) -> Vec<(Vec<Step>, Result<Slope, String>)> {
    let mut found = Vec::new();
    for entry in document.entries().unwrap_or_default() {
        if SILENT.contains(&entry.key.as_str()) {
            continue;
        }
        let first = found.len();
        below(&entry.node, &mut vec![Step::Key(entry.key.clone())], constants, &mut found);
        if OF_ROWS.contains(&entry.key.as_str()) {
            let why = "derivatives are those of rows and metrics that stay what they are";
            found[first..].iter_mut().for_each(|(_, slope)| *slope = Err(why.to_owned()));
        }
    }
    found
}

fn below(
    node: &Node,
    walked: &mut Vec<Step>,
    constants: &Constants,
    found: &mut Vec<(Vec<Step>, Result<Slope, String>)>,
) {
    match &node.value {
        Value::Table(entries) => {
            if let Some(text) = node.get("expression").and_then(|text| text.text())
                && names(text, constants)
            {
                found.push((walked.clone(), slope(text, node.get("unit"), constants)));
            }
            let is_other = |key: &str| !TEXTS.contains(&key) && key != "expression";
            for entry in entries.iter().filter(|entry| is_other(&entry.key) || entry.node.text().is_none()) {
                walked.push(Step::Key(entry.key.clone()));
                below(&entry.node, walked, constants, found);
                walked.pop();
            }
        }
        Value::Array(items) => {
            for (k, item) in items.iter().enumerate() {
                walked.push(Step::Index(k));
                below(item, walked, constants, found);
                walked.pop();
            }
        }
        // Units are no constants.
        Value::Text(text) if units::split_quantity(text).is_some() => {}
        Value::Text(text) if names(text, constants) => found.push((walked.clone(), slope(text, None, constants))),
        _ => {}
    }
}

/// Whether a text names a constant that changes.
fn names(text: &str, constants: &Constants) -> bool {
    let words = text.split(|c: char| !(c.is_alphanumeric() || c == '_'));
    words.into_iter().any(|word| constants.iter().any(|(name, _, slope)| name == word && *slope != 0.0))
}

fn slope(text: &str, unit: Option<&std::sync::Arc<Node>>, constants: &Constants) -> Result<Slope, String> {
    let slope = match Expression::slope(text, constants) {
        Ok(slope) => slope,
        Err(SlopeError::Expression(_)) => return Ok(Slope::Feedback(constants.clone())),
        Err(other) => return Err(other.to_string()),
    };
    let scale = scale(unit);
    let SignalSlope { function, jumps } = slope;
    let slope = match function.is_constant().filter(|_| jumps.is_empty()) {
        Some(value) => Slope::Number(value * scale),
        None => Slope::Signal { by: Signal::scaled(Signal::expression(function), scale, 0.0), jumps },
    };
    match &slope {
        Slope::Number(value) if !value.is_finite() => Err(format!("its derivative is {value}")),
        _ => Ok(slope),
    }
}
