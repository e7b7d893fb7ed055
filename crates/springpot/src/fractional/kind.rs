//! The two readings of D^alpha.

/// Where the fractional derivative's memory starts.
///
/// For 0 < alpha < 1 and lower terminal 0,
///
/// ```text
/// Caputo              C(t) = 1/Γ(1−alpha) ∫₀ᵗ (t−s)^−alpha x'(s) ds
/// Riemann–Liouville   RL(t) = C(t) + x(0) t^−alpha/Γ(1−alpha)
/// ```
///
/// They agree when x(0) = 0. At alpha = 0 they are x − x(0) and x; at alpha = 1 both are x'.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// x was held at x(0) for t < 0.
    #[default]
    Caputo,
    /// x was 0 for t < 0 and jumped to x(0) at t = 0; singular at t = 0 unless x(0) = 0.
    RiemannLiouville,
}
