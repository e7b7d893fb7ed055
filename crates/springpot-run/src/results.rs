//! Results of a run that has ended, read again for pages and files.

use crate::table::disk::Disk;
use crate::table::stored::Stored;
use serde::Deserialize;
use serde_json::{Map, Value};
use springpot::table::Column;
use springpot_report::scene::{LawText, Scene};
use std::io;
use std::path::{Path, PathBuf};

/// Why there are no results to read.
#[derive(Debug, thiserror::Error)]
pub enum ResultsError {
    /// A file cannot be read.
    #[error("{}: {error}", file.display())]
    File {
        /// The file.
        file: PathBuf,
        /// Why.
        error: io::Error,
    },
    /// There is no record of a run.
    #[error("{} has no run.json that says what its rows are", .0.display())]
    NoRecord(PathBuf),
    /// An earlier version wrote them, without what is drawn.
    #[error("the run.json of {} does not say what is drawn: an earlier version wrote it", .0.display())]
    NoScene(PathBuf),
    /// A case that was asked for has no row.
    #[error("case {0} has no row")]
    NoCase(usize),
}

/// The results in a folder.
#[derive(Debug)]
pub struct Results {
    pub(crate) folder: PathBuf,
    pub(crate) record: Record,
    /// Columns of the rows, those of swept parameters aside.
    pub(crate) columns: Vec<Column>,
    /// How many columns of swept parameters stand before them.
    swept: usize,
    rows: Stored,
    disk: Disk,
}

/// What run.json says.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct Record {
    pub(crate) status: String,
    pub(crate) title: Option<String>,
    pub(crate) versions: Map<String, Value>,
    columns: Vec<Described>,
    sweeps: Vec<Sweep>,
    pub(crate) cases: Vec<Listed>,
    format: Option<String>,
    pub(crate) scenes: Vec<Scene>,
    pub(crate) laws: Vec<LawText>,
}

#[derive(Debug, Deserialize)]
struct Described {
    name: String,
    #[serde(default)]
    unit: String,
    #[serde(default)]
    meaning: String,
}

#[derive(Debug, Deserialize)]
struct Sweep {
    parameters: Vec<String>,
}

/// A case as it is listed.
#[derive(Debug, Deserialize)]
pub(crate) struct Listed {
    pub(crate) index: usize,
    #[serde(default)]
    pub(crate) parameters: Map<String, Value>,
    #[serde(default)]
    pub(crate) status: String,
    #[serde(default)]
    pub(crate) error: Option<String>,
    #[serde(default)]
    pub(crate) rows: u64,
    #[serde(default)]
    pub(crate) scene: usize,
}

/// Takes the swept values of a case as text, each with its comma, its place among those with rows, and the values of a row.
pub(crate) type TakeRow<'a> = &'a mut dyn FnMut(&str, usize, &[f64]) -> io::Result<()>;

impl Results {
    /// Opens the results in a folder.
    ///
    /// # Errors
    /// There are none, or they cannot be read.
    pub fn open(disk: &Disk, folder: &Path) -> Result<Self, ResultsError> {
        let failed = |file: &Path, error| ResultsError::File { file: file.to_owned(), error };
        match disk.look(folder) {
            Ok(Some(_)) => {}
            Ok(None) => {
                return Err(failed(folder, io::Error::new(io::ErrorKind::NotFound, "there is no such folder")));
            }
            Err(error) => return Err(failed(folder, error)),
        }
        let read = disk.read(&folder.join("run.json"));
        let record: Option<Record> = read.ok().and_then(|bytes| serde_json::from_slice(&bytes).ok());
        let record = record.ok_or_else(|| ResultsError::NoRecord(folder.to_owned()))?;
        if record.scenes.is_empty() {
            return Err(ResultsError::NoScene(folder.to_owned()));
        }
        let file = folder.join(format!("results.{}", record.format.as_deref().unwrap_or("csv")));
        let rows = Stored::open(disk, &file).map_err(|error| failed(&file, error))?;
        let swept = record.sweeps.iter().map(|sweep| sweep.parameters.len()).sum::<usize>().min(rows.columns().len());
        let described = |name: &String| {
            let found = record.columns.iter().find(|column| column.name == *name);
            let (unit, meaning) = found.map_or(("", ""), |column| (&column.unit, &column.meaning));
            Column::new(name.as_str(), unit, meaning)
        };
        let columns = rows.columns()[swept..].iter().map(described).collect();
        Ok(Self { folder: folder.to_owned(), record, columns, swept, rows, disk: disk.clone() })
    }

    /// Whether the case of that index has rows.
    pub fn has_rows(&self, index: usize) -> bool {
        self.record.cases.iter().any(|case| case.index == index && case.rows > 0)
    }

    /// What they are called.
    pub(crate) fn name(&self) -> String {
        let folder = self.folder.canonicalize().unwrap_or_else(|_| self.folder.clone());
        folder.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// Paths of the swept parameters.
    pub(crate) fn parameters(&self) -> impl Iterator<Item = &String> {
        self.record.sweeps.iter().flat_map(|sweep| &sweep.parameters)
    }

    /// Calls `take` with every row.
    ///
    /// # Errors
    /// The rows cannot be read; what `take` returns.
    pub(crate) fn visit(&self, take: TakeRow<'_>) -> Result<(), ResultsError> {
        let numbers: Vec<usize> = (self.swept..self.swept + self.columns.len()).collect();
        let time = self.columns.iter().position(|column| column.name == "t");
        let (mut lead, mut case, mut last) = (None::<String>, 0, f64::NEG_INFINITY);
        let read = self.rows.visit(self.swept, &numbers, &mut |text, values| {
            let t = time.map_or(f64::NEG_INFINITY, |time| values[time]);
            // Times rise within a case.
            match &lead {
                None => lead = Some(text.to_owned()),
                Some(earlier) if earlier == text && !(t <= last && time.is_some()) => {}
                Some(_) => {
                    lead = Some(text.to_owned());
                    case += 1;
                }
            }
            last = t;
            take(text, case, values)
        });
        read.map_err(|error| ResultsError::File { file: self.rows.file().to_owned(), error })
    }

    /// The rows of a file of texts, such as events.csv: the swept values as in [`Self::visit`], and the other fields; nothing where there is no such file.
    pub(crate) fn texts(&self, name: &str) -> Vec<(String, Vec<String>)> {
        let Ok(bytes) = self.disk.read(&self.folder.join(name)) else { return Vec::new() };
        let mut reader = csv::Reader::from_reader(&bytes[..]);
        let records = reader.records().filter_map(Result::ok);
        let split = records.map(|record| {
            let mut lead = String::new();
            for field in record.iter().take(self.swept) {
                crate::table::push_text(&mut lead, field);
                lead.push(',');
            }
            (lead, record.iter().skip(self.swept).map(str::to_owned).collect())
        });
        split.collect()
    }
}
