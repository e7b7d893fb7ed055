//! Forward dynamics of what keeps nothing and is not stiff: an explicit method of order 8.
//!
//! Dormand and Prince's twelve stages in q, v and the works of the ledger, each one solve for the accelerations; rows between steps come from
//! a polynomial of order 7 for which three more stages are worked out where one is asked for. What turns out to be stiff goes on with Radau
//! IIA(5), which shares the origin of steps and what errors are measured by, and comes back when it no longer is.
//! Source of the method: Hairer, Nørsett & Wanner, Solving ODEs I, II.5 and II.6; of edges of stability: Hairer & Wanner, Solving ODEs II, IV.2.

mod attempt;
mod between;
mod integrated;
mod method;
mod radius;
mod step;
mod stiffness;
mod tableau;
mod variation;

pub(crate) use method::{Explicit, StepperState};
