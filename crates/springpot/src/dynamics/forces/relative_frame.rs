//! One frame seen from another one: six coordinates, their derivatives.

use super::coordinate::Coordinate;
use crate::dynamics::joint;
use crate::dynamics::kinematics::Kinematics;
use crate::model::{Frame, Model};
use crate::spatial::{Rotation, Vec3, left_inverse, left_inverse_slope, left_inverse_transposed};

/// A coordinate of the frame `to` in the axes of the frame `from`: of its origin, or of the rotation vector φ of R_fromᵀ R_to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RelativeCoordinate {
    pub(crate) from: Frame,
    pub(crate) to: Frame,
    /// Which axis of `from`.
    pub(crate) axis: usize,
    pub(crate) is_turn: bool,
}

/// What of a configuration the derivatives need.
struct Seen {
    /// r_to, world axes.
    point: Vec3,
    /// ∂y = ±(direction · T) or ±(direction · Om) of a degree, world axes.
    direction: Vec3,
    /// φ and R_from, of a turn.
    turn: Option<(Vec3, Rotation)>,
    /// The last link that carries both frames.
    common: usize,
}

impl RelativeCoordinate {
    /// y; for a turn with φ.
    pub(crate) fn value(&self, kinematics: &Kinematics) -> (f64, Option<Vec3>) {
        let (from, to) = (kinematics.frame(&self.from), kinematics.frame(&self.to));
        if self.is_turn {
            let turn = (from.rotation.transpose() * to.rotation).rotation_vector();
            return (turn.0[self.axis], Some(turn));
        }
        (from.rotation.column(self.axis).dot(to.translation - from.translation), None)
    }

    fn see(&self, model: &Model, kinematics: &Kinematics) -> Seen {
        let (from, to) = (kinematics.frame(&self.from), kinematics.frame(&self.to));
        let common = joint::common_link(model, self.from.link(), self.to.link());
        if !self.is_turn {
            let direction = from.rotation.column(self.axis);
            return Seen { point: to.translation, direction, turn: None, common };
        }
        let turn = (from.rotation.transpose() * to.rotation).rotation_vector();
        let mut axis = Vec3::ZERO;
        axis.0[self.axis] = 1.0;
        let direction = from.rotation * left_inverse_transposed(turn, axis);
        Seen { point: to.translation, direction, turn: Some((turn, from.rotation)), common }
    }

    /// The degrees that move one frame and not the other, with 1 for `to` and −1 for `from`.
    fn degrees<'m>(&self, model: &'m Model, common: usize) -> impl Iterator<Item = (usize, f64)> + use<'m> {
        let path = |link: usize, sign: f64| joint::path_to(model, link, common).map(move |k| (k, sign));
        path(self.from.link(), -1.0).chain(path(self.to.link(), 1.0))
    }
}

/// With t_k = T_k(r_to), as if r_to were a point of all that degree k carries, ∂_k y = ±e·t_k for a shift along e; for a turn
/// φ̇ = J_l⁻¹(φ) R_fromᵀ(ω_to − ω_from), so that ∂_k y = ±c·Om_k with c = R_from J_l⁻ᵀ(φ) e. Signs: + where k carries `to`, − where it
/// carries `from`.
impl Coordinate<f64> for RelativeCoordinate {
    #[inline(always)]
    fn slopes(&self, model: &Model, kinematics: &Kinematics, mut visit: impl FnMut(usize, f64)) {
        let Seen { point, direction, turn, common } = self.see(model, kinematics);
        for (k, sign) in self.degrees(model, common) {
            let degree = &model.degrees()[k];
            let link = kinematics.link(degree.link);
            let column = match turn {
                None => joint::point_column(model, degree, link, point),
                Some(_) => joint::angular_column(degree, link),
            };
            visit(degree.index, sign * direction.dot(column));
        }
    }

    /// Shifts: e·(Om_lo × t_hi) where both degrees carry `to`, e·(Om_hi × t_lo) where both carry `from`, −e·(Om_from × t_to)
    /// otherwise. Turns: s_a s_b e·(DJ_l⁻¹(φ)[J_l⁻¹ w_b] w_a) with w = R_fromᵀ Om, and what ∂w_a/∂q_b adds.
    #[inline(always)]
    fn second_derivatives(
        &self,
        model: &Model,
        kinematics: &Kinematics,
        columns: &mut [Vec3],
        mut visit: impl FnMut(usize, usize, f64),
    ) {
        let degrees = model.degrees();
        let Seen { point, direction, turn, common } = self.see(model, kinematics);
        let spin = |k: usize| joint::angular_column(&degrees[k], kinematics.link(degrees[k].link));
        for (k, _) in self.degrees(model, common) {
            let link = kinematics.link(degrees[k].link);
            columns[k] = match turn {
                None => joint::point_column(model, &degrees[k], link, point),
                Some(_) => spin(k),
            };
        }
        let mut give = |a: usize, b: usize, second: f64| visit(degrees[a].index, degrees[b].index, second);
        if let Some((turn, rotation)) = turn {
            for (a, first) in self.degrees(model, common) {
                for (b, second) in self.degrees(model, common) {
                    let [own, other] = [a, b].map(|k| rotation.unrotate(columns[k]));
                    let slope = left_inverse_slope(turn, left_inverse(turn, other), own);
                    give(a, b, first * second * slope.0[self.axis]);
                }
            }
        }
        for (link, is_from) in [(self.from.link(), true), (self.to.link(), false)] {
            for hi in joint::path_to(model, link, common) {
                for lo in joint::inwards(model, hi + 1, model.last_degree(common)) {
                    // Degrees of one joint move with one another.
                    let one_joint = degrees[lo].link == degrees[hi].link;
                    let along = |a: usize, b: usize| direction.dot(spin(a).cross(columns[b]));
                    let (inner, outer) = match (is_from, turn.is_some()) {
                        (true, false) => (along(hi, lo), if one_joint { along(lo, hi) } else { along(hi, lo) }),
                        (false, false) => (along(lo, hi), if one_joint { along(hi, lo) } else { along(lo, hi) }),
                        (true, true) => (0.0, if one_joint { 0.0 } else { along(hi, lo) }),
                        (false, true) => (along(lo, hi), if one_joint { along(hi, lo) } else { 0.0 }),
                    };
                    give(hi, lo, inner);
                    if lo != hi {
                        give(lo, hi, outer);
                    }
                }
            }
        }
        for a in joint::path_to(model, self.to.link(), common) {
            for b in joint::path_to(model, self.from.link(), common) {
                let both = -direction.dot(spin(b).cross(columns[a]));
                give(a, b, both);
                if turn.is_none() {
                    give(b, a, both);
                }
            }
        }
    }
}
