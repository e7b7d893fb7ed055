//! What a run has written so far.

use crate::equations::control::Misread;
use serde::{Deserialize, Serialize};

/// What of the rows must outlast a step.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Written {
    /// Number of rows.
    pub(super) rows: usize,
    /// Time of the last one, s.
    pub(super) last: Option<f64>,
    /// Largest residual of the balance, J, and its time, s.
    pub(super) residual: f64,
    pub(super) residual_at: f64,
    /// What rounding may do to the balance, J.
    pub(super) rounding: f64,
    /// The first row whose rate is not that of its step: its time, the element, the departure in units of D^alpha x.
    pub(super) departure: Option<(f64, usize, f64)>,
    /// The first row where an expression of the state is not what its step used, and its time.
    pub(super) misread: Option<(f64, Misread)>,
}
