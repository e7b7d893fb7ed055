//! What a joint does: the only place that tells joints apart. A kind of motion is a file beside this one,
//! whose functions bear the names of those here.

mod floating;
mod helical;
mod prismatic;
mod revolute;
mod spherical;

use crate::model::{Axis, Degree, DegreeMotion, JointMotion, Model};
use crate::spatial::{ArticulatedInertia, Force, Inertia, Motion, Placement, Scalar, Vec3};

/// Where the joints stand: coordinate, sine and cosine of each; without meaning for a spherical or floating joint.
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
    #[inline(always)]
    pub(super) fn read(&mut self, model: &Model, q: &[T]) {
        for (j, coordinate) in self.coordinates.iter_mut().enumerate() {
            *coordinate = stand(model, j, q);
        }
        T::sin_cos_each(&self.coordinates, &mut self.sines, &mut self.cosines);
    }

    /// Reads `q` (nq) for some joints alone, which are then found by their places among these.
    #[inline(always)]
    pub(super) fn read_some(&mut self, model: &Model, joints: &[usize], q: &[T]) {
        let count = joints.len();
        for (coordinate, &j) in self.coordinates.iter_mut().zip(joints) {
            *coordinate = stand(model, j, q);
        }
        T::sin_cos_each(&self.coordinates[..count], &mut self.sines[..count], &mut self.cosines[..count]);
    }

    /// The coordinate of joint `j` of one degree, as last read.
    #[inline(always)]
    pub(super) fn coordinate(&self, j: usize) -> T {
        self.coordinates[j]
    }

    /// The link frame of joint `j` in the frame of its parent link; `q` as it was read.
    #[inline(always)]
    pub(super) fn placement(&self, model: &Model, j: usize, q: &[T]) -> Placement<T> {
        self.placement_of(model, (j, j), q)
    }

    /// [`Self::placement`] of joint `j`, which was read in place `k`.
    #[inline(always)]
    pub(super) fn placement_of(&self, model: &Model, (k, j): (usize, usize), q: &[T]) -> Placement<T> {
        let at_zero = Placement::from_f64(model.joint_placement(j));
        match model.motion(j) {
            JointMotion::Revolute => revolute::placement(at_zero, self.sines[k], self.cosines[k]),
            JointMotion::Prismatic => prismatic::placement(at_zero, self.coordinates[k]),
            JointMotion::Helical => {
                helical::placement(at_zero, model.pitch(j), [self.coordinates[k], self.sines[k], self.cosines[k]])
            }
            JointMotion::Spherical => spherical::placement(model, j, q),
            JointMotion::Floating => floating::placement(model, j, q),
        }
    }
}

/// Where a joint of one degree stands.
#[inline(always)]
fn stand<T: Scalar>(model: &Model, j: usize, q: &[T]) -> T {
    let own = model.coordinates(j);
    q[own.q].times_plus(T::from_f64(own.ratio), T::from_f64(own.offset))
}

/// Whether a degree of freedom turns nothing.
#[inline(always)]
pub(super) fn is_shift(degree: &Degree) -> bool {
    matches!(degree.motion, DegreeMotion::Shift(_))
}

/// The velocity (or acceleration) of a joint of one degree.
#[inline(always)]
fn speed<T: Scalar>(model: &Model, j: usize, v: &[T]) -> T {
    let own = model.coordinates(j);
    v[own.v] * T::from_f64(own.ratio)
}

/// The velocity (or acceleration) of a spherical or floating joint, in the axes of its link.
#[inline(always)]
fn twist<T: Scalar>(model: &Model, j: usize, v: &[T]) -> Motion<T> {
    let own = &v[model.coordinates(j).v..];
    if model.motion(j) == JointMotion::Spherical { spherical::twist(own) } else { floating::twist(own) }
}

/// The velocity of `link`, which joint `j` moves with `v` (nv), where its parent carries its origin along with `carried`.
#[inline(always)]
pub(super) fn velocity<T: Scalar>(
    model: &Model,
    j: usize,
    link: &Placement<T>,
    carried: Motion<T>,
    v: &[T],
) -> Motion<T> {
    let axis = link.rotation.z_axis();
    match model.motion(j) {
        JointMotion::Revolute => revolute::velocity(carried, axis, speed(model, j, v)),
        JointMotion::Prismatic => prismatic::velocity(carried, axis, speed(model, j, v)),
        JointMotion::Helical => helical::velocity(carried, axis, model.pitch(j), speed(model, j, v)),
        JointMotion::Spherical | JointMotion::Floating => {
            floating::velocity(carried, &link.rotation, twist(model, j, v))
        }
    }
}

