//! All cases of a scenario on all cores, into one folder of results.

mod case;
mod checkpoint;
mod derivatives;
mod events;
mod kept;
mod layout;
mod limits;
mod metrics;
mod output;
mod parcel;
mod record;
mod shard;
mod simulate;
mod taken;

pub use case::CaseResult;
pub use checkpoint::{CheckpointError, Checkpoints, MergeError, Origin, Shards, Unfinished};
pub use derivatives::CaseDerivatives;
pub use events::Happened;
pub use kept::CaseCurves;
pub use layout::{
    Abscissa, FigureCurve, FigureData, FigureTotal, KeptCurve, Layout, LeftOut, MAX_CURVES, MAX_CURVES_IN_ALL, Ranked,
    Total, most_points,
};
pub use limits::{CasesPassing, LimitTally};
pub use metrics::CaseMetrics;
pub(crate) use parcel::Ended;
pub use parcel::{Parcel, ParcelError, Source};
pub(crate) use record::begun;
pub use shard::Shard;
pub(crate) use taken::push_row;

use crate::metrics::{COLUMNS as METRIC_COLUMNS, GRADIENT_COLUMNS};
use crate::table::disk::DiskFile;
use crate::table::folder::{EVENTS, Folder, GRADIENT, METRICS, RANKING};
use crate::table::ordered::Ordered;
use crate::table::push_text;
use case::Sections;
use derivatives::RANKING_COLUMNS;
use springpot::driver::Report;
use springpot::system::Stop;
use springpot::table::Column;
use springpot_scenario::{Cases, Refusals};
use std::fmt;
use std::io::{self, Seek as _, SeekFrom, Write as _};
use std::ops::Range;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How a sweep is carried out.
#[derive(Clone, Copy)]
pub struct Options<'a> {
    /// Cases at a time.
    pub jobs: usize,
    /// Set from outside to interrupt.
    pub stop: &'a Stop,
    /// How far the run has come.
    pub progress: &'a Progress,
    /// Keeps what it takes to go on later, or goes on.
    pub checkpoints: Option<&'a Checkpoints>,
    /// Has cases that came to their end elsewhere.
    pub source: Option<&'a dyn Source>,
    /// The part of the cases that is run; `None`: all.
    pub shard: Option<Shard>,
}

impl fmt::Debug for Options<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { jobs, checkpoints, shard, .. } = self;
        f.debug_struct("Options").field("jobs", jobs).field("checkpoints", checkpoints).field("shard", shard).finish()
    }
}

/// How far a run has come, for others to watch.
#[derive(Debug, Default)]
pub struct Progress {
    /// Rows written so far, over all cases.
    pub rows: AtomicU64,
    /// The most switches of the signals of one case so far.
    pub switches: AtomicU64,
    /// The bits of the time, s, that some case has reached.
    t: AtomicU64,
}

impl Progress {
    /// The time that some case has reached, s.
    pub fn t(&self) -> f64 {
        f64::from_bits(self.t.load(Ordering::Relaxed))
    }

    fn reach(&self, t: f64) {
        self.t.store(t.to_bits(), Ordering::Relaxed);
    }
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
    /// The cases that were begun, in order; beyond [`MAX_LISTED`] that ended well, and as many that did not, they are
    /// counted only, unless a figure draws them.
    pub cases: Vec<CaseResult>,
    /// Cases that reached their end.
    pub done: usize,
    /// Cases that failed.
    pub failed: usize,
    /// Inner steps over all cases.
    pub steps: u64,
    /// Inner steps tried and not kept.
    pub rejected_steps: u64,
    /// What forward dynamics took over all cases.
    pub forward: Option<ForwardWork>,
    /// Simulated time over all cases, s.
    pub simulated: f64,
    /// Smallest time reached by a case that was begun; `None` where one has no row, or none was begun.
    pub t_reached: Option<f64>,
    /// The energy residual of the case in which it is largest beside the energy turned over, and that energy, J; `None`
    /// where no case knows its ledger.
    pub energy_residual: Option<(f64, f64)>,
    /// Whether that is no more than rounding makes of it.
    pub is_rounding: bool,
    /// How often each event happened over all cases.
    pub events: Happened,
    /// The limits of joints that cases pass.
    pub limits: Vec<CasesPassing>,
    /// Number of cases that do not know their ledger, and why the first of them does not.
    pub no_ledger: Option<(usize, String)>,
    /// The part of the cases that was run; `None`: all.
    pub shard: Option<Shard>,
    /// Wall time.
    pub wall: Duration,
}

/// Cases that are listed one by one, of those that ended well and of those that did not.
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

