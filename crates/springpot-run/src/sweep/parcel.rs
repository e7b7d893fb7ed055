//! A case that has come to its end, whole: what another process hands over, and what a run in memory keeps.

use super::Progress;
use super::checkpoint::{CaseDone, CheckpointError, Shards, Stretch, Written};
use super::derivatives::CaseDerivatives;
use super::events::{CaseEvents, Happened};
use super::layout::Layout;
use super::metrics::CaseMetrics;
use super::simulate::{Back, Ran, Resumed, Sink, simulate};
use super::taken::{Taken, push_row};
use crate::table::Statistics;
use crate::table::disk::Disk;
use crate::table::sealed::{CHECKPOINT, SealError, open, seal};
use crate::trouble::Trouble;
use serde::{Deserialize, Serialize};
use springpot::driver::{PassedLimit, Report};
use springpot::sensitivity::Lost;
use springpot::system::{RunError, Stop, System};
use springpot_scenario::{Cases, Plan};
use std::io;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Text is handed over at about this size.
const CHUNK: usize = 1 << 16;

/// A case that has come to its end, with all that a run writes of it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Parcel {
    pub(super) done: CaseDone,
    rows: ParcelRows,
    /// Its values that are kept for figures, row by row.
    kept: Vec<f64>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
enum ParcelRows {
    /// As they stand in the file.
    Text(Vec<u8>),
    /// One for each selected column; NaN where a cell is empty.
    Columns(Vec<Vec<f64>>),
}

/// What is known of a case that was read back, its rows aside.
#[derive(Debug, Default)]
pub(crate) struct Ended {
    pub(crate) index: usize,
    pub(crate) report: Report,
    pub(crate) error: Option<Trouble>,
    pub(crate) no_ledger: Option<String>,
    pub(crate) limits: Vec<PassedLimit>,
    pub(crate) wall: Duration,
    /// Values in the order of the scenario.
    pub(crate) metrics: Vec<f64>,
    /// By metric and parameter.
    pub(crate) gradients: Vec<Vec<f64>>,
    pub(crate) lost: Vec<Lost>,
    /// Its lines in events.csv.
    pub(crate) events: String,
}

/// Takes text of rows, and values kept for figures.
type TakeRows<'a> = &'a mut dyn FnMut(&[u8], &[f64]) -> io::Result<()>;

/// Where cases are found that have come to their end elsewhere.
pub trait Source: Send + Sync {
    /// Case `index`; `None` where it is to be run here. Each case is asked for once, in order where one job runs.
    ///
    /// # Errors
    /// What keeps the whole run from going on; `Interrupted` where it was told to stop before the case was there.
    fn case(&self, index: usize) -> io::Result<Option<Arc<Parcel>>>;

    /// Wall time that was spent elsewhere.
    fn wall(&self) -> Duration {
        Duration::ZERO
    }
}

impl Source for Shards {
    fn case(&self, index: usize) -> io::Result<Option<Arc<Parcel>>> {
        let ended = self.ended(index).map_err(io::Error::other)?;
        Ok(ended.map(|(done, rows, kept)| Arc::new(Parcel::of_text(done, rows, kept))))
    }

    fn wall(&self) -> Duration {
        self.wall_of_parts()
    }
}

/// Why bytes are no parcel.
#[derive(Debug, thiserror::Error)]
pub enum ParcelError {
    /// Another version or build of Springpot wrote them.
    #[error("a case was computed by {theirs:?}, this is {ours:?}: all processes must run the same build")]
    OtherBuild {
        /// Who wrote it.
        theirs: String,
        /// Who reads it.
        ours: String,
    },
    /// They are damaged.
    #[error("a case that was handed over is damaged")]
    Damaged,
}

impl Parcel {
    /// Runs case `index` of `cases` into memory; `None` where it was interrupted.
    ///
    /// A case that fails is a parcel too: with its rows up to there, and [`Self::error`].
    ///
    /// # Panics
    /// Never: memory takes all rows.
    pub fn run(cases: &Cases, layout: &Layout, index: usize, stop: &Stop, progress: &Progress) -> Option<Self> {
        let begun = Instant::now();
        let taken = Taken::of(cases, layout, index);
        let columns = vec![Vec::new(); taken.selected.len()];
        let mut sink = Memory { taken, columns, kept: Vec::new() };
        let ran = simulate(cases, index, (stop, progress), None, &mut sink).expect("memory takes all rows");
        if ran.interrupted {
            return None;
        }
        let Ran { report, error, no_ledger, limits, metrics, .. } = ran;
        let Memory { taken: Taken { statistics, events, .. }, columns, kept } = sink;
        let (rows, wall) = (Stretch::default(), begun.elapsed());
        let written = Written { rows, aside: false, kept: rows, statistics, events, wall, wall_of_run: wall };
        let done = CaseDone { index, written, report, error, no_ledger, limits, metrics };
        Some(Self { done, rows: ParcelRows::Columns(columns), kept })
    }

