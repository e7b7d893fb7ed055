//! Forward dynamics in steps of one size: for loops in real time.
//!
//! [`Loop`] is the library's type for a controller's loop: it does not allocate after it is built, and every step takes the same
//! work whatever happens. With [`crate::system::Settings::fixed_step`] a whole run or a [`crate::driver::Simulation`] takes such steps, with the energy ledger.
//!
//! Both methods have one stage. Its accelerations come from three Newton iterations with all analytic derivatives taken anew, those of
//! the elements' forces included. The first one is the linearly implicit method, which already has the order; the second
//! takes what bends, to 1e-6 of a velocity on the falling arm at 1 ms; the third takes as much where an element of 10⁹ N/m
//! turns, which two leave at 0.1. [`Loop::correction`] tells how far the last one went. The iterations start from v_0 and not from the last
//! accelerations, so that a shock does not throw the next step off.
//!
//! Friction that sticks takes its value from the velocity at the end of the step: a joint that would turn round within the step and
//! can be held is at rest at its end, and stays there to the bit. Which of several joints hold is found anew in every iteration.

mod between;
mod control;
mod real_time;
mod rub;
mod run;
mod step;
mod variation;

pub use crate::system::fixed_step::Method;
pub use real_time::{Loop, LoopError, LoopState, MemorySettings};
pub(crate) use run::{Fixed, StepperState};
pub use step::ITERATIONS;
