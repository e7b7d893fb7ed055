//! The algorithms over many states at once.
//!
//! `foo_into` does for N rows what [`dynamics::foo_into`](super) does for one state: `q` holds N · nq numbers, row by row, `v`, `a` and `tau` N · nv,
//! and results N rows of what one state has. Rows are worked out side by side, as many as the registers of this processor hold
//! ([`SimdLevel`](crate::spatial::SimdLevel)), with products and sums joined into one rounding where it has the instruction: results are those of one
//! state to a few units of the last place, bit for bit the same for a row wherever it stands and whatever stands beside it, and may differ in
//! these last bits from level to level. At the level `baseline` they are those of one state to the bit.
//!
//! Nothing here starts threads: who has several cores cuts rows into as many pieces, and gives each thread its [`BatchWorkspace`].
//!
//! No rows are worked out as what they are, without an error; arguments that do not fit together are refused before anything is written. A row whose
//! results are not finite leaves the others as they are and is told afterwards ([`BatchError::NotFinite`]).
//!
//! ```
//! use springpot::dynamics::batch::{self, BatchWorkspace};
//! # use springpot::model::{BodySpec, JointSpec, ModelBuilder, Parent};
//! # let mut builder = ModelBuilder::new([0.0, 0.0, -9.81]);
//! # let joint = JointSpec::revolute("q1", [0.0, 1.0, 0.0], [0.0; 3]);
//! # let inertia = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]];
//! # builder.push(BodySpec { name: "arm".into(), parent: Parent::World, joint, mass: 2.0, com: [0.5, 0.0, 0.0], inertia })?;
//! # let model = builder.finish()?;
//! let mut workspace = BatchWorkspace::new(&model)?;
//! let (q, still) = ([0.0, 0.1, 0.2], [0.0; 3]);
//! let mut tau = [0.0; 3];
//! batch::rnea_into(&model, &mut workspace, &q, &still, &still, &mut tau)?;
//! assert!((tau[0] + 9.81).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod rooms;

pub use error::BatchError;
pub use rooms::BatchWorkspace;

use self::rooms::{Algorithm, Room, Shape, run};
use super::cholesky::upper_mass_inverse_into;
use super::crba::coupled_crba_into;
use super::rnea_second_derivatives::{SecondRoom, second_derivatives_into};
use super::{
    BODY_NUMBERS, RneaSecondDerivatives as AllSecondDerivatives, aba_derivatives_into as aba_derivatives_of_one,
    aba_into as aba_of_one, centroidal_matrix_into as centroidal_matrix_of_one,
    centroidal_matrix_rate_into as centroidal_matrix_rate_of_one, christoffel_into as christoffel_of_one, com,
    com_jacobian_into as com_jacobian_of_one, coriolis_into as coriolis_of_one, frame_jacobian_at_into,
    frame_jacobian_rate_into as frame_jacobian_rate_of_one, gravity_into as gravity_of_one,
    joint_torque_regressor_into as joint_torque_regressor_of_one, kinetic_energy,
    mass_derivative_into as mass_derivative_of_one, nonlinear_effects_into as nonlinear_effects_of_one,
    pair_into as pair_of_one, potential_energy, rnea_derivatives_into as rnea_derivatives_of_one,
    rnea_into as rnea_of_one,
};
use crate::model::{Frame, Model, Site};
use crate::spatial::{Scalar, Vec3};
use std::slice::from_ref;

type Done = Result<(), BatchError>;

struct Rnea;

impl Algorithm<3, 1> for Rnea {
    #[inline(always)]
    fn work<'r, T: Scalar>(&self, model: &Model, room: &'r mut Room<T>, [q, v, a]: [&[T]; 3]) -> [&'r [T]; 1] {
        rnea_of_one(model, q, v, a, &[], &mut room.workspace, &mut room.vector);
        [&room.vector]
    }
}

