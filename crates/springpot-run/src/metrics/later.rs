//! Metrics of a run that has ended, from its results.

use super::series::is_within;
use super::{COLUMNS, push_line, value};
use crate::record::Record;
use crate::table::disk::Disk;
use crate::table::push_text;
use crate::table::stored::Stored;
use springpot::table::Column;
use springpot_scenario::{Metric, Refusals, suggest};
use std::io;
use std::path::{Path, PathBuf};

/// Why there are no metrics.
#[derive(Debug, thiserror::Error)]
pub enum LaterError {
    /// There are no results, or none that can be read.
    #[error("{}: {error}", file.display())]
    File {
        /// What was to be read.
        file: PathBuf,
        /// Why it cannot be.
        error: io::Error,
    },
    /// There is no run.json beside the rows that says which metrics the run has.
    #[error("{} has no run.json that says what its columns are", .0.display())]
    NoRecord(PathBuf),
    /// As [`LaterError::NoRecord`], of a file of rows.
    #[error("no run.json stands beside {}, which would say what its columns are", .0.display())]
    NoneBeside(PathBuf),
    /// No case has a row in the window of a metric that was asked for.
    #[error("the window of {name:?} runs from {from} s to {to} s, where there is no row")]
    NoRow {
        /// The metric.
        name: String,
        /// The window, s.
        from: f64,
        /// Its end, s.
        to: f64,
        /// What the rows go over.
        help: String,
    },
    /// The run has none, and none were asked for.
    #[error("the run in {} has no metrics", .0.display())]
    NoMetrics(PathBuf),
    /// A metric of the run is of a column that its file does not hold.
    #[error("metric {name:?} is of {column}, which is not among the columns of {}", file.display())]
    LeftOut {
        /// The metric.
        name: String,
        /// Its column.
        column: String,
        /// The file.
        file: PathBuf,
        /// Columns of a similar name.
        help: String,
    },
    /// The record lists fewer cases than there are, and metrics differ from case to case.
    #[error("the metrics of {} are swept, and run.json does not list all of its cases", .0.display())]
    Unlisted(PathBuf),
    /// What was asked for is refused.
    #[error(transparent)]
    Refused(#[from] Refusals),
}

/// The results of a run.
#[derive(Debug)]
pub struct Source {
    rows: Stored,
    folder: PathBuf,
    record: Record,
    columns: Vec<Column>,
    swept: usize,
}

/// What metrics came to.
#[derive(Debug)]
pub struct Recomputed {
    /// The text of metrics.csv.
    pub text: String,
    /// Whether these are the metrics of the run itself.
    pub is_own: bool,
}

impl Source {
    /// Opens the results in a folder, or a file of rows with run.json beside it.
    ///
    /// # Errors
    /// There are none.
    pub fn open(disk: &Disk, results: &Path) -> Result<Self, LaterError> {
        let is_folder = disk.is_folder(results);
        let folder = if is_folder { results } else { results.parent().unwrap_or(Path::new("")) };
        let record = Record::read(disk, folder).map_err(|why| match disk.look(results) {
            Ok(Some(_)) if why.is_some() => {
                let error = io::Error::new(io::ErrorKind::InvalidData, why.unwrap_or_default());
                LaterError::File { file: folder.join("run.json"), error }
            }
            Ok(None) => {
                let error = io::Error::new(io::ErrorKind::NotFound, "there is no such file or folder");
                LaterError::File { file: results.to_owned(), error }
            }
            Err(error) => LaterError::File { file: results.to_owned(), error },
            Ok(_) if is_folder => LaterError::NoRecord(results.to_owned()),
            Ok(_) => LaterError::NoneBeside(results.to_owned()),
        })?;
        let file = if is_folder { folder.join(record.rows_file()) } else { results.to_owned() };
        let rows = Stored::open(disk, &file).map_err(|error| LaterError::File { file: file.clone(), error })?;
        let columns = rows.columns().iter().map(|name| record.column(name)).collect();
        let swept = record.parameters().count().min(rows.columns().len());
        Ok(Self { rows, folder: folder.to_owned(), record, columns, swept })
    }

    /// The folder that run.json is in, and the version of Springpot that wrote it.
    pub fn origin(&self) -> (&Path, &str) {
        (&self.folder, self.record.version())
    }

    /// The columns of the run, swept parameters aside.
    pub fn columns(&self) -> &[Column] {
        &self.columns[self.swept..]
    }

