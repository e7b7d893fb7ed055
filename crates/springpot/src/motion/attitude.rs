//! An attitude in time: roll, pitch and yaw as signals.

use crate::signal::{Jet, Signal};
use crate::spatial::{Quaternion, Rotation, Vec3};

/// A turning frame at one time, in the axes of its reference frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Attitude {
    pub(super) rotation: Rotation,
    /// The same turn, without a jump of sign where the angles have none.
    pub(super) quaternion: Quaternion,
    /// Angular velocity, rad/s.
    pub(super) omega: Vec3,
    /// Angular acceleration, rad/s².
    pub(super) alpha: Vec3,
}

impl Attitude {
    /// From roll, pitch and yaw, R = Rz(yaw) Ry(pitch) Rx(roll), at t.
    ///
    /// ω = yaw' e_z + pitch' e_y' + roll' e_x'': each axis is carried by the turns before it.
    pub(super) fn at(rpy: &[Signal; 3], t: f64) -> Self {
        let [roll, pitch, yaw]: [Jet; 3] = [0, 1, 2].map(|k| rpy[k].at(t));
        let turn = Rotation::from_rpy([0.0, 0.0, yaw.value]);
        let tilt = Rotation::from_rpy([0.0, pitch.value, yaw.value]);
        let (ez, ey, ex) = (Vec3([0.0, 0.0, 1.0]), turn * Vec3([0.0, 1.0, 0.0]), tilt * Vec3([1.0, 0.0, 0.0]));
        let carrier = ez * yaw.first;
        let tilted = carrier + ey * pitch.first;
        Self {
            rotation: Rotation::from_rpy([roll.value, pitch.value, yaw.value]),
            quaternion: Quaternion::from_rpy([roll.value, pitch.value, yaw.value]),
            omega: tilted + ex * roll.first,
            alpha: ez * yaw.second
                + ey * pitch.second
                + carrier.cross(ey) * pitch.first
                + ex * roll.second
                + tilted.cross(ex) * roll.first,
        }
    }
}
