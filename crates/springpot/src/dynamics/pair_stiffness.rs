//! How the generalized force of a pair answers to positions and velocities.

use super::pair::{pair_into, second_derivatives};
use super::{Kinematics, PairForce, Workspace, joint};
use crate::model::Model;
use crate::spatial::Scalar;

/// Adds −∂Q_b/∂q_c = F ∂²l/∂q_b∂q_c + ∂_b l (∂F/∂l ∂_c l + ∂F/∂l' ∂_c l') to `d_q` and −∂Q_b/∂v_c = ∂_b l ∂F/∂l' ∂_c l to `d_v`.
///
/// l' = Σ_a ∂_a l v_a, so that ∂_c l' = Σ_a ∂²l/∂q_a∂q_c v_a.
pub(super) fn add_pair_stiffness<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    force: &PairForce<T>,
    workspace: &mut Workspace<T>,
    d_q: &mut [T],
    d_v: &mut [T],
) {
    let n = model.nv();
    let v = &kinematics.joint_velocities()[..n];
    let (from, to) = (&force.from, &force.to);
    let (gradient, rate_gradient) = (&mut workspace.gradient[..n], &mut workspace.rate_gradient[..n]);
    let pair = pair_into(model, kinematics, from, to, gradient);
    rate_gradient.fill(T::ZERO);
    second_derivatives(model, kinematics, from, to, &pair, &mut workspace.columns[..n], |b, c, second| {
        d_q[b * n + c] += force.force * second;
        rate_gradient[c] += second * v[b];
        if b != c {
            d_q[c * n + b] += force.force * second;
            rate_gradient[b] += second * v[c];
        }
    });
    let common = joint::common_link(model, from.link(), to.link());
    let between = || joint::path_to(model, from.link(), common).chain(joint::path_to(model, to.link(), common));
    for c in between() {
        let by_position = force.d_length * gradient[c] + force.d_rate * rate_gradient[c];
        let by_velocity = force.d_rate * gradient[c];
        for b in between() {
            d_q[b * n + c] += gradient[b] * by_position;
            d_v[b * n + c] += gradient[b] * by_velocity;
        }
    }
}
