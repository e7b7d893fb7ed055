//! Jacobian of a frame and its time derivative: six rows, world-aligned at the frame.

use super::joint;
use super::kinematics::Kinematics;
use super::workspace::Workspace;
use crate::model::{Frame, Model};
use crate::spatial::{Placement, Scalar, Vec3};

/// Jacobian of a frame, (dr_O/dt, ω) = J v: linear rows of the frame's origin O first, then angular ones, both in world axes.
///
/// Column b is (T_b(O), Om_b). `jacobian` is 6 × nv, row-major (all entries are written); needs positions.
#[inline(always)]
pub fn frame_jacobian_into<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, frame: &Frame, jacobian: &mut [T]) {
    let n = clear(model, jacobian);
    let origin = kinematics.frame(frame).translation;
    for k in joint::path_to_world(model, frame.link()) {
        let degree = &model.degrees()[k];
        let link = kinematics.link(degree.link);
        let (linear, angular) = (joint::point_column(model, degree, link, origin), joint::angular_column(degree, link));
        add_column(jacobian, n, degree.index, linear, angular);
    }
}

/// [`frame_jacobian_into`] at `q` (nq), where nothing else of the robot is asked for: only the joints that carry the frame are placed.
#[inline(always)]
pub fn frame_jacobian_at_into<T: Scalar>(
    model: &Model,
    q: &[T],
    frame: &Frame,
    workspace: &mut Workspace<T>,
    jacobian: &mut [T],
) {
    let (n, q) = (clear(model, jacobian), &q[..model.nq()]);
    let Workspace { stands, world, path, .. } = workspace;
    path.clear();
    let mut link = frame.link();
    while link > 0 {
        path.push(link - 1);
        link = model.parent_link(link - 1);
    }
    stands.read_some(model, path, q);
    world[0] = Placement::IDENTITY;
    for (k, &j) in path.iter().enumerate().rev() {
        world[j + 1] = world[model.parent_link(j)] * stands.placement_of(model, (k, j), q);
    }
    let origin = world[frame.link()].point(Vec3::from_f64(frame.placement().translation));
    for k in joint::path_to_world(model, frame.link()) {
        let degree = &model.degrees()[k];
        let link = &world[degree.link];
        let (linear, angular) = (joint::point_column(model, degree, link, origin), joint::angular_column(degree, link));
        add_column(jacobian, n, degree.index, linear, angular);
    }
}

/// [`frame_jacobian_into`], allocating.
pub fn frame_jacobian<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, frame: &Frame) -> Vec<T> {
    let mut jacobian = vec![T::ZERO; 6 * model.nv()];
    frame_jacobian_into(model, kinematics, frame, &mut jacobian);
    jacobian
}

/// Time derivative of [`frame_jacobian_into`], so that (d²r_O/dt², dω/dt) = J a + J̇ v.
///
/// Column b is (ė_b × (r_O − O_b) + e_b × (ṙ_O − Ȯ_b), ė_b) (revolute) or (ė_b, 0) (prismatic), with ė_b = ω_b × e_b. `rate` is
/// 6 × nv, row-major (all entries are written); needs velocities.
#[inline(always)]
pub fn frame_jacobian_rate_into<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, frame: &Frame, rate: &mut [T]) {
    let n = clear(model, rate);
    let carrier = kinematics.link(frame.link());
    let arm = carrier.rotation * Vec3::from_f64(frame.placement().translation);
    let (origin, velocity) = (carrier.translation + arm, kinematics.link_velocity(frame.link()).shifted(arm).linear);
    for k in joint::path_to_world(model, frame.link()) {
        let degree = &model.degrees()[k];
        let (link, motion) = (kinematics.link(degree.link), kinematics.link_velocity(degree.link));
        let linear = joint::point_column_rate(model, degree, link, motion, origin, velocity);
        let angular = motion.angular.cross(joint::angular_column(degree, link));
        add_column(rate, n, degree.index, linear, angular);
    }
}

/// [`frame_jacobian_rate_into`], allocating.
pub fn frame_jacobian_rate<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, frame: &Frame) -> Vec<T> {
    let mut rate = vec![T::ZERO; 6 * model.nv()];
    frame_jacobian_rate_into(model, kinematics, frame, &mut rate);
    rate
}

#[inline(always)]
fn clear<T: Scalar>(model: &Model, matrix: &mut [T]) -> usize {
    let n = model.nv();
    assert_eq!(matrix.len(), 6 * n, "the Jacobian is 6 x nv");
    matrix.fill(T::ZERO);
    n
}

#[inline(always)]
fn add_column<T: Scalar>(matrix: &mut [T], n: usize, column: usize, linear: Vec3<T>, angular: Vec3<T>) {
    for row in 0..3 {
        matrix[row * n + column] += linear.0[row];
        matrix[(3 + row) * n + column] += angular.0[row];
    }
}
