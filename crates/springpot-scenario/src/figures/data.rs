//! `data` of a figure: measured points from a CSV file.

use super::curves::WORD;
use crate::csv::{self, CsvProblem};
use crate::keys::{Key, Keys, Need, SEPARATOR, Shape, key};
use crate::reader::{Field, Read, all};
use crate::text::document::shorten;
use crate::text::refusal::{Place, RefusalKind};
use crate::units::Unit;
use serde_json::{Value, json};

/// Most rows of a file of points.
const MAX_POINTS: usize = 100_000;

pub(super) const DATA: Key =
    key("data", Shape::TableOrTables(&POINTS), Need::Optional, "Measured points beside the columns.").only(&[WORD]);

pub(crate) static POINTS: Keys = Keys {
    words: "Points from the columns of a CSV file.",
    keys: &[
        key("csv", Shape::Text, Need::Written("csv = \"FILE\""), "The file, relative to the scenario."),
        key("x", Shape::Text, Need::Written("x = \"COLUMN\""), "Name of the column of the abscissae."),
        key("y", Shape::Text, Need::Written("y = \"COLUMN\""), "Name of the column of the ordinates."),
        key("label", Shape::Text, Need::Said("the name in `y`"), "What the legend calls them."),
        key(
            "x_unit",
            Shape::Text,
            Need::Said("that in brackets behind the name, else SI"),
            "Unit of the abscissae in the file.",
        ),
        key(
            "y_unit",
            Shape::Text,
            Need::Said("that in brackets behind the name, else SI"),
            "Unit of the ordinates in the file.",
        ),
        SEPARATOR,
    ],
};

/// Measured points.
#[derive(Debug, Clone, PartialEq)]
pub struct FigurePoints {
    /// What the legend calls them.
    pub label: String,
    /// Abscissae.
    pub x: FigureNumbers,
    /// Ordinates.
    pub y: FigureNumbers,
    /// The file as written.
    csv: String,
}

/// A column of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct FigureNumbers {
    /// Its name.
    column: String,
    /// As they stand there.
    pub numbers: Vec<f64>,
    /// Their unit; `None`: SI of what they are drawn beside.
    pub unit: Option<Unit>,
    /// Where the unit stands; the name of the column where there is none.
    pub place: Place,
}

/// Reads `data`: one table or several.
pub(super) fn read(field: &Field<'_>) -> Read<Vec<FigurePoints>> {
    match field.node.entries() {
        Some(_) => points(field).map(|points| vec![points]),
        None => all(field.items("a table with csv, x, y, or an array of such tables")?.iter().map(points)),
    }
}

fn points(field: &Field<'_>) -> Read<FigurePoints> {
    let table = field.table(&POINTS)?;
    let [file, x, y] = ["csv", "x", "y"].map(|key| table.require(key).and_then(|field| Ok((field.text()?, field))));
    let units = ["x_unit", "y_unit"].map(|key| table.get(key).map(|field| unit(&field)).transpose());
    let label = table.get("label").map(|field| field.text()).transpose();
    let separator = table.word("separator", "separator")?.chars().next().unwrap_or(',');
    let ((name, file), (x, x_field), (y, y_field), label) = (file?, x?, y?, label?);
    let [x_unit, y_unit] = units;
    let x_unit = x_unit.and_then(|unit| unit.map_or_else(|| told(&x_field, "x_unit"), |unit| Ok(Some(unit))));
    let y_unit = y_unit.and_then(|unit| unit.map_or_else(|| told(&y_field, "y_unit"), |unit| Ok(Some(unit))));
    let (x_unit, y_unit) = (x_unit?, y_unit?);
    let path = field.ctx.folder.join(name);
    let columns = csv::separated_columns(&path, &[x, y], (MAX_POINTS, separator)).map_err(|error| {
        let (at, help) = match &error.problem {
            CsvProblem::OtherSeparator { separator, .. } => (&file, Some(format!("write separator = {separator:?}"))),
            CsvProblem::MissingColumn { name, .. } if name == x => (&x_field, None),
            CsvProblem::MissingColumn { .. } => (&y_field, None),
            _ => (&file, Some("write the path of a CSV file, relative to the scenario".to_owned())),
        };
        at.refuse(RefusalKind::File, format!("cannot be read: {error}"), help)
    })?;
    let place =
        |key: &str, column: &Field<'_>| table.node.get(key).map_or(&column.node.place, |unit| &unit.place).clone();
    let [along, up] = <[Vec<f64>; 2]>::try_from(columns).unwrap_or_default();
    let x = FigureNumbers { column: x.to_owned(), numbers: along, unit: x_unit, place: place("x_unit", &x_field) };
    let y_numbers = FigureNumbers { column: y.to_owned(), numbers: up, unit: y_unit, place: place("y_unit", &y_field) };
    Ok(FigurePoints { label: label.unwrap_or(y).to_owned(), x, y: y_numbers, csv: name.to_owned() })
}

/// The unit that the name of a column tells, `t [ms]`; `key` is where it stands else.
fn told(column: &Field<'_>, key: &str) -> Read<Option<Unit>> {
    let Some((_, text)) = csv::bracket(column.text()?) else { return Ok(None) };
    match Unit::parse(text, &|_| None) {
        Ok(unit) => Ok(Some(unit)),
        // An index is no unit.
        Err(_) if !text.contains(char::is_alphabetic) => Ok(None),
        Err(error) => {
            let message = format!("is {:?}, and its brackets tell no unit: {error}", shorten(column.text()?));
            let help = format!("say the unit, as in {key} = \"ms\"; {key} = \"1\" is none");
            Err(column.refuse(RefusalKind::BadQuantity, message, Some(help)))
        }
    }
}

fn unit(field: &Field<'_>) -> Read<Unit> {
    let text = field.text()?;
    Unit::parse(text, &|_| None).map_err(|error| {
        let place = field.node.place_in_text(error.span());
        let message = format!("{field} is {:?}: {error}", shorten(text));
        field.ctx.refuse(place.refuse(RefusalKind::BadQuantity, message).help("write a unit such as mm"))
    })
}

impl FigurePoints {
    /// What run.json says of them.
    pub(super) fn record(&self) -> Value {
        json!({ "csv": self.csv, "x": self.x.column, "y": self.y.column, "label": self.label, "points": self.x.numbers.len() })
    }
}