/// Inverse dynamics, [`dynamics::rnea_into`](super::rnea_into) without pairs: N × nv.
///
/// # Errors
/// [`BatchError`].
pub fn rnea_into(
    model: &Model,
    workspace: &mut BatchWorkspace,
    q: &[f64],
    v: &[f64],
    a: &[f64],
    tau: &mut [f64],
) -> Done {
    run(
        &Rnea,
        model,
        workspace,
        [("q", q, model.nq()), ("v", v, model.nv()), ("a", a, model.nv())],
        [("tau", tau, model.nv())],
    )
}

struct NonlinearEffects;

impl Algorithm<2, 1> for NonlinearEffects {
    #[inline(always)]
    fn work<'r, T: Scalar>(&self, model: &Model, room: &'r mut Room<T>, [q, v]: [&[T]; 2]) -> [&'r [T]; 1] {
        nonlinear_effects_of_one(model, q, v, &[], &mut room.workspace, &mut room.vector);
        [&room.vector]
    }
}

/// C(q, v) v + g(q), [`dynamics::nonlinear_effects_into`](super::nonlinear_effects_into) without pairs: N × nv.
///
/// # Errors
/// [`BatchError`].
pub fn nonlinear_effects_into(
    model: &Model,
    workspace: &mut BatchWorkspace,
    q: &[f64],
    v: &[f64],
    tau: &mut [f64],
) -> Done {
    run(&NonlinearEffects, model, workspace, [("q", q, model.nq()), ("v", v, model.nv())], [("tau", tau, model.nv())])
}

struct Aba;

impl Algorithm<3, 1> for Aba {
    #[inline(always)]
    fn work<'r, T: Scalar>(&self, model: &Model, room: &'r mut Room<T>, [q, v, tau]: [&[T]; 3]) -> [&'r [T]; 1] {
        room.kinematics.set_moving(model, q, v);
        aba_of_one(model, &room.kinematics, tau, &[], &mut room.workspace, &mut room.vector);
        [&room.vector]
    }
}

/// Forward dynamics, [`dynamics::aba_into`](super::aba_into) without pairs: N × nv.
///
/// # Errors
/// [`BatchError`].
pub fn aba_into(
    model: &Model,
    workspace: &mut BatchWorkspace,
    q: &[f64],
    v: &[f64],
    tau: &[f64],
    a: &mut [f64],
) -> Done {
    run(
        &Aba,
        model,
        workspace,
        [("q", q, model.nq()), ("v", v, model.nv()), ("tau", tau, model.nv())],
        [("a", a, model.nv())],
    )
}

struct Crba;

impl Algorithm<1, 1> for Crba {
    const SHAPE: Shape = Shape::Mass;

    #[inline(always)]
    fn work<'r, T: Scalar>(&self, model: &Model, room: &'r mut Room<T>, [q]: [&[T]; 1]) -> [&'r [T]; 1] {
        room.kinematics.place(model, q);
        coupled_crba_into(model, &room.kinematics, &mut room.workspace, &mut room.square);
        [&room.square]
    }
}

/// The mass matrix, [`dynamics::crba_into`](super::crba_into): N × nv × nv.
///
/// # Errors
/// [`BatchError`].
pub fn crba_into(model: &Model, workspace: &mut BatchWorkspace, q: &[f64], mass: &mut [f64]) -> Done {
    let n = model.nv();
    run(&Crba, model, workspace, [("q", q, model.nq())], [("mass", mass, n * n)])
}

struct MassInverse;

impl Algorithm<1, 1> for MassInverse {
    const SHAPE: Shape = Shape::Upper;

    #[inline(always)]
    fn work<'r, T: Scalar>(&self, model: &Model, room: &'r mut Room<T>, [q]: [&[T]; 1]) -> [&'r [T]; 1] {
        let Room { kinematics, workspace, forward_slopes, square, .. } = room;
        kinematics.place(model, q);
        upper_mass_inverse_into(model, kinematics, workspace, &mut forward_slopes.d_tau, square);
        [square]
    }
}

/// M⁻¹, [`dynamics::mass_inverse_into`](super::mass_inverse_into): N × nv × nv.
///
/// # Errors
/// [`BatchError`].
pub fn mass_inverse_into(model: &Model, workspace: &mut BatchWorkspace, q: &[f64], inverse: &mut [f64]) -> Done {
    let n = model.nv();
    run(&MassInverse, model, workspace, [("q", q, model.nq())], [("inverse", inverse, n * n)])
}

