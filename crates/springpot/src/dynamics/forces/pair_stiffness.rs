//! How the generalized force of a pair answers to positions and velocities.

use super::line::Line;
use super::pair::PairForce;
use crate::dynamics::kinematics::Kinematics;
use crate::dynamics::workspace::Workspace;
use crate::model::Model;
use crate::spatial::Scalar;

/// Adds −∂Q_b/∂q_c = F ∂²l/∂q_b∂q_c + ∂_b l (∂F/∂l ∂_c l + ∂F/∂l' ∂_c l') to `d_q` and −∂Q_b/∂v_c = ∂_b l ∂F/∂l' ∂_c l to `d_v`.
///
/// l' = Σ_a ∂_a l v_a, so that ∂_c l' = Σ_a ∂²l/∂q_a∂q_c v_a.
#[inline(always)]
pub(in crate::dynamics) fn add_pair_stiffness<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    force: &PairForce<T>,
    workspace: &mut Workspace<T>,
    d_q: &mut [T],
    d_v: &mut [T],
) {
    let (n, degrees) = (model.nv(), model.degrees());
    let v = kinematics.joint_velocities();
    let line = Line::new(model, kinematics, &force.from, &force.to);
    let Workspace { columns, gradient, rate_gradient, .. } = workspace;
    line.fill_columns(model, kinematics, columns);
    for k in line.degrees(model) {
        (gradient[k], rate_gradient[k]) = (line.direction.dot(columns[k]), T::ZERO);
    }
    line.second_derivatives(
        model,
        kinematics,
        columns,
        |_, _| true,
        |b, c, second| {
            d_q[degrees[b].index * n + degrees[c].index] += force.force * second;
            rate_gradient[c] += second * v[degrees[b].index];
        },
    );
    for c in line.degrees(model) {
        let by_position = force.d_length * gradient[c] + force.d_rate * rate_gradient[c];
        let by_velocity = force.d_rate * gradient[c];
        for b in line.degrees(model) {
            let entry = degrees[b].index * n + degrees[c].index;
            d_q[entry] += gradient[b] * by_position;
            d_v[entry] += gradient[b] * by_velocity;
        }
    }
}
