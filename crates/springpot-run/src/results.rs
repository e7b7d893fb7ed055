//! Results of a run that has ended, read again for pages and files.

mod whole;

pub use whole::Told;

use crate::record::{self, Record};
use crate::table::disk::Disk;
use crate::table::stored::Stored;
use crate::warning::Warning;
use springpot::table::Column;
use std::io;
use std::path::{Path, PathBuf};

/// What is to be said where the results in a folder are of another version of Springpot: names and meanings may have changed since.
pub fn of_other_version(folder: &Path, version: &str) -> Option<Warning> {
    let own = env!("CARGO_PKG_VERSION");
    (!version.is_empty() && version != own).then(|| {
        let version: String = version.chars().filter(|c| !c.is_control()).take(20).collect();
        let record = folder.join("run.json");
        let message = format!(
            "{} is of Springpot {version}, and this is {own}: what is called otherwise there is not found",
            record.display()
        );
        message.into()
    })
}

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
    /// There is a record, which is damaged.
    #[error("{}: {why}", folder.join("run.json").display())]
    Damaged {
        /// The folder.
        folder: PathBuf,
        /// What is wrong with it.
        why: String,
    },
    /// An earlier version wrote them, without what is drawn.
    #[error("the run.json of {} does not say what is drawn: an earlier version wrote it", .0.display())]
    NoScene(PathBuf),
    /// They are one part of a run.
    #[error("{} holds one part of a run, and others are elsewhere: put them together with `springpot merge`", .0.display())]
    Part(PathBuf),
    /// A case that was asked for has no row.
    #[error("case {0} has no row")]
    NoCase(usize),
    /// There is no row at all.
    #[error("no case of {} has a row", .0.display())]
    NoRow(PathBuf),
    /// The rows lack a column.
    #[error("the rows of {} have no column `{column}`", folder.display())]
    NoColumn {
        /// The folder.
        folder: PathBuf,
        /// The column.
        column: &'static str,
    },
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

/// Takes the swept values of a case as text, each with its comma, its place among those with rows, and the values of a row.
pub(crate) type TakeRow<'a> = &'a mut dyn FnMut(&str, usize, &[f64]) -> io::Result<()>;

impl Results {
    /// Opens the results in a folder.
    ///
    /// # Errors
    /// There are none, or they cannot be read.
    pub fn open(disk: &Disk, folder: &Path) -> Result<Self, ResultsError> {
        Self::of(disk, folder, true)
    }

    /// The same, also where nothing says what is drawn.
    ///
    /// # Errors
    /// There are none, or they cannot be read.
    pub fn read(disk: &Disk, folder: &Path) -> Result<Self, ResultsError> {
        Self::of(disk, folder, false)
    }

    fn of(disk: &Disk, folder: &Path, wants_scenes: bool) -> Result<Self, ResultsError> {
        let failed = |file: &Path, error| ResultsError::File { file: file.to_owned(), error };
        match disk.look(folder) {
            Ok(Some(_)) => {}
            Ok(None) => {
                return Err(failed(folder, io::Error::new(io::ErrorKind::NotFound, "there is no such folder")));
            }
            Err(error) => return Err(failed(folder, error)),
        }
        let record = Record::read(disk, folder).map_err(|why| match why {
            None => ResultsError::NoRecord(folder.to_owned()),
            Some(why) => ResultsError::Damaged { folder: folder.to_owned(), why },
        })?;
        if wants_scenes && record.scenes.is_empty() {
            return Err(ResultsError::NoScene(folder.to_owned()));
        }
        let file = folder.join(record.rows_file());
        let rows = Stored::open(disk, &file).map_err(|error| failed(&file, error))?;
        let swept = record.parameters().count().min(rows.columns().len());
        let columns = rows.columns()[swept..].iter().map(|name| record.column(name)).collect();
        Ok(Self { folder: folder.to_owned(), record, columns, swept, rows, disk: disk.clone() })
    }

    /// Whether the case of that index has rows.
    pub fn has_rows(&self, index: usize) -> bool {
        self.record.cases.iter().any(|case| case.index == index && case.rows > 0)
    }

    /// Indices of the cases that have rows.
    pub fn cases_with_rows(&self) -> Vec<usize> {
        self.record.with_rows().iter().map(|case| case.index).collect()
    }

    /// The version of Springpot that they are of; empty where run.json does not say it.
    pub fn version(&self) -> &str {
        self.record.version()
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// What they are called.
    pub(crate) fn name(&self) -> String {
        record::name(&self.folder)
    }

    /// Names of the columns, those of swept parameters aside.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|column| column.name.as_str())
    }

    /// A file among the results.
    pub(crate) fn file(&self, name: &str) -> Option<Vec<u8>> {
        self.disk.read(&self.folder.join(name)).ok()
    }

    /// Calls `take` with every row of the cases that run.json lists.
    ///
    /// # Errors
    /// The rows cannot be read, or are not those that run.json tells of; what `take` returns.
    pub(crate) fn visit(&self, take: TakeRow<'_>) -> Result<(), ResultsError> {
        let failed = |error| ResultsError::File { file: self.rows.file().to_owned(), error };
        let numbers: Vec<usize> = (self.swept..self.swept + self.columns.len()).collect();
        let time = self.columns.iter().position(|column| column.name == "t");
        let cases = self.record.with_rows();
        let leads: Vec<String> = cases.iter().map(|case| self.record.lead(case)).collect();
        let mut counts = vec![0_u64; cases.len()];
        let (mut lead, mut case, mut next, mut last) = (None::<String>, None, 0, f64::NEG_INFINITY);
        let read = self.rows.visit(self.swept, &numbers, &mut |text, values| {
            let t = time.map_or(f64::NEG_INFINITY, |time| values[time]);
            // Times rise within a case.
            let is_same = lead.as_deref() == Some(text) && !(t <= last && time.is_some());
            if !is_same {
                lead = Some(text.to_owned());
                // Cases come in their order; of many, only the first are listed.
                case = (next..cases.len()).find(|at| leads[*at] == text);
                next = case.map_or(next, |at| at + 1);
            }
            last = t;
            let Some(case) = case else { return Ok(()) };
            counts[case] += 1;
            take(text, case, values)
        });
        read.map_err(failed)?;
        match cases.iter().zip(counts).find(|(case, count)| case.rows != *count) {
            None => Ok(()),
            Some((case, count)) => {
                let words =
                    format!("it holds {count} rows of case {}, where run.json tells of {}", case.index, case.rows);
                Err(failed(io::Error::new(io::ErrorKind::InvalidData, words)))
            }
        }
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