struct Coriolis;

impl Algorithm<2, 1> for Coriolis {
    #[inline(always)]
    fn work<'r, T: Scalar>(&self, model: &Model, room: &'r mut Room<T>, [q, v]: [&[T]; 2]) -> [&'r [T]; 1] {
        room.kinematics.set_moving(model, q, v);
        coriolis_of_one(model, &room.kinematics, &mut room.workspace, &mut room.square);
        [&room.square]
    }
}

/// The Coriolis matrix, [`dynamics::coriolis_into`](super::coriolis_into): N × nv × nv.
///
/// # Errors
/// [`BatchError`].
pub fn coriolis_into(
    model: &Model,
    workspace: &mut BatchWorkspace,
    q: &[f64],
    v: &[f64],
    coriolis: &mut [f64],
) -> Done {
    let n = model.nv();
    run(&Coriolis, model, workspace, [("q", q, model.nq()), ("v", v, model.nv())], [("coriolis", coriolis, n * n)])
}

struct Gravity;

impl Algorithm<1, 1> for Gravity {
    #[inline(always)]
    fn work<'r, T: Scalar>(&self, model: &Model, room: &'r mut Room<T>, [q]: [&[T]; 1]) -> [&'r [T]; 1] {
        room.kinematics.place(model, q);
        gravity_of_one(model, &room.kinematics, &mut room.workspace, &mut room.vector);
        [&room.vector]
    }
}

/// The gravity vector, [`dynamics::gravity_into`](super::gravity_into): N × nv.
///
/// # Errors
/// [`BatchError`].
pub fn gravity_into(model: &Model, workspace: &mut BatchWorkspace, q: &[f64], forces: &mut [f64]) -> Done {
    run(&Gravity, model, workspace, [("q", q, model.nq())], [("forces", forces, model.nv())])
}

struct Christoffel;

impl Algorithm<1, 1> for Christoffel {
    #[inline(always)]
    fn work<'r, T: Scalar>(&self, model: &Model, room: &'r mut Room<T>, [q]: [&[T]; 1]) -> [&'r [T]; 1] {
        let n = model.nv();
        room.cube.resize(n * n * n, T::ZERO);
        room.kinematics.place(model, q);
        christoffel_of_one(model, &room.kinematics, &mut room.workspace, &mut room.cube);
        [&room.cube]
    }
}

/// Christoffel symbols, [`dynamics::christoffel_into`](super::christoffel_into): N × nv × nv × nv.
///
/// # Panics
/// Unless all joints have one degree of freedom, as for one state.
///
/// # Errors
/// [`BatchError`].
pub fn christoffel_into(model: &Model, workspace: &mut BatchWorkspace, q: &[f64], gamma: &mut [f64]) -> Done {
    let n = model.nv();
    run(&Christoffel, model, workspace, [("q", q, model.nq())], [("gamma", gamma, n * n * n)])
}

struct RneaDerivatives;

impl Algorithm<3, 2> for RneaDerivatives {
    #[inline(always)]
    fn work<'r, T: Scalar>(&self, model: &Model, room: &'r mut Room<T>, [q, v, a]: [&[T]; 3]) -> [&'r [T]; 2] {
        let Room { kinematics, workspace, inverse_slopes, .. } = room;
        kinematics.set_moving(model, q, v);
        rnea_derivatives_of_one(model, kinematics, a, &[], workspace, inverse_slopes);
        [&inverse_slopes.d_q, &inverse_slopes.d_v]
    }
}

/// ∂τ/∂q and ∂τ/∂v, [`dynamics::rnea_derivatives_into`](super::rnea_derivatives_into) without pairs: N × nv × nv each.
///
/// # Errors
/// [`BatchError`].
pub fn rnea_derivatives_into(
    model: &Model,
    workspace: &mut BatchWorkspace,
    q: &[f64],
    v: &[f64],
    a: &[f64],
    d_q: &mut [f64],
    d_v: &mut [f64],
) -> Done {
    let n = model.nv();
    run(
        &RneaDerivatives,
        model,
        workspace,
        [("q", q, model.nq()), ("v", v, model.nv()), ("a", a, model.nv())],
        [("d_q", d_q, n * n), ("d_v", d_v, n * n)],
    )
}

