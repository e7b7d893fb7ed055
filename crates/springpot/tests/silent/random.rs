//! Random numbers with a fixed seed, and random sliders.

/// xorshift64*.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Evenly over the decades.
    pub(crate) fn log(&mut self, low: f64, high: f64) -> f64 {
        (self.within(low.ln(), high.ln())).exp()
    }

    pub(crate) fn of<'a, T>(&mut self, choices: &'a [T]) -> &'a T {
        &choices[(self.unit() * choices.len() as f64) as usize]
    }
}

/// A slider without gravity whose element `e` has `law`, the rest of its table; its stroke is q − 1.
pub(crate) fn slider(law: &str, motion: &str, end: f64, rows: usize) -> String {
    let step = end / rows as f64;
    format!(
        r#"
[robot]
gravity = [0, 0, 0]
[[robot.body]]
name = "b"
joint = {{ name = "q", kind = "prismatic", axis = [1, 0, 0] }}
mass = 1
[[element]]
name = "e"
from = {{ body = "world", point = [0, 0, 0] }}
to = {{ body = "b", point = [0, 0, 0] }}
rest_length = 1
{law}
[motion]
{motion}
[time]
end = {end}
output_step = {step}
"#
    )
}
