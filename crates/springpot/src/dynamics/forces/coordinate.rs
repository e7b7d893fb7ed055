//! Any scalar coordinate of the configuration: forces along it, and how they answer to positions and velocities.

use crate::dynamics::kinematics::Kinematics;
use crate::dynamics::workspace::Workspace;
use crate::model::Model;
use crate::spatial::{Scalar, Vec3};

/// A scalar y of the configuration with two derivatives; several contributions to one entry add up.
pub(crate) trait Coordinate<T: Scalar> {
    /// Hands contributions to ∂y/∂q_b to `visit`, b an index of v; needs positions.
    fn slopes(&self, model: &Model, kinematics: &Kinematics<T>, visit: impl FnMut(usize, T));

    /// Hands contributions to ∂(∂y/∂q_a)/∂q_b to `visit`; `columns` is scratch, one for each degree of freedom.
    fn second_derivatives(
        &self,
        model: &Model,
        kinematics: &Kinematics<T>,
        columns: &mut [Vec3<T>],
        visit: impl FnMut(usize, usize, T),
    );
}

/// Writes ∂y/∂q to `gradient` (nv); the rate y' = Σ_b ∂y/∂q_b v_b. Needs velocities.
#[inline(always)]
pub(crate) fn gradient_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    coordinate: &impl Coordinate<T>,
    gradient: &mut [T],
) -> T {
    let gradient = &mut gradient[..model.nv()];
    let v = kinematics.joint_velocities();
    gradient.fill(T::ZERO);
    let mut rate = T::ZERO;
    coordinate.slopes(model, kinematics, |b, slope| {
        gradient[b] += slope;
        rate = slope.times_plus(v[b], rate);
    });
    rate
}

/// Writes ∂²y to `hessian` (nv × nv, row-major): entry (a, b) is ∂(∂y/∂q_a)/∂q_b. Needs positions.
#[inline(always)]
pub(crate) fn hessian_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    coordinate: &impl Coordinate<T>,
    workspace: &mut Workspace<T>,
    hessian: &mut [T],
) {
    let n = model.nv();
    hessian[..n * n].fill(T::ZERO);
    coordinate.second_derivatives(model, kinematics, &mut workspace.columns, |a, b, second| {
        hessian[a * n + b] += second;
    });
}

/// Adds F ∂y/∂q_b = −Q_b of a force F along y to `tau` (nv); needs positions.
#[inline(always)]
pub(crate) fn add_force<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    coordinate: &impl Coordinate<T>,
    force: T,
    tau: &mut [T],
) {
    coordinate.slopes(model, kinematics, |b, slope| tau[b] += force * slope);
}

/// Adds −∂Q_b/∂q_c = F ∂²y/∂q_b∂q_c + ∂_b y (∂F/∂y ∂_c y + ∂F/∂y' ∂_c y') to `d_q` and −∂Q_b/∂v_c = ∂_b y ∂F/∂y' ∂_c y to `d_v`, for
/// F, ∂F/∂y and ∂F/∂y' in `pull`; needs velocities.
///
/// y' = Σ_a ∂_a y v_a, so that ∂_c y' = Σ_a ∂²y/∂q_a∂q_c v_a.
#[inline(always)]
pub(crate) fn add_stiffness<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    coordinate: &impl Coordinate<T>,
    [force, d_coordinate, d_rate]: [T; 3],
    workspace: &mut Workspace<T>,
    [d_q, d_v]: [&mut [T]; 2],
) {
    let n = model.nv();
    let v = kinematics.joint_velocities();
    let Workspace { columns, gradient, rate_gradient, .. } = workspace;
    let (gradient, rate_gradient) = (&mut gradient[..n], &mut rate_gradient[..n]);
    gradient.fill(T::ZERO);
    rate_gradient.fill(T::ZERO);
    coordinate.slopes(model, kinematics, |b, slope| gradient[b] += slope);
    coordinate.second_derivatives(model, kinematics, columns, |b, c, second| {
        d_q[b * n + c] += force * second;
        rate_gradient[c] += second * v[b];
    });
    for (b, &row) in gradient.iter().enumerate() {
        for (c, (&column, &by_rate)) in gradient.iter().zip(&*rate_gradient).enumerate() {
            d_q[b * n + c] += row * (d_coordinate * column + d_rate * by_rate);
            d_v[b * n + c] += row * d_rate * column;
        }
    }
}
