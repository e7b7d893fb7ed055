//! Two points of two bodies: their distance, its derivatives, and a force along the line that joins them.

use super::line::Line;
use crate::dynamics::joint;
use crate::dynamics::kinematics::Kinematics;
use crate::dynamics::workspace::Workspace;
use crate::model::{Model, Site};
use crate::spatial::{Scalar, Vec3};
use serde::{Deserialize, Serialize};

/// Multiples of the rounding unit of the positions below which a distance has no direction.
const DIRECTION_TOLERANCE: f64 = 16.0 * f64::EPSILON;

/// Distance of two points in one state.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Pair<T = f64> {
    /// l = |l_vec| with l_vec = r_to − r_from, m.
    pub length: T,
    /// dl/dt = Σ_b ∂l/∂q_b v_b, m/s.
    pub rate: T,
    /// l_vec/l, world axes. NaN where the length is 0.
    pub direction: Vec3<T>,
    /// |r_from|² + |r_to|², the measure of the rounding in l_vec.
    scale_squared: T,
}

/// Two anchors coincide, so that the line between them has no direction and the force no line to act along.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("the two anchors coincide (length {length} m): there is no direction for the force")]
pub struct CoincidentAnchors {
    /// The length, m.
    pub length: f64,
}

impl Pair<f64> {
    /// Whether the points met or passed each other until `after`: the line turned by more than a right angle.
    pub(crate) fn lost_until(&self, after: &Self) -> bool {
        let met = after.length < self.length && after.check().is_err();
        met || self.direction.dot(after.direction) <= 0.0
    }

    /// Whether the line has a direction.
    ///
    /// # Errors
    /// [`CoincidentAnchors`] where the length is below 16 rounding units of the anchors' positions (or not a number): rate,
    /// direction and derivatives are then NaN or noise.
    pub fn check(&self) -> Result<(), CoincidentAnchors> {
        let smallest = DIRECTION_TOLERANCE * self.scale_squared.sqrt();
        if self.length > smallest { Ok(()) } else { Err(CoincidentAnchors { length: self.length }) }
    }
}

/// A force between two anchors, and how it answers to their distance; plain numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairForce<T = f64> {
    /// The first anchor.
    pub from: Site,
    /// The second anchor.
    pub to: Site,
    /// F, N, positive in tension: it pulls the two points together.
    pub force: T,
    /// ∂F/∂l, N/m.
    pub d_length: T,
    /// ∂F/∂(dl/dt), N·s/m.
    pub d_rate: T,
}

/// Length, rate and direction from `from` to `to`, and ∂l/∂q_b = (l_vec/l)·(T_b(to) − T_b(from)).
///
/// `gradient` is nv, m/rad or 1, and exactly 0 for joints that carry both points or neither; needs velocities. Where the
/// points coincide, rate, direction and gradient are NaN: call [`Pair::check`].
#[inline(always)]
pub fn pair_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    from: &Site,
    to: &Site,
    gradient: &mut [T],
) -> Pair<T> {
    let gradient = &mut gradient[..model.nv()];
    gradient.fill(T::ZERO);
    add_gradient(model, kinematics, from, to, gradient)
}

/// [`pair_into`], added to what `gradient` holds.
#[inline(always)]
pub(in crate::dynamics) fn add_gradient<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    from: &Site,
    to: &Site,
    gradient: &mut [T],
) -> Pair<T> {
    let v = kinematics.joint_velocities();
    let (start, end) = (kinematics.position(from), kinematics.position(to));
    let line = end - start;
    let length = line.norm();
    let direction = line * (T::ONE / length);
    let common = joint::common_link(model, from.link(), to.link());
    let mut rate = T::ZERO;
    for (site, point, towards) in [(to, end, direction), (from, start, -direction)] {
        for k in joint::path_to(model, site.link(), common) {
            let degree = &model.degrees()[k];
            let slope = towards.dot(joint::point_column(model, degree, kinematics.link(degree.link), point));
            gradient[degree.index] += slope;
            rate = slope.times_plus(v[degree.index], rate);
        }
    }
    Pair { length, rate, direction, scale_squared: start.dot(start) + end.dot(end) }
}

/// [`pair_into`], allocating: the pair and its gradient.
pub fn pair<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, from: &Site, to: &Site) -> (Pair<T>, Vec<T>) {
    let mut gradient = vec![T::ZERO; model.nv()];
    let pair = pair_into(model, kinematics, from, to, &mut gradient);
    (pair, gradient)
}

/// Second derivatives of the pair's length: entry (a, b) is ∂(∂l/∂q_a)/∂q_b, by which the gradient of
/// [`pair_into`] changes.
///
/// With u = l_vec/l and t_b = ∂l_vec/∂q_b it is
///
/// (t_a·t_b − ∂_a l ∂_b l)/l + u·∂t_a/∂q_b,
///
/// where the last term stands for two degrees that carry the same end alone: ±u·(Om_lo × T_hi), lo the inner one, or
/// ±u·(Om_b × T_a) where both belong to one joint. `hessian` is nv × nv, row-major (all entries are written), and symmetric but
/// for the degrees of one floating joint, whose tangent vectors do not commute; needs positions. NaN where the points coincide.
#[inline(always)]
pub fn pair_hessian_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    from: &Site,
    to: &Site,
    workspace: &mut Workspace<T>,
    hessian: &mut [T],
) {
    pair_hessian_of_moving(model, kinematics, [from, to], |_| true, workspace, hessian);
}

/// [`pair_hessian_into`] in the rows of the velocities that move; other rows stay.
#[inline(always)]
pub(crate) fn pair_hessian_of_moving<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    [from, to]: [&Site; 2],
    moves: impl Fn(usize) -> bool,
    workspace: &mut Workspace<T>,
    hessian: &mut [T],
) {
    let (n, degrees) = (model.nv(), model.degrees());
    assert_eq!(hessian.len(), n * n, "the Hessian is nv x nv");
    let wanted = |a: usize, b: usize| moves(degrees[a].index) || moves(degrees[b].index);
    for row in (0..n).filter(|row| moves(*row)) {
        hessian[row * n..(row + 1) * n].fill(T::ZERO);
    }
    let line = Line::new(model, kinematics, from, to);
    line.fill_columns(model, kinematics, &mut workspace.columns);
    line.second_derivatives(
        model,
        kinematics,
        &workspace.columns,
        wanted,
        #[inline(always)]
        |a, b, entry| {
            if moves(degrees[a].index) {
                hessian[degrees[a].index * n + degrees[b].index] += entry;
            }
        },
    );
}

/// [`pair_hessian_into`], allocating.
pub fn pair_hessian<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, from: &Site, to: &Site) -> Vec<T> {
    let n = model.nv();
    let mut hessian = vec![T::ZERO; n * n];
    pair_hessian_into(model, kinematics, from, to, &mut Workspace::new(model), &mut hessian);
    hessian
}

/// The force on the first anchor of a pair, world axes: tension pulls `from` towards `to`. NaN where the points coincide.
#[inline(always)]
pub(in crate::dynamics) fn pull<T: Scalar>(pair: &PairForce<T>, from: Vec3<T>, to: Vec3<T>) -> Vec3<T> {
    let line = to - from;
    line * (pair.force / line.norm())
}

/// Adds the generalized force Q_b = −F ∂l/∂q_b of a tension F to `q_force` (nv), N·m or N.
#[inline(always)]
pub fn add_generalized_force<T: Scalar>(force: T, gradient: &[T], q_force: &mut [T]) {
    for (q, &d) in q_force.iter_mut().zip(gradient) {
        *q -= force * d;
    }
}
