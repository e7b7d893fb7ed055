//! What a run did.

/// What a run did.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Report {
    /// Inner steps taken.
    pub steps: u64,
    /// Inner steps tried and not kept.
    pub rejected_steps: u64,
    /// Newton iterations of forward dynamics.
    pub newton_iterations: Option<u64>,
    /// Explicit steps among them, of forward dynamics without memory.
    pub explicit_steps: Option<u64>,
    /// Solves for accelerations in explicit steps and between them.
    pub evaluations: Option<u64>,
    /// How often another method took over, since the motion was stiff or no longer so.
    pub method_switches: Option<u64>,
    /// Rows written.
    pub rows: u64,
    /// Time of the last complete row, s; `None` before the first.
    pub t_reached: Option<f64>,
    /// Largest departure of the energy balance from 0, J; `None` where the ledger is not known.
    pub energy_residual: Option<f64>,
    /// The energy turned over: largest kinetic, potential (above the start), stored, dissipated, supplied energies, summed, J.
    pub energy_turned_over: Option<f64>,
    /// What rounding alone may do to the balance, J: of heights above the world's origin, and of strokes, which are differences of lengths.
    pub energy_rounding: Option<f64>,
    /// Exponentials of the memories at the end.
    pub modes: usize,
    /// Kinks and jumps of the signals, each of which ends a step; `None` for steps of one size, which do not look ahead.
    pub switches: Option<u64>,
    /// What signals do in less time than this may be missed between steps, s; `None` for steps of one size.
    pub resolution: Option<f64>,
}
