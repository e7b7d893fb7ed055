//! The time loop: a system along its motion, row by row.
//!
//! [`along`] takes a [`System`] (robot, elements, motion) and [`Settings`], chooses inner steps for the tolerance, and hands over one row
//! per output time, whose columns are [`System::columns`]. A step has the Radau IIA nodes; its error estimate is the difference of
//! two interpolations of the stroke, in units of atol + rtol·max|D^alpha x| so far, the worst of the elements. Rows never change the
//! steps. The [`Report`] tells steps, rows, the time reached, and the residual of the energy balance.

mod along;
mod checkpoint;
mod control;
mod coulomb;
mod equation;
mod error;
pub mod fixed;
mod forward;
mod jump;
mod ledger;
mod limits;
mod moment;
mod on_grid;
mod pose;
mod recorder;
mod resistance;
mod row;
mod row_times;
mod signals;
mod zero;

pub use along::along;
pub use checkpoint::Checkpoint;
pub use equation::{ElementTerm, Equation, EquationError};
pub use error::RunError;
pub use fixed::FixedStep;
pub use forward::forward;
pub use limits::{LimitKind, LimitWatch, PassedLimit, Watch};
pub use pose::{ElementStart, Pose, State};
pub use row_times::RowTimes;

use crate::element::Element;
pub use crate::model::FRICTION_SPEED;
use crate::model::{Model, Site};
use crate::motion::Motion;
use crate::observe::Table;
use checkpoint::StepperState;
use std::sync::atomic::AtomicBool;

/// A robot, its elements and its motion.
#[derive(Debug, Clone)]
pub struct System {
    /// The robot.
    pub model: Model,
    /// The elements.
    pub elements: Vec<Element>,
    /// How it moves.
    pub motion: Motion,
    /// The gripper, where there is one.
    pub gripper: Option<Site>,
    /// Whether the rows tell the energy lost in damping and friction of joints. It is part of the balance in any case.
    pub tells_joint_losses: bool,
}

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

/// Runs `system` as its motion says: [`along`] a motion given in advance, [`forward`], or in [`fixed`] steps.
pub fn run(system: &System, settings: &Settings, rows: &mut dyn Rows, stop: &Stop) -> (Report, Result<(), RunError>) {
    match (&system.motion, settings.fixed_step) {
        (Motion::Prescribed(_) | Motion::GripperPath(_), _) => along(system, settings, rows, stop),
        (Motion::Forward(_), None) => forward(system, settings, rows, stop),
        (Motion::Forward(_), Some(by)) => fixed::fixed(system, by, settings, rows, stop),
    }
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
    let fits = checkpoint.fits(system);
    let Checkpoint { recorder, stepper_state } = checkpoint;
    match (&system.motion, settings.fixed_step, stepper_state) {
        (Motion::Prescribed(_) | Motion::GripperPath(_), _, StepperState::Along(stepper_state)) if fits => {
            along::resume(system, settings, (recorder, stepper_state), rows, stop)
        }
        (Motion::Forward(motion), None, StepperState::Forward(stepper_state)) if fits => {
            forward::resume(system, motion, settings, (recorder, *stepper_state), rows, stop)
        }
        (Motion::Forward(motion), Some(by), StepperState::Fixed(stepper_state)) if fits => {
            fixed::resume(system, (motion, by), settings, (recorder, *stepper_state), rows, stop)
        }
        _ => (Report::default(), Err(RunError::OtherRun)),
    }
}

/// A flag that interrupts runs from outside.
pub type Stop = AtomicBool;
