//! Proportional–integral–derivative control, of whole and of fractional orders.

use super::controller::{At, Controller, ErrorTerm, Scratch, TorqueSlopes};
use super::variation::ControllerVariation;

/// τ = kp·e + ki·I^lambda e + kd·D^mu e of every joint by itself, e = q_d − q, terminal 0, Caputo (Podlubny 1999, PI^λD^μ); a PID controller
/// where lambda = mu = 1. Gravity is not in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Pid {
    /// kp ≥ 0 of each velocity (nv), N·m/rad or N/m.
    pub kp: Vec<f64>,
    /// ki ≥ 0 of each velocity (nv), N·m/(rad·s^lambda) or N/(m·s^lambda).
    pub ki: Vec<f64>,
    /// kd ≥ 0 of each velocity (nv), N·m·s^mu/rad or N·s^mu/m.
    pub kd: Vec<f64>,
    /// 0 < lambda ≤ 1 of each velocity (nv).
    pub lambda: Vec<f64>,
    /// 0 < mu ≤ 1 of each velocity (nv).
    pub mu: Vec<f64>,
}

impl Controller for Pid {
    fn torque(&self, at: &At, _: &mut Scratch, tau: &mut [f64]) {
        for (k, tau) in tau.iter_mut().enumerate() {
            let rate = if self.mu[k] == 1.0 { at.derived(k) } else { 0.0 };
            *tau = self.kp[k] * at.weighted(k) + self.kd[k] * rate;
        }
    }

    fn slopes(&self, at: &At, _: &mut Scratch, slopes: &mut TorqueSlopes) {
        let n = at.model.nv();
        for k in 0..n {
            slopes.d_q[k * n + k] -= self.kp[k];
            let acts = self.mu[k] == 1.0 && at.shaping.filter.is_none();
            slopes.d_v[k * n + k] -= if acts { self.kd[k] } else { 0.0 };
        }
    }

    fn error_terms(&self) -> Vec<ErrorTerm> {
        let mut terms = Vec::new();
        for velocity in 0..self.kp.len() {
            if self.ki[velocity] != 0.0 {
                terms.push(ErrorTerm { velocity, order: -self.lambda[velocity], gain: self.ki[velocity] });
            }
            if self.kd[velocity] != 0.0 && self.mu[velocity] < 1.0 {
                terms.push(ErrorTerm { velocity, order: self.mu[velocity], gain: self.kd[velocity] });
            }
        }
        terms
    }

    fn rate_terms(&self) -> Vec<ErrorTerm> {
        let of_rates = (0..self.kp.len()).filter(|k| self.kd[*k] != 0.0 && self.mu[*k] == 1.0);
        of_rates.map(|velocity| ErrorTerm { velocity, order: 1.0, gain: self.kd[velocity] }).collect()
    }

    fn variation(&self) -> Option<&dyn ControllerVariation> {
        Some(self)
    }
}