/// The acceleration of `link`, which joint `j` moves with `v` and `a` (nv), where its parent, which turns with `omega`,
/// carries its origin along with `carried`.
#[inline(always)]
pub(super) fn acceleration<T: Scalar>(
    model: &Model,
    j: usize,
    link: &Placement<T>,
    (carried, omega): (Motion<T>, Vec3<T>),
    [v, a]: [&[T]; 2],
) -> Motion<T> {
    let axis = link.rotation.z_axis();
    match model.motion(j) {
        JointMotion::Revolute => revolute::acceleration(carried, omega, axis, [speed(model, j, v), speed(model, j, a)]),
        JointMotion::Prismatic => {
            prismatic::acceleration(carried, omega, axis, [speed(model, j, v), speed(model, j, a)])
        }
        JointMotion::Helical => {
            helical::acceleration(carried, omega, axis, model.pitch(j), [speed(model, j, v), speed(model, j, a)])
        }
        JointMotion::Spherical | JointMotion::Floating => {
            let twists = [twist(model, j, v), twist(model, j, a)];
            floating::acceleration(carried, omega, &link.rotation, twists)
        }
    }
}

/// v += S q̇ and a += S q̈ + v × S q̇, with S along z: from the motion of the parent, seen at the origin of the link of joint `j` in
/// its axes, to that of the link.
#[inline(always)]
pub(super) fn advance<T: Scalar>(
    model: &Model,
    j: usize,
    velocity: &mut Motion<T>,
    acceleration: &mut Motion<T>,
    v: &[T],
    a: Option<&[T]>,
) {
    match model.motion(j) {
        JointMotion::Revolute => {
            let push = if let Some(a) = a { speed(model, j, a) } else { T::ZERO };
            revolute::advance(velocity, acceleration, speed(model, j, v), push);
        }
        JointMotion::Prismatic => {
            let push = if let Some(a) = a { speed(model, j, a) } else { T::ZERO };
            prismatic::advance(velocity, acceleration, speed(model, j, v), push);
        }
        JointMotion::Helical => {
            let push = if let Some(a) = a { speed(model, j, a) } else { T::ZERO };
            helical::advance(velocity, acceleration, model.pitch(j), [speed(model, j, v), push]);
        }
        JointMotion::Spherical | JointMotion::Floating => {
            let push = if let Some(a) = a { twist(model, j, a) } else { Motion::ZERO };
            floating::advance(velocity, acceleration, twist(model, j, v), push);
        }
    }
}

/// Adds Sᵀ f to `tau` (nv), 0 until then where the joint has several degrees: what joint `j` feels of a force on its link, in the link's axes.
#[inline(always)]
pub(super) fn add_effort<T: Scalar>(model: &Model, j: usize, force: Force<T>, tau: &mut [T]) {
    let own = model.coordinates(j);
    match model.motion(j) {
        JointMotion::Revolute => tau[own.v] += revolute::effort(force) * T::from_f64(own.ratio),
        JointMotion::Prismatic => tau[own.v] += prismatic::effort(force) * T::from_f64(own.ratio),
        JointMotion::Helical => tau[own.v] += helical::effort(force, model.pitch(j)) * T::from_f64(own.ratio),
        JointMotion::Spherical => spherical::write_effort(force, &mut tau[own.v..]),
        JointMotion::Floating => floating::write_effort(force, &mut tau[own.v..]),
    }
}

/// v × S q̇ of joint `j`, whose `link` moves with `velocity`, in world axes.
#[inline(always)]
pub(super) fn bias<T: Scalar>(model: &Model, j: usize, link: &Placement<T>, velocity: Motion<T>, v: &[T]) -> Motion<T> {
    match model.motion(j) {
        JointMotion::Revolute => revolute::bias(velocity, link.rotation.z_axis() * speed(model, j, v)),
        JointMotion::Prismatic => prismatic::bias(velocity, link.rotation.z_axis() * speed(model, j, v)),
        JointMotion::Helical => helical::bias(velocity, link.rotation.z_axis() * speed(model, j, v), model.pitch(j)),
        JointMotion::Spherical | JointMotion::Floating => floating::bias(velocity, &link.rotation, twist(model, j, v)),
    }
}

/// The axis of a degree of freedom in world axes, as long as its ratio.
#[inline(always)]
pub(super) fn axis<T: Scalar>(degree: &Degree, link: &Placement<T>) -> Vec3<T> {
    let axis = match degree.motion.axis() {
        Axis::Z => link.rotation.z_axis(),
        Axis::Y => link.rotation.column(1),
        Axis::X => link.rotation.column(0),
    };
    axis * T::from_f64(degree.ratio)
}

/// The motion of the degree's link at unit velocity, at a point from which the link's origin is seen at `arm`; world axes.
#[inline(always)]
pub(super) fn unit_motion<T: Scalar>(model: &Model, degree: &Degree, link: &Placement<T>, arm: Vec3<T>) -> Motion<T> {
    let axis = axis(degree, link);
    match degree.motion {
        DegreeMotion::Turn(_) => revolute::unit_motion(axis, arm),
        DegreeMotion::Shift(_) => prismatic::unit_motion(axis),
        DegreeMotion::Screw => helical::unit_motion(axis, arm, model.pitch(degree.link - 1)),
    }
}

