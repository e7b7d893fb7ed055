//! One case of a sweep.

use super::checkpoint::{CaseDone, CaseFiles, CaseState};
use super::events::Happened;
use super::kept::{CaseCurves, Kept};
use super::metrics::CaseMetrics;
use super::output::{self, Output};
use super::parcel::Parcel;
use super::simulate::{Ran, Resumed, simulate};
use super::taken::{Taken, lead};
use super::{Options, Sweep};
use crate::table::disk::DiskFile;
use crate::table::ordered::Section;
use crate::trouble::Trouble;
use springpot::driver::{PassedLimit, Report};
use std::io::{self, ErrorKind};
use std::sync::atomic::Ordering;
use std::time::Duration;

/// What one case did.
#[derive(Debug)]
pub struct CaseResult {
    /// Index in the grid.
    pub index: usize,
    /// Steps, rows, energy.
    pub report: Report,
    /// Why it stopped early.
    pub error: Option<Trouble>,
    /// Whether it stopped because it was interrupted.
    pub interrupted: bool,
    /// Wall time.
    pub wall: Duration,
    /// Why its energy ledger is not known; `None` where it is.
    pub no_ledger: Option<String>,
    /// How often its events happened.
    pub events: Happened,
    /// The limits of joints that it passes.
    pub limits: Vec<PassedLimit>,
    /// What figures draw of it, where they do.
    pub curves: Option<CaseCurves>,
    /// What its metrics are.
    pub metrics: CaseMetrics,
}

/// The rows, the statistics, the events and the metrics of one case, in the files that all cases share.
#[derive(Debug)]
pub(super) struct Sections<'a> {
    rows: Section<'a, DiskFile>,
    rest: Rest<'a>,
}

/// What is written at the end of a case.
#[derive(Debug)]
struct Rest<'a> {
    summary: Section<'a, DiskFile>,
    events: Option<Section<'a, DiskFile>>,
    metrics: Option<Section<'a, DiskFile>>,
    gradient: Option<Section<'a, DiskFile>>,
    ranking: Option<Section<'a, DiskFile>>,
}

impl<'a> Sections<'a> {
    /// Those of case `index`, once its rows are within the window.
    pub(super) fn of(sweep: &'a Sweep<'a>, index: usize) -> Self {
        Self { rows: sweep.rows.section(index), rest: Rest::of(sweep, index) }
    }

    /// Leaves them empty.
    pub(super) fn finish(self) -> io::Result<()> {
        self.rows.finish()?;
        self.rest.write("", "", &CaseMetrics::default())
    }
}

impl<'a> Rest<'a> {
    fn of(sweep: &'a Sweep<'a>, index: usize) -> Self {
        Self {
            summary: sweep.summary.section(index),
            events: sweep.events.as_ref().map(|events| events.section(index)),
            metrics: sweep.metrics.as_ref().map(|metrics| metrics.section(index)),
            gradient: sweep.gradient.as_ref().map(|gradient| gradient.section(index)),
            ranking: sweep.ranking.as_ref().map(|ranking| ranking.section(index)),
        }
    }

    fn write(self, summary: &str, events: &str, metrics: &CaseMetrics) -> io::Result<()> {
        let [gradient, ranking] = &metrics.derivatives.lines;
        let gradient = self.gradient.map(|section| (section, &**gradient));
        let ranking = self.ranking.map(|section| (section, &**ranking));
        let events = self.events.map(|section| (section, events));
        let metrics = self.metrics.map(|section| (section, &*metrics.lines));
        let others = events.into_iter().chain(metrics).chain(gradient).chain(ranking);
        for (section, text) in [(self.summary, summary)].into_iter().chain(others) {
            section.write(text.as_bytes())?;
            section.finish()?;
        }
        Ok(())
    }
}

