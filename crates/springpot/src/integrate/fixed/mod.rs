//! Forward dynamics in steps of one size: for loops in real time.
//!
//! [`Loop`] is the library's type for a controller's loop: it does not allocate after it is built, and every step takes the same
//! work whatever happens. With [`super::Settings::fixed_step`] a whole run or a [`super::Simulation`] takes such steps, with the energy ledger.
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
mod elements;
mod real_time;
mod rub;
mod run;
mod step;

pub use real_time::{Loop, LoopError, MemorySettings};
pub(super) use run::{Fixed, StepperState};

use crate::fractional::Nodes;

/// A fixed-step method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Method {
    /// Backward Euler's: order 1, L-stable; elements of any stiffness and friction come to rest without ringing. Memories take the L1
    /// scheme.
    BackwardEuler,
    /// The implicit midpoint rule: order 2, no damping of its own, so that energy without elements stays; what is too fast for the
    /// step rings on, and where that is very stiff and turns far in a step it may grow. Memories take the mean of their force over
    /// the step ([`Nodes::Midpoint`]), so that the motion has order 2 at every fractional order, and 2 − alpha after a singular
    /// Riemann–Liouville start.
    Midpoint,
}

/// Steps of one size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FixedStep {
    /// The method.
    pub method: Method,
    /// Step size, s, positive.
    pub step: f64,
}

/// Newton iterations of every step.
pub const ITERATIONS: u32 = 3;

impl Method {
    /// Its name in scenario files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::BackwardEuler => "backward-euler",
            Self::Midpoint => "midpoint",
        }
    }

    /// Where the stage is, as a share of the step.
    const fn node(self) -> f64 {
        match self {
            Self::BackwardEuler => 1.0,
            Self::Midpoint => 0.5,
        }
    }

    const fn nodes(self) -> Nodes {
        match self {
            Self::BackwardEuler => Nodes::One,
            Self::Midpoint => Nodes::Midpoint,
        }
    }
}
