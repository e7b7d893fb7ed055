//! What lies between the errors of a controller and its law: weights, a filter, and what is measured.

use super::controller::Aim;
use crate::model::Model;
use crate::random::Random;

/// How the parts of a law see its error; the default shows it as it is.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Shaping {
    /// b of each velocity (nv): the proportional part takes b·q_d − q. Empty: 1.
    pub set_point: Vec<f64>,
    /// Whether the derivative part takes −q in place of q_d − q.
    pub on_measurement: bool,
    /// T > 0, s, of a filter behind the derivative part: T·y' + y = D^mu of what it takes, y(0) = 0.
    pub filter: Option<f64>,
}

impl Shaping {
    /// b of velocity `k`.
    pub(super) fn weight(&self, k: usize) -> f64 {
        self.set_point.get(k).copied().unwrap_or(1.0)
    }

    /// What the derivative part takes of velocity `k` of a joint of one degree, and its rate: the error, or −q; zeros for other joints.
    pub(crate) fn taken(&self, aim: &Aim, model: &Model, k: usize, [q, v]: [&[f64]; 2]) -> [f64; 2] {
        match self.on_measurement {
            true => model.coordinate_of(k).map_or([0.0; 2], |place| [-q[place], -v[k]]),
            false => aim.error(model, k, q, v),
        }
    }

    /// Whether all parts see the error as it is.
    pub(crate) fn is_plain(&self) -> bool {
        *self == Self::default()
    }
}

/// How a sampled controller sees coordinates: Δ·round((q + σ·n)/Δ), n of the standard normal distribution, another for each sample and coordinate.
///
/// Rates, and what keeps on between samples, are as they are.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// σ ≥ 0 of each velocity (nv), rad or m.
    pub deviation: Vec<f64>,
    /// Δ ≥ 0 of each velocity (nv), rad or m; 0: none.
    pub quantum: Vec<f64>,
    /// Of the random numbers: the same seed gives the same noise.
    pub seed: u64,
}

impl Measurement {
    /// What is seen of the coordinate `q` of velocity `k` in sample `sample`.
    pub(crate) fn of(&self, q: f64, k: usize, sample: u64) -> f64 {
        let noisy = match self.deviation[k] {
            0.0 => q,
            deviation => q + deviation * normal(&mut Random::new(self.seed, ((k as u64) << 40) ^ sample)),
        };
        match self.quantum[k] {
            0.0 => noisy,
            quantum => quantum * (noisy / quantum).round(),
        }
    }
}

/// A number of the standard normal distribution.
///
/// Source: G. E. P. Box, M. E. Muller, A Note on the Generation of Random Normal Deviates, Ann. Math. Statist. 29 (1958) 610.
fn normal(random: &mut Random) -> f64 {
    let radius = (-2.0 * (1.0 - random.share()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.share()).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean, deviation, fourth moment and what neighbours have in common, in units of what 40000 numbers leave of them.
    #[test]
    fn noise_is_white_and_normal() {
        let measured = Measurement { deviation: vec![0.3, 0.3], quantum: vec![0.0; 2], seed: 7 };
        const COUNT: usize = 40_000;
        let noise: Vec<f64> = (0..COUNT as u64).map(|sample| (measured.of(2.0, 1, sample) - 2.0) / 0.3).collect();
        let other: Vec<f64> = (0..COUNT as u64).map(|sample| (measured.of(2.0, 0, sample) - 2.0) / 0.3).collect();
        let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / COUNT as f64;
        let scatter = (COUNT as f64).sqrt();
        assert!(mean(&mut noise.iter().copied()).abs() < 4.0 / scatter);
        assert!((mean(&mut noise.iter().map(|n| n * n)) - 1.0).abs() < 4.0 * 2.0f64.sqrt() / scatter);
        assert!((mean(&mut noise.iter().map(|n| n.powi(4))) - 3.0).abs() < 4.0 * 96.0f64.sqrt() / scatter);
        for lag in [1, 2, 3, 7, 64] {
            let common = mean(&mut noise.iter().zip(&noise[lag..]).map(|(a, b)| a * b));
            assert!(common.abs() < 4.0 / scatter, "{lag}: {common}");
        }
        assert!(mean(&mut noise.iter().zip(&other).map(|(a, b)| a * b)).abs() < 4.0 / scatter);
    }

    #[test]
    fn what_is_measured_has_steps() {
        let measured = Measurement { deviation: vec![0.0], quantum: vec![0.25], seed: 0 };
        assert_eq!([0.3, -0.4, 0.1].map(|q| measured.of(q, 0, 5)), [0.25, -0.5, 0.0]);
    }
}
