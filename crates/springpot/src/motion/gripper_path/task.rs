//! What a gripper path asks of the robot at one time: residual, Jacobian and their rates.

use crate::dynamics::{
    Kinematics, angular_jacobian_into, angular_jacobian_rate_into, point_jacobian_into, point_jacobian_rate_into,
};
use crate::model::{Frame, Model, Site};
use crate::motion::attitude::Attitude;
use crate::signal::Signal;
use crate::spatial::{Rotation, Vec3};

/// Most conditions of a task.
pub(super) const CONDITIONS: usize = 6;

/// A path of the gripper: its position and, if wanted, its orientation as signals of time.
#[derive(Debug, Clone)]
pub struct Task {
    /// The gripper point.
    pub site: Site,
    /// The gripper's body, whose axes the orientation speaks of.
    pub frame: Frame,
    /// World x, y, z, m.
    pub position: [Signal; 3],
    /// Roll, pitch, yaw of the body, R = Rz(yaw) Ry(pitch) Rx(roll), rad.
    pub rpy: Option<[Signal; 3]>,
}

/// Wanted motion: position and its derivatives; rotation, angular velocity and acceleration (world axes).
#[derive(Debug, Clone, Copy)]
pub(super) struct Target {
    pub(super) position: Vec3,
    rotation: Option<Rotation>,
    /// First derivative of the task (linear first); 0 beyond its size.
    pub(super) rate: [f64; CONDITIONS],
    /// Second derivative.
    pub(super) acceleration: [f64; CONDITIONS],
}

/// Residual of a task in one configuration.
#[derive(Debug, Clone, Copy)]
pub(super) struct Residual {
    /// Wanted less actual: linear (m), then a rotation vector (rad); 0 beyond the task's size.
    pub(super) error: [f64; CONDITIONS],
    /// Distance to the wanted point, m.
    pub(super) distance: f64,
    /// Angle to the wanted orientation, rad; 0 where none is wanted.
    pub(super) angle: f64,
}

impl Target {
    /// The derivative of the position, m/s.
    pub(super) fn velocity(&self) -> [f64; 3] {
        [self.rate[0], self.rate[1], self.rate[2]]
    }
}

impl Task {
    /// Number of task coordinates.
    pub(super) fn size(&self) -> usize {
        if self.rpy.is_some() { 6 } else { 3 }
    }

    pub(super) fn target(&self, t: f64) -> Target {
        let [x, y, z] = [0, 1, 2].map(|k| self.position[k].at(t));
        let mut target = Target {
            position: Vec3([x.value, y.value, z.value]),
            rotation: None,
            rate: [x.first, y.first, z.first, 0.0, 0.0, 0.0],
            acceleration: [x.second, y.second, z.second, 0.0, 0.0, 0.0],
        };
        if let Some(rpy) = &self.rpy {
            let Attitude { rotation, omega, alpha, .. } = Attitude::at(rpy, t);
            target.rotation = Some(rotation);
            target.rate[3..].copy_from_slice(&omega.0);
            target.acceleration[3..].copy_from_slice(&alpha.0);
        }
        target
    }

    pub(super) fn residual(&self, kinematics: &Kinematics, target: &Target) -> Residual {
        let miss = target.position - kinematics.position(&self.site);
        let mut residual = Residual { error: [0.0; CONDITIONS], distance: miss.norm(), angle: 0.0 };
        residual.error[..3].copy_from_slice(&miss.0);
        if let Some(wanted) = &target.rotation {
            let turn = (*wanted * kinematics.frame(&self.frame).rotation.transpose()).rotation_vector();
            residual.angle = turn.norm();
            residual.error[3..].copy_from_slice(&turn.0);
        }
        residual
    }

    /// The task Jacobian, `size` × nv, row-major.
    pub(super) fn jacobian_into(&self, model: &Model, kinematics: &Kinematics, jacobian: &mut [f64]) {
        let (linear, angular) = jacobian.split_at_mut(3 * model.nv());
        point_jacobian_into(model, kinematics, &self.site, linear);
        if self.rpy.is_some() {
            angular_jacobian_into(model, kinematics, &self.site, angular);
        }
    }

    /// Its time derivative; needs velocities.
    pub(super) fn jacobian_rate_into(&self, model: &Model, kinematics: &Kinematics, rate: &mut [f64]) {
        let (linear, angular) = rate.split_at_mut(3 * model.nv());
        point_jacobian_rate_into(model, kinematics, &self.site, linear);
        if self.rpy.is_some() {
            angular_jacobian_rate_into(model, kinematics, &self.site, angular);
        }
    }

    pub(super) fn signals(&self) -> impl Iterator<Item = &Signal> {
        self.position.iter().chain(self.rpy.iter().flatten())
    }
}