    /// A case that was read back from results, with its columns behind the swept parameters.
    pub(crate) fn read_back(ended: Ended, columns: Vec<Vec<f64>>) -> Self {
        let Ended { index, report, error, no_ledger, limits, wall, metrics, gradients, lost, events } = ended;
        let statistics = columns.iter().map(|column| {
            let mut statistics = Statistics::default();
            column.iter().for_each(|value| statistics.add(*value));
            statistics
        });
        let events = CaseEvents { lines: events, happened: Happened::default() };
        let (rows, statistics) = (Stretch::default(), statistics.collect());
        let written = Written { rows, aside: false, kept: rows, statistics, events, wall, wall_of_run: wall };
        let derivatives = CaseDerivatives { gradients, lost, ..CaseDerivatives::default() };
        let metrics = CaseMetrics { values: metrics, derivatives, ..CaseMetrics::default() };
        let done = CaseDone { index, written, report, error, no_ledger, limits, metrics };
        Self { done, rows: ParcelRows::Columns(columns), kept: Vec::new() }
    }

    /// A case whose rows are known as text.
    pub(super) fn of_text(done: CaseDone, rows: Vec<u8>, kept: Vec<f64>) -> Self {
        Self { done, rows: ParcelRows::Text(rows), kept }
    }

    /// The cases that a run under way has brought to their end, up to the first that has not ended, with their rows as numbers.
    ///
    /// # Errors
    /// As [`Unfinished::read`](super::Unfinished::read); damaged rows.
    pub fn under_way(results: &Path, disk: &Disk, holder: &str, layout: &Layout) -> Result<Vec<Self>, CheckpointError> {
        let (swept, columns) = (layout.swept(), layout.written().len() - layout.swept());
        let cases = Shards::under_way(results, disk, holder, layout)?.into_iter().map(|(done, rows, kept)| {
            let numbers = Self::of_text(done, rows, kept).with_numbers(swept, columns);
            numbers.map_err(|_| CheckpointError::Rows(results.to_owned()))
        });
        cases.collect()
    }

    /// Bytes that hold every number to the bit.
    ///
    /// # Errors
    /// More than memory holds.
    pub fn to_bytes(&self) -> io::Result<Vec<u8>> {
        seal(CHECKPOINT, self)
    }