/// Runs every case and streams rows and statistics into `folder`, in case order for any number of jobs; [`Folder::put`] then puts them in
/// the place of the last run's.
///
/// A case that fails does not stop the others; its rows up to the failure are written.
///
/// # Errors
/// [`SweepError::Output`] where the folder cannot be written; the complete rows that were written stay in `results.csv.part`.
pub fn run(cases: &Cases, layout: &Layout, folder: &mut Folder, options: Options) -> Result<Outcome, SweepError> {
    let Range { start, end } = options.shard.map_or(0..cases.len(), |shard| shard.cases(cases.len()));
    let jobs = options.jobs.clamp(1, (end - start).max(1));
    let sweep = Sweep::open(cases, layout, folder, options, (start, jobs))?;
    let mut tally = Tally::default();
    for index in start..sweep.first {
        tally.take(case::ended(&sweep, index)?);
    }

    let next = AtomicUsize::new(sweep.first);
    let tally = Mutex::new(tally);
    let stopped = || options.stop.load(Ordering::Relaxed);
    let work = || -> io::Result<()> {
        while !stopped() {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= end {
                break;
            }
            let sections = Sections::of(&sweep, index);
            // The section may have been long in coming.
            if stopped() {
                sections.finish()?;
                break;
            }
            let Some(result) = case::run(&sweep, index, sections)? else { break };
            tally.lock().unwrap_or_else(PoisonError::into_inner).take(result);
        }
        Ok(())
    };
    let ended = std::thread::scope(|scope| {
        // Where the system gives fewer threads, fewer do the work.
        let spawn = |_| std::thread::Builder::new().spawn_scoped(scope, work).ok();
        let others: Vec<_> = (1..jobs).map_while(spawn).collect();
        let own = work();
        let joined = others.into_iter().map(|other| other.join().unwrap_or_else(|panic| resume_unwind(panic)));
        first_error(std::iter::once(own).chain(joined))
    });
    if let Err(error) = ended {
        // What keeps rows from being written may keep them from being cut too; the first error is the one to tell.
        let _ = folder.cut_rows();
        return Err(error.into());
    }

    let mut tally = tally.into_inner().unwrap_or_else(PoisonError::into_inner);
    tally.cases.sort_by_key(|case| case.index);
    let status = if stopped() && tally.done + tally.failed < end - start {
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
        forward: tally.forward,
        simulated: tally.simulated,
        t_reached: tally.t_reached.flatten(),
        energy_residual: tally.energy_residual.map(|(_, [residual, turned_over])| (residual, turned_over)),
        is_rounding: tally.energy_residual.is_some_and(|(share, _)| share == 0.0),
        events: tally.events,
        limits: tally.limits.passing(),
        no_ledger: tally.no_ledger.map(|(count, _, why)| (count, why)),
        shard: options.shard,
        wall: sweep.wall(),
    })
}

/// What all cases share.
#[derive(Debug)]
struct Sweep<'a> {
    cases: &'a Cases,
    layout: &'a Layout,
    options: Options<'a>,
    rows: Ordered<DiskFile>,
    summary: Ordered<DiskFile>,
    /// Where there are events.
    events: Option<Ordered<DiskFile>>,
    /// Where there are metrics.
    metrics: Option<Ordered<DiskFile>>,
    /// Where there are metrics and parameters.
    gradient: Option<Ordered<DiskFile>>,
    /// Where there are parameters.
    ranking: Option<Ordered<DiskFile>>,
    /// The file of `rows`, to wait for the disk without keeping others from writing.
    file: DiskFile,
    /// The first case that has not ended.
    first: usize,
    begun: Instant,
    earlier_wall: Duration,
}

impl<'a> Sweep<'a> {
    fn open(
        cases: &'a Cases,
        layout: &'a Layout,
        folder: &mut Folder,
        options: Options<'a>,
        (start, jobs): (usize, usize),
    ) -> io::Result<Self> {
        let begun = Instant::now();
        let first = options.checkpoints.and_then(Checkpoints::first);
        let mut summary = folder.create_summary()?;
        summary.write_all(header(&layout.summary_columns()).as_bytes())?;
        // What is written at the end of each case, where there is any.
        let mut beside = |is_there: bool, name: &str, columns: &dyn Fn() -> Vec<Column>| {
            let begin = || {
                let mut file = folder.create_beside(name)?;
                file.write_all(header(&columns()).as_bytes())?;
                Ok::<_, io::Error>(Ordered::new(file, usize::MAX).from_case(start))
            };
            is_there.then(begin).transpose()
        };
        let events = beside(!layout.events().is_empty(), EVENTS, &|| layout.event_columns())?;
        let metrics = beside(!layout.metrics().is_empty(), METRICS, &|| layout.columns_with(&METRIC_COLUMNS))?;
        let gradient = beside(layout.has_gradients(), GRADIENT, &|| layout.columns_with(&GRADIENT_COLUMNS))?;
        let is_ranked = layout.differentiated().is_some();
        let ranking = beside(is_ranked, RANKING, &|| layout.columns_with(&RANKING_COLUMNS))?;
        let rows = if first.is_some() {
            let mut rows = folder.reopen_rows()?;
            rows.seek(SeekFrom::End(0))?;
            rows
        } else {
            let mut rows = folder.create_rows()?;
            rows.write_all(header(layout.written()).as_bytes())?;
            if options.checkpoints.is_some() {
                rows.sync()?;
                folder.disk().sync_folder(folder.path())?;
            }
            rows
        };
        let first = first.unwrap_or(start);
        Ok(Self {
            cases,
            layout,
            options,
            file: rows.try_clone()?,
            rows: Ordered::new(rows, 4 * jobs + 16).from_case(first),
            // It begins with the cases that have ended.
            summary: Ordered::new(summary, usize::MAX).from_case(start),
            events,
            metrics,
            gradient,
            ranking,
            first,
            begun,
            earlier_wall: options.checkpoints.map_or(Duration::ZERO, Checkpoints::earlier_wall)
                + options.source.map_or(Duration::ZERO, Source::wall),
        })
    }

