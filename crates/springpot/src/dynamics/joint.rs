//! What a joint does: the only place besides the recursions that tells joints apart.

use crate::model::{Axis, Degree, DegreeMotion, JointMotion, Model};
use crate::spatial::{Motion, Placement, Rotation, Scalar, Vec3};

/// Where the joints stand: coordinate, sine and cosine of each; without meaning for a floating joint.
#[derive(Debug, Clone)]
pub(super) struct Stands<T> {
    coordinates: Vec<T>,
    sines: Vec<T>,
    cosines: Vec<T>,
}

impl<T: Scalar> Stands<T> {
    pub(super) fn new(model: &Model) -> Self {
        let zeros = || vec![T::ZERO; model.joint_count()];
        Self { coordinates: zeros(), sines: zeros(), cosines: zeros() }
    }

    /// Reads `q` (nq).
    #[inline]
    pub(super) fn read(&mut self, model: &Model, q: &[T]) {
        for (j, coordinate) in self.coordinates.iter_mut().enumerate() {
            let own = model.coordinates(j);
            *coordinate = q[own.q].times_plus(T::from_f64(own.ratio), T::from_f64(own.offset));
        }
        T::sin_cos_each(&self.coordinates, &mut self.sines, &mut self.cosines);
    }

    /// The coordinate of joint `j` of one degree, as last read.
    #[inline]
    pub(super) fn coordinate(&self, j: usize) -> T {
        self.coordinates[j]
    }

    /// The link frame of joint `j` in the frame of its parent link; `q` as it was read.
    #[inline]
    pub(super) fn placement(&self, model: &Model, j: usize, q: &[T]) -> Placement<T> {
        let at_zero = Placement::from_f64(model.joint_placement(j));
        match model.motion(j) {
            JointMotion::Revolute => {
                Placement { rotation: at_zero.rotation.turned_about_z(self.sines[j], self.cosines[j]), ..at_zero }
            }
            JointMotion::Prismatic => {
                let translation = at_zero.rotation.z_axis().times_plus(self.coordinates[j], at_zero.translation);
                Placement { translation, ..at_zero }
            }
            JointMotion::Floating => floating_placement(model, j, q),
        }
    }
}

/// The velocity (or acceleration) of a joint of one degree.
#[inline]
pub(super) fn speed<T: Scalar>(model: &Model, j: usize, v: &[T]) -> T {
    let own = model.coordinates(j);
    v[own.v] * T::from_f64(own.ratio)
}

/// The velocity (or acceleration) of a floating joint, in the axes of its link.
#[inline]
pub(super) fn twist<T: Scalar>(model: &Model, j: usize, v: &[T]) -> Motion<T> {
    let first = model.coordinates(j).v;
    let v = &v[first..first + 6];
    Motion { linear: Vec3([v[0], v[1], v[2]]), angular: Vec3([v[3], v[4], v[5]]) }
}

/// Apart, so that joints of one degree keep a short path.
#[inline(never)]
fn floating_placement<T: Scalar>(model: &Model, j: usize, q: &[T]) -> Placement<T> {
    let first = model.coordinates(j).q;
    let q = &q[first..first + 7];
    let own = Placement {
        rotation: Rotation::from_quaternion_components([q[3], q[4], q[5], q[6]]),
        translation: Vec3([q[0], q[1], q[2]]),
    };
    Placement::from_f64(model.joint_placement(j)) * own
}

/// The axis of a degree of freedom in world axes, as long as its ratio, and whether it turns about it.
#[inline]
fn axis<T: Scalar>(degree: &Degree, link: &Placement<T>) -> (Vec3<T>, bool) {
    let (axis, turns) = match degree.motion {
        DegreeMotion::Turn(axis) => (axis, true),
        DegreeMotion::Shift(axis) => (axis, false),
    };
    let axis = match axis {
        Axis::Z => link.rotation.z_axis(),
        Axis::Y => link.rotation.column(1),
        Axis::X => link.rotation.column(0),
    };
    (axis * T::from_f64(degree.ratio), turns)
}

