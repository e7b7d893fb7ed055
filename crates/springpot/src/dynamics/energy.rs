//! Kinetic and potential energy.

use super::kinematics::Kinematics;
use crate::model::Model;
use crate::spatial::{Inertia, Motion, Scalar, Vec3};

/// Kinetic energy T = ½ vᵀ M v, J, that of rotors included; needs velocities. Does not allocate.
#[inline(always)]
pub fn kinetic_energy<T: Scalar>(model: &Model, kinematics: &Kinematics<T>) -> T {
    let mut twice = T::ZERO;
    for j in 0..model.joint_count() {
        let rotation = &kinematics.link(j + 1).rotation;
        let Motion { angular, linear } = kinematics.link_velocity(j + 1);
        let velocity = Motion { angular: rotation.unrotate(angular), linear: rotation.unrotate(linear) };
        twice += velocity.dot(Inertia::from_f64(model.link_inertia(j)) * velocity);
    }
    for (&v, &rotor) in kinematics.joint_velocities().iter().zip(model.felt_rotors()) {
        twice += v * v * T::from_f64(rotor);
    }
    twice * T::from_f64(0.5)
}

/// Potential energy of gravity V = −Σ_i m_i g·r_Ci, J, zero at the world's origin; needs positions. Does not allocate.
///
/// Bodies fixed to the world add a constant, which is left out.
#[inline(always)]
pub fn potential_energy<T: Scalar>(model: &Model, kinematics: &Kinematics<T>) -> T {
    let mut first = Vec3::ZERO;
    for j in 0..model.joint_count() {
        let (link, inertia) = (kinematics.link(j + 1), Inertia::<T>::from_f64(model.link_inertia(j)));
        first += link.translation.times_plus(inertia.mass, link.rotation * inertia.first_moment);
    }
    -first.dot(Vec3::from_f64(model.gravity().into()))
}
