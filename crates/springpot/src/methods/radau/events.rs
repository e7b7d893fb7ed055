//! What may happen to a joint or to an element within a step, and what becomes of the step.

use crate::equations::control::Guard;
use crate::equations::kinks::Kink;
use crate::methods::stepper::Target;

/// What may happen within a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Change {
    /// Velocity `k`, which has the sign `direction`, comes to rest.
    Stop { k: usize, direction: f64 },
    /// Velocity `k` is no longer held against a force of the sign `direction`.
    BreakAway { k: usize, direction: f64 },
    /// A joint that signals move turns round.
    Reversal,
    /// The force of an element has a kink.
    Kink(Kink),
    /// Control leaves the branch that it is on.
    Control(Guard),
}

/// What is seen of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Look {
    /// Nothing changes.
    Nothing,
    /// Holding forces cannot be followed over so long a step.
    Unclear,
    /// The first change is at θ.
    Within(f64, Change),
    /// What changes does so at the end, and is noted with the stick.
    AtEnd,
}

/// What becomes of a step that was solved within its tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Settled {
    /// It stands like this, and has been solved so.
    At(Target),
    /// A step of this size is to be tried instead.
    Shorter(f64),
    /// Something changes at its start.
    AtStart,
}
