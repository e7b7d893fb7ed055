//! Columns of finished runs, and statistics of them over a swept parameter, as one figure: from the files of the results.

mod curves;
mod look;
mod summary;
mod table;

use crate::warning::Warn;
use curves::Wanted;
use springpot_report::Plot;
use std::path::PathBuf;
use table::Table;

/// What a figure of finished runs shall show, in the words of `springpot plot`.
#[derive(Debug, Clone, Default)]
pub struct AskedFigure {
    /// Folders of results, or their results.csv; behind the first one also CSV files of measured points. At least one.
    pub results: Vec<PathBuf>,
    /// Columns or globs, or statistics such as `max(COLUMN)` and `metric(NAME)`. At least one.
    pub columns: Vec<String>,
    /// Column of the abscissa; of statistics a swept path, where `t` stands for the only one.
    pub x: String,
    /// `PATH=VALUE`: only the cases with this value of a swept parameter.
    pub selection: Vec<String>,
    /// `COLUMN=UNIT`.
    pub units: Vec<String>,
    /// Title.
    pub title: Option<String>,
    /// Names of [`LookOption`](springpot_scenario::LookOption)s with their texts; without one there is none of what it says.
    pub look: Vec<(String, Option<String>)>,
}

/// A figure of finished runs.
#[derive(Debug)]
pub struct LaterFigure {
    /// The figure.
    pub plot: Plot,
    /// The folder of the first results.
    pub folder: PathBuf,
    /// A name for its files, which none of the figures has that the first run drew.
    pub name: String,
}

/// Why nothing is drawn, and what would be right.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NotDrawn {
    /// What is wrong.
    pub message: String,
    /// What would be right, where that is known.
    pub help: Option<String>,
}

impl NotDrawn {
    fn new(message: impl Into<String>, help: impl Into<Option<String>>) -> Self {
        Self { message: message.into(), help: help.into() }
    }

    /// The same of the abscissa of a table.
    fn of_abscissa(self, table: &Table) -> Self {
        let measured = "the abscissa of measured points is called as that of the run; `data` of a [[figure]] takes columns of other names";
        if table.is_measured { Self { help: Some(measured.to_owned()), ..self } } else { self }
    }
}

impl AskedFigure {
    /// Reads the results and makes the figure: the cases of a first sweep make curves, those of others panels.
    ///
    /// # Errors
    /// Results, columns, values or units that are not there, and a look that does not fit them.
    pub fn figure(&self, warn: Warn<'_>) -> Result<LaterFigure, NotDrawn> {
        if self.columns.is_empty() {
            let help = "name a column behind the results, such as strut.force".to_owned();
            return Err(NotDrawn::new("no column is named", help));
        }
        let look = look::read(&self.look)?;
        let open = |(at, results): (usize, &PathBuf)| Table::open(results, at > 0, warn);
        let tables = self.results.iter().enumerate().map(open).collect::<Result<Vec<_>, _>>()?;
        let Some(first) = tables.first() else { return Err(NotDrawn::new("no results are named", None)) };
        let (folder, name) = (first.folder.clone(), self.name(&tables));
        let plot = match summary::asked(&self.columns)? {
            Some(asked) => summary::plot(&tables, self, &look, &asked)?,
            None => curves::plot(&tables, &Wanted::new(&tables, self, &look)?, self.title.as_deref())?,
        };
        Ok(LaterFigure { plot, folder, name })
    }

    /// What is drawn, as the name of a file; other than those of the figures that the run drew.
    fn name(&self, tables: &[Table]) -> String {
        let last = |path: &str| path.trim().trim_end_matches('"').rsplit('.').next().unwrap_or(path).to_owned();
        // Of a swept parameter its last name says enough.
        let is_swept = tables[0].sweeps.iter().any(|sweep| sweep.parameters.contains(&self.x));
        let x = if is_swept { last(&self.x) } else { self.x.clone() };
        let over = (self.x != "t").then(|| format!("over-{x}"));
        let chosen = self.selection.iter().map(|assignment| {
            let (path, value) =
                assignment.split_at(springpot_scenario::equals_sign(assignment).unwrap_or(assignment.len()));
            format!("{}_{}", last(path), value.trim_start_matches('=').trim())
        });
        let others = tables.iter().skip(1).map(|table| format!("with-{}", table.name()));
        let words: Vec<String> = self.columns.iter().cloned().chain(over).chain(chosen).chain(others).collect();
        let full = words.join("-");
        let mut name: String = file_name(&full).chars().take(LONGEST_NAME).collect();
        // What is cut off or replaced may be all that tells two figures apart.
        let is_plain = |c: char| plain(c) == c || "*?, ()".contains(c);
        if full.chars().count() > LONGEST_NAME || !full.chars().all(is_plain) {
            name.push_str(&format!("-{:08x}", crc32fast::hash(full.as_bytes())));
        }
        if name.starts_with('.') {
            name.insert(0, '_');
        }
        if tables[0].drawn.contains(&format!("figures/{name}.svg")) {
            name.push_str("-plot");
        }
        name
    }
}

/// Characters of the name of a file.
const LONGEST_NAME: usize = 80;

fn plain(c: char) -> char {
    if c.is_ascii_alphanumeric() || "_-.".contains(c) { c } else { '_' }
}

/// A text as the name of a file: `max(strut.force)` is max-strut.force.
fn file_name(text: &str) -> String {
    text.replace('(', "-").replace(')', "").chars().map(plain).collect()
}
