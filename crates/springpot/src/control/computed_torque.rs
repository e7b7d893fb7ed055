//! Control by inverse dynamics.

use super::controller::{At, Controller, Scratch, TorqueSlopes};
use super::variation::ControllerVariation;
use crate::dynamics::{rnea_at_into, rnea_derivatives_into};

/// τ = a(q)·(q̈_d + kd·ė + kp·e) + Γq̇q̇ − Q_g, and with `compensate_elements` − Q_elements, e = q_d − q (Luh, Walker and Paul 1980).
///
/// Where nothing else acts and the elements are compensated, ë + kd·ė + kp·e = 0. It is for robots whose joints all have one degree.
#[derive(Debug, Clone, PartialEq)]
pub struct ComputedTorque {
    /// kp ≥ 0 of each velocity (nv), 1/s².
    pub kp: Vec<f64>,
    /// kd ≥ 0 of each velocity (nv), 1/s.
    pub kd: Vec<f64>,
    /// Whether the forces of the elements are taken off.
    pub compensate_elements: bool,
}

impl ComputedTorque {
    /// q̈_d + kd·ė + kp·e.
    pub(super) fn accelerations(&self, at: &At, a: &mut [f64]) {
        for (k, a) in a.iter_mut().enumerate() {
            *a = at.aim.a[k] + self.kd[k] * at.derived(k) + self.kp[k] * at.weighted(k);
        }
    }
}

impl Controller for ComputedTorque {
    fn torque(&self, at: &At, scratch: &mut Scratch, tau: &mut [f64]) {
        self.accelerations(at, &mut scratch.row);
        rnea_at_into(at.model, at.kinematics, at.q, &scratch.row, &[], &mut scratch.workspace, tau);
    }

    fn slopes(&self, at: &At, scratch: &mut Scratch, slopes: &mut TorqueSlopes) {
        self.accelerations(at, &mut scratch.row);
        let Scratch { workspace, derivatives, row, .. } = scratch;
        rnea_derivatives_into(at.model, at.kinematics, row, &[], workspace, derivatives);
        let n = at.model.nv();
        for i in 0..n * n {
            slopes.d_q[i] += derivatives.d_q[i] - derivatives.d_a[i] * self.kp[i % n];
            slopes.d_v[i] += derivatives.d_v[i] - derivatives.d_a[i] * self.kd[i % n];
        }
    }

    fn compensates_elements(&self) -> bool {
        self.compensate_elements
    }

    fn follows_accelerations(&self) -> bool {
        true
    }

    fn variation(&self) -> Option<&dyn ControllerVariation> {
        Some(self)
    }
}
