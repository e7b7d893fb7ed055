//! How the generalized force of a pair answers to positions and velocities.

use super::pair::{line_columns, second_derivatives};
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
    let (n, degrees) = (model.nv(), model.degrees());
    let v = kinematics.joint_velocities();
    let (from, to) = (&force.from, &force.to);
    let line = kinematics.position(to) - kinematics.position(from);
    let length = line.norm();
    let direction = line * (T::ONE / length);
    let columns = &mut workspace.columns[..degrees.len()];
    let (gradient, rate_gradient) = (&mut workspace.gradient, &mut workspace.rate_gradient);
    line_columns(model, kinematics, from, to, columns);
    let common = joint::common_link(model, from.link(), to.link());
    let between = || joint::path_to(model, from.link(), common).chain(joint::path_to(model, to.link(), common));
    for k in between() {
        (gradient[k], rate_gradient[k]) = (direction.dot(columns[k]), T::ZERO);
    }
    second_derivatives(model, kinematics, from, to, length, direction, columns, |b, c, second| {
        d_q[degrees[b].index * n + degrees[c].index] += force.force * second;
        rate_gradient[c] += second * v[degrees[b].index];
    });
    for c in between() {
        let by_position = force.d_length * gradient[c] + force.d_rate * rate_gradient[c];
        let by_velocity = force.d_rate * gradient[c];
        for b in between() {
            let entry = degrees[b].index * n + degrees[c].index;
            d_q[entry] += gradient[b] * by_position;
            d_v[entry] += gradient[b] * by_velocity;
        }
    }
}
