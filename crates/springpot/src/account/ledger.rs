//! The energy accounts of a run: kinetic + potential + stored + dissipated − input − actuators stays what it was at t = 0.

use crate::collocation::Nodes;
use crate::collocation::{Cubic, STAGES, quadrature, quadrature_defect};
use serde::{Deserialize, Serialize};

/// Gauss–Legendre rule on [−1, 1], 12 points: positive nodes and weights.
const GAUSS: [(f64, f64); 6] = [
    (0.125_233_408_511_468_9, 0.249_147_045_813_402_8),
    (0.367_831_498_998_180_2, 0.233_492_536_538_354_8),
    (0.587_317_954_286_617_4, 0.203_167_426_723_065_92),
    (0.769_902_674_194_304_7, 0.160_078_328_543_346_23),
    (0.904_117_256_370_474_9, 0.106_939_325_995_318_43),
    (0.981_560_634_246_719_3, 0.047_175_336_386_511_83),
];

/// A power at the start and at the nodes of a step, W.
pub(crate) type NodePower = [f64; STAGES + 1];

/// ∫ power dt from t_n to t_n + θh.
pub(super) fn work(power: &NodePower, h: f64, theta: f64) -> f64 {
    let weights = quadrature(Nodes::Radau, theta);
    h * power.iter().zip(weights).map(|(p, w)| p * w).sum::<f64>()
}

/// Error estimate of the work over the whole step.
pub(super) fn work_defect(power: &[f64], h: f64) -> f64 {
    h * quadrature_defect(Nodes::Radau, power)
}

/// ∫ s^−alpha g(s) ds from t_n to t_n + θh for g given at the start and at the nodes: the work of a singular force.
pub(super) fn singular_work(g: &NodePower, t: f64, h: f64, theta: f64, alpha: f64) -> f64 {
    let end = theta * h;
    let polynomial = Cubic::through(g).coefficients;
    if t == 0.0 {
        let terms = polynomial.iter().enumerate().rev();
        return end.powf(1.0 - alpha) * terms.fold(0.0, |sum, (p, c)| sum * theta + c / (p as f64 + 1.0 - alpha));
    }
    let panel = |from: f64, to: f64| {
        (to - from)
            * gauss(|u| {
                let s = from + (to - from) * u;
                s.powf(-alpha) * polynomial.iter().rev().fold(0.0, |sum, c| sum * ((s - t) / h) + c)
            })
    };
    // Two panels of equal ratio keep the rule at rounding where the step is long beside its start.
    let middle = (t * (t + end)).sqrt();
    panel(t, middle) + panel(middle, t + end)
}

/// ∫₀¹ f.
fn gauss(f: impl Fn(f64) -> f64) -> f64 {
    GAUSS.iter().map(|(x, w)| 0.5 * w * (f(0.5 - 0.5 * x) + f(0.5 + 0.5 * x))).sum()
}

/// The largest energies seen, which make "the energy turned over", J.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Turnover {
    kinetic: f64,
    potential: f64,
    stored: f64,
    dissipated: f64,
    input: f64,
    actuators: f64,
}

/// One balance, J.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Balance {
    pub(super) kinetic: f64,
    /// Above its value at t = 0.
    pub(super) potential: f64,
    pub(super) stored: f64,
    /// In elements and joints.
    pub(super) dissipated: f64,
    pub(super) input: f64,
    pub(super) actuators: f64,
}

impl Balance {
    /// kinetic + potential + stored + dissipated − input − actuators.
    pub(super) fn total(&self) -> f64 {
        self.kinetic + self.potential + self.stored + self.dissipated - self.input - self.actuators
    }
}

impl Turnover {
    pub(super) fn take(&mut self, balance: &Balance) {
        let raise = |largest: &mut f64, value: f64| *largest = largest.max(value.abs());
        raise(&mut self.kinetic, balance.kinetic);
        raise(&mut self.potential, balance.potential);
        raise(&mut self.stored, balance.stored);
        raise(&mut self.dissipated, balance.dissipated);
        raise(&mut self.input, balance.input);
        raise(&mut self.actuators, balance.actuators);
    }

    /// The energy turned over: the sum of the largest amounts, J.
    pub(super) fn total(&self) -> f64 {
        self.kinetic + self.potential + self.stored + self.dissipated + self.input + self.actuators
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collocation::RADAU_NODES;

    #[test]
    fn work_is_exact_for_cubics() {
        let power = |x: f64| 1.0 - 2.0 * x + 0.5 * x * x + 3.0 * x.powi(3);
        let integral = |x: f64| x - x * x + x.powi(3) / 6.0 + 0.75 * x.powi(4);
        let values: NodePower = std::array::from_fn(|k| power(if k == 0 { 0.0 } else { RADAU_NODES[k - 1] }));
        for theta in [0.1, 0.6, 1.0] {
            assert!((work(&values, 2.0, theta) - 2.0 * integral(theta)).abs() < 1e-14);
        }
    }

    #[test]
    fn singular_work_is_exact_for_cubics() {
        // ∫ s^−alpha s^p ds = s^{p+1−alpha}/(p+1−alpha), with g(s) = s³ in absolute time.
        for alpha in [0.1, 0.5, 0.9] {
            for (t, h) in [(0.0, 0.3), (0.1, 0.5), (4.0, 0.01)] {
                let position = |k: usize| if k == 0 { 0.0 } else { RADAU_NODES[k - 1] };
                let g: NodePower = std::array::from_fn(|k| f64::powi(t + position(k) * h, 3));
                let exact = |s: f64| s.powf(4.0 - alpha) / (4.0 - alpha);
                for theta in [0.4, 1.0] {
                    let value = singular_work(&g, t, h, theta, alpha);
                    let expected = exact(t + theta * h) - exact(t);
                    assert!((value / expected - 1.0).abs() < 1e-9, "{alpha} {t} {theta}: {value} {expected}");
                }
            }
        }
    }
}
