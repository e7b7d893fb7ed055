//! The time loop: a system along its motion, step by step or row by row.
//!
//! [`run`] takes a [`System`] (robot, elements, motion) and [`Settings`], chooses inner steps for the tolerance, and hands over one row
//! per output time, whose columns are [`System::columns`]. [`Simulation`] is the same run in the hands of somebody else, who takes its steps. Both
//! stand on one driver and three methods: kinematics given in advance (`prescribed`), forward dynamics (`radau`), and steps of one size
//! ([`fixed`]). Rows never change the accuracy. The [`Report`] tells steps, rows, the time reached, and the residual of the energy balance.

mod context;
mod coulomb;
mod driver;
mod equation;
mod error;
mod evaluate;
pub mod fixed;
mod jump;
mod ledger;
mod limits;
mod on_grid;
mod output;
mod pose;
mod prescribed;
mod radau;
mod recorder;
mod resistance;
mod row_times;
mod signals;
mod simulation;
mod state;
mod stepper;
mod system;
mod zero;

pub use equation::{ElementTerm, Equation, EquationError};
pub use error::RunError;
pub use fixed::FixedStep;
pub use limits::{LimitKind, LimitWatch, PassedLimit, Watch};
pub use pose::{ElementStart, Pose, State};
pub use row_times::RowTimes;
pub use simulation::Simulation;
pub use state::{Checkpoint, SimulationState};
pub use system::{Motion, System};

pub use crate::model::FRICTION_SPEED;
use crate::observe::Table;
use context::Context;
use driver::Driver;
use output::{Output, Written};
use std::sync::atomic::AtomicBool;
use stepper::Stepper;

/// How a run is carried out.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// End of the motion, s; it starts at 0.
    pub end: f64,
    /// When rows are written.
    pub rows: RowTimes,
    /// Relative tolerance of every D^alpha x, in units of its largest value so far; of forward runs that of the motion, in units of its
    /// largest travel and speed so far.
    pub rtol: f64,
    /// Errors below this are not looked at: of D^alpha x, in forward runs of q and v. `None`: the relative tolerance alone.
    pub atol: Option<f64>,
    /// Relative tolerance of the kernels.
    pub memory_rtol: f64,
    /// First inner step, s.
    pub first_step: Option<f64>,
    /// Longest inner step, s.
    pub max_step: Option<f64>,
    /// Number of inner steps allowed; `None`: ten million, and a hundred more for every switch of the signals.
    pub max_steps: Option<u64>,
    /// Steps of one size, of forward dynamics; `None`: the run chooses its steps.
    pub fixed_step: Option<FixedStep>,
}

/// What a run did.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Report {
    /// Inner steps taken.
    pub steps: u64,
    /// Inner steps tried and not kept.
    pub rejected_steps: u64,
    /// Newton iterations of forward dynamics.
    pub newton_iterations: Option<u64>,
    /// Rows written.
    pub rows: u64,
    /// Time of the last complete row, s; `None` before the first.
    pub t_reached: Option<f64>,
    /// Largest departure of the energy balance from 0, J; `None` where the ledger is not known.
    pub energy_residual: Option<f64>,
    /// The energy turned over: largest kinetic, potential (above the start), stored, dissipated, supplied energies, summed, J.
    pub energy_turned_over: Option<f64>,
    /// Exponentials of the memories at the end.
    pub modes: usize,
    /// Kinks and jumps of the signals, each of which ends a step; `None` for steps of one size, which do not look ahead.
    pub switches: Option<u64>,
    /// What signals do in less time than this may be missed between steps, s; `None` for steps of one size.
    pub resolution: Option<f64>,
}

/// Takes the rows of a run.
pub trait Rows {
    /// One complete row, in the order of [`System::columns`]; NaN stands for an empty field.
    ///
    /// # Errors
    /// Whatever keeps the row from being kept; the run stops.
    fn row(&mut self, values: &[f64]) -> std::io::Result<()>;

    /// Before the first row, how often the signals of the run will switch ([`Report::switches`]).
    fn looked_ahead(&mut self, _switches: u64) {}

    /// Whether [`Self::checkpoint`] is to be called now, at time `t` between two steps; `last` where the run stops here because it
    /// was interrupted. Asking changes nothing about the steps.
    fn wants_checkpoint(&mut self, _t: f64, _last: bool) -> bool {
        false
    }

    /// The state from which [`resume`] goes on; all rows that belong to it were handed over.
    ///
    /// # Errors
    /// Whatever keeps it from being kept; the run stops.
    fn checkpoint(&mut self, _state: Checkpoint) -> std::io::Result<()> {
        Ok(())
    }
}

impl<F: FnMut(&[f64]) -> std::io::Result<()>> Rows for F {
    fn row(&mut self, values: &[f64]) -> std::io::Result<()> {
        self(values)
    }
}

/// Keeps every row.
impl Rows for Table {
    fn row(&mut self, values: &[f64]) -> std::io::Result<()> {
        self.push(values);
        Ok(())
    }
}

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
    let outcome = driver.run(cx, &mut output, stop);
    (output.report(&driver), outcome)
}

/// The method that a system's motion and the settings ask for.
fn method(cx: Context, settings: &Settings) -> Result<Box<dyn Stepper>, RunError> {
    Ok(match (&cx.system.motion, settings.fixed_step) {
        (Motion::Given(trajectory), _) => Box::new(prescribed::Prescribed::new(cx, trajectory)),
        (Motion::Forward(forward), None) => Box::new(radau::Radau::new(cx, forward, settings)),
        (Motion::Forward(forward), Some(by)) => Box::new(fixed::Fixed::new(cx, forward, by)?),
    })
}

impl Settings {
    /// Whether steps can be taken with them.
    fn check(&self) -> Result<(), RunError> {
        let Self { end, rtol, atol, memory_rtol, first_step, max_step, fixed_step, .. } = self;
        let fixed = fixed_step.map(|by| by.step);
        let positive = [
            ("time.end", Some(*end)),
            ("solver.rtol", Some(*rtol)),
            ("solver.memory_rtol", Some(*memory_rtol)),
            ("solver.first_step", *first_step),
            ("solver.max_step", *max_step),
            ("solver.step", fixed),
        ];
        for (what, value) in positive.into_iter().filter_map(|(what, value)| Some((what, value?))) {
            if !(value > 0.0 && value.is_finite()) {
                return Err(RunError::Setting { what, value });
            }
        }
        match atol {
            Some(atol) if !(*atol >= 0.0 && atol.is_finite()) => {
                Err(RunError::Setting { what: "solver.atol", value: *atol })
            }
            _ => Ok(()),
        }
    }
}

/// A flag that interrupts runs from outside.
pub type Stop = AtomicBool;
