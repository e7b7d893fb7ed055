//! The momentum of the whole robot about its centre of mass.

use super::kinematics::Kinematics;
use super::moments::{at_reference, motions_at_rest};
use super::workspace::Workspace;
use crate::model::Model;
use crate::spatial::{Force, Inertia, Scalar, Vec3};

/// Centroidal momentum matrix A(q): A v is the momentum of all that moves, linear (kg·m/s) above angular about the centre of mass (kg·m²/s).
///
/// `matrix` is 6 × nv, row-major, world axes; needs positions. With the momentum (p, l) at some point of all that joint b carries when it moves at unit
/// speed, and the centre of mass at r from there, column b is (p, l − r × p). NaN for a robot without mass. Source: Orin, Goswami and Lee, Centroidal
/// dynamics of a humanoid robot, Auton. Robots 35, 2013.
#[inline(always)]
pub fn centroidal_matrix_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    workspace: &mut Workspace<T>,
    matrix: &mut [T],
) {
    let n = clear(model, matrix);
    if n == 0 {
        return;
    }
    at_reference(model, kinematics, workspace);
    let whole = gather(model, workspace);
    let centre = whole.first_moment * (T::ONE / whole.mass);
    for (k, degree) in model.degrees().iter().enumerate() {
        let momentum = workspace.composite[degree.link - 1] * workspace.axes.unit[k];
        add_column(matrix, n, degree.index, momentum.linear, momentum.angular - centre.cross(momentum.linear));
    }
}

/// [`centroidal_matrix_into`], allocating.
pub fn centroidal_matrix<T: Scalar>(model: &Model, kinematics: &Kinematics<T>) -> Vec<T> {
    let mut matrix = vec![T::ZERO; 6 * model.nv()];
    centroidal_matrix_into(model, kinematics, &mut Workspace::new(model), &mut matrix);
    matrix
}

/// Its time derivative Ȧ(q, v), so that A a + Ȧ v is the rate of that momentum: the forces from outside, and their moment about the centre of mass.
///
/// `rate` is 6 × nv, row-major, world axes; needs velocities. Column b is the rate of the momentum of all that joint b carries, İ J + I J̇ with
/// İ J = 2 B J − J ×* I v (see [`coriolis_into`](super::coriolis_into) for B), about the centre of mass, which moves. NaN for a robot without mass.
#[inline(always)]
pub fn centroidal_matrix_rate_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    workspace: &mut Workspace<T>,
    rate: &mut [T],
) {
    let n = clear(model, rate);
    if n == 0 {
        return;
    }
    motions_at_rest(model, kinematics, workspace);
    let ws = workspace;
    let (mut moving, joints) = (Force::ZERO, model.joint_count());
    for j in 0..joints {
        ws.force[j + 1] = ws.composite[j] * ws.velocity[j + 1];
        moving += ws.force[j + 1];
    }
    for j in (0..joints).rev() {
        let Some(parent) = model.parent_link(j).checked_sub(1) else { continue };
        let (inner, outer) = ws.body_coriolis.split_at_mut(j);
        inner[parent] += outer[0];
        let carried = ws.force[j + 1];
        ws.force[parent + 1] += carried;
    }
    let whole = gather(model, ws);
    let inverse = T::ONE / whole.mass;
    let (centre, drift) = (whole.first_moment * inverse, moving.linear * inverse);
    let two = T::from_f64(2.0);
    for (k, degree) in model.degrees().iter().enumerate() {
        let (inertia, sway) = (ws.composite[degree.link - 1], ws.body_coriolis[degree.link - 1]);
        let unit = ws.axes.unit[k];
        let (momentum, felt) = (inertia * unit, unit.cross_force(ws.force[degree.link]));
        let changes = inertia * ws.axes.own_rate[k] + sway.times(unit.angular) * two;
        let (linear, angular) = (changes.linear - felt.linear, changes.angular - felt.angular);
        let about_centre = angular - centre.cross(linear) - drift.cross(momentum.linear);
        add_column(rate, n, degree.index, linear, about_centre);
    }
}

/// [`centroidal_matrix_rate_into`], allocating.
pub fn centroidal_matrix_rate<T: Scalar>(model: &Model, kinematics: &Kinematics<T>) -> Vec<T> {
    let mut rate = vec![T::ZERO; 6 * model.nv()];
    centroidal_matrix_rate_into(model, kinematics, &mut Workspace::new(model), &mut rate);
    rate
}

/// Inertias of links, about one point, become those of all that joints carry; gives that of the whole robot.
#[inline(always)]
fn gather<T: Scalar>(model: &Model, ws: &mut Workspace<T>) -> Inertia<T> {
    let mut whole = Inertia::ZERO;
    for j in (0..model.joint_count()).rev() {
        let carried = ws.composite[j];
        match model.parent_link(j).checked_sub(1) {
            Some(parent) => ws.composite[parent] += carried,
            None => whole += carried,
        }
    }
    whole
}

#[inline(always)]
fn clear<T: Scalar>(model: &Model, matrix: &mut [T]) -> usize {
    let n = model.nv();
    assert_eq!(matrix.len(), 6 * n, "the centroidal momentum matrix is 6 x nv");
    matrix.fill(T::ZERO);
    n
}

#[inline(always)]
fn add_column<T: Scalar>(matrix: &mut [T], n: usize, column: usize, linear: Vec3<T>, angular: Vec3<T>) {
    for row in 0..3 {
        matrix[row * n + column] += linear.0[row];
        matrix[(row + 3) * n + column] += angular.0[row];
    }
}
