//! Derivatives of the forward dynamics.

use super::aba::aba_into;
use super::cholesky::{cholesky_into, inverse_from_cholesky_into, solve_matrix};
use super::forces::pair::PairForce;
use super::kinematics::Kinematics;
use super::rnea_derivatives::{RneaDerivatives, rnea_derivatives_into};
use super::workspace::Workspace;
use crate::model::Model;
use crate::spatial::Scalar;

/// Accelerations a = ABA(q, v, τ) and their derivatives, each nv × nv, row-major: row b belongs to a_b, column c to the variable
/// with index c.
#[derive(Debug, Clone, PartialEq)]
pub struct AbaDerivatives<T = f64> {
    /// a (nv), rad/s² or m/s².
    pub a: Vec<T>,
    /// ∂a/∂q.
    pub d_q: Vec<T>,
    /// ∂a/∂v.
    pub d_v: Vec<T>,
    /// ∂a/∂τ, the inverse of the mass matrix (symmetric).
    pub d_tau: Vec<T>,
    inverse_dynamics: RneaDerivatives<T>,
}

impl<T: Scalar> AbaDerivatives<T> {
    /// Room for the derivatives of `model`.
    pub fn new(model: &Model) -> Self {
        let zero = || vec![T::ZERO; model.nv() * model.nv()];
        Self {
            a: vec![T::ZERO; model.nv()],
            d_q: zero(),
            d_v: zero(),
            d_tau: zero(),
            inverse_dynamics: RneaDerivatives::new(model),
        }
    }
}

/// The forward dynamics [`aba_into`] with ∂a/∂q, ∂a/∂v and ∂a/∂τ, the derivatives of the pair forces included.
///
/// `tau` (nv); needs velocities; all entries of `derivatives` are written. Differentiating RNEA(q, v, ABA(q, v, τ)) = τ gives
/// ∂a/∂q = −M⁻¹ ∂RNEA/∂q and ∂a/∂v = −M⁻¹ ∂RNEA/∂v at that a, and ∂a/∂τ = M⁻¹; M is factorised along the tree. NaN where M
/// is singular or a pair has length 0. Source: Carpentier and Mansard, Analytical derivatives of rigid body dynamics
/// algorithms, RSS 2018.
#[inline(always)]
pub fn aba_derivatives_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    tau: &[T],
    pairs: &[PairForce<T>],
    workspace: &mut Workspace<T>,
    derivatives: &mut AbaDerivatives<T>,
) {
    let AbaDerivatives { a, d_q, d_v, d_tau, inverse_dynamics } = derivatives;
    aba_into(model, kinematics, tau, pairs, workspace, a);
    rnea_derivatives_into(model, kinematics, a, pairs, workspace, inverse_dynamics);
    let factor = &mut inverse_dynamics.d_a[..];
    cholesky_into(model, factor);
    inverse_from_cholesky_into(model, factor, d_tau);
    for (solution, slope) in [(d_q, &inverse_dynamics.d_q), (d_v, &inverse_dynamics.d_v)] {
        for (x, &y) in solution.iter_mut().zip(slope) {
            *x = -y;
        }
        solve_matrix(model, factor, solution);
    }
}

/// [`aba_derivatives_into`] at `q` (nq), `v`, `tau` (nv), allocating.
pub fn aba_derivatives<T: Scalar>(
    model: &Model,
    q: &[T],
    v: &[T],
    tau: &[T],
    pairs: &[PairForce<T>],
) -> AbaDerivatives<T> {
    let mut derivatives = AbaDerivatives::new(model);
    let kinematics = Kinematics::at_velocity(model, q, v);
    aba_derivatives_into(model, &kinematics, tau, pairs, &mut Workspace::new(model), &mut derivatives);
    derivatives
}
