//! A statistic of columns over a swept parameter.

use super::columns::ColumnGlob;
use super::{FigureKind, Reading};
use crate::changes::path;
use crate::keys::{Key, Need, Shape, key};
use crate::reader::{Field, Read, all};
use crate::text::names;
use crate::text::refusal::RefusalKind;
use serde_json::{Map, Value, json};

/// Its word in `kind`.
pub(super) const WORD: &str = "summary";

/// What is drawn of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Statistic {
    /// Smallest value.
    Min,
    /// Largest value.
    Max,
    /// Mean over the rows.
    Mean,
    /// Root mean square over the rows.
    Rms,
    /// Value of the last row.
    Final,
}

impl Statistic {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Min, Self::Max, Self::Mean, Self::Rms, Self::Final];

    /// What stands before the parenthesis.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Min => "min",
            Self::Max => "max",
            Self::Mean => "mean",
            Self::Rms => "rms",
            Self::Final => "final",
        }
    }
}

/// What stands at y.
#[derive(Debug, Clone, PartialEq)]
pub enum Summarised {
    /// A statistic of columns.
    Columns {
        /// What of them.
        statistic: Statistic,
        /// The columns.
        columns: ColumnGlob,
    },
    /// The metric of this name.
    Metric(String),
}

/// What stands before the parenthesis of a metric.
const METRIC: &str = "metric";

impl Summarised {
    /// As a scenario has it.
    pub fn written(&self) -> String {
        match self {
            Self::Columns { statistic, columns } => format!("{}({})", statistic.name(), columns.text),
            Self::Metric(name) => format!("{METRIC}({name})"),
        }
    }
}

/// The sweep whose values are the abscissae.
#[derive(Debug, Clone, PartialEq)]
pub struct SweptAxis {
    /// Index of the `[[sweep]]`.
    pub axis: usize,
    /// Index of the path among those that it moves.
    pub target: usize,
    /// The path.
    pub path: String,
}

pub(super) const X: Key =
    key("x", Shape::Column, Need::Word("t"), "Column of the abscissa; of a summary and a map a swept path.");

/// Reads it.
pub(super) fn read(reading: &Reading<'_>) -> Read<FigureKind> {
    let table = reading.table;
    let right = "x = \"element.NAME.PARAMETER\": a swept path";
    let x = table.require_with("x", right).and_then(|field| swept(reading, &field));
    let y = table.require_with("y", "y = \"max(strut.force)\"").and_then(|field| summarised(reading, &field));
    Ok(FigureKind::Summary { x: x?, y: y? })
}

pub(super) fn swept(reading: &Reading<'_>, field: &Field<'_>) -> Read<SweptAxis> {
    let wanted = path::resolve(field.ctx, reading.root.node, field.text()?, &field.node.place)?;
    let targets = || {
        let axes = reading.axes.iter().enumerate();
        axes.flat_map(|(axis, swept)| swept.targets.iter().enumerate().map(move |(at, target)| (axis, at, target)))
    };
    if let Some((axis, target, _)) = targets().find(|(_, _, target)| target.steps == wanted.steps) {
        return Ok(SweptAxis { axis, target, path: wanted.written });
    }
    let swept: Vec<&str> = targets().map(|(_, _, target)| target.written.as_str()).collect();
    let help = match names::nearest(&wanted.written, swept.iter().copied()) {
        Some(right) => format!("did you mean `{right}`?"),
        None if swept.is_empty() => "nothing is swept: a summary needs a [[sweep]]".to_owned(),
        None => format!("swept: {}", names::list(swept)),
    };
    let message = format!("is {}, which is not swept", wanted.written);
    Err(field.refuse(RefusalKind::UnknownName, message, Some(help)))
}

fn summarised(reading: &Reading<'_>, field: &Field<'_>) -> Read<Vec<Summarised>> {
    if field.node.text().is_some() {
        return one(reading, field).map(|one| vec![one]);
    }
    let items = field.items("a statistic such as \"max(strut.force)\" or an array of them")?;
    if items.is_empty() {
        let help = "write statistics, as in [\"max(strut.force)\"]".to_owned();
        return Err(field.refuse(RefusalKind::Missing, "is empty", Some(help)));
    }
    all(items.iter().map(|item| one(reading, item)))
}

pub(super) fn one(reading: &Reading<'_>, field: &Field<'_>) -> Read<Summarised> {
    let text = field.text()?.trim();
    let choices = Statistic::ALL.map(Statistic::name);
    let Some((name, column)) = text.strip_suffix(')').and_then(|text| text.split_once('(')) else {
        let message = format!("is {}, which is no statistic of a column", field.node.written());
        let help =
            format!("write \"max({text})\": {} of a column", names::either(choices.into_iter().map(str::to_owned)));
        return Err(field.refuse(RefusalKind::BadName, message, Some(help)));
    };
    let (name, column) = (name.trim(), column.trim());
    if name == METRIC {
        return metric(reading, field, column).map(Summarised::Metric);
    }
    let Some(statistic) = Statistic::ALL.into_iter().find(|statistic| statistic.name() == name) else {
        let message = format!("is {text:?}: {name:?} is no statistic");
        return Err(field.refuse(
            RefusalKind::UnknownName,
            message,
            Some(names::suggest(name, choices.into_iter().chain([METRIC]))),
        ));
    };
    if column.is_empty() {
        let help = format!("write the name of a column, as in \"{name}(strut.force)\"");
        return Err(field.refuse(RefusalKind::Missing, format!("is {text:?}: there is no column"), Some(help)));
    }
    Ok(Summarised::Columns {
        statistic,
        columns: ColumnGlob { text: column.to_owned(), place: field.node.place.clone() },
    })
}

/// The name of a metric, which there is.
fn metric(reading: &Reading<'_>, field: &Field<'_>, name: &str) -> Read<String> {
    let metrics = reading.root.node.get("metric").and_then(|metrics| metrics.items()).unwrap_or_default();
    let names = || metrics.iter().filter_map(|metric| metric.get("name")?.text());
    if names().any(|known| known == name) {
        return Ok(name.to_owned());
    }
    let help = match names().next() {
        None => "there is none yet: write a [[metric]] with this name".to_owned(),
        Some(_) => names::suggest(name, names()),
    };
    Err(field.refuse(
        RefusalKind::UnknownName,
        format!("is {:?}: no metric has this name", field.node.label()),
        Some(help),
    ))
}

/// What run.json says of it.
pub(super) fn record(x: &SweptAxis, y: &[Summarised]) -> Map<String, Value> {
    let y: Value = y.iter().map(Summarised::written).collect();
    Map::from_iter([("x".to_owned(), json!(x.path)), ("y".to_owned(), y)])
}
