//! The line between two points: how it changes with the degrees of freedom between its ends.

use crate::dynamics::joint;
use crate::dynamics::kinematics::Kinematics;
use crate::model::{Model, Site};
use crate::spatial::{Scalar, Vec3};

/// The line from one point to another in one state. NaN where the points coincide.
pub(in crate::dynamics) struct Line<'a, T> {
    from: &'a Site,
    to: &'a Site,
    /// The last link that carries both ends.
    common: usize,
    length: T,
    /// u = l_vec/l.
    pub(in crate::dynamics) direction: Vec3<T>,
}

impl<'a, T: Scalar> Line<'a, T> {
    #[inline(always)]
    pub(in crate::dynamics) fn new(model: &Model, kinematics: &Kinematics<T>, from: &'a Site, to: &'a Site) -> Self {
        let line = kinematics.position(to) - kinematics.position(from);
        let length = line.norm();
        let common = joint::common_link(model, from.link(), to.link());
        Self { from, to, common, length, direction: line * (T::ONE / length) }
    }

    /// The degrees of freedom that move one end and not the other.
    #[inline(always)]
    pub(in crate::dynamics) fn degrees<'m>(&self, model: &'m Model) -> impl Iterator<Item = usize> + 'm {
        let path = |site: &Site| joint::path_to(model, site.link(), self.common);
        path(self.from).chain(path(self.to))
    }

    /// Hands ∂l/∂q_b to `visit`, degree by degree.
    #[inline(always)]
    pub(in crate::dynamics) fn slopes(
        &self,
        model: &Model,
        kinematics: &Kinematics<T>,
        visit: &mut impl FnMut(usize, T),
    ) {
        for (site, towards) in [(self.to, self.direction), (self.from, -self.direction)] {
            let point = kinematics.position(site);
            for k in joint::path_to(model, site.link(), self.common) {
                let degree = &model.degrees()[k];
                visit(
                    degree.index,
                    towards.dot(joint::point_column(model, degree, kinematics.link(degree.link), point)),
                );
            }
        }
    }

    /// Fills t_k = ∂l_vec/∂q_k of [`Line::degrees`]; other columns stay as they are.
    #[inline(always)]
    pub(in crate::dynamics) fn fill_columns(&self, model: &Model, kinematics: &Kinematics<T>, columns: &mut [Vec3<T>]) {
        for (site, sign) in [(self.from, -T::ONE), (self.to, T::ONE)] {
            let point = kinematics.position(site);
            for k in joint::path_to(model, site.link(), self.common) {
                let degree = &model.degrees()[k];
                columns[k] = joint::point_column(model, degree, kinematics.link(degree.link), point) * sign;
            }
        }
    }

    /// Hands ∂(∂l/∂q_a)/∂q_b = (t_a·t_b − ∂_a l ∂_b l)/l + u·∂t_a/∂q_b to `visit` for every ordered two of [`Line::degrees`].
    #[inline(always)]
    pub(in crate::dynamics) fn second_derivatives(
        &self,
        model: &Model,
        kinematics: &Kinematics<T>,
        columns: &[Vec3<T>],
        wanted: impl Fn(usize, usize) -> bool,
        mut visit: impl FnMut(usize, usize, T),
    ) {
        let (degrees, u, inverse) = (model.degrees(), self.direction, T::ONE / self.length);
        for site in [self.from, self.to] {
            for hi in joint::path_to(model, site.link(), self.common) {
                for lo in joint::inwards(model, hi + 1, model.last_degree(self.common)).filter(|lo| wanted(*lo, hi)) {
                    let both = stretched(u, [columns[lo], columns[hi]], inverse);
                    let shifts = joint::is_shift(&degrees[lo]);
                    let turned = if shifts { T::ZERO } else { u.dot(turn(model, kinematics, lo).cross(columns[hi])) };
                    visit(hi, lo, both + turned);
                    if lo == hi {
                        continue;
                    }
                    // Degrees of one joint move with one another.
                    let one_joint = degrees[lo].link == degrees[hi].link;
                    let turned = if one_joint { u.dot(turn(model, kinematics, hi).cross(columns[lo])) } else { turned };
                    visit(lo, hi, both + turned);
                }
            }
        }
        for a in joint::path_to(model, self.from.link(), self.common) {
            for b in joint::path_to(model, self.to.link(), self.common).filter(|b| wanted(a, *b)) {
                let both = stretched(u, [columns[a], columns[b]], inverse);
                visit(a, b, both);
                visit(b, a, both);
            }
        }
    }
}

/// (t_a·t_b − (u·t_a)(u·t_b))/l.
#[inline(always)]
fn stretched<T: Scalar>(u: Vec3<T>, [a, b]: [Vec3<T>; 2], inverse: T) -> T {
    let along = u.dot(a) * u.dot(b);
    (a.dot(b) - along) * inverse
}

/// Om_k of the link that degree k moves.
#[inline(always)]
fn turn<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, k: usize) -> Vec3<T> {
    let degree = &model.degrees()[k];
    joint::angular_column(degree, kinematics.link(degree.link))
}