/// The force that the acceleration `unit` of a degree takes: I S.
#[inline(always)]
pub(super) fn load<T: Scalar>(degree: &Degree, inertia: &ArticulatedInertia<T>, unit: Motion<T>) -> Force<T> {
    match degree.motion {
        DegreeMotion::Turn(_) => revolute::load(inertia, unit),
        DegreeMotion::Shift(_) => prismatic::load(inertia, unit),
        DegreeMotion::Screw => helical::load(inertia, unit),
    }
}

/// The momentum of what moves with a degree at `unit` velocity: I S.
#[inline(always)]
pub(super) fn momentum<T: Scalar>(degree: &Degree, inertia: &Inertia<T>, unit: Motion<T>) -> Force<T> {
    match degree.motion {
        DegreeMotion::Turn(_) => revolute::momentum(inertia, unit),
        DegreeMotion::Shift(_) => prismatic::momentum(inertia, unit),
        DegreeMotion::Screw => helical::momentum(inertia, unit),
    }
}

/// What a degree with this axis feels of a momentum about its link's origin.
#[inline(always)]
pub(super) fn felt<T: Scalar>(model: &Model, degree: &Degree, axis: Vec3<T>, momentum: Force<T>) -> T {
    match degree.motion {
        DegreeMotion::Turn(_) => revolute::felt(axis, momentum),
        DegreeMotion::Shift(_) => prismatic::felt(axis, momentum),
        DegreeMotion::Screw => helical::felt(axis, momentum, model.pitch(degree.link - 1)),
    }
}

/// ∂r_P/∂q_k = T_k(P) for a point P that degree k carries: e × (r_P − O) or e, with its axis e and the link's origin O.
#[inline(always)]
pub(super) fn point_column<T: Scalar>(model: &Model, degree: &Degree, link: &Placement<T>, point: Vec3<T>) -> Vec3<T> {
    let axis = axis(degree, link);
    match degree.motion {
        DegreeMotion::Turn(_) => revolute::point_column(axis, point - link.translation),
        DegreeMotion::Shift(_) => axis,
        DegreeMotion::Screw => helical::point_column(axis, point - link.translation, model.pitch(degree.link - 1)),
    }
}

/// dT_k(P)/dt, where the link turns with `motion.angular` and its origin moves with `motion.linear`, and P moves with
/// `velocity`.
#[inline(always)]
pub(super) fn point_column_rate<T: Scalar>(
    model: &Model,
    degree: &Degree,
    link: &Placement<T>,
    motion: Motion<T>,
    point: Vec3<T>,
    velocity: Vec3<T>,
) -> Vec3<T> {
    let axis = axis(degree, link);
    let rate = motion.angular.cross(axis);
    match degree.motion {
        DegreeMotion::Turn(_) => {
            revolute::point_column_rate(axis, rate, point - link.translation, velocity - motion.linear)
        }
        DegreeMotion::Shift(_) => rate,
        DegreeMotion::Screw => {
            let arms = [point - link.translation, velocity - motion.linear];
            helical::point_column_rate([axis, rate], arms, model.pitch(degree.link - 1))
        }
    }
}

/// ∂ω/∂v_k = Om_k of a link that degree k carries: its axis e if it turns, else 0.
#[inline(always)]
pub(super) fn angular_column<T: Scalar>(degree: &Degree, link: &Placement<T>) -> Vec3<T> {
    match degree.motion {
        DegreeMotion::Turn(_) | DegreeMotion::Screw => axis(degree, link),
        DegreeMotion::Shift(_) => Vec3::ZERO,
    }
}

/// ∂(m r_C)/∂q_k of all that degree k carries, whose first moments about the link's origin are `first`: e × H or m e.
#[inline(always)]
pub(super) fn first_moment_column<T: Scalar>(
    model: &Model,
    degree: &Degree,
    link: &Placement<T>,
    first: Vec3<T>,
) -> Vec3<T> {
    let axis = axis(degree, link);
    match degree.motion {
        DegreeMotion::Turn(_) => revolute::point_column(axis, first),
        DegreeMotion::Shift(_) => axis * T::from_f64(model.subtree_mass(degree.link - 1)),
        DegreeMotion::Screw => axis.times_plus(
            T::from_f64(model.pitch(degree.link - 1) * model.subtree_mass(degree.link - 1)),
            axis.cross(first),
        ),
    }
}

/// The degrees of freedom that carry `link`, from the link to the world.
#[inline(always)]
pub(super) fn path_to_world(model: &Model, link: usize) -> impl Iterator<Item = usize> + '_ {
    inwards(model, model.last_degree(link), 0)
}

/// The degrees of freedom that carry `link` but not its ancestor `end`, from the link inwards.
#[inline(always)]
pub(super) fn path_to(model: &Model, link: usize, end: usize) -> impl Iterator<Item = usize> + '_ {
    inwards(model, model.last_degree(link), model.last_degree(end))
}

/// The degrees of freedom that carry degree `k`, from the next one to the world.
#[inline(always)]
pub(super) fn carriers(model: &Model, k: usize) -> impl Iterator<Item = usize> + '_ {
    inwards(model, model.carrier(k), 0)
}

/// From the degree before `start` to the one behind `end`.
#[inline(always)]
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
#[inline(always)]
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