/// Runs case `index`, or goes on with it, or takes what an earlier run or another process has of it; `None` where it was to come from elsewhere
/// and the run was interrupted first.
///
/// # Errors
/// What keeps rows from being written; that of the case itself is in the result.
pub(super) fn run<'a>(sweep: &'a Sweep<'a>, index: usize, sections: Sections<'a>) -> io::Result<Option<CaseResult>> {
    let Options { checkpoints, source, stop, progress, .. } = sweep.options;
    if let Some(done) = checkpoints.map(|checkpoints| checkpoints.done(index)).transpose()?.flatten() {
        return again(sweep, done, Some(sections)).map(Some);
    }
    let state = checkpoints.and_then(|checkpoints| checkpoints.take_state(index));
    if let (None, Some(source)) = (&state, source) {
        match source.case(index) {
            Ok(Some(parcel)) => return delivered(sweep, &parcel, sections).map(Some),
            Ok(None) => {}
            Err(error) if error.kind() == ErrorKind::Interrupted && stop.load(Ordering::Relaxed) => {
                return sections.finish().map(|()| None);
            }
            Err(error) => return Err(error),
        }
    }
    let Sections { rows, rest } = sections;
    let mut output = Output::open(sweep, index, rows, state.as_ref())?;
    let resumed = state.map(|CaseState { run, watch, lost, .. }| Resumed { run, watch, lost });
    let ran = simulate(sweep.cases, index, (stop, progress), resumed, &mut output)?;
    let wall = output.wall();
    let taken = output.close(|output| {
        if ran.interrupted || output.files.is_none() {
            return Ok(());
        }
        let Ran { report, error, no_ledger, limits, metrics, .. } = ran.clone();
        let done = CaseDone { index, written: output.written(), report, error, no_ledger, limits, metrics };
        output.files.take().map_or(Ok(()), |files| files.end(&done, || sweep.sync()))
    })?;
    let Taken { statistics, events, kept, .. } = taken;
    rest.write(&output::summary(sweep, index, &statistics), &events.lines, &ran.metrics)?;
    let (curves, events) = (kept.and_then(Kept::into_curves), events.happened);
    let Ran { report, error, interrupted, no_ledger, limits, metrics } = ran;
    Ok(Some(CaseResult { index, report, error, interrupted, wall, no_ledger, events, limits, curves, metrics }))
}

/// Writes a case that came to its end elsewhere.
fn delivered(sweep: &Sweep, parcel: &Parcel, Sections { rows, rest }: Sections) -> io::Result<CaseResult> {
    let index = parcel.index();
    let aside = sweep.rows.turn() != index;
    let files = sweep.options.checkpoints.map(|checkpoints| CaseFiles::begin(checkpoints, index, aside));
    let mut files = files.transpose()?;
    let mut kept = Kept::of(sweep.layout, index).map(Kept::without_metrics);
    let width = kept.as_ref().map_or(0, Kept::width);
    parcel.hand_over(&lead(sweep.cases, index), width, &mut |text, values| {
        if let Some(files) = &mut files {
            files.take(text)?;
            files.take_kept(values)?;
        }
        rows.write(text)
    })?;
    if let Some(kept) = &mut kept {
        parcel.kept(width).for_each(|values| kept.again(values));
    }
    let mut done = parcel.done.clone();
    if let Some(files) = files {
        (done.written.rows, done.written.kept) = files.written();
        (done.written.aside, done.written.wall_of_run) = (files.is_aside(), sweep.wall());
        files.end(&done, || sweep.sync())?;
    }
    rows.finish()?;
    settled(sweep, done, rest, kept)
}

/// A case that an earlier run brought to its end, and whose rows stand where they belong.
///
/// # Errors
/// The file system's.
pub(super) fn ended(sweep: &Sweep, index: usize) -> io::Result<CaseResult> {
    let done = sweep.options.checkpoints.map(|checkpoints| checkpoints.done(index)).transpose()?.flatten();
    again(sweep, done.ok_or(io::ErrorKind::NotFound)?, None)
}

/// Writes what an earlier run has of a case that it brought to its end.
fn again(sweep: &Sweep, done: CaseDone, rows: Option<Sections>) -> io::Result<CaseResult> {
    let checkpoints = sweep.options.checkpoints.expect("it has the record");
    let rest = match rows {
        Some(Sections { rows, rest }) => {
            checkpoints.copy_rows(&done, &mut |text| rows.write(text))?;
            rows.finish()?;
            rest
        }
        None => Rest::of(sweep, done.index),
    };
    let mut kept = Kept::of(sweep.layout, done.index).map(Kept::without_metrics);
    if let Some(kept) = &mut kept {
        checkpoints.kept(done.index, done.written.kept, kept.width(), &mut |values| kept.again(values))?;
    }
    settled(sweep, done, rest, kept)
}

/// Writes the lines of a case whose rows are written.
fn settled(sweep: &Sweep, done: CaseDone, rest: Rest, kept: Option<Kept>) -> io::Result<CaseResult> {
    let lines = output::summary(sweep, done.index, &done.written.statistics);
    rest.write(&lines, &done.written.events.lines, &done.metrics)?;
    let curves = kept.and_then(Kept::into_curves);
    let CaseDone { index, written, report, error, no_ledger, limits, metrics } = done;
    sweep.options.progress.rows.fetch_add(report.rows, Ordering::Relaxed);
    let (wall, events) = (written.wall, written.events.happened);
    Ok(CaseResult { index, report, error, interrupted: false, wall, no_ledger, events, limits, curves, metrics })
}
