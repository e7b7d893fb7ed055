//! The time loop: a system along its motion, step by step or row by row.
//!
//! [`run`] takes a [`System`] (robot, elements, motion) and [`Settings`], chooses inner steps for the tolerance, and hands over one row
//! per output time, whose columns are [`System::columns`]. [`Simulation`] is the same run in the hands of somebody else, who takes its steps. Both
//! stand on one driver and three methods: kinematics given in advance (`prescribed`), forward dynamics (`radau`), and steps of one size
//! ([`fixed`]). Rows never change the accuracy. The [`Report`] tells steps, rows, the time reached, and the residual of the energy balance.

mod context;
mod control;
mod coulomb;
mod definite;
mod driver;
mod driver_state;
mod end_stops;
mod equation;
mod error;
mod evaluate;
mod event;
pub mod fixed;
mod fixed_step;
mod jump;
mod kinks;
mod ledger;
mod limits;
mod on_grid;
mod output;
mod pose;
mod prescribed;
mod radau;
mod recorder;
mod report;
mod resistance;
mod row_times;
mod rows;
mod run;
mod settings;
mod signals;
mod simulation;
mod solver;
mod state;
mod steady;
mod stepper;
mod system;
mod written;
mod zero;

pub use equation::{ElementTerm, Equation, EquationError};
pub use error::RunError;
pub use event::{Action, Direction, Event, Setting};
pub use fixed_step::FixedStep;
pub use limits::{LimitKind, LimitWatch, PassedLimit, Watch};
pub use pose::{ElementStart, Pose, State};
pub use report::Report;
pub use row_times::RowTimes;
pub use rows::Rows;
pub use run::{resume, run};
pub use settings::{Settings, Stop};
pub use simulation::Simulation;
pub use state::{Checkpoint, SimulationState};
pub use steady::SteadyError;
pub use system::{Motion, System};

pub(crate) use resistance::add_tangents as add_resistance_slopes;

pub use crate::model::FRICTION_SPEED;
