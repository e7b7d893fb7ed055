//! The size of the inner steps along a given motion.

/// Exponent of the energy estimate, whose order is that of the third difference.
const ENERGY_EXPONENT: f64 = 0.25;

/// Error of a step in units of its tolerance, by what it comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StepError {
    /// The worst memory: its error and order alpha.
    pub(super) memory: f64,
    /// Order alpha of the worst memory.
    pub(super) alpha: f64,
    /// Index of the worst element.
    pub(super) element: Option<usize>,
    /// The energy ledger.
    pub(super) energy: f64,
}

impl StepError {
    /// No error.
    pub(super) const NONE: Self = Self { memory: 0.0, alpha: 0.0, element: None, energy: 0.0 };

    /// Whether the step may be kept.
    pub(super) fn accepted(&self) -> bool {
        self.memory <= 1.0 && self.energy <= 1.0
    }

    /// The larger of the two.
    pub(super) fn worst(&self) -> f64 {
        self.memory.max(self.energy)
    }

    /// By how much the next step may be longer; below 1 after a rejection.
    pub(super) fn factor(&self) -> f64 {
        let memory = 0.85 * self.memory.powf(-1.0 / (4.0 - self.alpha));
        let energy = 0.85 * self.energy.powf(-ENERGY_EXPONENT);
        let factor = memory.min(energy).clamp(0.1, 6.0);
        // A step that changes little keeps its size, and with it the tables of the exponentials.
        if (1.0..1.25).contains(&factor) { 1.0 } else { factor }
    }
}
