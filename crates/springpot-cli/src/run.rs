//! `springpot run`.

mod prepare;

use self::prepare::{Prepared, Unprepared, prepare};
use crate::arguments::RunOptions;
use crate::numbers::{brief, count, rough, short};
use crate::{Ending, diagnostic, figures, progress, terminal};
use springpot::scenario::Cases;
use springpot::sweep::{self, CaseResult, CasesPassing, Options, Outcome, Status, SweepError};
use springpot::table::Format;
use springpot::table::folder::Folder;
use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Failed cases that are named one by one.
const NAMED: usize = 5;

/// Limits of joints that are named one by one.
pub(crate) const NAMED_LIMITS: usize = 10;

/// What a run that came to an end left behind.
struct Finished {
    cases: Cases,
    outcome: Outcome,
    folder: Folder,
    rows: u64,
    /// End of the first case, s.
    end: f64,
}

pub(crate) fn run(options: &RunOptions) -> Ending {
    let begun = Instant::now();
    let prepared = match prepare(options) {
        Ok(prepared) => prepared,
        Err(Unprepared::Refused(refused)) => {
            diagnostic::refused(&refused);
            return Ending::Refused;
        }
        Err(Unprepared::Shown) => return Ending::Refused,
        Err(Unprepared::Output(out, error)) => return cannot_write(&out, &error, false),
    };
    let (out, goes_on) = (prepared.folder.path().to_owned(), prepared.checkpoints.is_some());
    match execute(options, prepared) {
        Ok(finished) => {
            finished.warn();
            finished.complain();
            if goes_on && finished.outcome.status == Status::Interrupted {
                terminal::print_error(&format!("to go on: {}\n", to_go_on(&out)));
            }
            if !options.quiet {
                terminal::print(&finished.summary(begun.elapsed()));
            }
            match finished.outcome.status {
                Status::Done => Ending::Done,
                Status::Failed => Ending::Failed,
                Status::Interrupted => Ending::Interrupted,
            }
        }
        Err(SweepError::Refused(refused)) => {
            diagnostic::refused(&refused);
            Ending::Refused
        }
        Err(SweepError::Output(error)) => cannot_write(&out, &error, goes_on),
    }
}

fn cannot_write(out: &Path, error: &io::Error, goes_on: bool) -> Ending {
    let message = format!("the results cannot be written to {}: {error}", out.display());
    match goes_on {
        true => diagnostic::error_with_help(message, format!("to go on once they can: {}", to_go_on(out))),
        false => diagnostic::error(message),
    }
    Ending::Failed
}

/// The command that goes on with a run.
fn to_go_on(out: &Path) -> String {
    format!("springpot run --resume {}", out.display())
}

/// Runs all cases, draws the figures, and writes the record.
fn execute(options: &RunOptions, prepared: Prepared) -> Result<Finished, SweepError> {
    let Prepared { cases, plan, system, layout, mut folder, checkpoints, figures, format } = prepared;
    let rows = AtomicU64::new(0);
    let wanted = (cases.len() as u64).saturating_mul(plan.time.rows.count() as u64);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let jobs = options.jobs.map_or(cores, usize::from);
    let stop = progress::interrupt_flag();
    let sweep_options = Options { jobs, stop, rows: &rows, checkpoints: checkpoints.as_ref() };
    let outcome =
        progress::show_while(wanted, &rows, options.quiet, || sweep::run(&cases, &layout, &mut folder, sweep_options))?;

    if figures && outcome.status != Status::Interrupted {
        for warning in figures::draw(&cases, &system, &plan, &layout, &outcome, &mut folder)? {
            diagnostic::warning(warning, None);
        }
    }
    // What is gone on with goes on as text.
    let goes_on = checkpoints.is_some() && outcome.status == Status::Interrupted;
    let written = if goes_on { Format::Csv } else { format };
    let converted = folder.convert_rows(written, layout.written(), layout.swept());
    let mut record = outcome.record(&cases, &plan, &layout);
    record.insert("format".to_owned(), if converted.is_ok() { written } else { Format::Csv }.name().into());
    folder.write_run(record)?;
    converted?;
    if let Some(checkpoints) = checkpoints.filter(|_| outcome.status != Status::Interrupted) {
        checkpoints.remove()?;
    }
    Ok(Finished { cases, outcome, folder, rows: rows.load(Ordering::Relaxed), end: plan.time.end })
}

impl Finished {
    /// Which joints pass their limits, and where.
    fn warn(&self) {
        let Self { cases, outcome, .. } = self;
        let ran = outcome.done + outcome.failed;
        let passing = &outcome.limits;
        for CasesPassing { passed, case, cases: found } in passing.iter().take(NAMED_LIMITS) {
            diagnostic::warning(in_cases(cases, ran, *case, *found, &passed.to_string()), None);
        }
        if let Some(more @ 1..) = passing.len().checked_sub(NAMED_LIMITS) {
            let more = count(more, "more limit of a joint is", "more limits of joints are");
            diagnostic::warning(format!("{more} passed; run.json says which"), None);
        }
    }

    /// What failed, and how far an interrupted run came.
    fn complain(&self) {
        let Self { cases, outcome, .. } = self;
        let failed: Vec<&CaseResult> = outcome.cases.iter().filter(|c| c.error.is_some() && !c.interrupted).collect();
        for case in failed.iter().take(NAMED) {
            let error = case.error.as_deref().unwrap_or_default();
            diagnostic::error(in_case(cases, case.index, error));
        }
        if outcome.failed > NAMED {
            let more = count(outcome.failed - NAMED, "more case", "more cases");
            diagnostic::error(format!("{more} failed; run.json says which and why"));
        }
        match outcome.status {
            Status::Done => {}
            Status::Failed => terminal::print_error(&format!("failed{}\n", self.how_far())),
            Status::Interrupted => terminal::print_error(&format!("interrupted{}\n", self.how_far())),
        }
    }

