//! Forward dynamics: the equations of motion with the memories of the elements inside.
//!
//! Radau IIA(5) in the accelerations. The law of an element answers with its forces at the nodes and their tangents, so that the
//! Newton iteration has three unknowns for each velocity whatever the number of elements and of their exponentials. Order five
//! in time at every fractional order; rows between steps come from the cubic through the accelerations, integrated twice.
//! Source of the method: Hairer & Wanner, Solving ODEs II, IV.5 and IV.8.

mod attempt;
mod cross;
mod dense;
mod errors;
mod estimate;
mod method;
mod newton;
mod stages;
mod start;
mod step;
mod system;
mod variation;

pub(crate) use method::{Radau, StepperState};
