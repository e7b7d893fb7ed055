//! Whether the mass matrix is positive definite.

use super::cholesky::cholesky_into;
use super::crba::lower_crba_into;
use super::kinematics::Kinematics;
use super::workspace::Workspace;
use crate::model::Model;

/// The joint, from the tips inwards, at which the mass matrix M(q) is not positive definite; needs positions.
///
/// Where every link has an inertia that a body can have, M is at worst singular; with accepted ones
/// ([`Model::may_be_indefinite`]) a joint may have a negative inertia in some configurations, and what forward dynamics says
/// there means nothing. `mass` is nv × nv and left with the factors of [`cholesky_into`].
pub fn indefinite_joint_into(
    model: &Model,
    kinematics: &Kinematics,
    workspace: &mut Workspace,
    mass: &mut [f64],
) -> Option<usize> {
    lower_crba_into(model, kinematics, workspace, mass);
    cholesky_into(model, mass);
    // Once a pivot is not positive, those nearer the root mean nothing. NaN is not positive either.
    let is_positive = |k: usize| mass[k * model.nv() + k] > 0.0;
    let k = (0..model.nv()).rev().find(|&k| !is_positive(k))?;
    model.own_joints().find(|j| model.v_range(*j).contains(&k))
}

/// [`indefinite_joint_into`], allocating.
pub fn indefinite_joint(model: &Model, kinematics: &Kinematics) -> Option<usize> {
    let mut mass = vec![0.0; model.nv() * model.nv()];
    indefinite_joint_into(model, kinematics, &mut Workspace::new(model), &mut mass)
}
