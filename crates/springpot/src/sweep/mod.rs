//! All cases of a scenario on all cores, into one folder of results.

mod case;
mod layout;
mod record;

pub use case::CaseResult;
pub use layout::{FigureColumn, FigureData, Layout, MAX_CURVES};

use crate::scenario::{Cases, Refusals};
use crate::simulate::Stop;
use crate::table::folder::Folder;
use crate::table::ordered::Ordered;
use crate::table::{Column, push_number};
use std::fs::File;
use std::io;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How a sweep is carried out.
#[derive(Debug, Clone, Copy)]
pub struct Options<'a> {
    /// Cases at a time.
    pub jobs: usize,
    /// Set from outside to interrupt.
    pub stop: &'a Stop,
    /// Rows written so far, over all cases; counted as the run goes.
    pub rows: &'a AtomicU64,
}

/// How a sweep ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// Every case reached its end.
    Done,
    /// At least one case did not.
    Failed,
    /// Interrupted from outside.
    Interrupted,
}

/// What a sweep did.
#[derive(Debug)]
pub struct Outcome {
    /// How it ended.
    pub status: Status,
    /// The cases that were begun, in order; successful ones beyond [`MAX_LISTED`] are counted only.
    pub cases: Vec<CaseResult>,
    /// Cases that reached their end.
    pub done: usize,
    /// Cases that failed.
    pub failed: usize,
    /// Inner steps over all cases.
    pub steps: u64,
    /// Inner steps tried and not kept.
    pub rejected_steps: u64,
    /// Smallest time reached by a case that was begun; `None` where one has no row, or none was begun.
    pub t_reached: Option<f64>,
    /// The energy residual of the case in which it is largest beside the energy turned over, and that energy, J; `None`
    /// where no case knows its ledger.
    pub energy_residual: Option<(f64, f64)>,
    /// Wall time.
    pub wall: Duration,
}

/// Successful cases that are listed one by one.
pub const MAX_LISTED: usize = 10_000;

/// Why a sweep could not be carried out at all.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// The scenario asks for columns that do not exist, or the like.
    #[error(transparent)]
    Refused(#[from] Refusals),
    /// The folder of the results cannot be written.
    #[error("the results cannot be written: {0}")]
    Output(#[from] io::Error),
}

/// Runs every case and streams rows and statistics into `folder`, in case order for any number of jobs.
///
/// A case that fails does not stop the others; its rows up to the failure are written.
///
/// # Errors
/// [`SweepError::Output`] where the folder cannot be written.
pub fn run(cases: &Cases, layout: &Layout, folder: &mut Folder, options: Options) -> Result<Outcome, SweepError> {
    let begun = Instant::now();
    let jobs = options.jobs.clamp(1, cases.len().max(1));
    let writers = Writers {
        rows: Ordered::new(folder.open_rows()?, 4 * jobs + 16),
        summary: Ordered::new(folder.open_summary()?, usize::MAX / 2),
    };
    writers.rows.write(0, header(layout.written()).as_bytes())?;
    writers.summary.write(0, header(&layout.summary_columns()).as_bytes())?;

    let next = AtomicUsize::new(0);
    let tally = Mutex::new(Tally::default());
    let work = || -> io::Result<()> {
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= cases.len() || options.stop.load(Ordering::Relaxed) {
                return Ok(());
            }
            writers.rows.wait_for_turn(index);
            let result = case::run(cases, index, layout, &writers, &options)?;
            tally.lock().unwrap_or_else(PoisonError::into_inner).take(result);
        }
    };
    std::thread::scope(|scope| -> io::Result<()> {
        let others: Vec<_> = (1..jobs).map(|_| scope.spawn(work)).collect();
        let own = work();
        let joined =
            others.into_iter().map(|other| other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        own.and(joined.collect())
    })?;
    folder.close_rows()?;
    folder.close_summary();

    let mut tally = tally.into_inner().unwrap_or_else(PoisonError::into_inner);
    tally.cases.sort_by_key(|case| case.index);
    let status = if options.stop.load(Ordering::Relaxed) && tally.done < cases.len() {
        Status::Interrupted
    } else if tally.failed > 0 {
        Status::Failed
    } else {
        Status::Done
    };
    Ok(Outcome {
        status,
        cases: tally.cases,
        done: tally.done,
        failed: tally.failed,
        steps: tally.steps,
        rejected_steps: tally.rejected_steps,
        t_reached: tally.t_reached.flatten(),
        energy_residual: tally.energy_residual,
        wall: begun.elapsed(),
    })
}

/// The two files that all cases write.
#[derive(Debug)]
struct Writers {
    rows: Ordered<File>,
    summary: Ordered<File>,
}

/// What is added up over the cases.
#[derive(Debug, Default)]
struct Tally {
    cases: Vec<CaseResult>,
    done: usize,
    failed: usize,
    steps: u64,
    rejected_steps: u64,
    /// `None` before the first case.
    t_reached: Option<Option<f64>>,
    energy_residual: Option<(f64, f64)>,
}

impl Tally {
    fn take(&mut self, case: CaseResult) {
        match &case.error {
            None => self.done += 1,
            Some(_) if case.interrupted => {}
            Some(_) => self.failed += 1,
        }
        self.steps += case.report.steps;
        self.rejected_steps += case.report.rejected_steps;
        let reached = case.report.t_reached;
        self.t_reached = Some(match self.t_reached {
            None => reached,
            Some(smallest) => smallest.zip(reached).map(|(a, b)| a.min(b)),
        });
        if let Some((residual, turned_over)) = case.report.energy_residual.zip(case.report.energy_turned_over) {
            let share =
                |(residual, turned_over): (f64, f64)| if residual == 0.0 { 0.0 } else { residual / turned_over };
            let new = (residual, turned_over);
            if self.energy_residual.is_none_or(|old| share(new) > share(old)) {
                self.energy_residual = Some(new);
            }
        }
        if case.error.is_some() || case.kept.is_some() || self.cases.len() < MAX_LISTED {
            self.cases.push(case);
        }
    }
}

/// One line of column names.
fn header(columns: &[Column]) -> String {
    let mut line = String::new();
    for (k, column) in columns.iter().enumerate() {
        if k > 0 {
            line.push(',');
        }
        push_field(&mut line, &column.name);
    }
    line.push('\n');
    line
}

/// Appends a text as one CSV field (RFC 4180).
fn push_field(line: &mut String, text: &str) {
    if text.contains([',', '"', '\n', '\r']) {
        line.push('"');
        line.push_str(&text.replace('"', "\"\""));
        line.push('"');
    } else {
        line.push_str(text);
    }
}

/// Appends numbers as fields, each with its comma in front.
fn push_fields(line: &mut String, values: impl Iterator<Item = f64>) {
    for value in values {
        line.push(',');
        push_number(line, value);
    }
}
