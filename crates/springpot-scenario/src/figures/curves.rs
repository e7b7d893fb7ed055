//! Curves: columns over a column.

use super::columns::{ColumnGlob, glob, globs};
use super::{FigureKind, PLANE, Reading};
use crate::keys::{Key, Need, Shape, key};
use crate::reader::Read;
use serde_json::{Map, Value, json};

/// Its word in `kind`.
pub(super) const WORD: &str = "curves";

pub(super) const Y: Key = key(
    "y",
    Shape::Columns,
    Need::Required("y = [\"strut.Q.q2\"]: the columns to draw"),
    "A column, a glob such as \"strut.Q.*\", or an array of them; of a summary statistics such as \"max(strut.force)\", of a map a swept path.",
)
.only(&PLANE);

/// Reads it.
pub(super) fn read(reading: &Reading<'_>) -> Read<FigureKind> {
    let Reading { table, item, .. } = reading;
    let x = match table.get("x") {
        Some(field) => glob(&field),
        None => Ok(ColumnGlob { text: "t".to_owned(), place: item.node.place.clone() }),
    };
    let y = table.require("y").and_then(|field| globs(&field));
    Ok(FigureKind::Curves { x: x?, y: y? })
}

/// What run.json says of it.
pub(super) fn record(x: &ColumnGlob, y: &[ColumnGlob]) -> Map<String, Value> {
    let y: Value = y.iter().map(|glob| glob.text.clone()).collect();
    Map::from_iter([("x".to_owned(), json!(x.text)), ("y".to_owned(), y)])
}