struct AbaDerivatives;

impl Algorithm<3, 2> for AbaDerivatives {
    #[inline(always)]
    fn work<'r, T: Scalar>(&self, model: &Model, room: &'r mut Room<T>, [q, v, tau]: [&[T]; 3]) -> [&'r [T]; 2] {
        let Room { kinematics, workspace, forward_slopes, .. } = room;
        kinematics.set_moving(model, q, v);
        aba_derivatives_of_one(model, kinematics, tau, &[], workspace, forward_slopes);
        [&forward_slopes.d_q, &forward_slopes.d_v]
    }
}

/// ∂a/∂q and ∂a/∂v, [`dynamics::aba_derivatives_into`](super::aba_derivatives_into) without pairs: N × nv × nv each.
///
/// # Errors
/// [`BatchError`].
pub fn aba_derivatives_into(
    model: &Model,
    workspace: &mut BatchWorkspace,
    q: &[f64],
    v: &[f64],
    tau: &[f64],
    d_q: &mut [f64],
    d_v: &mut [f64],
) -> Done {
    let n = model.nv();
    run(
        &AbaDerivatives,
        model,
        workspace,
        [("q", q, model.nq()), ("v", v, model.nv()), ("tau", tau, model.nv())],
        [("d_q", d_q, n * n), ("d_v", d_v, n * n)],
    )
}

struct Com;

impl Algorithm<1, 1> for Com {
    #[inline(always)]
    fn work<'r, T: Scalar>(&self, model: &Model, room: &'r mut Room<T>, [q]: [&[T]; 1]) -> [&'r [T]; 1] {
        room.kinematics.place(model, q);
        let Vec3(centre) = com(model, &room.kinematics);
        room.vector[..3].copy_from_slice(&centre);
        [&room.vector]
    }
}

/// The centre of mass, [`dynamics::com`](super::com()): N × 3.
///
/// # Errors
/// [`BatchError`].
pub fn com_into(model: &Model, workspace: &mut BatchWorkspace, q: &[f64], centre: &mut [f64]) -> Done {
    run(&Com, model, workspace, [("q", q, model.nq())], [("centre", centre, 3)])
}

struct ComJacobian;

impl Algorithm<1, 1> for ComJacobian {
    #[inline(always)]
    fn work<'r, T: Scalar>(&self, model: &Model, room: &'r mut Room<T>, [q]: [&[T]; 1]) -> [&'r [T]; 1] {
        let jacobian = &mut room.matrix[..3 * model.nv()];
        room.kinematics.place(model, q);
        com_jacobian_of_one(model, &room.kinematics, &mut room.workspace, jacobian);
        [jacobian]
    }
}

/// Its Jacobian, [`dynamics::com_jacobian_into`](super::com_jacobian_into): N × 3 × nv.
///
/// # Errors
/// [`BatchError`].
pub fn com_jacobian_into(model: &Model, workspace: &mut BatchWorkspace, q: &[f64], jacobian: &mut [f64]) -> Done {
    let n = model.nv();
    run(&ComJacobian, model, workspace, [("q", q, model.nq())], [("jacobian", jacobian, 3 * n)])
}

struct CentroidalMatrix;

impl Algorithm<1, 1> for CentroidalMatrix {
    #[inline(always)]
    fn work<'r, T: Scalar>(&self, model: &Model, room: &'r mut Room<T>, [q]: [&[T]; 1]) -> [&'r [T]; 1] {
        room.kinematics.place(model, q);
        centroidal_matrix_of_one(model, &room.kinematics, &mut room.workspace, &mut room.matrix);
        [&room.matrix]
    }
}

