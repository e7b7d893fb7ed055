//! Impedance control of the gripper.

use super::controller::{At, Controller, Scratch, TorqueSlopes};
use super::pd_gravity::gravity_slopes;
use super::variation::ControllerVariation;
use crate::dynamics::{gravity_into, point_jacobian_into, point_jacobian_rate_into};
use crate::spatial::Vec3;

/// τ = J_Hᵀ(kp·(H_d − H) + kd·(Ḣ_d − Ḣ)) − Q_g: the gripper H behaves as if a spring and a dashpot held it to the point H_d (Hogan 1985).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impedance {
    /// kp ≥ 0, N/m.
    pub kp: f64,
    /// kd ≥ 0, N·s/m.
    pub kd: f64,
}

impl Impedance {
    /// The force of spring and dashpot, N, in world axes.
    pub(super) fn force(&self, at: &At) -> Vec3 {
        let Some(site) = at.gripper else { return Vec3::default() };
        let [position, mut velocity] = at.aim.gripper.map(Vec3);
        if at.shaping.on_measurement {
            velocity = Vec3::default();
        }
        let (off, slip) = (position - at.kinematics.position(site), velocity - at.kinematics.velocity(site));
        off * self.kp + slip * self.kd
    }
}

impl Controller for Impedance {
    fn torque(&self, at: &At, scratch: &mut Scratch, tau: &mut [f64]) {
        gravity_into(at.model, at.kinematics, &mut scratch.workspace, tau);
        let Some(site) = at.gripper else { return };
        let [jacobian, _] = &mut scratch.jacobians;
        point_jacobian_into(at.model, at.kinematics, site, jacobian);
        for (row, force) in jacobian.chunks_exact(at.model.nv()).zip(self.force(at).0) {
            tau.iter_mut().zip(row).for_each(|(tau, column)| *tau += column * force);
        }
    }

    /// Without Σ ∂J_Hᵀ/∂q·F, which vanishes where the gripper is where it should be.
    fn slopes(&self, at: &At, scratch: &mut Scratch, slopes: &mut TorqueSlopes) {
        gravity_slopes(at, scratch, slopes);
        let (Some(site), n) = (at.gripper, at.model.nv()) else { return };
        let [jacobian, rate] = &mut scratch.jacobians;
        point_jacobian_into(at.model, at.kinematics, site, jacobian);
        point_jacobian_rate_into(at.model, at.kinematics, site, rate);
        for (row, rate) in jacobian.chunks_exact(n).zip(rate.chunks_exact(n)) {
            for b in 0..n {
                for c in 0..n {
                    // ∂(J v)/∂q is the time derivative of J, since second derivatives are symmetric.
                    slopes.d_q[b * n + c] -= row[b] * (self.kp * row[c] + self.kd * rate[c]);
                    slopes.d_v[b * n + c] -= row[b] * self.kd * row[c];
                }
            }
        }
    }

    fn variation(&self) -> Option<&dyn ControllerVariation> {
        Some(self)
    }
}
