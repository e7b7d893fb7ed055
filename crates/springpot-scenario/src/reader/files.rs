//! Files that were read, so that the cases of a sweep share them.

use crate::csv::{CsvError, CsvTable, Dialect};
use springpot::model::description::{DescriptionError, DescriptionOptions, DescriptionWarningKind, RobotDescription};
use springpot::signal::{SampleError, Signal};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// CSV files that were read and the signals made of them, so that the cases of a sweep share them.
#[derive(Debug, Default)]
pub(crate) struct CsvCache {
    tables: Mutex<HashMap<(PathBuf, String), Arc<CsvTable>>>,
    signals: Mutex<HashMap<(PathBuf, String, String, bool), Signal>>,
}

impl CsvCache {
    pub(crate) fn table(&self, path: &Path, dialect: &Dialect) -> Result<Arc<CsvTable>, CsvError> {
        let key = (path.to_owned(), format!("{dialect:?}"));
        let mut tables = self.tables.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(table) = tables.get(&key) {
            return Ok(table.clone());
        }
        let table = Arc::new(CsvTable::read_as(path, dialect)?);
        tables.insert(key, table.clone());
        Ok(table)
    }

    /// The signal of a column: a spline where it has to be smooth, else straight lines.
    pub(crate) fn signal(&self, samples: &CsvSamples, column: &str, smooth: bool) -> Result<Signal, ColumnError> {
        let table = &*samples.table;
        let key = (table.file().to_owned(), format!("{:?}", samples.dialect), column.to_owned(), smooth);
        let mut signals = self.signals.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(signal) = signals.get(&key) {
            return Ok(signal.clone());
        }
        let (times, values) = (table.time(), table.column(column)?);
        let signal = if smooth { Signal::spline(times, values) } else { Signal::linear(times, values) }?;
        signals.insert(key, signal.clone());
        Ok(signal)
    }
}

/// Why a column makes no signal.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ColumnError {
    #[error(transparent)]
    Csv(#[from] CsvError),
    #[error(transparent)]
    Samples(#[from] SampleError),
}

/// A CSV file, how it is written, and what holds outside its times.
pub(crate) struct CsvSamples {
    pub(crate) table: Arc<CsvTable>,
    pub(crate) dialect: Dialect,
    pub(crate) held: bool,
}

/// URDF files that were read, in the order of their first use, so that the cases of a sweep share them.
#[derive(Debug, Default)]
pub(crate) struct DescriptionCache {
    entries: Mutex<Vec<Entry>>,
    /// Kinds of warnings that scenarios accept.
    accepted: Mutex<HashSet<DescriptionWarningKind>>,
}

#[derive(Debug)]
struct Entry {
    /// As the scenario names it: what is told of it is told elsewhere too.
    written: String,
    file: PathBuf,
    options: DescriptionOptions,
    robot: Arc<RobotDescription>,
}

impl DescriptionCache {
    pub(crate) fn read(
        &self,
        written: &str,
        file: PathBuf,
        options: DescriptionOptions,
    ) -> Result<Arc<RobotDescription>, DescriptionError> {
        let mut entries = self.entries.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(entry) = entries.iter().find(|entry| entry.file == file && entry.options == options) {
            return Ok(entry.robot.clone());
        }
        let robot = Arc::new(RobotDescription::read(&file, &options)?);
        entries.push(Entry { written: written.to_owned(), file, options, robot: robot.clone() });
        Ok(robot)
    }

    /// Warnings of these kinds are no longer told.
    pub(crate) fn accept(&self, kinds: Vec<DescriptionWarningKind>) {
        self.accepted.lock().unwrap_or_else(PoisonError::into_inner).extend(kinds);
    }

    /// Names of the kinds of all warnings, those included that are accepted already.
    pub(crate) fn kinds(&self) -> Vec<&'static str> {
        let entries = self.entries.lock().unwrap_or_else(PoisonError::into_inner);
        let kinds = entries.iter().flat_map(|entry| entry.robot.warnings.iter().map(|warning| warning.kind));
        let mut kinds: Vec<DescriptionWarningKind> = kinds.collect();
        kinds.sort_unstable();
        kinds.dedup();
        kinds.into_iter().map(DescriptionWarningKind::name).collect()
    }

    /// What the files hold and the robots do without, each once, as `file: what`, the file as the scenario names it.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let entries = self.entries.lock().unwrap_or_else(PoisonError::into_inner);
        let accepted = self.accepted.lock().unwrap_or_else(PoisonError::into_inner);
        let mut seen = HashSet::new();
        let all = entries.iter().flat_map(|Entry { written, robot, .. }| {
            let told = robot.warnings.iter().filter(|warning| !accepted.contains(&warning.kind));
            told.map(move |warning| format!("{written}: {warning}"))
        });
        all.filter(|warning| seen.insert(warning.clone())).collect()
    }
}