    /// What [`Self::to_bytes`] made, in this process or in another one of the same build.
    ///
    /// # Errors
    /// [`ParcelError`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ParcelError> {
        open(CHECKPOINT, bytes).map_err(|error| match error {
            SealError::OtherVersion(theirs) => {
                ParcelError::OtherBuild { theirs, ours: CHECKPOINT.trim_end().to_owned() }
            }
            _ => ParcelError::Damaged,
        })
    }

    /// Index in the grid.
    pub fn index(&self) -> usize {
        self.done.index
    }

    /// Steps, rows, energy.
    pub fn report(&self) -> &Report {
        &self.done.report
    }

    /// Why it stopped early.
    pub fn error(&self) -> Option<&Trouble> {
        self.done.error.as_ref()
    }

    /// Why its energy ledger is not known; `None` where it is.
    pub fn no_ledger(&self) -> Option<&str> {
        self.done.no_ledger.as_deref()
    }

    /// The limits of joints that it passes.
    pub fn limits(&self) -> &[PassedLimit] {
        &self.done.limits
    }

    /// What its metrics are.
    pub fn metrics(&self) -> &CaseMetrics {
        &self.done.metrics
    }

    /// Its lines in events.csv, and how often each event happened.
    pub fn events(&self) -> (&str, &Happened) {
        (&self.done.written.events.lines, &self.done.written.events.happened)
    }

    /// Statistics of the selected columns, and behind them of those whose size ranks parameters.
    pub fn statistics(&self) -> &[Statistics] {
        &self.done.written.statistics
    }

    /// Wall time.
    pub fn wall(&self) -> Duration {
        self.done.written.wall
    }

    /// Its rows, column by column as [`Layout::written`] has them behind the swept parameters; NaN where a cell is empty. `None` where they are known as text.
    pub fn columns(&self) -> Option<&[Vec<f64>]> {
        match &self.rows {
            ParcelRows::Columns(columns) => Some(columns),
            ParcelRows::Text(_) => None,
        }
    }

    /// The same with these of its columns alone, by their place; the others hold nothing, and it is not written any more.
    pub fn with_columns(&self, kept: &[usize]) -> Self {
        let ParcelRows::Columns(columns) = &self.rows else { return self.clone() };
        let column = |(k, column): (usize, &Vec<f64>)| if kept.contains(&k) { column.clone() } else { Vec::new() };
        let rows = ParcelRows::Columns(columns.iter().enumerate().map(column).collect());
        Self { done: self.done.clone(), rows, kept: Vec::new() }
    }

    /// Whether it has all of its columns, so that it can be written.
    pub fn is_whole(&self) -> bool {
        let wanted = self.done.report.rows as usize;
        match &self.rows {
            ParcelRows::Text(_) => true,
            ParcelRows::Columns(columns) => columns.iter().all(|column| column.len() == wanted),
        }
    }

    /// The same with its rows as numbers: `swept` fields begin each of them.
    ///
    /// # Errors
    /// [`ParcelError::Damaged`] where they are no rows of so many columns.
    pub(super) fn with_numbers(self, swept: usize, columns: usize) -> Result<Self, ParcelError> {
        let ParcelRows::Text(text) = &self.rows else { return Ok(self) };
        let mut numbers = vec![Vec::new(); columns];
        let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(&text[..]);
        let mut row = csv::StringRecord::new();
        while reader.read_record(&mut row).map_err(|_| ParcelError::Damaged)? {
            if row.len() != swept + columns {
                return Err(ParcelError::Damaged);
            }
            for (column, field) in numbers.iter_mut().zip(row.iter().skip(swept)) {
                let value = if field.is_empty() { Ok(f64::NAN) } else { field.parse() };
                column.push(value.map_err(|_| ParcelError::Damaged)?);
            }
        }
        Ok(Self { rows: ParcelRows::Columns(numbers), ..self })
    }

    /// Hands over its rows as they stand in results.csv, and with each piece the values kept for figures that belong to it or to an earlier one.
    pub(super) fn hand_over(&self, lead: &str, width: usize, take: TakeRows<'_>) -> io::Result<()> {
        let columns = match &self.rows {
            ParcelRows::Text(text) => return take(text, &self.kept),
            ParcelRows::Columns(columns) => columns,
        };
        let (mut text, mut from) = (String::with_capacity(2 * CHUNK), 0);
        let rows = columns.first().map_or(0, Vec::len);
        for row in 0..rows {
            push_row(&mut text, lead, columns.iter().map(|column| column[row]));
            if text.len() >= CHUNK || row + 1 == rows {
                let kept = if width == 0 { &[][..] } else { &self.kept[from * width..(row + 1) * width] };
                take(text.as_bytes(), kept)?;
                text.clear();
                from = row + 1;
            }
        }
        Ok(())
    }

    /// The values that it keeps for figures, `width` of each row.
    pub(super) fn kept(&self, width: usize) -> impl Iterator<Item = &[f64]> {
        self.kept.chunks_exact(width.max(1))
    }
}

/// Rows that stay in memory.
struct Memory<'a> {
    taken: Taken<'a>,
    columns: Vec<Vec<f64>>,
    kept: Vec<f64>,
}

impl Sink for Memory<'_> {
    fn row(&mut self, row: &[f64]) -> io::Result<()> {
        for (column, &k) in self.columns.iter_mut().zip(&self.taken.selected) {
            // As a file has it: an infinity is an empty cell.
            column.push(if row[k].is_finite() { row[k] } else { f64::NAN });
        }
        self.kept.extend_from_slice(self.taken.row(row));
        Ok(())
    }

    fn event(&mut self, system: &System, event: usize, row: &[f64]) {
        self.taken.event(system, event, row);
    }

    fn ended(&mut self, row: &[f64], later: &[f64]) {
        self.taken.ended(row, later);
    }

    fn is_due(&self, _t: f64, _last: bool) -> bool {
        false
    }

    fn keep(&mut self, _plan: &Plan, _system: &System, _resumed: Resumed) -> io::Result<()> {
        Ok(())
    }

    fn metrics(&self, plan: &Plan, back: Option<Back>) -> Result<CaseMetrics, RunError> {
        self.taken.metrics(plan, back)
    }
}
