//! Robots that move by themselves, from texts, in fixed steps and with error control.

use crate::support::robots::{self, ARM};
use crate::support::run_system;
pub(crate) use crate::support::{robots::strut, system};
use springpot::driver::Report;
use springpot::methods::fixed::{Loop, MemorySettings, Method};
use springpot::observe::Quantity;
use springpot::system::{FixedStep, RowTimes, RunError, Settings, System};

pub(crate) const METHODS: [Method; 2] = [Method::BackwardEuler, Method::Midpoint];

/// The three-body arm of the papers, falling under gravity; `more` holds elements and the rest.
pub(crate) fn arm(more: &str) -> String {
    format!("{ARM}{more}")
}

/// The thermoviscoelastic strut of the first paper, at 25 °C.
pub(crate) fn thermoviscoelastic(alpha: f64, derivative: &str) -> String {
    robots::thermoviscoelastic(alpha, 25.0, derivative)
}

/// A free motion of 1 s, which tests cut where they want.
pub(crate) fn free(start: &str) -> String {
    format!("[motion]\nkind = \"forward\"\n{start}\n[time]\nend = 1\noutput_step = 0.1\n")
}

/// Loops of tests remember this well.
pub(crate) const MEMORY: MemorySettings = MemorySettings { tolerance: 1e-10, horizon: 100.0 };

/// A loop after `end` seconds without torque.
pub(crate) fn looped(system: &System, method: Method, step: f64, end: f64) -> Loop<'_> {
    let mut robot = Loop::new(system, method, step, MEMORY).expect("a loop");
    let still = vec![0.0; system.model.nv()];
    for _ in 0..(end / step).round() as u64 {
        robot.advance(&still).expect("a step");
    }
    robot
}

/// q and v of a loop.
pub(crate) fn state(robot: &Loop) -> Vec<f64> {
    [robot.q(), robot.v()].concat()
}

/// How runs of tests are carried out; `None`: with error control.
pub(crate) fn settings(end: f64, rows: &[f64], fixed_step: Option<FixedStep>) -> Settings {
    Settings { rtol: 1e-10, memory_rtol: 1e-12, fixed_step, ..Settings::new(end, RowTimes::Times(rows.into())) }
}

/// The rows of a run, what it did and how it ended.
pub(crate) fn rows(system: &System, settings: &Settings) -> (Vec<Vec<f64>>, Report, Result<(), RunError>) {
    let run = run_system(system, settings);
    (run.rows, run.report, run.error.map_or(Ok(()), Err))
}

/// q and v at `end` with error control, 1e-10.
pub(crate) fn truth(system: &System, end: f64) -> Vec<f64> {
    let run = run_system(system, &settings(end, &[end], None));
    assert!(run.error.is_none(), "the adaptive run ends: {:?}", run.error);
    let q = (0..system.model.nq()).map(Quantity::Coordinate);
    let state = q.chain((0..system.model.nv()).map(Quantity::Velocity));
    state.map(|quantity| run.table.value(0, quantity).expect("the row at the end")).collect()
}

/// Largest difference.
pub(crate) fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).fold(0.0, |m, (a, b)| m.max((a - b).abs()))
}
