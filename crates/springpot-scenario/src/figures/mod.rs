//! `[[figure]]` and `[output]`.
//!
//! A kind of figure is a variant of [`FigureKind`] and a row of [`KINDS`]; its keys are rows of [`FIGURE`] that name it, and what it
//! reads and records of them is in a file of its own.

pub(crate) mod columns;
mod curves;
mod data;
mod look;
mod map;
mod selection;
mod summary;

pub(crate) use columns::read_columns;
pub use columns::{ColumnGlob, FigureUnit};
#[cfg(test)]
pub(crate) use data::POINTS;
pub use data::{FigureNumbers, FigurePoints};
pub use look::{
    AxisLook, FIGURE_SIDES, FigureFormat, FigureLabel, Look, LookOption, OPTIONS as LOOK_OPTIONS, RangeEnd, Said,
    Spelt, Takes,
};
pub use selection::Selection;
pub use summary::{Statistic, Summarised, SweptAxis};

use crate::changes::sweep::Axis;
use crate::keys::{Key, Keys, Need, Shape, key};
use crate::reader::{Field, Read, Refused, Table, all};
use crate::text::document::Value as DocumentValue;
use crate::text::names;
use crate::text::refusal::{Place, RefusalKind};
use crate::units;
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
    /// A statistic of columns over a swept parameter.
    Summary {
        /// The sweep of the abscissa.
        x: SweptAxis,
        /// The statistics.
        y: Vec<Summarised>,
    },
    /// A number of every case over two swept parameters, in coloured cells.
    Map {
        /// The sweep along x.
        x: SweptAxis,
        /// The sweep along y.
        y: SweptAxis,
        /// What the colours say.
        z: Summarised,
    },
    /// The robot and its elements at t = 0.
    Robot,
}

const CURVES: &str = curves::WORD;
const ROBOT: &str = "robot";
/// The kinds of curves.
const DRAWN: [&str; 2] = [CURVES, summary::WORD];
/// The kinds that have axes.
const PLANE: [&str; 3] = [CURVES, summary::WORD, map::WORD];

/// A kind of figure.
struct Kind {
    /// What stands under `kind`.
    word: &'static str,
    /// Reads its own keys.
    read: fn(&Reading<'_>) -> Read<FigureKind>,
}

/// A figure that is being read.
struct Reading<'a> {
    root: &'a Table<'a>,
    /// The whole figure, and its table.
    item: &'a Field<'a>,
    table: &'a Table<'a>,
    axes: &'a [Axis],
}

/// In the order in which messages list them.
static KINDS: [Kind; 4] = [
    Kind { word: CURVES, read: curves::read },
    Kind { word: summary::WORD, read: summary::read },
    Kind { word: map::WORD, read: map::read },
    Kind { word: ROBOT, read: |_| Ok(FigureKind::Robot) },
];

impl FigureKind {
    /// Its row, and what run.json says of its own keys.
    fn row(&self) -> (&'static Kind, Map<String, Value>) {
        // Constants, so that a kind without a row does not build.
        match self {
            Self::Curves { x, y } => (const { &KINDS[0] }, curves::record(x, y)),
            Self::Summary { x, y } => (const { &KINDS[1] }, summary::record(x, y)),
            Self::Map { x, y, z } => (const { &KINDS[2] }, map::record(x, y, z)),
            Self::Robot => (const { &KINDS[3] }, Map::new()),
        }
    }
}

/// The kinds of it that `only` knows are the kinds of figures.
pub(crate) static FIGURE: Keys =
    Keys { words: "A figure of curves, of statistics, of coloured cells, or of the robot.", keys: &ALL };

/// What is drawn, of which cases; how it looks are the keys behind them.
const OWN: [Key; 9] = [
    key("name", Shape::FileName, Need::Said("figure-1, …"), "Name of its files without an ending."),
    key("title", Shape::Text, Need::Said("none"), "Title."),
    summary::X.only(&PLANE),
    curves::Y,
    map::Z,
    data::DATA,
    key("units", Shape::TextsByName, Need::Said("SI"), "Units to draw columns in, by column or glob.").only(&PLANE),
    key("where", Shape::ByName, Need::Said("all cases"), "Only the cases with these values, by swept path."),
    key("kind", Shape::Words(|| KINDS.iter().map(|kind| kind.word).collect()), Need::Word(CURVES), "What is drawn."),
];

