//! How what a memory tells goes on with the time since the last committed step, x' being the polynomial of the step.

use super::exponentials::moments;
use super::memory::Memory;
use super::step::{RatePolynomial, SEXTIC};
use crate::collocation::Nodes;

/// d/ds of what a unit springpot tells at a lag s behind the last committed step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Slopes {
    /// Of D^alpha x without singular parts.
    pub(crate) derivative: f64,
    /// Of the stored energy.
    pub(crate) stored: f64,
    /// Of the rate of dissipation.
    pub(crate) dissipation: f64,
}

impl Memory {
    /// At s = θh, 0 < θ ≤ 1; of orders 0 and 1, which keep no past, nothing.
    ///
    /// D = Σ_k w_k e^{−λ_k s} z_k + s^{1−α} Σ_p f_p u_p θ^p, and a mode goes on by Z' = x' − λ Z.
    pub(crate) fn slopes(&self, step: &RatePolynomial, theta: f64) -> Slopes {
        let Some(past) = self.past() else { return Slopes::default() };
        let (lag, local) = (theta * step.h, self.local());
        let mut power = lag.powf(-self.alpha());
        let mut derivative = 0.0;
        for (p, (u, factor)) in step.u.iter().zip(local.factors).enumerate() {
            derivative += u * factor * (p as f64 + 1.0 - self.alpha()) * power;
            power *= theta;
        }
        if !past.is_empty() {
            let kernel = past.kernel();
            for ((lambda, weight), z) in kernel.lambda.iter().zip(&kernel.weight).zip(past.modes()) {
                derivative -= lambda * weight * (-lambda * lag).exp() * z;
            }
            for k in 1..=kernel.missing(lag) {
                let (lambda, weight) = kernel.faster(k);
                derivative -= lambda * weight * (-lambda * lag).exp() * past.fast_mode(lambda);
            }
        }
        let longer = past.extended(Nodes::Radau.positions()[0] * step.h);
        let past = longer.as_ref().unwrap_or(past);
        let (rate, bend, turn) = (step.rate(theta), step.bend(theta), step.turn(theta));
        let [d1, d2, d3] = past.fast_tail();
        let mut slopes = Slopes {
            derivative,
            stored: d2 * rate * bend,
            dissipation: bend * (d1 * rate - 2.0 * d2 * bend)
                + rate * (d1 * bend - 2.0 * d2 * turn)
                + 2.0 * d3 * bend * turn,
        };
        let kernel = past.kernel();
        for ((lambda, weight), z) in kernel.lambda.iter().zip(&kernel.weight).zip(past.modes()) {
            let mut psi = [0.0; SEXTIC];
            let psi = &mut psi[..step.coefficients().len()];
            moments(lambda * lag, psi);
            let mut power = lag;
            let mut value = (-lambda * lag).exp() * z;
            for (u, psi) in step.u.iter().zip(&*psi) {
                value += power * u * psi;
                power *= theta;
            }
            let forward = weight * value * (rate - lambda * value);
            slopes.stored += forward;
            slopes.dissipation += 2.0 * lambda * forward;
        }
        slopes
    }
}
