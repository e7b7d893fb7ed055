//! The state of an instance, kept or as bytes.

use super::build::Setup;
use super::mode::Mode;
use crate::sealed;
use serde::{Deserialize, Serialize};
use springpot::driver::SimulationState;
use std::collections::{BTreeMap, BTreeSet};

/// What the bytes begin with.
const MARK: &[u8] = b"springpot-fmu-1";

/// All that it takes an instance to go on from a communication point, to the bit.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Checkpoint {
    /// The FMU that it is of.
    pub(super) guid: String,
    pub(super) mode: Mode,
    pub(super) setup: Setup,
    pub(super) torques: BTreeMap<u32, f64>,
    pub(super) held: BTreeSet<u32>,
    pub(super) has_ended: bool,
    /// None before the start.
    pub(super) simulation: Option<SimulationState>,
}

impl Checkpoint {
    /// As bytes.
    ///
    /// # Errors
    /// In words.
    pub fn bytes(&self) -> Result<Vec<u8>, String> {
        sealed::seal(MARK, self).map_err(|error| error.to_string())
    }

    /// Of bytes.
    ///
    /// # Errors
    /// In words, where they are torn or no state of an FMU of this version.
    pub fn of_bytes(bytes: &[u8]) -> Result<Self, String> {
        sealed::open(MARK, bytes).map_err(|why| format!("the bytes are no state of an FMU: {why}"))
    }
}
