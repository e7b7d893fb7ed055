//! How a path is followed.

use std::sync::atomic::AtomicBool;

/// Knots after which a path is given up: 200 MB for seven joints.
pub(super) const MOST_KNOTS: usize = 1_000_000;

/// How far and how closely a path is followed.
#[derive(Debug, Clone, Copy)]
pub struct Course<'a> {
    /// End of the path, s; it starts at 0.
    pub end: f64,
    /// Longest stretch between two knots, s.
    pub max_step: Option<f64>,
    /// Interrupts from outside.
    pub stop: &'a AtomicBool,
}
