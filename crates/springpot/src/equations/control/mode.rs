//! On which branch the control of a joint is: what limits do to its force, and to its integral.

use super::term::Integrand;
use crate::control::Limit;
use serde::{Deserialize, Serialize};

/// The branch of one joint. Between two changes its force is a smooth function; steps end on changes.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Mode {
    pub(super) bound: Bound,
    pub(super) integrand: Integrand,
    pub(super) slew: Slew,
}

/// Where the force is against its limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub(super) enum Bound {
    #[default]
    Free,
    /// At the positive (1) or the negative limit (−1).
    At(i8),
}

/// What the limit of its rate does.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(super) enum Slew {
    #[default]
    Follows,
    /// It goes at its largest rate, up (1) or down (−1), from a force at a time.
    Goes { sign: i8, from: f64, since: f64 },
}

/// A function that is positive on the branch and passes zero where it is left.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Guard {
    /// Kink `bit` of an expression.
    Branch { law: usize, bit: u32 },
    /// The force of a joint reaches its positive or negative limit.
    Reaches { joint: usize, sign: i8 },
    /// It comes back.
    Returns { joint: usize },
    /// The error changes its sign while the force is at its limit.
    Turns { joint: usize },
    /// What an integral takes that keeps the force at its limit comes to nothing.
    Empties { joint: usize },
    /// It comes to the error.
    Fills { joint: usize },
    /// The force changes faster than it may, up or down.
    Outruns { joint: usize, sign: i8 },
    /// The force that goes at its largest rate is where it should be.
    Catches { joint: usize },
}

impl Guard {
    /// Whether it is a kink of the same expression before another one.
    pub(super) fn precedes(self, other: Self) -> bool {
        match (self, other) {
            (Self::Branch { law, bit }, Self::Branch { law: other, bit: next }) => law == other && bit < next,
            _ => false,
        }
    }
}

impl Mode {
    /// The force that is wanted at t as the limit of its rate lets it through.
    pub(super) fn shaped(&self, wanted: f64, rate: f64, t: f64) -> f64 {
        match self.slew {
            Slew::Follows => wanted,
            Slew::Goes { sign, from, since } => from + f64::from(sign) * rate * (t - since),
        }
    }

    /// The force behind both limits.
    pub(super) fn force(&self, wanted: f64, limit: Limit, t: f64) -> f64 {
        match self.bound {
            Bound::Free => self.shaped(wanted, limit.rate, t),
            Bound::At(sign) => f64::from(sign) * limit.torque,
        }
    }

    /// Whether the force follows what is wanted.
    pub(super) fn follows(&self) -> bool {
        self.bound == Bound::Free && self.slew == Slew::Follows
    }
}
