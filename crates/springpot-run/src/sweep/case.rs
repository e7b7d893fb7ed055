//! One case of a sweep.

use super::Sweep;
use super::checkpoint::CaseDone;
use super::events::Happened;
use super::kept::{CaseCurves, Kept};
use super::metrics::CaseMetrics;
use super::output::{self, CaseRows, Output};
use crate::table::disk::DiskFile;
use crate::table::ordered::Section;
use crate::trouble::Trouble;
use springpot::integrate::{self, LimitWatch, PassedLimit, Report, RunError, System};
use std::io;
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
}

impl<'a> Sections<'a> {
    /// Those of case `index`, once its rows are within the window.
    pub(super) fn of(sweep: &'a Sweep<'a>, index: usize) -> Self {
        Self { rows: sweep.rows.section(index), rest: Rest::of(sweep, index) }
    }

    /// Leaves them empty.
    pub(super) fn finish(self) -> io::Result<()> {
        self.rows.finish()?;
        self.rest.write("", "", "")
    }
}

impl<'a> Rest<'a> {
    fn of(sweep: &'a Sweep<'a>, index: usize) -> Self {
        Self {
            summary: sweep.summary.section(index),
            events: sweep.events.as_ref().map(|events| events.section(index)),
            metrics: sweep.metrics.as_ref().map(|metrics| metrics.section(index)),
        }
    }

    fn write(self, summary: &str, events: &str, metrics: &str) -> io::Result<()> {
        let events = self.events.map(|section| (section, events));
        let metrics = self.metrics.map(|section| (section, metrics));
        for (section, text) in [(self.summary, summary)].into_iter().chain(events).chain(metrics) {
            section.write(text.as_bytes())?;
            section.finish()?;
        }
        Ok(())
    }
}

/// Runs case `index`, or goes on with it.
///
/// # Errors
/// What keeps rows from being written; that of the case itself is in the result.
pub(super) fn run<'a>(sweep: &'a Sweep<'a>, index: usize, sections: Sections<'a>) -> io::Result<CaseResult> {
    let checkpoints = sweep.options.checkpoints;
    if let Some(done) = checkpoints.map(|checkpoints| checkpoints.done(index)).transpose()?.flatten() {
        return again(sweep, done, Some(sections));
    }
    let Sections { rows, rest } = sections;
    let state = checkpoints.and_then(|checkpoints| checkpoints.take_state(index));
    let mut output = Output::open(sweep, index, rows, state.as_ref())?;
    let (report, no_ledger, limits, metrics, outcome) = match sweep.cases.plan(index) {
        Err(refusals) => {
            let why = Some("no row was written".into());
            let trouble = Trouble { message: refusals.to_string(), ..Trouble::default() };
            (Report::default(), why, Vec::new(), CaseMetrics::default(), Err((trouble, None)))
        }
        Ok(plan) => {
            let stop = sweep.options.stop;
            let (system, settings) = (plan.system_unless(stop), plan.settings.clone());
            let watch = LimitWatch::new(&system);
            let mut rows = CaseRows { output: &mut output, watch, plan: &plan, system: &system };
            let (report, outcome) = match state {
                None => integrate::run(&system, &settings, &mut rows, stop),
                Some(state) => {
                    rows.watch.go_on(state.watch);
                    integrate::resume(&system, &settings, state.run, &mut rows, stop)
                }
            };
            let passed = rows.watch.passed();
            (
                report,
                why_no_ledger(&system, &report),
                passed,
                output.metrics(&plan.metrics),
                outcome.map_err(|error| (Trouble::of(&error, &plan), Some(error))),
            )
        }
    };
    let (error, interrupted) = match outcome {
        Ok(()) => (None, false),
        // What was kept last is what can be gone on from.
        Err((_, Some(RunError::Output(error)))) => return Err(error),
        Err((trouble, error)) => (Some(trouble), matches!(error, Some(RunError::Interrupted { .. }))),
    };
    let (wall, statistics, events) = (output.wall(), output.statistics.clone(), output.events.clone());
    let curves = output.close(|output| {
        if interrupted || output.files.is_none() {
            return Ok(());
        }
        let (error, no_ledger, limits, metrics) = (error.clone(), no_ledger.clone(), limits.clone(), metrics.clone());
        let done = CaseDone { index, written: output.written(), report, error, no_ledger, limits, metrics };
        output.files.take().map_or(Ok(()), |files| files.end(&done, || sweep.sync()))
    })?;
    rest.write(&output::summary(sweep, index, &statistics), &events.lines, &metrics.lines)?;
    let events = events.happened;
    Ok(CaseResult { index, report, error, interrupted, wall, no_ledger, events, limits, curves, metrics })
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
    let lines = output::summary(sweep, done.index, &done.written.statistics);
    let checkpoints = sweep.options.checkpoints.expect("it has the record");
    let rest = match rows {
        Some(Sections { rows, rest }) => {
            checkpoints.copy_rows(&done, &mut |text| rows.write(text))?;
            rows.finish()?;
            rest
        }
        None => Rest::of(sweep, done.index),
    };
    rest.write(&lines, &done.written.events.lines, &done.metrics.lines)?;
    let mut kept = Kept::of(sweep.layout, done.index).map(Kept::without_metrics);
    if let Some(kept) = &mut kept {
        checkpoints.kept(done.index, done.written.kept, kept.width(), &mut |values| kept.again(values))?;
    }
    let curves = kept.and_then(Kept::into_curves);
    let CaseDone { index, written, report, error, no_ledger, limits, metrics } = done;
    sweep.options.progress.rows.fetch_add(report.rows, Ordering::Relaxed);
    let (wall, events) = (written.wall, written.events.happened);
    Ok(CaseResult { index, report, error, interrupted: false, wall, no_ledger, events, limits, curves, metrics })
}

/// Why a case does not know its energies; `None` where it does.
fn why_no_ledger(system: &System, report: &Report) -> Option<String> {
    if report.energy_residual.is_some() {
        return None;
    }
    if report.rows == 0 {
        return Some("no row was written".into());
    }
    if let Some(element) = system.elements.iter().find(|element| element.scheme.is_some()) {
        return Some(format!("element \"{}\" has a named scheme, which keeps no account of energy", element.name));
    }
    let starts = system.element_starts().unwrap_or_default();
    let singular = system.elements.iter().zip(&starts).find(|(_, start)| start.singular);
    Some(singular.map_or("an energy is not finite".into(), |(element, _)| {
        format!("element \"{}\" starts with x(0) != 0 and the Riemann-Liouville derivative", element.name)
    }))
}