    /// Makes the rows safe from the loss of power; returns the first case whose rows may not all be there.
    fn sync(&self) -> io::Result<usize> {
        let turn = self.rows.turn();
        self.file.sync()?;
        // Once interrupted, cases may end without rows.
        Ok(if self.options.stop.load(Ordering::Relaxed) { 0 } else { turn })
    }

    /// Wall time, that of an earlier run included.
    fn wall(&self) -> Duration {
        self.earlier_wall + self.begun.elapsed()
    }
}

/// The error with the system's own words, or else any: a case that others kept from writing knows its kind alone.
fn first_error(results: impl Iterator<Item = io::Result<()>>) -> io::Result<()> {
    let errors = results.filter_map(Result::err);
    errors.max_by_key(|error| error.raw_os_error().is_some()).map_or(Ok(()), Err)
}

/// What forward dynamics took.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ForwardWork {
    /// Newton iterations of implicit steps.
    pub newton_iterations: u64,
    /// Explicit steps; `None` where no case may take any.
    pub explicit_steps: Option<u64>,
    /// Solves for accelerations in these.
    pub evaluations: u64,
    /// How often a method took over from another one.
    pub method_switches: u64,
}

impl ForwardWork {
    fn take(&mut self, iterations: u64, report: &Report) {
        self.newton_iterations += iterations;
        if let Some(steps) = report.explicit_steps {
            *self.explicit_steps.get_or_insert(0) += steps;
        }
        self.evaluations += report.evaluations.unwrap_or(0);
        self.method_switches += report.method_switches.unwrap_or(0);
    }
}

/// What is added up over the cases.
#[derive(Debug, Default)]
struct Tally {
    cases: Vec<CaseResult>,
    done: usize,
    failed: usize,
    steps: u64,
    rejected_steps: u64,
    forward: Option<ForwardWork>,
    simulated: f64,
    /// `None` before the first case.
    t_reached: Option<Option<f64>>,
    /// The largest share of the energy turned over by which a balance departs, and the residual and the energy of that case.
    energy_residual: Option<(f64, [f64; 2])>,
    events: Happened,
    limits: LimitTally,
    /// How many, index of the first, and its reason.
    no_ledger: Option<(usize, usize, String)>,
    listed: [usize; 2],
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
        if let Some(iterations) = case.report.newton_iterations {
            self.forward.get_or_insert_default().take(iterations, &case.report);
        }
        let reached = case.report.t_reached;
        self.simulated += reached.unwrap_or(0.0);
        self.t_reached = Some(match self.t_reached {
            None => reached,
            Some(smallest) => smallest.zip(reached).map(|(a, b)| a.min(b)),
        });
        if let Some((residual, turned_over)) = case.report.energy_residual.zip(case.report.energy_turned_over) {
            let rounding = case.report.energy_rounding.unwrap_or(0.0);
            // What rounding alone may do is no departure.
            let share = if residual <= rounding { 0.0 } else { residual / turned_over };
            if self.energy_residual.is_none_or(|(old, _)| share > old) {
                self.energy_residual = Some((share, [residual, turned_over]));
            }
        }
        self.events.add(&case.events);
        self.limits.take(case.index, &case.limits);
        if let Some(why) = &case.no_ledger {
            let (count, first, reason) = self.no_ledger.get_or_insert_with(|| (0, case.index, why.clone()));
            *count += 1;
            if case.index < *first {
                (*first, *reason) = (case.index, why.clone());
            }
        }
        let listed = &mut self.listed[usize::from(case.error.is_some())];
        if case.curves.is_some() || *listed < MAX_LISTED {
            *listed += 1;
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
        push_text(&mut line, &column.name);
    }
    line.push('\n');
    line
}
