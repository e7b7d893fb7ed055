//! Loads from outside: a force and a moment on a body.

use crate::dynamics::joint;
use crate::dynamics::kinematics::Kinematics;
use crate::model::{Model, Site};
use crate::spatial::{Force, Scalar};

/// Adds the generalized force of a wrench on the body that carries `site` to `q_force` (nv), N·m or N:
/// Q_b = f·T_b(P) + n·Om_b.
///
/// The force f, N, acts at the site's point P; f and the moment n, N·m, have world axes. Needs positions. Add it to τ for
/// forward dynamics; inverse dynamics gives what actuators and loads must supply together, so take it off there.
#[inline(always)]
pub fn add_wrench<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    site: &Site,
    wrench: Force<T>,
    q_force: &mut [T],
) {
    let q_force = &mut q_force[..model.nv()];
    let point = kinematics.position(site);
    for k in joint::path_to_world(model, site.link()) {
        let degree = &model.degrees()[k];
        let link = kinematics.link(degree.link);
        q_force[degree.index] += joint::point_column(model, degree, link, point).dot(wrench.linear)
            + joint::angular_column(degree, link).dot(wrench.angular);
    }
}

/// Adds ∂Q_b/∂q_c of a wrench that keeps its world components while the body moves to `d_q` (nv × nv, row-major, b the row).
///
/// With lo the inner and hi the outer of joints b and c: f·(Om_lo × T_hi(P)), and n·(Om_c × Om_b) where c carries b. Needs
/// positions.
#[inline(always)]
pub fn add_wrench_derivative<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    site: &Site,
    wrench: Force<T>,
    d_q: &mut [T],
) {
    let (n, degrees) = (model.nv(), model.degrees());
    assert_eq!(d_q.len(), n * n, "the derivative is nv x nv");
    let point = kinematics.position(site);
    for hi in joint::path_to_world(model, site.link()) {
        let (degree, link) = (&degrees[hi], kinematics.link(degrees[hi].link));
        let (column, spin) = (joint::point_column(model, degree, link, point), joint::angular_column(degree, link));
        for lo in joint::inwards(model, hi + 1, 0) {
            let inner = &degrees[lo];
            let carrier_link = kinematics.link(inner.link);
            let turn = joint::angular_column(inner, carrier_link);
            let (row, other) = (degree.index, inner.index);
            let by_turn = turn.cross(column).dot(wrench.linear);
            d_q[row * n + other] += by_turn + turn.cross(spin).dot(wrench.angular);
            if lo == hi {
                continue;
            }
            d_q[other * n + row] += if inner.link == degree.link {
                // Degrees of one joint move with one another.
                let moved = spin.cross(joint::point_column(model, inner, carrier_link, point));
                moved.dot(wrench.linear) + spin.cross(turn).dot(wrench.angular)
            } else {
                by_turn
            };
        }
    }
}
