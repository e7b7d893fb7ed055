//! The state of a run between two steps: all that it takes to go on, and to end with the same bits.

use super::driver_state::DriverState;
use super::events::WatchState;
use super::written::Written;
use serde::{Deserialize, Serialize};

/// The state of a run between two steps, memories included; see [`super::Rows::checkpoint`] and [`super::resume`].
///
/// What follows from the system and its settings is not in it: it belongs to the very system and settings that it was taken from.
/// A run that goes on from it takes the same steps and writes the same rows, bit by bit, as the one that it was taken from, on the
/// same machine. Numbers that are not finite may be part of it, so that formats which know none (JSON) may not hold it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Checkpoint {
    pub(super) driver: DriverState,
    pub(super) written: Written,
    pub(super) events: WatchState,
}

/// The state of a [`super::Simulation`] between two steps, memories, the sides of events and what is held included.
///
/// As with a [`Checkpoint`], it belongs to the system and settings that it was taken from, and what goes on from it does so to the bit.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SimulationState {
    pub(super) driver: DriverState,
    pub(super) events: WatchState,
}

impl Checkpoint {
    /// The time at which it was taken, s: rows up to it are written, later ones are not.
    pub fn t(&self) -> f64 {
        self.driver.t
    }

    /// How many rows are written.
    pub fn rows(&self) -> usize {
        self.written.rows
    }
}

impl SimulationState {
    /// The time at which it was taken, s.
    pub fn t(&self) -> f64 {
        self.driver.t
    }
}