/// The centroidal momentum matrix, [`dynamics::centroidal_matrix_into`](super::centroidal_matrix_into): N × 6 × nv.
///
/// # Errors
/// [`BatchError`].
pub fn centroidal_matrix_into(model: &Model, workspace: &mut BatchWorkspace, q: &[f64], matrix: &mut [f64]) -> Done {
    let n = model.nv();
    run(&CentroidalMatrix, model, workspace, [("q", q, model.nq())], [("matrix", matrix, 6 * n)])
}

struct CentroidalMatrixRate;

impl Algorithm<2, 1> for CentroidalMatrixRate {
    #[inline(always)]
    fn work<'r, T: Scalar>(&self, model: &Model, room: &'r mut Room<T>, [q, v]: [&[T]; 2]) -> [&'r [T]; 1] {
        room.kinematics.set_moving(model, q, v);
        centroidal_matrix_rate_of_one(model, &room.kinematics, &mut room.workspace, &mut room.matrix);
        [&room.matrix]
    }
}

/// Its time derivative, [`dynamics::centroidal_matrix_rate_into`](super::centroidal_matrix_rate_into): N × 6 × nv.
///
/// # Errors
/// [`BatchError`].
pub fn centroidal_matrix_rate_into(
    model: &Model,
    workspace: &mut BatchWorkspace,
    q: &[f64],
    v: &[f64],
    rate: &mut [f64],
) -> Done {
    let n = model.nv();
    let inputs = [("q", q, model.nq()), ("v", v, model.nv())];
    run(&CentroidalMatrixRate, model, workspace, inputs, [("rate", rate, 6 * n)])
}

struct JointTorqueRegressor;

impl Algorithm<3, 1> for JointTorqueRegressor {
    #[inline(always)]
    fn work<'r, T: Scalar>(&self, model: &Model, room: &'r mut Room<T>, [q, v, a]: [&[T]; 3]) -> [&'r [T]; 1] {
        let Room { kinematics, workspace, cube, .. } = room;
        cube.resize(model.nv() * BODY_NUMBERS * model.frames().len(), T::ZERO);
        kinematics.set_moving(model, q, v);
        joint_torque_regressor_of_one(model, kinematics, a, workspace, cube);
        [cube]
    }
}

/// The joint torque regressor, [`dynamics::joint_torque_regressor_into`](super::joint_torque_regressor_into): N × nv × 10·bodies.
///
/// # Errors
/// [`BatchError`].
pub fn joint_torque_regressor_into(
    model: &Model,
    workspace: &mut BatchWorkspace,
    q: &[f64],
    v: &[f64],
    a: &[f64],
    regressor: &mut [f64],
) -> Done {
    let width = model.nv() * BODY_NUMBERS * model.frames().len();
    run(
        &JointTorqueRegressor,
        model,
        workspace,
        [("q", q, model.nq()), ("v", v, model.nv()), ("a", a, model.nv())],
        [("regressor", regressor, width)],
    )
}

struct MassDerivative;

impl Algorithm<1, 1> for MassDerivative {
    #[inline(always)]
    fn work<'r, T: Scalar>(&self, model: &Model, room: &'r mut Room<T>, [q]: [&[T]; 1]) -> [&'r [T]; 1] {
        let n = model.nv();
        room.cube.resize(n * n * n, T::ZERO);
        room.kinematics.place(model, q);
        mass_derivative_of_one(model, &room.kinematics, &mut room.workspace, &mut room.cube);
        [&room.cube]
    }
}

/// ∂M/∂q, [`dynamics::mass_derivative_into`](super::mass_derivative_into): N × nv × nv × nv.
///
/// # Errors
/// [`BatchError`].
pub fn mass_derivative_into(model: &Model, workspace: &mut BatchWorkspace, q: &[f64], derivative: &mut [f64]) -> Done {
    let n = model.nv();
    run(&MassDerivative, model, workspace, [("q", q, model.nq())], [("derivative", derivative, n * n * n)])
}

struct RneaSecondDerivatives;

