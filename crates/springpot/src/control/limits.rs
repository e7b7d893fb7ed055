//! Bounds of actuator forces.

/// Bounds of one actuator force; the default has none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// Largest |τ|, N·m or N; acts last.
    pub torque: f64,
    /// Largest |dτ/dt| before that, N·m/s or N/s. The first value is taken as it is.
    pub rate: f64,
}

impl Default for Limit {
    fn default() -> Self {
        Self { torque: f64::INFINITY, rate: f64::INFINITY }
    }
}

/// What the integrals of a controller do while the force before its limit is outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AntiWindup {
    /// The integrand is 0 while the force is outside and ki·e has its sign.
    #[default]
    Conditional,
    /// They go on.
    None,
}
