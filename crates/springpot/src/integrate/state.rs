//! The state of a run between two steps: all that it takes to go on, and to end with the same bits.

use super::context::Held;
use super::output::Written;
use super::recorder::RecorderState;
use super::{RowTimes, Settings, System, fixed, prescribed, radau};
use serde::{Deserialize, Serialize};
use std::fmt::{self, Write as _};

/// The state of a run between two steps, memories included; see [`super::Rows::checkpoint`] and [`super::resume`].
///
/// What follows from the system and its settings is not in it: it belongs to the very system and settings that it was taken from.
/// A run that goes on from it takes the same steps and writes the same rows, bit by bit, as the one that it was taken from, on the
/// same machine. Numbers that are not finite may be part of it, so that formats which know none (JSON) may not hold it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Checkpoint {
    pub(super) driver: DriverState,
    pub(super) written: Written,
}

/// The state of a [`super::Simulation`] between two steps, memories and what is held from outside included.
///
/// As with a [`Checkpoint`], it belongs to the system and settings that it was taken from, and what goes on from it does so to the bit.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SimulationState {
    pub(super) driver: DriverState,
    pub(super) held: Held,
}

/// What a driver takes over from the steps before.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct DriverState {
    pub(super) system: u64,
    pub(super) recorder: RecorderState,
    pub(super) stepper: StepperState,
    pub(super) t: f64,
    pub(super) h: f64,
    pub(super) crossing: Option<f64>,
    pub(super) tick: usize,
    pub(super) steps: u64,
    pub(super) rejected_steps: u64,
}

/// What a method takes over from the steps before.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) enum StepperState {
    Prescribed(prescribed::StepperState),
    Radau(Box<radau::StepperState>),
    Fixed(Box<fixed::StepperState>),
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

/// A number that tells systems and settings apart: of all that `Debug` prints of them, which is the same in every process, but for the rows and
/// the number of steps allowed.
pub(super) fn fingerprint(system: &System, settings: &Settings) -> u64 {
    /// FNV-1a.
    struct Hash(u64);
    impl fmt::Write for Hash {
        fn write_str(&mut self, text: &str) -> fmt::Result {
            for byte in text.bytes() {
                self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
            }
            Ok(())
        }
    }
    let settings = Settings { rows: RowTimes::Times([].into()), max_steps: None, ..settings.clone() };
    let mut hash = Hash(0xcbf2_9ce4_8422_2325);
    let _ = write!(hash, "{system:?}{settings:?}");
    hash.0
}