    /// How far a run came that did not come to its end; goes on after "failed" or "interrupted".
    fn how_far(&self) -> String {
        let Self { cases, outcome, end, .. } = self;
        let stopped = outcome.cases.iter().filter(|case| case.error.is_some());
        let reached = stopped.clone().map(|case| case.report.t_reached.unwrap_or(-1.0)).fold(f64::INFINITY, f64::min);
        let rows = match reached {
            t if t < 0.0 => "before the first row".to_owned(),
            t => format!("after the row at t = {} s", short(t)),
        };
        if cases.len() == 1 {
            return match outcome.cases.len() {
                0 => " before anything was run".to_owned(),
                _ => format!(" {rows} of {} s; all rows are complete", short(*end)),
            };
        }
        let interrupted = stopped.filter(|case| case.interrupted).count();
        let mut parts = vec![format!("{} of {} done", outcome.done, count(cases.len(), "case", "cases"))];
        if outcome.failed > 0 {
            parts.push(format!("{} failed", outcome.failed));
        }
        if interrupted > 0 {
            parts.push(format!("{interrupted} stopped"));
        }
        if outcome.failed + interrupted > 0 {
            parts.push(format!("the earliest {rows}"));
        }
        format!(": {}; all rows are complete", parts.join(", "))
    }

    /// The lines after a run: how much was done, how well the energy balance closes, where the results are.
    fn summary(&self, wall: Duration) -> String {
        let Self { cases, outcome, folder, rows, .. } = self;
        let mut work = Vec::new();
        if cases.len() > 1 {
            work.push(count(outcome.done + outcome.failed, "case", "cases"));
        }
        work.push(count(*rows, "row", "rows"));
        if outcome.newton_iterations.is_none() {
            work.push(count(outcome.steps, "step", "steps"));
        }
        let work = format!("{} in {:.2} s", work.join(", "), wall.as_secs_f64());
        let width = terminal::stdout_width();
        let mut lines = terminal::hanging("", &work, width);
        lines.push_str(&terminal::hanging("energy   ", &self.balance(), width));
        let figures = folder.files().iter().filter(|name| name.ends_with(".svg")).count();
        let rows =
            folder.files().iter().find(|name| name.starts_with("results.")).map_or("results.csv", String::as_str);
        let mut files = format!("{rows}, summary.csv, run.json");
        if figures > 0 {
            let figures = count(figures, "figure", "figures").replace(' ', terminal::NO_BREAK);
            files.push_str(&format!(", {figures} (SVG and PNG)"));
        }
        lines.push_str(&terminal::hanging("results  ", &format!("{}: {files}", folder.path().display()), width));
        if let Some(iterations) = outcome.newton_iterations {
            lines.push_str(&terminal::hanging("forward  ", &self.effort(iterations), width));
        }
        lines
    }

    /// What robots that move by themselves took: work, wall time, how much faster than life, and how well the energy balance closes.
    fn effort(&self, iterations: u64) -> String {
        let outcome = &self.outcome;
        let wall = outcome.wall.as_secs_f64();
        let residual = match outcome.energy_residual {
            Some((residual, turned_over)) if turned_over > 0.0 => rough(residual / turned_over),
            Some(_) => "0".to_owned(),
            None => "unknown".to_owned(),
        };
        format!(
            "{}, {} rejected, {}, {} s, {} times real time, energy residual {residual}",
            count(outcome.steps, "step", "steps"),
            outcome.rejected_steps,
            count(iterations, "Newton iteration", "Newton iterations"),
            brief(wall),
            brief(if wall > 0.0 { outcome.simulated / wall } else { 0.0 }),
        )
    }

    /// How well the energy balance closes, and where it is not known.
    fn balance(&self) -> String {
        let outcome = &self.outcome;
        let known = match outcome.energy_residual {
            Some((residual, turned_over)) if turned_over > 0.0 => {
                format!("balance closes to {} of {} J turned over", rough(residual / turned_over), rough(turned_over))
            }
            Some(_) => "no energy was turned over".into(),
            None => String::new(),
        };
        match &outcome.no_ledger {
            None if known.is_empty() => "balance unknown: nothing was run".into(),
            None => known,
            Some((_, why)) if known.is_empty() => format!("balance unknown: {why}"),
            Some((1, why)) => format!("{known}; unknown in 1 case: {why}"),
            Some((unknown, why)) => format!("{known}; unknown in {unknown} cases: {why}"),
        }
    }
}

/// `message` with the swept values of its case in front, where anything is swept.
pub(crate) fn in_case(cases: &Cases, index: usize, message: &str) -> String {
    let name = case_name(cases, index);
    if name.is_empty() { message.to_owned() } else { format!("{name}: {message}") }
}

/// `message` about the case `first` with its swept values in front, and how many others it holds for; as it is where
/// it holds for all that were looked at.
pub(crate) fn in_cases(cases: &Cases, looked_at: usize, first: usize, found: usize, message: &str) -> String {
    if found >= looked_at {
        message.to_owned()
    } else if found == 1 {
        in_case(cases, first, message)
    } else {
        let others = count(found - 1, "other case", "other cases");
        format!("{} and {others}: {message}", case_name(cases, first))
    }
}

/// The swept values of a case; empty where nothing is swept.
pub(crate) fn case_name(cases: &Cases, index: usize) -> String {
    let labels = cases.labels(index);
    let named = cases.parameters().iter().zip(labels).map(|(parameter, label)| format!("{parameter} = {label}"));
    named.collect::<Vec<_>>().join(", ")
}
