//! The run of one case, wherever its rows go.

use super::Progress;
use super::derivatives::Losses;
use super::metrics::CaseMetrics;
use crate::trouble::Trouble;
use springpot::driver::{self, Checkpoint, LimitWatch, PassedLimit, Report, Rows, Tape, Watch};
use springpot::sensitivity::Lost;
use springpot::system::{Action, RunError, Stop, System};
use springpot_scenario::{Cases, Plan};
use std::io;
use std::sync::atomic::Ordering;

/// Takes the rows of a case.
pub(super) trait Sink {
    fn row(&mut self, row: &[f64]) -> io::Result<()>;

    /// Takes the row of an event.
    fn event(&mut self, system: &System, event: usize, row: &[f64]);

    /// Takes the row of an event that ends the case, whose derivatives are along the event, and those of its time; none where the run has no tangents.
    fn ended(&mut self, row: &[f64], later: &[f64]);

    /// Whether a checkpoint is wanted at t, which is the last one or not.
    fn is_due(&self, t: f64, last: bool) -> bool;

    /// Keeps what it takes to go on.
    fn keep(&mut self, plan: &Plan, system: &System, resumed: Resumed) -> io::Result<()>;

    /// What the metrics are of the rows so far, with their gradients back through a tape, where there is one.
    ///
    /// # Errors
    /// What keeps the tape from being gone back through.
    fn metrics(&self, plan: &Plan, back: Option<Back>) -> Result<CaseMetrics, RunError>;
}

/// What a run is gone back through by, until it is stopped.
#[derive(Clone, Copy)]
pub(super) struct Back<'a> {
    pub(super) tape: &'a Tape,
    pub(super) stop: &'a Stop,
}

/// Where an earlier run left a case.
pub(super) struct Resumed {
    pub(super) run: Checkpoint,
    pub(super) watch: Watch,
    /// Derivatives that are lost.
    pub(super) lost: Vec<Lost>,
}

/// What a case did, but for its rows.
#[derive(Debug, Clone)]
pub(super) struct Ran {
    pub(super) report: Report,
    pub(super) error: Option<Trouble>,
    pub(super) interrupted: bool,
    pub(super) no_ledger: Option<String>,
    pub(super) limits: Vec<PassedLimit>,
    pub(super) metrics: CaseMetrics,
}

/// Runs case `index`, or goes on with it.
///
/// # Errors
/// What keeps rows from being taken; that of the case itself is in the result.
pub(super) fn simulate(
    cases: &Cases,
    index: usize,
    (stop, progress): (&Stop, &Progress),
    resumed: Option<Resumed>,
    sink: &mut dyn Sink,
) -> io::Result<Ran> {
    let plan = match cases.plan(index) {
        Ok(plan) => plan,
        Err(refusals) => {
            let error = Some(Trouble { message: refusals.to_string(), ..Trouble::default() });
            return Ok(Ran {
                report: Report::default(),
                error,
                interrupted: false,
                no_ledger: Some("no row was written".into()),
                limits: Vec::new(),
                metrics: CaseMetrics::default(),
            });
        }
    };
    let (system, settings) = (plan.system_unless(stop).sharing(cases.shared()), plan.settings.clone());
    let watch = LimitWatch::new(&system);
    let places = plan.places(&system);
    let losses = Losses::of(&plan, Vec::new());
    let mut rows = CaseRows { sink, progress, watch, losses, plan: &plan, system: &system, places, row: Vec::new() };
    let (report, outcome) = match resumed {
        None => driver::record(&system, &settings, &mut rows, stop),
        Some(Resumed { run, watch, lost }) => {
            rows.watch.go_on(watch);
            rows.losses = Losses::of(&plan, lost);
            let (report, outcome) = driver::resume(&system, &settings, run, &mut rows, stop);
            (report, outcome.map(|()| None))
        }
    };
    let limits = rows.watch.passed();
    let mut lost = rows.losses.as_ref().map_or_else(Vec::new, |losses| losses.lost().to_vec());
    let outcome = outcome.and_then(|tape| {
        if let Some(tape) = &tape {
            lost = tape.lost(stop)?;
        }
        sink.metrics(&plan, tape.as_ref().map(|tape| Back { tape, stop }))
    });
    let (error, interrupted, metrics) = match outcome {
        Ok(metrics) => (None, false, Some(metrics)),
        // What was kept last is what can be gone on from.
        Err(RunError::Output(error)) => return Err(error),
        Err(error) => (Some(Trouble::of(&error, &plan)), matches!(error, RunError::Interrupted { .. }), None),
    };
    let mut metrics = match metrics {
        Some(metrics) => metrics,
        None => sink.metrics(&plan, None).unwrap_or_default(),
    };
    let no_ledger = why_no_ledger(&system, &report);
    lost.append(&mut metrics.derivatives.lost);
    metrics.derivatives.lost = lost;
    Ok(Ran { report, error, interrupted, no_ledger, limits, metrics })
}

