//! Functions of time.

/// Value and first two time derivatives of a signal.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Jet {
    /// Value.
    pub value: f64,
    /// First time derivative.
    pub first: f64,
    /// Second time derivative.
    pub second: f64,
}
