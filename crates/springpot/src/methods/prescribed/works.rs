//! Works over a step by the powers at its nodes and at those of the step before: the quadrature of Radau's nodes alone is of order 5.

use crate::account::ledger::NodePower;
use crate::account::works::{TERMS, Works, terms};
use crate::collocation::{RADAU_NODES, STAGES};
use serde::{Deserialize, Serialize};

/// Powers of the step before and of this one, whose start is the end of that.
const POINTS: usize = 2 * STAGES + 1;
const _: () = assert!(POINTS == TERMS);

/// What a step leaves to the next one, where nothing jumps between them.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Before {
    size: f64,
    flows: Vec<NodePower>,
}

/// ∫₀^θ of the polynomial through powers at a step's nodes and at those of one `ratio` times as long before it.
#[derive(Debug, Clone)]
pub(super) struct Quadrature {
    ratio: f64,
    /// Of θ^{p+1}: Σ_k coefficients[p][k] power_k.
    coefficients: [[f64; POINTS]; TERMS],
    /// Weights at θ = 1 of the polynomial that leaves out the first power.
    shorter: [f64; POINTS],
}

impl Before {
    pub(super) fn new(size: f64, flows: Vec<NodePower>) -> Self {
        Self { size, flows }
    }

    /// Works of a step of size `h` that follows, and estimates of their errors.
    pub(super) fn works(&self, h: f64, flows: &[NodePower], quadrature: &mut Option<Quadrature>) -> (Works, Vec<f64>) {
        let ratio = self.size / h;
        if quadrature.as_ref().is_none_or(|known| known.ratio != ratio) {
            *quadrature = Some(Quadrature::new(ratio));
        }
        let rule = quadrature.as_ref().expect("it was made");
        let (mut change, mut within) = (Vec::new(), [const { Vec::new() }; TERMS]);
        let mut errors = Vec::new();
        for (before, own) in self.flows.iter().zip(flows) {
            let powers: [f64; POINTS] = std::array::from_fn(|k| if k < STAGES { before[k] } else { own[k - STAGES] });
            let sum = |weights: &[f64; POINTS]| h * weights.iter().zip(powers).map(|(w, p)| w * p).sum::<f64>();
            let own = terms(rule.coefficients.each_ref().map(sum));
            change.push(own[0]);
            errors.push((own[0] - sum(&rule.shorter)).abs());
            within.iter_mut().zip(own).for_each(|(terms, own)| terms.push(own));
        }
        let mut works = Works::default();
        works.take(&change, Some(within.each_ref().map(|terms| &terms[..])));
        (works, errors)
    }
}

impl Quadrature {
    fn new(ratio: f64) -> Self {
        let positions = [0.0, RADAU_NODES[0], RADAU_NODES[1], RADAU_NODES[2]];
        let points: [f64; POINTS] =
            std::array::from_fn(|k| if k < STAGES { ratio * (positions[k] - 1.0) } else { positions[k - STAGES] });
        let mut coefficients = [[0.0; POINTS]; TERMS];
        let mut shorter = [0.0; POINTS];
        for k in 0..POINTS {
            for (p, c) in lagrange(&points, k).into_iter().enumerate() {
                coefficients[p][k] = c / (p + 1) as f64;
            }
            if k > 0 {
                let own = lagrange(&points[1..], k - 1);
                shorter[k] = own.iter().enumerate().map(|(p, c)| c / (p + 1) as f64).sum();
            }
        }
        Self { ratio, coefficients, shorter }
    }
}

/// Coefficients of θ^p of the Lagrange polynomial of point `k`.
fn lagrange(points: &[f64], k: usize) -> [f64; POINTS] {
    let mut c = [0.0; POINTS];
    c[0] = 1.0;
    for (degree, other) in points.iter().enumerate().filter(|(m, _)| *m != k).map(|(_, x)| *x).enumerate() {
        let scale = 1.0 / (points[k] - other);
        for p in (0..=degree + 1).rev() {
            let below = if p > 0 { c[p - 1] } else { 0.0 };
            c[p] = (below - other * c[p]) * scale;
        }
    }
    c
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::account::works::polynomial;

    /// ∫ of a sixth power is exact, and a step behind another of any length errs like h⁸.
    #[test]
    fn works_are_of_order_7() {
        let positions = [0.0, RADAU_NODES[0], RADAU_NODES[1], 1.0];
        let at = |power: fn(f64) -> f64, from: f64, h: f64| [positions.map(|c| power(from + c * h))];
        let mut rule = None;
        for ratio in [0.2, 1.0, 5.0] {
            let sixth = |t: f64| (t - 0.3).powi(6);
            let before = Before::new(ratio, at(sixth, -ratio, ratio).to_vec());
            let (works, _) = before.works(1.0, &at(sixth, 0.0, 1.0), &mut rule);
            let exact = |t: f64| ((t - 0.3).powi(7) + 0.3f64.powi(7)) / 7.0;
            for theta in [0.4, 1.0] {
                assert!((works.until(0, theta) - exact(theta)).abs() < 1e-12, "{ratio} {theta}");
            }
        }
        let error = |h: f64| {
            let before = Before::new(h, at(f64::exp, -h, h).to_vec());
            let (works, estimates) = before.works(h, &at(f64::exp, 0.0, h), &mut None);
            ((works.until(0, 1.0) - h.exp_m1()).abs(), estimates[0])
        };
        let (coarse, fine) = (error(0.8), error(0.4));
        assert!((coarse.0 / fine.0).log2() > 7.6 && coarse.0 < coarse.1 && fine.0 < fine.1, "{coarse:?} {fine:?}");
        assert_eq!(polynomial([1.0; TERMS], 0.0)[0], 0.0);
    }
}
