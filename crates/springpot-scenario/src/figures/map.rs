//! A number of every case over two swept parameters, in coloured cells.

use super::summary::{self, Summarised, SweptAxis};
use super::{FigureKind, Reading, Selection};
use crate::changes::sweep::Axis;
use crate::keys::{Key, Need, Shape, key};
use crate::reader::Read;
use serde_json::{Map, Value, json};

/// Its word in `kind`.
pub(super) const WORD: &str = "map";

pub(super) const Z: Key = key(
    "z",
    Shape::Column,
    Need::Required("z = \"metric(NAME)\": what the colours say"),
    "What the colours of a map say: \"metric(NAME)\", or a statistic such as \"max(strut.force)\".",
)
.only(&[WORD]);

/// Reads it.
pub(super) fn read(reading: &Reading<'_>) -> Read<FigureKind> {
    let table = reading.table;
    let right = |key: &str| format!("{key} = \"element.NAME.PARAMETER\": a swept path");
    let axis =
        |key: &'static str| table.require_with(key, &right(key)).and_then(|field| summary::swept(reading, &field));
    let (x, y) = (axis("x"), axis("y"));
    let z = table.require("z").and_then(|field| summary::one(reading, &field));
    Ok(FigureKind::Map { x: x?, y: y?, z: z? })
}

/// Why x and y make no plane of cells of these sweeps, and what would be right.
pub(super) fn fault(x: &SweptAxis, y: &SweptAxis, axes: &[Axis], selection: &[Selection]) -> Option<(String, String)> {
    if x.axis == y.axis {
        let why = format!("{} and {} are swept together, and a map takes two sweeps", x.path, y.path);
        return Some((why, "write each in a [[sweep]] of its own".to_owned()));
    }
    let is_open =
        |axis: &usize| ![x.axis, y.axis].contains(axis) && selection.iter().all(|chosen| chosen.axis != *axis);
    let open = (0..axes.len()).find(is_open)?;
    let path = axes[open].targets.first().map_or("", |target| &target.written);
    Some((
        format!("{path} is swept too, and a map shows one value of it"),
        format!("choose it: where = {{ {path:?} = VALUE }}"),
    ))
}

/// What run.json says of it.
pub(super) fn record(x: &SweptAxis, y: &SweptAxis, z: &Summarised) -> Map<String, Value> {
    [("x", json!(x.path)), ("y", json!(y.path)), ("z", json!(z.written()))]
        .map(|(key, value)| (key.to_owned(), value))
        .into_iter()
        .collect()
}