impl Algorithm<3, 4> for RneaSecondDerivatives {
    #[inline(always)]
    fn work<'r, T: Scalar>(&self, model: &Model, room: &'r mut Room<T>, inputs: [&[T]; 3]) -> [&'r [T]; 4] {
        if room.second.is_none() {
            room.second = Some(Box::new((SecondRoom::new(model), AllSecondDerivatives::new(model))));
        }
        let (scratch, derivatives) = &mut **room.second.as_mut().expect("it was made");
        second_derivatives_into(model, inputs, scratch, derivatives);
        let AllSecondDerivatives { d_q_q, d_v_q, d_v_v, d_a_q } = derivatives;
        [d_q_q, d_v_q, d_v_v, d_a_q]
    }
}

/// Second derivatives of the inverse dynamics, [`dynamics::rnea_second_derivatives`](super::rnea_second_derivatives()): by q and q, v and q, v and v, a and
/// q, N × nv × nv × nv each.
///
/// # Errors
/// [`BatchError`].
pub fn rnea_second_derivatives_into(
    model: &Model,
    workspace: &mut BatchWorkspace,
    [q, v, a]: [&[f64]; 3],
    [d_q_q, d_v_q, d_v_v, d_a_q]: [&mut [f64]; 4],
) -> Done {
    let n = model.nv().pow(3);
    run(
        &RneaSecondDerivatives,
        model,
        workspace,
        [("q", q, model.nq()), ("v", v, model.nv()), ("a", a, model.nv())],
        [("d_q_q", d_q_q, n), ("d_v_q", d_v_q, n), ("d_v_v", d_v_v, n), ("d_a_q", d_a_q, n)],
    )
}

struct KineticEnergy;

impl Algorithm<2, 1> for KineticEnergy {
    #[inline(always)]
    fn work<'r, T: Scalar>(&self, model: &Model, room: &'r mut Room<T>, [q, v]: [&[T]; 2]) -> [&'r [T]; 1] {
        room.kinematics.set_moving(model, q, v);
        room.scalar = [kinetic_energy(model, &room.kinematics)];
        [&room.scalar]
    }
}

/// Kinetic energies, [`dynamics::kinetic_energy`](super::kinetic_energy): N.
///
/// # Errors
/// [`BatchError`].
pub fn kinetic_energy_into(
    model: &Model,
    workspace: &mut BatchWorkspace,
    q: &[f64],
    v: &[f64],
    energy: &mut [f64],
) -> Done {
    run(&KineticEnergy, model, workspace, [("q", q, model.nq()), ("v", v, model.nv())], [("energy", energy, 1)])
}

struct PotentialEnergy;

impl Algorithm<1, 1> for PotentialEnergy {
    #[inline(always)]
    fn work<'r, T: Scalar>(&self, model: &Model, room: &'r mut Room<T>, [q]: [&[T]; 1]) -> [&'r [T]; 1] {
        room.kinematics.place(model, q);
        room.scalar = [potential_energy(model, &room.kinematics)];
        [&room.scalar]
    }
}

/// Potential energies, [`dynamics::potential_energy`](super::potential_energy): N.
///
/// # Errors
/// [`BatchError`].
pub fn potential_energy_into(model: &Model, workspace: &mut BatchWorkspace, q: &[f64], energy: &mut [f64]) -> Done {
    run(&PotentialEnergy, model, workspace, [("q", q, model.nq())], [("energy", energy, 1)])
}

struct FrameJacobian<'a> {
    frame: &'a Frame,
}

impl Algorithm<1, 1> for FrameJacobian<'_> {
    #[inline(always)]
    fn work<'r, T: Scalar>(&self, model: &Model, room: &'r mut Room<T>, [q]: [&[T]; 1]) -> [&'r [T]; 1] {
        let jacobian = &mut room.matrix[..6 * model.nv()];
        frame_jacobian_at_into(model, q, self.frame, &mut room.workspace, jacobian);
        [jacobian]
    }
}

/// The Jacobian of a frame, [`dynamics::frame_jacobian_into`](super::frame_jacobian_into): N × 6 × nv.
///
/// # Errors
/// [`BatchError`].
pub fn frame_jacobian_into(
    model: &Model,
    workspace: &mut BatchWorkspace,
    frame: &Frame,
    q: &[f64],
    jacobian: &mut [f64],
) -> Done {
    let n = model.nv();
    run(&FrameJacobian { frame }, model, workspace, [("q", q, model.nq())], [("jacobian", jacobian, 6 * n)])
}

