//! Mass and inertia.

/// Mass and inertia of a link, in the link's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inertial {
    /// Mass, kg, 0 or more.
    pub mass: f64,
    /// Centre of mass in the link's frame, m.
    pub com: [f64; 3],
    /// Inertia tensor about the centre of mass in the axes of the link's frame, kg·m² (off-diagonals are tensor
    /// components): R I Rᵀ of the file's tensor I and its attitude R.
    pub inertia: [[f64; 3]; 3],
}

impl Inertial {
    /// No mass.
    pub(super) const ZERO: Self = Self { mass: 0.0, com: [0.0; 3], inertia: [[0.0; 3]; 3] };
}
