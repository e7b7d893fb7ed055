//! Robots that move by themselves, in steps of one size: for loops in real time.
//!
//! [`Loop`] is the library's type for a controller's loop: it does not allocate after it is built, and every step takes the same
//! work whatever happens. [`fixed`] is a whole run with rows and the energy ledger.
//!
//! Both methods have one stage. Its accelerations come from a fixed number of Newton iterations with all analytic derivatives taken anew,
//! those of the elements' forces included ([`Method::iterations`]). The first iteration is the linearly implicit method, which already
//! has the order and the stability; the second and third take what bends: strokes of stiff elements whose direction turns.
//! The iterations start from v_0 and not from the last accelerations, so that a shock does not throw the next step off.

mod place;
mod real_time;
mod resistance;
mod run;
mod stepper;

pub use real_time::{Loop, LoopError, MemorySettings};
pub use run::fixed;

use crate::fractional::{Form, Nodes};

/// A fixed-step method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Method {
    /// Backward Euler's: order 1, L-stable; stiff elements and friction come to rest without ringing. Memories take the L1 scheme.
    BackwardEuler,
    /// The implicit midpoint rule: order 2, stable, no damping of its own; what is too fast for the step rings on. Memories take
    /// the mean of their force over the step ([`Nodes::Midpoint`]), so that the motion has order 2 at every fractional order.
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

impl Method {
    /// Its name in scenario files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::BackwardEuler => "backward-euler",
            Self::Midpoint => "midpoint",
        }
    }

    /// Newton iterations of every step.
    pub const fn iterations(self) -> u32 {
        match self {
            Self::BackwardEuler => 2,
            Self::Midpoint => 3,
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

    const fn form(self) -> Form {
        match self {
            Self::BackwardEuler => Form::Strokes,
            Self::Midpoint => Form::Rates,
        }
    }
}
