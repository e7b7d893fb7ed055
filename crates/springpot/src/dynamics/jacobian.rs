//! Jacobians of points and of the angular velocity, and their time derivatives.

use super::joint;
use super::kinematics::Kinematics;
use crate::model::{Model, Site};
use crate::spatial::{Scalar, Vec3};

/// Jacobian of a point, dr_P/dt = J v: column b is T_b(P) = e_b × (r_P − O_b) (revolute) or e_b (prismatic), and 0 for the
/// joints that do not carry P. World axes, m/rad or 1.
///
/// `jacobian` is 3 × nv, row-major; needs positions.
#[inline(always)]
pub fn point_jacobian_into<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, site: &Site, jacobian: &mut [T]) {
    let n = clear(model, jacobian);
    let point = kinematics.position(site);
    for k in joint::path_to_world(model, site.link()) {
        let degree = &model.degrees()[k];
        add_column(jacobian, n, degree.index, joint::point_column(model, degree, kinematics.link(degree.link), point));
    }
}

/// [`point_jacobian_into`], allocating.
pub fn point_jacobian<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, site: &Site) -> Vec<T> {
    let mut jacobian = vec![T::ZERO; 3 * model.nv()];
    point_jacobian_into(model, kinematics, site, &mut jacobian);
    jacobian
}

/// Time derivative of [`point_jacobian_into`], so that d²r_P/dt² = J a + J̇ v: column b is ė_b × (r_P − O_b) +
/// e_b × (ṙ_P − Ȯ_b) (revolute) or ė_b (prismatic), with ė_b = ω_b × e_b.
///
/// `rate` is 3 × nv, row-major; needs velocities.
#[inline(always)]
pub fn point_jacobian_rate_into<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, site: &Site, rate: &mut [T]) {
    let n = clear(model, rate);
    let (position, velocity) = (kinematics.position(site), kinematics.velocity(site));
    for k in joint::path_to_world(model, site.link()) {
        let degree = &model.degrees()[k];
        let (link, motion) = (kinematics.link(degree.link), kinematics.link_velocity(degree.link));
        add_column(rate, n, degree.index, joint::point_column_rate(model, degree, link, motion, position, velocity));
    }
}

/// [`point_jacobian_rate_into`], allocating.
pub fn point_jacobian_rate<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, site: &Site) -> Vec<T> {
    let mut rate = vec![T::ZERO; 3 * model.nv()];
    point_jacobian_rate_into(model, kinematics, site, &mut rate);
    rate
}

/// Jacobian of the angular velocity of the body that carries `site`, ω = J v: column b is Om_b = e_b (revolute) or 0.
/// World axes.
///
/// `jacobian` is 3 × nv, row-major; needs positions. The point of the site has no influence.
#[inline(always)]
pub fn angular_jacobian_into<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, site: &Site, jacobian: &mut [T]) {
    let n = clear(model, jacobian);
    for k in joint::path_to_world(model, site.link()) {
        let degree = &model.degrees()[k];
        add_column(jacobian, n, degree.index, joint::angular_column(degree, kinematics.link(degree.link)));
    }
}

/// [`angular_jacobian_into`], allocating.
pub fn angular_jacobian<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, site: &Site) -> Vec<T> {
    let mut jacobian = vec![T::ZERO; 3 * model.nv()];
    angular_jacobian_into(model, kinematics, site, &mut jacobian);
    jacobian
}

/// Time derivative of [`angular_jacobian_into`], so that dω/dt = J a + J̇ v: column b is ω_b × e_b (revolute) or 0.
///
/// `rate` is 3 × nv, row-major; needs velocities.
#[inline(always)]
pub fn angular_jacobian_rate_into<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, site: &Site, rate: &mut [T]) {
    let n = clear(model, rate);
    for k in joint::path_to_world(model, site.link()) {
        let degree = &model.degrees()[k];
        let axis = joint::angular_column(degree, kinematics.link(degree.link));
        add_column(rate, n, degree.index, kinematics.link_velocity(degree.link).angular.cross(axis));
    }
}

/// [`angular_jacobian_rate_into`], allocating.
pub fn angular_jacobian_rate<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, site: &Site) -> Vec<T> {
    let mut rate = vec![T::ZERO; 3 * model.nv()];
    angular_jacobian_rate_into(model, kinematics, site, &mut rate);
    rate
}

#[inline(always)]
fn clear<T: Scalar>(model: &Model, matrix: &mut [T]) -> usize {
    let n = model.nv();
    assert_eq!(matrix.len(), 3 * n, "the Jacobian is 3 x nv");
    matrix.fill(T::ZERO);
    n
}

#[inline(always)]
fn add_column<T: Scalar>(matrix: &mut [T], n: usize, column: usize, v: Vec3<T>) {
    let [x, y, z] = v.0;
    matrix[column] += x;
    matrix[n + column] += y;
    matrix[2 * n + column] += z;
}