/// The motion of the degree's link at unit velocity, at a point from which the link's origin is seen at `arm`; world axes.
#[inline]
pub(super) fn unit_motion<T: Scalar>(degree: &Degree, link: &Placement<T>, arm: Vec3<T>) -> Motion<T> {
    match axis(degree, link) {
        (axis, true) => Motion { angular: axis, linear: arm.cross(axis) },
        (axis, false) => Motion { angular: Vec3::ZERO, linear: axis },
    }
}

/// ∂r_P/∂q_k = T_k(P) for a point P that degree k carries: e × (r_P − O) or e, with its axis e and the link's origin O.
#[inline]
pub(super) fn point_column<T: Scalar>(degree: &Degree, link: &Placement<T>, point: Vec3<T>) -> Vec3<T> {
    match axis(degree, link) {
        (axis, true) => axis.cross(point - link.translation),
        (axis, false) => axis,
    }
}

/// dT_k(P)/dt, where the link turns with `motion.angular` and its origin moves with `motion.linear`, and P moves with
/// `velocity`.
#[inline]
pub(super) fn point_column_rate<T: Scalar>(
    degree: &Degree,
    link: &Placement<T>,
    motion: Motion<T>,
    point: Vec3<T>,
    velocity: Vec3<T>,
) -> Vec3<T> {
    match axis(degree, link) {
        (axis, true) => {
            let rate = motion.angular.cross(axis);
            rate.cross(point - link.translation) + axis.cross(velocity - motion.linear)
        }
        (axis, false) => motion.angular.cross(axis),
    }
}

/// ∂ω/∂v_k = Om_k of a link that degree k carries: its axis e if it turns, else 0.
#[inline]
pub(super) fn angular_column<T: Scalar>(degree: &Degree, link: &Placement<T>) -> Vec3<T> {
    match axis(degree, link) {
        (axis, true) => axis,
        (_, false) => Vec3::ZERO,
    }
}

/// ∂(m r_C)/∂q_k of all that degree k carries, whose first moments about the link's origin are `first`: e × H or m e.
#[inline]
pub(super) fn first_moment_column<T: Scalar>(
    model: &Model,
    degree: &Degree,
    link: &Placement<T>,
    first: Vec3<T>,
) -> Vec3<T> {
    match axis(degree, link) {
        (axis, true) => axis.cross(first),
        (axis, false) => axis * T::from_f64(model.subtree_mass(degree.link - 1)),
    }
}

/// The degrees of freedom that carry `link`, from the link to the world.
#[inline]
pub(super) fn path_to_world(model: &Model, link: usize) -> impl Iterator<Item = usize> + '_ {
    inwards(model, model.last_degree(link), 0)
}

/// The degrees of freedom that carry `link` but not its ancestor `end`, from the link inwards.
#[inline]
pub(super) fn path_to(model: &Model, link: usize, end: usize) -> impl Iterator<Item = usize> + '_ {
    inwards(model, model.last_degree(link), model.last_degree(end))
}

/// The degrees of freedom that carry degree `k`, from the next one to the world.
#[inline]
pub(super) fn carriers(model: &Model, k: usize) -> impl Iterator<Item = usize> + '_ {
    inwards(model, model.carrier(k), 0)
}

/// From the degree before `start` to the one behind `end`.
#[inline]
pub(super) fn inwards(model: &Model, start: usize, end: usize) -> impl Iterator<Item = usize> + '_ {
    let mut at = start;
    std::iter::from_fn(move || {
        if at == end {
            return None;
        }
        let k = at - 1;
        at = model.carrier(k);
        Some(k)
    })
}

/// The last link that carries both `a` and `b`; parents come first, so the larger index always steps inwards.
#[inline]
pub(super) fn common_link(model: &Model, mut a: usize, mut b: usize) -> usize {
    while a != b {
        if a > b {
            a = model.parent_link(a - 1);
        } else {
            b = model.parent_link(b - 1);
        }
    }
    a
}
