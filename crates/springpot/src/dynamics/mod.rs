//! Rigid-body algorithms, one a file.
//!
//! The equations of motion are M(q) a + C(q, v) v + g(q) = τ + ΣQ with the mass matrix (basic metric tensor) M, the
//! Coriolis and centrifugal forces (C v)_c = Γ_ab,c v^a v^b, the gravity vector g = ∂V/∂q and the generalized forces Q of
//! the elements. All results are in SI units and world axes, all matrices row-major.
//!
//! A [`Kinematics`] holds where the links are (and how they move) and is shared by all algorithms that only read it; a
//! [`Workspace`] is scratch, one per thread, with nothing worth reading. `foo_into` writes into the caller's slice and does
//! not allocate; `foo` allocates its result and its scratch. Slices of a wrong length panic.
//!
//! Every algorithm is generic over one [`Scalar`](crate::spatial::Scalar) and never branches on its values, but the coordinates of one
//! frame in another: the rotation vector of a turn has branches.

mod aba;
mod aba_derivatives;
mod abreast;
pub mod batch;
mod body_coriolis;
mod centroidal;
mod cholesky;
mod christoffel;
mod com;
mod coriolis;
mod crba;
mod definite;
mod energy;
mod forces;
mod frame_jacobian;
mod gravity;
mod jacobian;
mod joint;
mod kinematics;
mod mass_derivative;
mod moments;
mod regressor;
mod rnea;
mod rnea_derivatives;
mod rnea_second_derivatives;
mod workspace;

pub use aba::{aba, aba_into};
pub use aba_derivatives::{AbaDerivatives, aba_derivatives, aba_derivatives_into};
pub(crate) use abreast::{Abreast, Found, Sought, Weights, weigh_measure};
pub use centroidal::{centroidal_matrix, centroidal_matrix_into, centroidal_matrix_rate, centroidal_matrix_rate_into};
pub use cholesky::{cholesky_into, cholesky_solve_into, inverse_from_cholesky_into, mass_inverse, mass_inverse_into};
pub use christoffel::{christoffel, christoffel_into};
pub use com::{com, com_jacobian, com_jacobian_into};
pub use coriolis::{coriolis, coriolis_into};
pub use crba::{crba, crba_into};
pub use definite::{indefinite_joint, indefinite_joint_into};
pub use energy::{kinetic_energy, potential_energy};
pub(crate) use forces::coordinate::{add_force, add_stiffness, gradient_into, hessian_into};
pub(crate) use forces::pair::pair_hessian_of_moving;
pub use forces::pair::{
    CoincidentAnchors, Pair, PairForce, add_generalized_force, pair, pair_hessian, pair_hessian_into, pair_into,
};
pub use forces::wrench::{add_wrench, add_wrench_derivative};
pub(crate) use forces::{CableLength, RelativeCoordinate};
pub use frame_jacobian::{
    frame_jacobian, frame_jacobian_at_into, frame_jacobian_into, frame_jacobian_rate, frame_jacobian_rate_into,
};
pub use gravity::{gravity, gravity_into};
pub use jacobian::{
    angular_jacobian, angular_jacobian_into, angular_jacobian_rate, angular_jacobian_rate_into, point_jacobian,
    point_jacobian_into, point_jacobian_rate, point_jacobian_rate_into,
};
pub use kinematics::Kinematics;
pub use mass_derivative::{mass_derivative, mass_derivative_into};
pub use regressor::{BODY_NUMBERS, body_numbers, joint_torque_regressor, joint_torque_regressor_into};
pub use rnea::{nonlinear_effects, nonlinear_effects_into, rnea, rnea_at_into, rnea_into};
pub use rnea_derivatives::{RneaDerivatives, rnea_derivatives, rnea_derivatives_into};
pub use rnea_second_derivatives::{RneaSecondDerivatives, rnea_second_derivatives};
pub use workspace::Workspace;
