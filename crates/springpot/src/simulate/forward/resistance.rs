//! Damping and friction of the joints.

use crate::model::Model;
use crate::simulate::moment::FRICTION_SPEED;

/// Joint damping and smooth Coulomb friction at the velocities `v`, added to the actuator forces.
pub(super) fn add_resistance(model: &Model, v: &[f64], tau: &mut [f64]) {
    for_each_resistance(model, v, |index, ratio, resistance, _| tau[index] += ratio * resistance);
}

/// Their derivatives by v, added to the nv × nv matrix `d_v`.
pub(super) fn add_resistance_slope(model: &Model, v: &[f64], d_v: &mut [f64]) {
    let n = model.nv();
    for_each_resistance(model, v, |index, ratio, _, slope| d_v[index * n + index] += ratio * ratio * slope);
}

/// Hands velocity index, ratio, resistance and its slope of every joint of one degree to `visit`.
fn for_each_resistance(model: &Model, v: &[f64], mut visit: impl FnMut(usize, f64, f64, f64)) {
    for j in 0..model.joint_count() {
        let (damping, friction) = (model.damping()[j], model.friction()[j]);
        if model.joint_kind(j).nv() != 1 || (damping == 0.0 && friction == 0.0) {
            continue;
        }
        let (index, ratio) = (model.v_range(j).start, model.followed(j).map_or(1.0, |(_, ratio, _)| ratio));
        let speed = ratio * v[index];
        let sign = (speed / FRICTION_SPEED).tanh();
        let slope = damping + friction * (1.0 - sign * sign) / FRICTION_SPEED;
        visit(index, ratio, damping * speed + friction * sign, slope);
    }
}
