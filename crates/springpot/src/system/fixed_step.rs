//! Which steps of one size.

use crate::collocation::Nodes;

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

impl Method {
    /// Its name in scenario files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::BackwardEuler => "backward-euler",
            Self::Midpoint => "midpoint",
        }
    }

    /// Where the stage is, as a share of the step.
    pub(crate) const fn node(self) -> f64 {
        match self {
            Self::BackwardEuler => 1.0,
            Self::Midpoint => 0.5,
        }
    }

    pub(crate) const fn nodes(self) -> Nodes {
        match self {
            Self::BackwardEuler => Nodes::One,
            Self::Midpoint => Nodes::Midpoint,
        }
    }
}
