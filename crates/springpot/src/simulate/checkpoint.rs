//! The state of a run between two steps: all that it takes to go on, and to end with the same bits.

use super::recorder::RecorderState;
use super::{System, along, fixed, forward};
use serde::{Deserialize, Serialize};

/// The state of a run between two steps, memories included; see [`super::Rows::checkpoint`] and [`super::resume`].
///
/// What follows from the system and its settings is not in it: it belongs to the very system and settings that it was taken from.
/// A run that goes on from it takes the same steps and writes the same rows, bit by bit, as the one that it was taken from, on the
/// same machine. Numbers that are not finite may be part of it, so that formats which know none (JSON) may not hold it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Checkpoint {
    pub(super) recorder: RecorderState,
    pub(super) stepper_state: StepperState,
}

/// What a time loop takes over from the steps before.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) enum StepperState {
    Along(along::StepperState),
    Forward(Box<forward::StepperState>),
    Fixed(Box<fixed::StepperState>),
}

impl Checkpoint {
    /// The time at which it was taken, s: rows up to it are written, later ones are not.
    pub fn t(&self) -> f64 {
        self.recorder.moment.t
    }

    /// How many rows are written.
    pub fn rows(&self) -> usize {
        self.recorder.next_row
    }

    /// Whether it can be one of `system`, by the numbers of its elements and joints.
    pub(super) fn fits(&self, system: &System) -> bool {
        self.recorder.fit(system.elements.len(), system.model.nq(), system.model.nv())
    }
}
