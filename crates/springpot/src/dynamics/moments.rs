//! Columns and moments of moving bodies about one point for the whole robot: the common ground of the Coriolis matrix and of
//! the derivatives.

use super::{Kinematics, Workspace, joint};
use crate::model::{JointMotion, Model};
use crate::spatial::{Force, Inertia, Motion, Scalar, Symmetric3, Vec3};

/// The point, at rest, about which all of the robot is taken: where the first joint is, so that a robot far from the world's
/// origin keeps its digits.
#[inline]
pub(super) fn reference<T: Scalar>(kinematics: &Kinematics<T>) -> Vec3<T> {
    kinematics.link(1).translation
}

/// Velocities, accelerations (less gravity) where a = 0, columns and inertia forces of all links at the reference point.
pub(super) fn motions_at_rest<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, ws: &mut Workspace<T>) {
    motions(model, kinematics, None, ws);
}

/// Velocities, accelerations (less gravity) at the accelerations `a`, columns and their rates, inertias and inertia forces of
/// all links at the reference point.
///
/// With v_λ, a_λ of the parent link: ψ̇ = v_λ × J (`unit_rate`), ψ̈ = a_λ × J + v_λ × ψ̇ (`unit_second_rate`), J̇ = v × J of the
/// link itself (`unit_own_rate`), which is ψ̇ for a joint of one degree.
pub(super) fn motions<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, a: Option<&[T]>, ws: &mut Workspace<T>) {
    let (origin, v) = (reference(kinematics), kinematics.joint_velocities());
    ws.velocity[0] = Motion::ZERO;
    ws.acceleration[0] = Motion { angular: Vec3::ZERO, linear: -Vec3::from_f64(model.gravity().into()) };
    ws.force[0] = Force::ZERO;
    for j in 0..model.joint_count() {
        let (link, parent) = (kinematics.link(j + 1), model.parent_link(j));
        let arm = link.translation - origin;
        let (carrier, pushed) = (ws.velocity[parent], ws.acceleration[parent]);
        let (mut velocity, mut acceleration) = (carrier, pushed);
        for k in model.degrees_of(j) {
            let degree = &model.degrees()[k];
            let unit = joint::unit_motion(degree, link, arm);
            let rate = carrier.cross(unit);
            velocity += unit * v[degree.index];
            acceleration += rate * v[degree.index];
            acceleration += a.map_or(Motion::ZERO, |a| unit * a[degree.index]);
            (ws.unit[k], ws.unit_rate[k], ws.unit_own_rate[k]) = (unit, rate, rate);
            ws.unit_second_rate[k] = pushed.cross(unit) + carrier.cross(rate);
        }
        if model.motion(j) == JointMotion::Floating {
            for k in model.degrees_of(j) {
                ws.unit_own_rate[k] = velocity.cross(ws.unit[k]);
            }
        }
        let inertia = Inertia::from_f64(model.link_inertia(j)).rotated(&link.rotation).shifted(arm);
        let momentum = inertia * velocity;
        ws.force[j + 1] = inertia * acceleration + velocity.cross_force(momentum);
        ws.sway[j] = Sway::new(&inertia, velocity, momentum);
        (ws.composite[j], ws.velocity[j + 1], ws.acceleration[j + 1]) = (inertia, velocity, acceleration);
    }
}

/// How the mass of moving bodies sways: l = ∫ ṙ dm (linear momentum) and S = ∫ ṙ rᵀ dm.
///
/// They hold all that B = ½((v×*) I − I (v×) + (I v)×̄*) knows, with (f×̄*) w = w ×* f:
/// B (α, β) = (tr(S) α − S α, α × l) in the order (moment, force). Being integrals, they add up over bodies.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Sway<T> {
    pub(super) momentum: Vec3<T>,
    /// Rows of S − tr(S) 1.
    rows: [Vec3<T>; 3],
}

impl<T: Scalar> Sway<T> {
    pub(super) const ZERO: Self = Self { momentum: Vec3::ZERO, rows: [Vec3::ZERO; 3] };

    /// Of a body with `inertia` about the reference point that moves with `velocity`, and whose momentum is `momentum`.
    ///
    /// S = u hᵀ + \[ω\]× Π with the second moments Π = ∫ r rᵀ dm.
    #[inline]
    pub(super) fn new(inertia: &Inertia<T>, velocity: Motion<T>, momentum: Force<T>) -> Self {
        let Symmetric3 { xx, yy, zz, xy, xz, yz } = inertia.rotational.second_moments();
        let (omega, h) = (velocity.angular, inertia.first_moment);
        let column = |c: usize, pi: Vec3<T>| velocity.linear.times_plus(h.0[c], omega.cross(pi)).0;
        let (x, y, z) = (column(0, Vec3([xx, xy, xz])), column(1, Vec3([xy, yy, yz])), column(2, Vec3([xz, yz, zz])));
        let rows = [
            Vec3([-(y[1] + z[2]), y[0], z[0]]),
            Vec3([x[1], -(x[0] + z[2]), z[1]]),
            Vec3([x[2], y[2], -(x[0] + y[1])]),
        ];
        Self { momentum: momentum.linear, rows }
    }

    /// B (α, β), which β does not change.
    #[inline]
    pub(super) fn times(&self, alpha: Vec3<T>) -> Force<T> {
        let [r0, r1, r2] = self.rows;
        let angular = -Vec3([r0.dot(alpha), r1.dot(alpha), r2.dot(alpha)]);
        Force { angular, linear: alpha.cross(self.momentum) }
    }

    /// The angular part of Bᵀ (η, φ); the linear part is 0.
    #[inline]
    pub(super) fn transposed_times(&self, motion: Motion<T>) -> Vec3<T> {
        let ([x, y, z], [r0, r1, r2]) = (motion.angular.0, self.rows);
        self.momentum.cross(motion.linear) - r2.times_plus(z, r1.times_plus(y, r0 * x))
    }
}

impl<T: Scalar> std::ops::AddAssign for Sway<T> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        self.momentum += other.momentum;
        for (row, o) in self.rows.iter_mut().zip(other.rows) {
            *row += o;
        }
    }
}
