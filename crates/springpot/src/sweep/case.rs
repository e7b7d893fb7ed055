//! One case of a sweep.

use super::layout::Layout;
use super::{Options, Writers, push_field, push_fields};
use crate::scenario::{Cases, SweptValue};
use crate::simulate::{self, LimitWatch, PassedLimit, Report, RunError, System};
use crate::table::{Statistics, push_number};
use std::io;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Text is handed over at this size, or after this time.
const CHUNK: usize = 1 << 15;
const PATIENCE: Duration = Duration::from_millis(200);

/// What one case did.
#[derive(Debug)]
pub struct CaseResult {
    /// Index in the grid.
    pub index: usize,
    /// Steps, rows, energy.
    pub report: Report,
    /// Why it stopped early.
    pub error: Option<String>,
    /// Whether it stopped because it was interrupted.
    pub interrupted: bool,
    /// Wall time.
    pub wall: Duration,
    /// Why its energy ledger is not known; `None` where it is.
    pub no_ledger: Option<String>,
    /// The limits of joints that it passes.
    pub limits: Vec<PassedLimit>,
    /// The columns that figures need, where this case is drawn.
    pub kept: Option<Vec<Vec<f64>>>,
}

/// Runs case `index`.
///
/// # Errors
/// What keeps rows from being written; that of the case itself is in the result.
pub(super) fn run(
    cases: &Cases,
    index: usize,
    layout: &Layout,
    writers: Writers,
    options: &Options,
) -> io::Result<CaseResult> {
    let begun = Instant::now();
    let mut lead = String::new();
    for value in cases.values(index) {
        match value {
            SweptValue::Number(number) => push_number(&mut lead, number),
            SweptValue::Text(text) => push_field(&mut lead, &text),
        }
        lead.push(',');
    }
    let selected: Vec<usize> = layout.selected().map(|(k, _)| k).collect();
    let mut statistics = vec![Statistics::default(); selected.len()];
    let kept_columns = layout.kept(index);
    let mut kept = kept_columns.map(|columns| vec![Vec::new(); columns.len()]);
    let (mut text, mut handed_over) = (String::with_capacity(2 * CHUNK), Instant::now());

    let (report, no_ledger, limits, outcome) = match cases.plan(index) {
        Err(refusals) => {
            let why = Some("no row was written".into());
            (Report::default(), why, Vec::new(), Err(CaseError::Refused(refusals.to_string())))
        }
        Ok(plan) => {
            let system = plan.system();
            let mut watch = LimitWatch::new(&system);
            let mut rows = |row: &[f64]| -> io::Result<()> {
                text.push_str(&lead);
                let mut values = selected.iter().map(|&k| row[k]);
                push_number(&mut text, values.next().unwrap_or(f64::NAN));
                push_fields(&mut text, values);
                text.push('\n');
                for (statistics, &k) in statistics.iter_mut().zip(&selected) {
                    statistics.add(row[k]);
                }
                for (kept, &k) in kept.iter_mut().flatten().zip(kept_columns.into_iter().flatten()) {
                    kept.push(row[k]);
                }
                watch.see(row);
                options.rows.fetch_add(1, Ordering::Relaxed);
                if text.len() >= CHUNK || handed_over.elapsed() > PATIENCE {
                    writers.rows.write(text.as_bytes())?;
                    text.clear();
                    handed_over = Instant::now();
                }
                Ok(())
            };
            let (report, outcome) = simulate::run(&system, &plan.settings(), &mut rows, options.stop);
            (report, why_no_ledger(&system, &report), watch.passed(), outcome.map_err(CaseError::Run))
        }
    };
    writers.rows.write(text.as_bytes())?;
    writers.rows.finish()?;
    let mut summary = String::new();
    for ((_, column), statistics) in layout.selected().zip(&statistics) {
        summary.push_str(&lead);
        push_field(&mut summary, &column.name);
        summary.push(',');
        push_field(&mut summary, &column.unit);
        push_fields(&mut summary, [statistics.min, statistics.max, statistics.rms()].into_iter());
        summary.push('\n');
    }
    writers.summary.write(summary.as_bytes())?;
    writers.summary.finish()?;
    if let Err(CaseError::Run(RunError::Output(error))) = outcome {
        return Err(error);
    }
    let interrupted = matches!(outcome, Err(CaseError::Run(RunError::Interrupted { .. })));
    let error = outcome.err().map(|error| error.to_string());
    Ok(CaseResult { index, report, error, interrupted, wall: begun.elapsed(), no_ledger, limits, kept })
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

/// Why a case has no complete run.
#[derive(Debug, thiserror::Error)]
enum CaseError {
    /// Its combination of values is not admissible.
    #[error("{0}")]
    Refused(String),
    /// The run stopped.
    #[error(transparent)]
    Run(RunError),
}
