//! The two fractional derivatives, which differ in what happened before t = 0.

/// Definition of D^alpha for 0 < alpha < 1 with lower terminal 0.
///
/// Caputo: C(t) = 1/Γ(1−alpha) ∫₀ᵗ (t−s)^−alpha x'(s) ds. Riemann–Liouville: RL(t) = C(t) + x(0) t^−alpha/Γ(1−alpha).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// x was held at x(0) for all t < 0.
    #[default]
    Caputo,
    /// x was 0 for all t < 0 and jumped to x(0) at t = 0: singular at 0+ whenever x(0) ≠ 0.
    RiemannLiouville,
}

impl Kind {
    /// Name in scenario files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Caputo => "caputo",
            Self::RiemannLiouville => "riemann-liouville",
        }
    }
}
