//! Whole runs: rows and a report.

use super::events::{Next, Watch, WatchState};
use super::output::Output;
use super::recorded::{Kept, MOST_KEPT, Tape};
use super::report::Report;
use super::rows::Rows;
use super::state::Checkpoint;
use super::time_loop::{Driver, RowsAhead};
use super::written::Written;
use crate::equations::context::Context;
use crate::system::System;
use crate::system::error::RunError;
use crate::system::settings::{Settings, Stop};
use std::sync::atomic::Ordering;

/// A run that begins, or goes on: its driver, what it has written, and what its events know.
pub(super) struct Begun {
    pub(super) driver: Result<Driver, RunError>,
    written: Written,
    events: WatchState,
}

impl Begun {
    pub(super) fn new(system: &System, settings: &Settings, stop: &Stop, looked_ahead: impl FnOnce(&Driver)) -> Self {
        let driver = Driver::new(system.context(), settings, stop, looked_ahead);
        Self { driver, written: Written::default(), events: WatchState::default() }
    }

    pub(super) fn again(
        system: &System,
        settings: &Settings,
        checkpoint: Checkpoint,
        stop: &Stop,
        looked_ahead: impl FnOnce(&Driver),
    ) -> Self {
        let Checkpoint { driver, written, events } = checkpoint;
        let driver = Driver::resume(events.cx(system), settings, driver, stop, looked_ahead);
        Self { driver, written, events }
    }
}

/// Runs `system` as its motion says and hands every row to `rows`.
///
/// The report is true also where the run stops early: all rows up to `t_reached` were handed over.
pub fn run(system: &System, settings: &Settings, rows: &mut dyn Rows, stop: &Stop) -> (Report, Result<(), RunError>) {
    let (report, outcome) = record(system, settings, rows, stop);
    (report, outcome.map(drop))
}

/// As [`run`], keeping what it takes to go back through it, where [`crate::system::sensitivity::Sensitivity::adjoint`] asks for that: no checkpoint is offered.
pub fn record(
    system: &System,
    settings: &Settings,
    rows: &mut dyn Rows,
    stop: &Stop,
) -> (Report, Result<Option<Tape>, RunError>) {
    record_within(system, settings, rows, stop, MOST_KEPT)
}

/// As [`record`], keeping `most` bytes of it at most: whatever it is, gradients have the same bits where what goes on from a checkpoint has.
pub fn record_within(
    system: &System,
    settings: &Settings,
    rows: &mut dyn Rows,
    stop: &Stop,
    most: usize,
) -> (Report, Result<Option<Tape>, RunError>) {
    let looked_ahead = |driver: &Driver| driver.switches().into_iter().for_each(|switches| rows.looked_ahead(switches));
    let begun = Begun::new(system, settings, stop, looked_ahead);
    let mut kept = Kept::new(most, false);
    let (report, outcome) = go(system, begun, rows, &mut kept, stop);
    (report, outcome.map(|sizes| sizes.map(|sizes| Tape::new(system, settings, kept, sizes))))
}

/// Goes on with a run of this very `system` and these `settings` from where its `checkpoint` was taken: rows that are still to
/// come, and the report at the end, are those of a run that was never interrupted, bit by bit.
pub fn resume(
    system: &System,
    settings: &Settings,
    checkpoint: Checkpoint,
    rows: &mut dyn Rows,
    stop: &Stop,
) -> (Report, Result<(), RunError>) {
    let looked_ahead = |driver: &Driver| driver.switches().into_iter().for_each(|switches| rows.looked_ahead(switches));
    let begun = Begun::again(system, settings, checkpoint, stop, looked_ahead);
    let (report, outcome) = go(system, begun, rows, &mut Kept::new(MOST_KEPT, false), stop);
    (report, outcome.map(drop))
}

/// Goes to the end, or to that of a stretch that is run again: gives the sizes of what was recorded, where anything was.
pub(super) fn go(
    system: &System,
    Begun { driver, written, events }: Begun,
    rows: &mut dyn Rows,
    kept: &mut Kept,
    stop: &Stop,
) -> (Report, Result<Option<[usize; 4]>, RunError>) {
    let mut driver = match driver {
        Ok(driver) => driver,
        Err(error) => return (Report::default(), Err(error)),
    };
    let mut output = Output::new(system.context(), rows, written);
    let events = Watch::new(system, &driver.recorder.settings, events, stop);
    let outcome = events.and_then(|events| to_the_end(system, &mut driver, (&mut output, &mut *kept), events, stop));
    let report = output.report(&driver);
    (report, outcome.map(|()| kept.end(&mut driver)))
}

/// Takes step after step, `output` writing the rows.
fn to_the_end(
    system: &System,
    driver: &mut Driver,
    (output, kept): (&mut Output, &mut Kept),
    mut events: Watch,
    stop: &Stop,
) -> Result<(), RunError> {
    output.emit(events.cx(system), driver)?;
    events.start(system, driver)?;
    loop {
        while driver.settle(events.cx(system))? {
            output.emit(events.cx(system), driver)?;
            events.look_now(system, driver)?;
            if happen(system, driver, output, &mut events)? == Next::Stops {
                return end(events.cx(system), driver, output);
            }
        }
        if driver.has_ended() {
            return verdict(events.cx(system), driver, output);
        }
        if driver.is_recorded() {
            let checkpoint = |driver: &Driver| {
                let (state, written) = (driver.state(events.cx(system)), output.written);
                Checkpoint { driver: state, written, events: events.state().clone() }
            };
            if kept.look(driver, checkpoint)? {
                return Ok(());
            }
        }
        let (t, stopped) = (driver.reached(), stop.load(Ordering::Relaxed));
        if output.rows.wants_checkpoint(t, stopped) && !driver.is_recorded() {
            let (driver, written) = (driver.state(events.cx(system)), output.written);
            output.rows.checkpoint(Checkpoint { driver, written, events: events.state().clone() })?;
        }
        if stopped {
            return Err(RunError::Interrupted { t });
        }
        let next = output.next(&driver.recorder.settings);
        let rows = next.map(|next| RowsAhead { next, last: output.written.last.unwrap_or(0.0) });
        let before = driver.mark();
        driver.advance(events.cx(system), f64::INFINITY, rows, &mut || false)?;
        events.look(system, driver, before, rows)?;
        output.emit(events.cx(system), driver)?;
        if happen(system, driver, output, &mut events)? == Next::Stops {
            return end(events.cx(system), driver, output);
        }
    }
}

/// Writes the rows of events, and does what they do.
fn happen(system: &System, driver: &mut Driver, output: &mut Output, events: &mut Watch) -> Result<Next, RunError> {
    events.happen(system, driver, &mut |cx, driver, at, later| output.event(cx, driver, at, later))
}

/// Ends a run before its time.
fn end(cx: Context, driver: &mut Driver, output: &mut Output) -> Result<(), RunError> {
    output.end_here(cx, driver)?;
    driver.close(cx)?;
    verdict(cx, driver, output)
}

fn verdict(cx: Context, driver: &Driver, output: &Output) -> Result<(), RunError> {
    if driver.has_fixed_steps() { Ok(()) } else { output.verdict(cx, driver) }
}
