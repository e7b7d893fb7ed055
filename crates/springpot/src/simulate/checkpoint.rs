//! The state of a run between two steps: all that it takes to go on, and to end with the same bits.

use super::book::Books;
use super::{System, along, fixed, forward};
use serde::{Deserialize, Serialize};

/// The state of a run between two steps, memories included; see [`super::Rows::checkpoint`] and [`super::resume`].
///
/// What follows from the system and its settings is not in it: it belongs to the very system and settings that it was taken from.
/// A run that goes on from it takes the same steps and writes the same rows, bit by bit, as the one that it was taken from, on the
/// same machine. Numbers that are not finite may be part of it, so that formats which know none (JSON) may not hold it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Checkpoint {
    pub(super) books: Books,
    pub(super) pace: Pace,
}

/// What a time loop takes over from the steps before.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) enum Pace {
    Along(along::Pace),
    Forward(Box<forward::Pace>),
    Fixed(Box<fixed::Pace>),
}

impl Checkpoint {
    /// The time at which it was taken, s: rows up to it are written, later ones are not.
    pub fn t(&self) -> f64 {
        self.books.moment.t
    }

    /// How many rows are written.
    pub fn rows(&self) -> usize {
        self.books.next_row
    }

    /// Whether it can be one of `system`, by the numbers of its elements and joints.
    pub(super) fn fits(&self, system: &System) -> bool {
        self.books.fit(system.elements.len(), system.model.nq(), system.model.nv())
    }
}
