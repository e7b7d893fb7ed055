//! Proportional–derivative control with gravity.

use super::controller::{At, Controller, ErrorTerm, Scratch, TorqueSlopes};
use super::variation::ControllerVariation;
use crate::dynamics::{gravity_into, rnea_derivatives_into};

/// τ = kp·e + kd·ė − Q_g, e = q_d − q (Takegaki and Arimoto 1981).
#[derive(Debug, Clone, PartialEq)]
pub struct PdGravity {
    /// kp ≥ 0 of each velocity (nv), N·m/rad or N/m.
    pub kp: Vec<f64>,
    /// kd ≥ 0 of each velocity (nv), N·m·s/rad or N·s/m.
    pub kd: Vec<f64>,
}

impl Controller for PdGravity {
    fn torque(&self, at: &At, scratch: &mut Scratch, tau: &mut [f64]) {
        gravity_into(at.model, at.kinematics, &mut scratch.workspace, tau);
        for (k, tau) in tau.iter_mut().enumerate() {
            *tau += self.kp[k] * at.weighted(k) + self.kd[k] * at.derived(k);
        }
    }

    fn slopes(&self, at: &At, scratch: &mut Scratch, slopes: &mut TorqueSlopes) {
        gravity_slopes(at, scratch, slopes);
        let n = at.model.nv();
        for k in 0..n {
            slopes.d_q[k * n + k] -= self.kp[k];
            slopes.d_v[k * n + k] -= if at.shaping.filter.is_none() { self.kd[k] } else { 0.0 };
        }
    }

    fn rate_terms(&self) -> Vec<ErrorTerm> {
        let of_rates = (0..self.kd.len()).filter(|k| self.kd[*k] != 0.0);
        of_rates.map(|velocity| ErrorTerm { velocity, order: 1.0, gain: self.kd[velocity] }).collect()
    }

    fn variation(&self) -> Option<&dyn ControllerVariation> {
        Some(self)
    }
}

/// Adds −∂Q_g/∂q.
pub(super) fn gravity_slopes(at: &At, scratch: &mut Scratch, slopes: &mut TorqueSlopes) {
    let Scratch { workspace, kinematics, derivatives, row, .. } = scratch;
    row.fill(0.0);
    kinematics.update_velocity(at.model, at.q, row);
    rnea_derivatives_into(at.model, kinematics, row, &[], workspace, derivatives);
    slopes.d_q.iter_mut().zip(&derivatives.d_q).for_each(|(slope, own)| *slope += own);
}
