//! `[[figure]]` and `[output]`.

use super::document::Node;
use super::keys::{FIGURE, OUTPUT};
use super::names;
use super::path;
use super::reader::{Field, Read, Table, all};
use super::refusal::{Place, RefusalKind};
use super::sweep::Axis;
use super::units::Unit;
use std::collections::HashMap;
use std::sync::Arc;

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

/// Name of a column, or a glob over names, not yet matched.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnGlob {
    /// As written.
    pub text: String,
    /// Where it stands; where it was left out: the figure.
    pub place: Place,
}

/// A column and the unit it is drawn in.
#[derive(Debug, Clone, PartialEq)]
pub struct FigureUnit {
    /// The column or glob.
    pub column: ColumnGlob,
    /// The unit, in the grammar of quantities; known to parse, its dimension not yet compared with the column's.
    pub unit: String,
}

/// One value of one sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Selection {
    /// Index of the `[[sweep]]`.
    pub axis: usize,
    /// Index of its value.
    pub value: usize,
}

/// Finds which value of which sweep is meant by a value under a path; told by the cases, which know SI values.
pub(crate) type Finder<'f> = dyn Fn(usize, usize, &Node) -> Option<usize> + 'f;

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
    let kind = match table.get("kind") {
        None => curves(&table, item),
        Some(field) => match field.word("kind of figure")? {
            "robot" => robot(&table),
            _ => curves(&table, item),
        },
    };
    let units = table.get("units").map_or(Ok(Vec::new()), |field| units(&field));
    let selection = table.get("where").map_or(Ok(Vec::new()), |field| selection(root, &field, axes, find));
    Ok(FigurePlan {
        name: name?,
        title: title?,
        kind: kind?,
        units: units?,
        selection: selection?,
        place: item.node.place.clone(),
    })
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

fn glob(field: &Field<'_>) -> Read<ColumnGlob> {
    let text = field.text()?;
    if text.trim().is_empty() {
        let help = "write the name of a column, as in \"strut.Q.q2\"".to_owned();
        return Err(field.refuse(RefusalKind::BadName, "is empty", Some(help)));
    }
    Ok(ColumnGlob { text: text.to_owned(), place: field.node.place.clone() })
}

fn globs(field: &Field<'_>) -> Read<Vec<ColumnGlob>> {
    if field.node.text().is_some() {
        return glob(field).map(|glob| vec![glob]);
    }
    let items = field.items("the name of a column or an array of them")?;
    if items.is_empty() {
        let help = "write the names of columns, as in [\"strut.Q.q2\"]".to_owned();
        return Err(field.refuse(RefusalKind::Missing, "is empty", Some(help)));
    }
    all(items.iter().map(glob))
}

fn curves(table: &Table<'_>, item: &Field<'_>) -> Read<FigureKind> {
    let x = match table.get("x") {
        Some(field) => glob(&field),
        None => Ok(ColumnGlob { text: "t".to_owned(), place: item.node.place.clone() }),
    };
    let y = table.require("y").and_then(|field| globs(&field));
    Ok(FigureKind::Curves { x: x?, y: y? })
}

fn robot(table: &Table<'_>) -> Read<FigureKind> {
    for key in FIGURE.keys.iter().map(|key| key.name).filter(|key| FIGURE.is_of_a_kind(key)) {
        if let Some(field) = table.get(key) {
            let message = "has no meaning where kind = \"robot\"";
            return Err(field.refuse(RefusalKind::Rule, message, Some(format!("leave `{key}` out"))));
        }
    }
    Ok(FigureKind::Robot)
}

fn units(field: &Field<'_>) -> Read<Vec<FigureUnit>> {
    if field.node.entries().is_none() {
        return Err(field.wrong_type("a table of units by column"));
    }
    all(field.node.entries().unwrap_or_default().iter().map(|entry| {
        let column = ColumnGlob { text: entry.key.clone(), place: entry.key_place.clone() };
        let unit =
            Field { node: &entry.node, key: &entry.key, row: None, owner: field.to_string().into(), ..field.clone() };
        let text = unit.text()?;
        match Unit::parse(text, &|_| None) {
            Ok(_) => Ok(FigureUnit { column, unit: text.to_owned() }),
            Err(error) => {
                let place = unit.node.place_in_text(error.span());
                let refusal = place.refuse(RefusalKind::BadQuantity, format!("{unit}: {error}"));
                Err(unit.ctx.refuse(refusal.help("write a unit such as N*cm")))
            }
        }
    }))
}

fn selection(root: &Table<'_>, field: &Field<'_>, axes: &[Axis], find: &Finder<'_>) -> Read<Vec<Selection>> {
    let Some(entries) = field.node.entries() else { return Err(field.wrong_type("a table of values by swept path")) };
    all(entries.iter().map(|entry| {
        let target = path::resolve(root.ctx, root.node, &entry.key, &entry.key_place)?;
        let mut swept = axes
            .iter()
            .enumerate()
            .flat_map(|(axis, swept)| swept.targets.iter().enumerate().map(move |(at, target)| (axis, at, target)));
        let Some((axis, at, _)) = swept.find(|(_, _, swept)| swept.steps == target.steps) else {
            let message = format!("`where` selects {}, which is not swept", target.written);
            let swept: Vec<&str> =
                axes.iter().flat_map(|axis| &axis.targets).map(|target| target.written.as_str()).collect();
            let help = match names::nearest(&target.written, swept.iter().copied()) {
                Some(right) => format!("did you mean `{right}`?"),
                None => format!("swept: {}", names::list(swept)),
            };
            let refusal = entry.key_place.refuse(RefusalKind::UnknownName, message);
            return Err(root.ctx.refuse(refusal.help(help)));
        };
        let Some(value) = find(axis, at, &entry.node) else {
            let message = format!("`where` selects {} = {}, which is not swept", target.written, entry.node.written());
            let shown: Vec<String> = (0..axes[axis].len().min(20)).map(|k| axes[axis].label(k)).collect();
            let help = format!("swept values: {}", names::list(shown.iter().map(String::as_str)));
            return Err(root.ctx.refuse(entry.node.place.refuse(RefusalKind::UnknownName, message).help(help)));
        };
        Ok(Selection { axis, value })
    }))
}

/// Reads `[output]`: globs of the columns to write.
pub(crate) fn read_columns(root: &Table<'_>) -> Read<Option<Arc<[ColumnGlob]>>> {
    let Some(field) = root.get("output") else { return Ok(None) };
    let table = Table::of(root.ctx, field.node, "[output]", &OUTPUT)?;
    let Some(field) = table.get("columns") else { return Ok(None) };
    Ok(Some(globs(&field)?.into()))
}