/// The rows of a case whose plan is known.
struct CaseRows<'a> {
    sink: &'a mut dyn Sink,
    progress: &'a Progress,
    watch: LimitWatch,
    /// Where there are derivatives.
    losses: Option<Losses>,
    plan: &'a Plan,
    system: &'a System,
    /// Where the cells of a row stand in a row of the system, if elsewhere.
    places: Option<Vec<Option<usize>>>,
    /// A row as all cases have it.
    row: Vec<f64>,
}

impl CaseRows<'_> {
    /// Fills in the empty cells of elements that are not enabled, and empties those of derivatives that are lost: whether there are any.
    fn spread(&mut self, row: &[f64]) -> bool {
        let is_spread = self.places.as_ref().is_some_and(|places| {
            self.row.clear();
            self.row.extend(places.iter().map(|place| place.map_or(f64::NAN, |place| row[place])));
            true
        });
        let Some(losses) = &mut self.losses else { return is_spread };
        if !losses.see(if is_spread { &self.row } else { row }) {
            return is_spread;
        }
        if !is_spread {
            self.row.clear();
            self.row.extend_from_slice(row);
        }
        losses.clear(&mut self.row);
        true
    }
}

impl Rows for CaseRows<'_> {
    fn row(&mut self, row: &[f64]) -> io::Result<()> {
        self.watch.see(row);
        self.progress.rows.fetch_add(1, Ordering::Relaxed);
        let is_spread = self.spread(row);
        self.sink.row(if is_spread { &self.row } else { row })
    }

    fn event(&mut self, event: usize, row: &[f64], later: &[f64]) -> io::Result<()> {
        let is_spread = self.spread(row);
        let row = if is_spread { &self.row } else { row };
        if self.system.events[event].action == Action::Stop {
            self.sink.ended(row, later);
        }
        if later.is_empty() {
            self.sink.event(self.system, event, row);
            return Ok(());
        }
        // Derivatives stand behind all else, those of the time first.
        let told = self.plan.sensitivity.as_ref();
        let [told, for_metrics] =
            told.map_or([0; 2], |sensitivity| [sensitivity.columns.len(), sensitivity.for_metrics.len()]);
        let (own, derivatives) = row.split_at(row.len() - told - for_metrics);
        self.sink.event(self.system, event, &[own, later, &derivatives[..told]].concat());
        Ok(())
    }

    fn looked_ahead(&mut self, switches: u64) {
        self.progress.switches.fetch_max(switches, Ordering::Relaxed);
    }

    fn lost(&mut self, lost: Lost) {
        self.losses.iter_mut().for_each(|losses| losses.lose(lost.clone()));
    }

    fn wants_checkpoint(&mut self, t: f64, last: bool) -> bool {
        self.progress.reach(t);
        self.sink.is_due(t, last)
    }

    fn checkpoint(&mut self, run: Checkpoint) -> io::Result<()> {
        let lost = self.losses.as_ref().map_or_else(Vec::new, |losses| losses.lost().to_vec());
        self.sink.keep(self.plan, self.system, Resumed { run, watch: self.watch.seen(), lost })
    }
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
    let hidden = system.elements.iter().zip(&starts).find(|(_, start)| start.hides_energy);
    Some(hidden.map_or("an energy is not finite".into(), |(element, start)| {
        let why = match start.singular {
            true => "starts with x(0) != 0 and the Riemann-Liouville derivative",
            false => "has an expression of which nobody knows what it stores",
        };
        format!("element \"{}\" {why}", element.name)
    }))
}