const ALL: [Key; OWN.len() + look::KEYS.len()] = {
    let (mut keys, mut k) = ([OWN[0]; OWN.len() + look::KEYS.len()], 0);
    while k < keys.len() {
        keys[k] = if k < OWN.len() { OWN[k] } else { look::KEYS[k - OWN.len()] };
        k += 1;
    }
    keys
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
    /// Measured points beside the columns.
    pub data: Vec<FigurePoints>,
    /// Units to draw columns in.
    pub units: Vec<FigureUnit>,
    /// Ranges, scales, size, words.
    pub look: Look,
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
    let end = end(root, axes);
    let whole = Whole { root, axes, find, end };
    let figures = all(items.iter().enumerate().map(|(i, item)| figure(&whole, item, i)))?;
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

/// What all figures are read with.
struct Whole<'a> {
    root: &'a Table<'a>,
    axes: &'a [Axis],
    find: &'a Finder<'a>,
    /// End of the run, s, where it is one number.
    end: Option<f64>,
}

/// The end of the run, s; `None` where it is swept or is no plain number.
fn end(root: &Table<'_>, axes: &[Axis]) -> Option<f64> {
    let mut swept = axes.iter().flat_map(|axis| &axis.targets);
    if swept.any(|target| target.written == "time.end") {
        return None;
    }
    match &root.node.get("time")?.get("end")?.value {
        DocumentValue::Number { value, .. } => Some(*value),
        DocumentValue::Text(text) => units::parse_quantity(text, "s", &|_| None).ok(),
        _ => None,
    }
}

fn figure(whole: &Whole<'_>, item: &Field<'_>, i: usize) -> Read<FigurePlan> {
    let &Whole { root, axes, find, end } = whole;
    let default = format!("figure-{}", i + 1);
    let table = Table::of(item.ctx, item.node, format!("[[figure]] {}", i + 1), &FIGURE)?;
    let name = table.get("name").map_or(Ok(default), |field| file_name(&field));
    let title = table.get("title").map(|field| field.text().map(str::to_owned)).transpose();
    let kind = kind(&Reading { root, item, table: &table, axes });
    let units = table.get("units").map_or(Ok(Vec::new()), |field| columns::units(&field));
    let data = table.get("data").map_or(Ok(Vec::new()), |field| data::read(&field));
    let selection = table.get("where").map_or(Ok(Vec::new()), |field| selection::selection(root, &field, axes, find));
    let kind = kind?;
    let look = look::read(&table, kind == FigureKind::Robot, end);
    let selection = selection?;
    let over = match &kind {
        FigureKind::Summary { x, .. } => vec![x],
        FigureKind::Map { x, y, .. } => vec![x, y],
        FigureKind::Curves { .. } | FigureKind::Robot => Vec::new(),
    };
    if let Some(x) = over.iter().find(|x| selection.iter().any(|chosen| chosen.axis == x.axis)) {
        let message = format!("[[figure]] {}: `where` chooses one value of {}, over which it is drawn", i + 1, x.path);
        let refusal = item.node.place.refuse(RefusalKind::Rule, message);
        return Err(item.ctx.refuse(refusal.help("leave it out of `where`")));
    }
    if let FigureKind::Map { x, y, .. } = &kind
        && let Some((why, help)) = map::fault(x, y, axes, &selection)
    {
        let refusal = item.node.place.refuse(RefusalKind::Rule, format!("[[figure]] {}: {why}", i + 1));
        return Err(item.ctx.refuse(refusal.help(help)));
    }
    Ok(FigurePlan {
        name: name?,
        title: title?,
        kind,
        data: data?,
        units: units?,
        look: look?,
        selection,
        place: item.node.place.clone(),
    })
}

fn kind(reading: &Reading<'_>) -> Read<FigureKind> {
    let table = reading.table;
    let word = table.word("kind", "kind of figure")?;
    if let Some(field) = FIGURE.not_of(word).find_map(|key| table.get(key.name)) {
        let message = format!("has no meaning where kind = {word:?}");
        return Err(field.refuse(RefusalKind::Rule, message, Some(format!("leave `{}` out", field.key))));
    }
    let kind = KINDS.iter().find(|kind| kind.word == word).ok_or(Refused)?;
    (kind.read)(reading)
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
            record.extend(self.look.record());
            if !self.data.is_empty() {
                record.insert("data".to_owned(), self.data.iter().map(FigurePoints::record).collect());
            }
        }
        record
    }
}
