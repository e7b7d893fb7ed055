//! Damping and friction of the joints as an iteration of fixed length takes them.

use crate::model::Model;
use crate::simulate::moment::FRICTION_SPEED;

/// Adds resistance/velocity, the secants through rest, to ∂τ/∂v (nv × nv).
///
/// Where friction brings a joint to rest within a step, tangents lead to and fro across rest; secants, which are never smaller,
/// lead towards it from one side, so that an iteration cut short never makes energy.
pub(super) fn add_secants(model: &Model, v: &[f64], d_v: &mut [f64]) {
    let n = model.nv();
    for j in 0..model.joint_count() {
        let (damping, friction) = (model.damping()[j], model.friction()[j]);
        if model.joint_kind(j).nv() != 1 || (damping == 0.0 && friction == 0.0) {
            continue;
        }
        let ratio = model.followed(j).map_or(1.0, |(_, ratio, _)| ratio);
        let index = model.v_range(j).start;
        let share = ratio * v[index] / FRICTION_SPEED;
        let secant = if share == 0.0 { 1.0 } else { share.tanh() / share };
        d_v[index * n + index] += ratio * ratio * (damping + friction / FRICTION_SPEED * secant);
    }
}