struct FrameJacobianRate<'a> {
    frame: &'a Frame,
}

impl Algorithm<2, 1> for FrameJacobianRate<'_> {
    #[inline(always)]
    fn work<'r, T: Scalar>(&self, model: &Model, room: &'r mut Room<T>, [q, v]: [&[T]; 2]) -> [&'r [T]; 1] {
        let rate = &mut room.matrix[..6 * model.nv()];
        room.kinematics.set_moving(model, q, v);
        frame_jacobian_rate_of_one(model, &room.kinematics, self.frame, rate);
        [rate]
    }
}

/// Its time derivative, [`dynamics::frame_jacobian_rate_into`](super::frame_jacobian_rate_into): N × 6 × nv.
///
/// # Errors
/// [`BatchError`].
pub fn frame_jacobian_rate_into(
    model: &Model,
    workspace: &mut BatchWorkspace,
    frame: &Frame,
    q: &[f64],
    v: &[f64],
    rate: &mut [f64],
) -> Done {
    let n = model.nv();
    run(
        &FrameJacobianRate { frame },
        model,
        workspace,
        [("q", q, model.nq()), ("v", v, model.nv())],
        [("rate", rate, 6 * n)],
    )
}

struct Placements<'a> {
    frame: &'a Frame,
}

impl Algorithm<1, 2> for Placements<'_> {
    #[inline(always)]
    fn work<'r, T: Scalar>(&self, model: &Model, room: &'r mut Room<T>, [q]: [&[T]; 1]) -> [&'r [T]; 2] {
        let (kinematics, matrix, vector) = (&mut room.kinematics, &mut room.more[..9], &mut room.vector);
        kinematics.place(model, q);
        let placement = kinematics.frame(self.frame);
        matrix.copy_from_slice(placement.rotation.0.as_flattened());
        vector[..3].copy_from_slice(&placement.translation.0);
        [matrix, vector]
    }
}

/// Where a frame is: its rotation, N × 3 × 3 row by row, and its origin, N × 3, m.
///
/// # Errors
/// [`BatchError`].
pub fn frame_placement_into(
    model: &Model,
    workspace: &mut BatchWorkspace,
    frame: &Frame,
    q: &[f64],
    rotation: &mut [f64],
    position: &mut [f64],
) -> Done {
    run(
        &Placements { frame },
        model,
        workspace,
        [("q", q, model.nq())],
        [("rotation", rotation, 9), ("position", position, 3)],
    )
}

struct Pairs<'a> {
    ends: [&'a Site; 2],
}

impl Algorithm<2, 3> for Pairs<'_> {
    #[inline(always)]
    fn work<'r, T: Scalar>(&self, model: &Model, room: &'r mut Room<T>, [q, v]: [&[T]; 2]) -> [&'r [T]; 3] {
        let Room { kinematics, vector, more, .. } = room;
        kinematics.set_moving(model, q, v);
        let [from, to] = self.ends;
        let pair = pair_of_one(model, kinematics, from, to, vector);
        (more[0], more[1]) = (pair.length, pair.rate);
        [from_ref(&more[0]), from_ref(&more[1]), vector]
    }
}

/// The distance of two points, N, its rate, N, and its gradient ∂l/∂q, N × nv: [`dynamics::pair_into`](super::pair_into).
///
/// # Errors
/// [`BatchError`].
pub fn pair_into(
    model: &Model,
    workspace: &mut BatchWorkspace,
    ends: [&Site; 2],
    q: &[f64],
    v: &[f64],
    [length, rate, gradient]: [&mut [f64]; 3],
) -> Done {
    run(
        &Pairs { ends },
        model,
        workspace,
        [("q", q, model.nq()), ("v", v, model.nv())],
        [("length", length, 1), ("rate", rate, 1), ("gradient", gradient, model.nv())],
    )
}
