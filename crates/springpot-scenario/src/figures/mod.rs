//! `[[figure]]` and `[output]`.
//!
//! A kind of figure is a variant of [`FigureKind`] and a row of [`KINDS`]; its keys are rows of [`FIGURE`] that name it, and what it
//! reads and records of them is in a file of its own.

mod columns;
mod curves;
mod selection;

pub(crate) use columns::read_columns;
pub use columns::{ColumnGlob, FigureUnit};
pub use selection::Selection;

use super::keys::{Keys, Need, Shape, key};
use super::names;
use super::reader::{Field, Read, Refused, Table, all};
use super::refusal::{Place, RefusalKind};
use super::sweep::Axis;
use selection::Finder;
use serde_json::{Map, Value, json};
use std::collections::HashMap;
use std::sync::Arc;

/// What a figure shows.
#[derive(Debug, Clone, PartialEq)]
pub enum FigureKind {
    /// Columns over a column.
    Curves {
        /// Column of the abscissa.
        x: ColumnGlob,
        /// Columns of the ordinate.
        y: Vec<ColumnGlob>,
    },
    /// The robot and its elements at t = 0.
    Robot,
}

/// A kind of figure.
struct Kind {
    /// What stands under `kind`.
    word: &'static str,
    /// Reads its own keys of a table; the field is the whole figure.
    read: fn(&Table<'_>, &Field<'_>) -> Read<FigureKind>,
}

/// In the order in which messages list them.
static KINDS: [Kind; 2] =
    [Kind { word: curves::WORD, read: curves::read }, Kind { word: "robot", read: |_, _| Ok(FigureKind::Robot) }];

impl FigureKind {
    /// Its row, and what run.json says of its own keys.
    fn row(&self) -> (&'static Kind, Map<String, Value>) {
        // Constants, so that a kind without a row does not build.
        match self {
            Self::Curves { x, y } => (const { &KINDS[0] }, curves::record(x, y)),
            Self::Robot => (const { &KINDS[1] }, Map::new()),
        }
    }
}

/// The kinds of it that `only` knows are the kinds of figures.
pub(crate) static FIGURE: Keys = Keys {
    words: "A figure of curves, or of the robot.",
    keys: &[
        key("name", Shape::FileName, Need::Said("figure-1, …"), "Name of its files without an ending."),
        key("title", Shape::Text, Need::Said("none"), "Title."),
        curves::X,
        curves::Y,
        key("units", Shape::TextsByName, Need::Said("SI"), "Units to draw columns in, by column or glob.")
            .only(&[curves::WORD]),
        key("where", Shape::ByName, Need::Said("all cases"), "Only the cases with these values, by swept path."),
        key(
            "kind",
            Shape::Words(|| KINDS.iter().map(|kind| kind.word).collect()),
            Need::Word(curves::WORD),
            "What is drawn.",
        ),
    ],
};

/// Most figures.
const MAX_FIGURES: usize = 1_000;

/// One figure.
#[derive(Debug, Clone, PartialEq)]
pub struct FigurePlan {
    /// File name without its ending.
    pub name: String,
    /// Title, if it has one.
    pub title: Option<String>,
    /// What is drawn.
    pub kind: FigureKind,
    /// Units to draw columns in.
    pub units: Vec<FigureUnit>,
    /// The cases that are drawn: those with these values of the sweeps.
    pub selection: Vec<Selection>,
    /// Where it stands in the scenario.
    pub place: Place,
}

/// Reads every `[[figure]]`.
pub(crate) fn read(root: &Table<'_>, axes: &[Axis], find: &Finder<'_>) -> Read<Arc<[FigurePlan]>> {
    let Some(field) = root.get("figure") else { return Ok(Arc::new([])) };
    let items = field.items("an array of tables: [[figure]]")?;
    if items.len() > MAX_FIGURES {
        let message = format!("holds {} figures; at most {MAX_FIGURES} are drawn", items.len());
        return Err(field.refuse(RefusalKind::TooLarge, message, None));
    }
    let figures = all(items.iter().enumerate().map(|(i, item)| figure(root, item, i, axes, find)))?;
    let mut seen: HashMap<String, usize> = HashMap::new();
    for figure in &figures {
        let line = figure.place.position().0;
        if let Some(earlier) = seen.insert(figure.name.to_lowercase(), line) {
            let message = format!("figure {:?}: the name is taken on line {earlier}", figure.name);
            let help = "names of figures are file names: they are unique, whatever the case of their letters";
            return Err(root.ctx.refuse(figure.place.refuse(RefusalKind::BadName, message).help(help)));
        }
    }
    Ok(figures.into())
}

fn figure(root: &Table<'_>, item: &Field<'_>, i: usize, axes: &[Axis], find: &Finder<'_>) -> Read<FigurePlan> {
    let default = format!("figure-{}", i + 1);
    let table = Table::of(item.ctx, item.node, format!("[[figure]] {}", i + 1), &FIGURE)?;
    let name = table.get("name").map_or(Ok(default), |field| file_name(&field));
    let title = table.get("title").map(|field| field.text().map(str::to_owned)).transpose();
    let kind = kind(&table, item);
    let units = table.get("units").map_or(Ok(Vec::new()), |field| columns::units(&field));
    let selection = table.get("where").map_or(Ok(Vec::new()), |field| selection::selection(root, &field, axes, find));
    Ok(FigurePlan {
        name: name?,
        title: title?,
        kind: kind?,
        units: units?,
        selection: selection?,
        place: item.node.place.clone(),
    })
}

fn kind(table: &Table<'_>, item: &Field<'_>) -> Read<FigureKind> {
    let word = table.word("kind", "kind of figure")?;
    if let Some(field) = FIGURE.not_of(word).find_map(|key| table.get(key.name)) {
        let message = format!("has no meaning where kind = {word:?}");
        return Err(field.refuse(RefusalKind::Rule, message, Some(format!("leave `{}` out", field.key))));
    }
    let kind = KINDS.iter().find(|kind| kind.word == word).ok_or(Refused)?;
    (kind.read)(table, item)
}

fn file_name(field: &Field<'_>) -> Read<String> {
    let name = field.text()?;
    if names::is_file_name(name) {
        return Ok(name.to_owned());
    }
    let message = format!("is {}, which is not a file name", field.node.written());
    let help = "write letters, digits, `_`, `-` and `.`, at most 100, without an ending".to_owned();
    Err(field.refuse(RefusalKind::BadName, message, Some(help)))
}

impl FigurePlan {
    /// What run.json says of it.
    pub(crate) fn record(&self) -> Value {
        let units: Map<String, Value> =
            self.units.iter().map(|unit| (unit.column.text.clone(), json!(unit.unit))).collect();
        let (kind, own) = self.kind.row();
        let mut record = json!({ "name": self.name, "title": self.title, "units": units, "kind": kind.word });
        if let Value::Object(record) = &mut record {
            record.extend(own);
        }
        record
    }
}
