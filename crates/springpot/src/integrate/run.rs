//! Whole runs: rows and a report.

use super::context::Context;
use super::driver::{Driver, RowsAhead};
use super::error::RunError;
use super::output::Output;
use super::report::Report;
use super::rows::Rows;
use super::settings::{Settings, Stop};
use super::state::Checkpoint;
use super::system::System;
use super::written::Written;
use std::sync::atomic::Ordering;

/// Runs `system` as its motion says and hands every row to `rows`.
///
/// The report is true also where the run stops early: all rows up to `t_reached` were handed over.
pub fn run(system: &System, settings: &Settings, rows: &mut dyn Rows, stop: &Stop) -> (Report, Result<(), RunError>) {
    let looked_ahead = |driver: &Driver| driver.switches().into_iter().for_each(|switches| rows.looked_ahead(switches));
    let driver = Driver::new(system.context(), settings, stop, looked_ahead);
    go(system.context(), driver, rows, Written::default(), stop)
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
    let Checkpoint { driver, written } = checkpoint;
    let looked_ahead = |driver: &Driver| driver.switches().into_iter().for_each(|switches| rows.looked_ahead(switches));
    let driver = Driver::resume(system.context(), settings, driver, stop, looked_ahead);
    go(system.context(), driver, rows, written, stop)
}

fn go(
    cx: Context,
    driver: Result<Driver, RunError>,
    rows: &mut dyn Rows,
    written: Written,
    stop: &Stop,
) -> (Report, Result<(), RunError>) {
    let mut driver = match driver {
        Ok(driver) => driver,
        Err(error) => return (Report::default(), Err(error)),
    };
    let mut output = Output::new(cx, rows, written);
    let outcome = to_the_end(cx, &mut driver, &mut output, stop);
    (output.report(&driver), outcome)
}

/// Takes step after step, `output` writing the rows.
fn to_the_end(cx: Context, driver: &mut Driver, output: &mut Output, stop: &Stop) -> Result<(), RunError> {
    output.emit(cx, driver)?;
    loop {
        while driver.settle(cx)? {
            output.emit(cx, driver)?;
        }
        if driver.has_ended() {
            return if driver.has_fixed_steps() { Ok(()) } else { output.verdict(cx, driver) };
        }
        let (t, stopped) = (driver.reached(), stop.load(Ordering::Relaxed));
        if output.rows.wants_checkpoint(t, stopped) {
            let checkpoint = Checkpoint { driver: driver.state(cx), written: output.written };
            output.rows.checkpoint(checkpoint)?;
        }
        if stopped {
            return Err(RunError::Interrupted { t });
        }
        let next = output.next(&driver.recorder.settings);
        let rows = next.map(|next| RowsAhead { next, last: output.written.last.unwrap_or(0.0) });
        driver.advance(cx, f64::INFINITY, rows)?;
        output.emit(cx, driver)?;
    }
}
