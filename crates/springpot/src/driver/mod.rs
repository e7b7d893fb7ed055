//! The time loop: a system along its motion, step by step or row by row.
//!
//! [`run`] takes a [`System`](crate::system::System) (robot, elements, motion) and [`Settings`](crate::system::Settings), chooses inner steps for
//! the tolerance, and hands over one row per output time, whose columns are [`System::columns`](crate::system::System::columns). [`Simulation`] is
//! the same run in the hands of somebody else, who takes its steps. Both stand on one driver over three [methods](crate::methods). Rows never
//! change the accuracy. The [`Report`] tells steps, rows, the time reached, and the residual of the energy balance.

mod changes;
mod driver_state;
mod equation;
mod events;
mod limits;
mod output;
mod recorded;
mod report;
mod roots;
mod rows;
mod run;
mod simulation;
mod state;
mod time_loop;
mod written;

pub use equation::{ElementTerm, Equation, EquationError};
pub use limits::{LimitKind, LimitWatch, PassedLimit, Watch};
pub use recorded::{MOST_KEPT, Tape};
pub use report::Report;
pub use rows::Rows;
pub use run::{record, record_within, resume, run};
pub use simulation::Simulation;
pub use state::{Checkpoint, SimulationState};
