//! Joints that move as signals say.

use super::attitude::Attitude;
use super::error::PathError;
use super::source::Source;
use super::wanted::Wanted;
use crate::model::Model;
use crate::signal::{Jet, Signal};
use crate::spatial::Vec3;

/// How one joint moves; v and a are exact derivatives.
#[derive(Debug, Clone)]
pub enum JointPath {
    /// A joint of one degree: its coordinate, rad or m.
    Coordinate(Signal),
    /// A spherical joint: roll, pitch, yaw of the body in the joint's frame, R = Rz(yaw) Ry(pitch) Rx(roll), rad.
    Attitude(Box<[Signal; 3]>),
    /// A floating joint: the pose of the body in the joint's frame.
    Pose(Box<PosePath>),
}

/// The pose of a floating joint in time.
#[derive(Debug, Clone)]
pub struct PosePath {
    /// x, y, z, m.
    pub position: [Signal; 3],
    /// Roll, pitch, yaw, R = Rz(yaw) Ry(pitch) Rx(roll), rad.
    pub rpy: [Signal; 3],
}

impl JointPath {
    pub(crate) fn signals(&self) -> Vec<&Signal> {
        match self {
            Self::Coordinate(signal) => vec![signal],
            Self::Attitude(rpy) => rpy.iter().collect(),
            Self::Pose(pose) => pose.position.iter().chain(&pose.rpy).collect(),
        }
    }
}

/// The joints that have coordinates of their own, in their order.
impl Source for Vec<JointPath> {
    fn at(
        &self,
        model: &Model,
        t: f64,
        q: &mut [f64],
        v: &mut [f64],
        a: &mut [f64],
    ) -> Result<Option<Wanted>, PathError> {
        for (j, joint) in model.own_joints().zip(self) {
            joint.at(t, &mut q[model.q_range(j)], &mut v[model.v_range(j)], &mut a[model.v_range(j)]);
        }
        Ok(None)
    }

    fn signals(&self) -> Vec<&Signal> {
        self.iter().flat_map(JointPath::signals).collect()
    }

    fn named_signals(&self, model: &Model) -> Vec<(String, &Signal)> {
        let mut named = Vec::new();
        for (j, joint) in model.own_joints().zip(self) {
            let name = format!("the motion of joint \"{}\"", model.joint_names()[j]);
            named.extend(joint.signals().into_iter().map(|signal| (name.clone(), signal)));
        }
        named
    }
}

impl JointPath {
    /// The joint's own coordinates, velocities and accelerations at t.
    pub(crate) fn at(&self, t: f64, q: &mut [f64], v: &mut [f64], a: &mut [f64]) {
        match self {
            Self::Coordinate(signal) => {
                let Jet { value, first, second } = signal.at(t);
                (q[0], v[0], a[0]) = (value, first, second);
            }
            Self::Attitude(rpy) => {
                let Attitude { rotation, quaternion, omega, alpha } = Attitude::at(rpy, t);
                q.copy_from_slice(&quaternion.0);
                v.copy_from_slice(&rotation.unrotate(omega).0);
                a.copy_from_slice(&rotation.unrotate(alpha).0);
            }
            Self::Pose(pose) => {
                let jets = [0, 1, 2].map(|k| pose.position[k].at(t));
                let Attitude { rotation, quaternion, omega, alpha } = Attitude::at(&pose.rpy, t);
                // Components in the body's axes: d(Rᵀ u)/dt = Rᵀ u̇ − Rᵀ ω × Rᵀ u.
                let linear = rotation.unrotate(Vec3(jets.map(|jet| jet.first)));
                let angular = rotation.unrotate(omega);
                let push = rotation.unrotate(Vec3(jets.map(|jet| jet.second))) - angular.cross(linear);
                q[..3].copy_from_slice(&jets.map(|jet| jet.value));
                q[3..].copy_from_slice(&quaternion.0);
                v[..3].copy_from_slice(&linear.0);
                v[3..].copy_from_slice(&angular.0);
                a[..3].copy_from_slice(&push.0);
                a[3..].copy_from_slice(&rotation.unrotate(alpha).0);
            }
        }
    }
}
