//! What is looked through, and how finely.

use super::function::Signal;

/// The narrowest cell, as a share of the run; what is narrower may be missed.
pub const FINEST: f64 = 1.0 / (1u64 << 30) as f64;

/// A signal, and what it is to the run.
#[derive(Debug, Clone, Copy)]
pub struct Watched<'a> {
    /// The signal.
    pub signal: &'a Signal,
    /// Whether it is a position, whose rates count; else it counts itself (a force, a voltage).
    pub is_position: bool,
    /// How many times more than others it may hide: 1 where the motion follows from it.
    pub slack: f64,
}

/// A stretch of time with a longest step, up to the next window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Window {
    pub(super) start: f64,
    pub(super) longest: f64,
}

/// Why a run cannot be looked through.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum AgendaError {
    /// A signal switches or swings too often.
    #[error("changes more often than a run can follow: about {times:.1e} times")]
    TooBusy {
        /// Index of the signal.
        signal: usize,
        /// How often about.
        times: f64,
    },
    /// Interrupted by the user.
    #[error("interrupted")]
    Interrupted,
}
