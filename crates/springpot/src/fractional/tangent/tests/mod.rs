//! Identities, oracles and closed forms.

mod closed_forms;
mod discrete;
mod jumps;
mod kernel;
mod price;
mod replay;
mod slider;
mod state;

/// A sequence of numbers in [0, 1) (D. E. Knuth's MMIX).
pub(super) struct Dice(pub(super) u64);

impl Dice {
    pub(super) fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}
