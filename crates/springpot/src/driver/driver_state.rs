//! The state of a driver, and whose it is.

use crate::account::recorder::RecorderState;
use crate::equations::VariationState;
use crate::equations::control::SamplerState;
use crate::methods::solver::SolverState;
use crate::system::System;
use crate::system::row_times::RowTimes;
use crate::system::settings::Settings;
use serde::{Deserialize, Serialize};
use std::fmt::{self, Write as _};

/// What a driver takes over from the steps before.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct DriverState {
    pub(super) system: u64,
    pub(super) recorder: RecorderState,
    pub(super) variation: Option<VariationState>,
    pub(super) sampler: Option<SamplerState>,
    pub(super) solver: SolverState,
    pub(super) t: f64,
    pub(super) h: f64,
    pub(super) crossing: Option<f64>,
    pub(super) is_own: bool,
    pub(super) tick: usize,
    pub(super) steps: u64,
    pub(super) rejected_steps: u64,
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
