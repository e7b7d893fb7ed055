//! Damping and friction of the joints: d·v + f·tanh(v/[`FRICTION_SPEED`]) on the side of the actuators, in joints of one degree.

use crate::model::Model;

/// Speed at which Coulomb friction has reached 76 % of its value, rad/s or m/s: the width of the smooth sign.
pub const FRICTION_SPEED: f64 = 1e-3;

/// A joint that resists.
struct Resisting {
    /// Its velocity is ratio · v\[index\].
    index: usize,
    ratio: f64,
    speed: f64,
    damping: f64,
    friction: f64,
}

fn resisting<'a>(model: &'a Model, v: &'a [f64]) -> impl Iterator<Item = Resisting> + 'a {
    (0..model.joint_count()).filter_map(move |j| {
        let (damping, friction) = (model.damping()[j], model.friction()[j]);
        if model.joint_kind(j).nv() != 1 || (damping == 0.0 && friction == 0.0) {
            return None;
        }
        let (index, ratio) = (model.v_range(j).start, model.followed(j).map_or(1.0, |(_, ratio, _)| ratio));
        Some(Resisting { index, ratio, speed: ratio * v[index], damping, friction })
    })
}

/// Adds what the joints ask of the actuators at the velocities `v` (nv) to `tau` (nv); returns the power that they take, W.
pub(super) fn add_resistance(model: &Model, v: &[f64], tau: &mut [f64]) -> f64 {
    let mut power = 0.0;
    for Resisting { index, ratio, speed, damping, friction } in resisting(model, v) {
        let resistance = damping * speed + friction * (speed / FRICTION_SPEED).tanh();
        tau[index] += ratio * resistance;
        power += resistance * speed;
    }
    power
}

/// Adds the derivatives of the resistance by v to ∂τ/∂v (nv × nv).
pub(super) fn add_tangents(model: &Model, v: &[f64], d_v: &mut [f64]) {
    let n = model.nv();
    for Resisting { index, ratio, speed, damping, friction } in resisting(model, v) {
        let sign = (speed / FRICTION_SPEED).tanh();
        let slope = damping + friction * (1.0 - sign * sign) / FRICTION_SPEED;
        d_v[index * n + index] += ratio * ratio * slope;
    }
}

/// Adds resistance/velocity, the secants through rest, to ∂τ/∂v (nv × nv): for an iteration of fixed length.
///
/// Where friction brings a joint to rest within a step, tangents lead to and fro across rest; secants, which are never smaller,
/// lead towards it from one side, so that an iteration cut short never makes energy.
pub(super) fn add_secants(model: &Model, v: &[f64], d_v: &mut [f64]) {
    let n = model.nv();
    for Resisting { index, ratio, speed, damping, friction } in resisting(model, v) {
        let share = speed / FRICTION_SPEED;
        let secant = if share == 0.0 { 1.0 } else { share.tanh() / share };
        d_v[index * n + index] += ratio * ratio * (damping + friction / FRICTION_SPEED * secant);
    }
}