    /// The metrics of the run or, where there are some, `asked`; as metrics.csv has them.
    ///
    /// # Errors
    /// The file lacks a column, or cannot be read.
    pub fn metrics(&self, asked: &[Metric]) -> Result<Recomputed, LaterError> {
        let is_own = asked.is_empty();
        let of_run = if is_own { self.record.metrics() } else { Vec::new() };
        let metrics = if is_own { &of_run[..] } else { asked };
        if metrics.is_empty() {
            return Err(LaterError::NoMetrics(self.folder.clone()));
        }
        let own = if is_own { self.own()? } else { None };
        let t = self.place("t", &metrics[0])?;
        let mut places = vec![t];
        let of = metrics.iter().map(|metric| {
            let at = self.place(&metric.of, metric)?;
            Ok(places.iter().position(|place| *place == at).unwrap_or_else(|| {
                places.push(at);
                places.len() - 1
            }))
        });
        let of = of.collect::<Result<Vec<_>, LaterError>>()?;
        let mut text = String::new();
        for name in self.columns[..self.swept].iter().map(|column| &*column.name).chain(COLUMNS) {
            push_text(&mut text, name);
            text.push(if name == COLUMNS[3] { '\n' } else { ',' });
        }
        let mut own = own.into_iter().flatten();
        let (mut is_met, mut reach) = (vec![false; metrics.len()], [f64::INFINITY, f64::NEG_INFINITY]);
        let mut end = |case: &mut Rows| {
            if case.columns[0].is_empty() {
                return;
            }
            let own = own.next();
            let t = &case.columns[0];
            reach = t.iter().fold(reach, |[low, high], t| [low.min(*t), high.max(*t)]);
            for (k, (metric, &at)) in metrics.iter().zip(&of).enumerate() {
                let metric = own.flatten().and_then(|own| own.get(k)).unwrap_or(metric);
                is_met[k] |= metric.window.is_none_or(|window| t.iter().any(|t| is_within(window, *t)));
                let value = value(metric, &case.columns[0], &case.columns[at]);
                push_line(&mut text, &case.lead, metric, &self.columns[places[at]], value);
            }
            case.columns.iter_mut().for_each(Vec::clear);
        };
        let mut case = Rows { lead: String::new(), columns: vec![Vec::new(); places.len()] };
        let mut take = |lead: &str, numbers: &[f64]| {
            // Times rise within a case.
            if lead != case.lead || case.columns[0].last().is_some_and(|last| numbers[0] <= *last) {
                end(&mut case);
                lead.clone_into(&mut case.lead);
            }
            case.columns.iter_mut().zip(numbers).for_each(|(column, number)| column.push(*number));
            Ok(())
        };
        let read = self.rows.visit(self.swept, &places, &mut take);
        read.map_err(|error| LaterError::File { file: self.rows.file().to_owned(), error })?;
        end(&mut case);
        let is_empty = |(metric, is_met): &(&Metric, bool)| !is_own && !is_met && metric.window.is_some();
        if let Some((metric, _)) = metrics.iter().zip(is_met).find(is_empty)
            && let Some([from, to]) = metric.window
        {
            let [first, last] = reach;
            let help = format!("the rows go from {first} s to {last} s; choose a window that holds some");
            return Err(LaterError::NoRow { name: metric.name.clone(), from, to, help });
        }
        Ok(Recomputed { text, is_own })
    }

    /// Where a column stands that `metric` needs.
    fn place(&self, name: &str, metric: &Metric) -> Result<usize, LaterError> {
        let found = self.columns().iter().position(|column| column.name == name);
        found.map(|at| at + self.swept).ok_or_else(|| LaterError::LeftOut {
            name: metric.name.clone(),
            column: name.to_owned(),
            file: self.rows.file().to_owned(),
            help: suggest(name, self.columns().iter().map(|column| &*column.name)),
        })
    }

    /// By case with rows, the metrics that are not those of the first; `None` where all are.
    fn own(&self) -> Result<Option<Vec<Option<&[Metric]>>>, LaterError> {
        let cases = &self.record.cases;
        if cases.iter().all(|case| case.metrics.is_none()) {
            return Ok(None);
        }
        if cases.len() < self.record.totals.cases_done + self.record.totals.cases_failed {
            return Err(LaterError::Unlisted(self.folder.clone()));
        }
        Ok(Some(self.record.with_rows().into_iter().map(|case| case.metrics.as_deref()).collect()))
    }
}

/// The rows of a case under way.
struct Rows {
    lead: String,
    /// t, then the columns that metrics are of.
    columns: Vec<Vec<f64>>,
}
