//! Columns and moments of moving bodies about one point for the whole robot: the common ground of the Coriolis matrix and of
//! the derivatives.

use super::body_coriolis::BodyCoriolis;
use super::joint;
use super::kinematics::Kinematics;
use super::workspace::Workspace;
use crate::model::Model;
use crate::spatial::{Force, Inertia, Motion, Scalar, Vec3};

/// The point, at rest, about which all of the robot is taken: where the first joint is, so that a robot far from the world's
/// origin keeps its digits.
#[inline(always)]
pub(super) fn reference<T: Scalar>(kinematics: &Kinematics<T>) -> Vec3<T> {
    kinematics.link(1).translation
}

/// Columns and inertias of all links at the reference point.
#[inline(always)]
pub(super) fn at_reference<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, ws: &mut Workspace<T>) {
    let origin = reference(kinematics);
    for j in 0..model.joint_count() {
        let link = kinematics.link(j + 1);
        let arm = link.translation - origin;
        for k in model.degrees_of(j) {
            ws.axes.unit[k] = joint::unit_motion(model, &model.degrees()[k], link, arm);
        }
        ws.composite[j] = Inertia::from_f64(model.link_inertia(j)).rotated(&link.rotation).shifted(arm);
    }
}

/// Velocities, accelerations (less gravity) where a = 0, columns and inertia forces of all links at the reference point.
#[inline(always)]
pub(super) fn motions_at_rest<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, ws: &mut Workspace<T>) {
    motions(model, kinematics, None, ws, |_| true);
}

/// Velocities, accelerations (less gravity) at the accelerations `a`, columns and their rates, inertias and inertia forces of
/// all links at the reference point.
///
/// With v_λ, a_λ of the parent link: ψ̇ = v_λ × J (`unit_rate`), ψ̈ = a_λ × J + v_λ × ψ̇ (`unit_second_rate`), J̇ = v × J of the
/// link itself (`unit_own_rate`), which is ψ̇ for a joint of one degree.
///
/// Joints stand still of which no velocity `moves`: of these there are no `unit_own_rate`.
#[inline(always)]
pub(super) fn motions<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    a: Option<&[T]>,
    ws: &mut Workspace<T>,
    moves: impl Fn(usize) -> bool,
) {
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
            let unit = joint::unit_motion(model, degree, link, arm);
            if !moves(degree.index) && joint::is_shift(degree) {
                let (rate, second) = (swept(carrier, unit), swept(pushed, unit));
                let turned = swept(carrier, rate);
                (ws.axes.unit[k], ws.axes.rate[k], ws.axes.second_rate[k]) = (unit, rate, second + turned);
                continue;
            }
            let rate = carrier.cross(unit);
            velocity += unit * v[degree.index];
            acceleration += rate * v[degree.index];
            acceleration += if let Some(a) = a { unit * a[degree.index] } else { Motion::ZERO };
            (ws.axes.unit[k], ws.axes.rate[k], ws.axes.own_rate[k]) = (unit, rate, rate);
            ws.axes.second_rate[k] = pushed.cross(unit) + carrier.cross(rate);
        }
        if model.degrees_of(j).len() > 1 {
            for k in model.degrees_of(j) {
                ws.axes.own_rate[k] = velocity.cross(ws.axes.unit[k]);
            }
        }
        (ws.velocity[j + 1], ws.acceleration[j + 1]) = (velocity, acceleration);
        if *model.link_inertia(j) == Inertia::ZERO {
            // A place: it carries others.
            (ws.force[j + 1], ws.body_coriolis[j], ws.composite[j]) = (Force::ZERO, BodyCoriolis::ZERO, Inertia::ZERO);
            continue;
        }
        let inertia = Inertia::from_f64(model.link_inertia(j)).rotated(&link.rotation).shifted(arm);
        let momentum = inertia * velocity;
        ws.force[j + 1] = inertia * acceleration + velocity.cross_force(momentum);
        ws.body_coriolis[j] = BodyCoriolis::new(&inertia, velocity, momentum);
        ws.composite[j] = inertia;
    }
}

/// What turns `shift` along: ω × u.
#[inline(always)]
fn swept<T: Scalar>(motion: Motion<T>, shift: Motion<T>) -> Motion<T> {
    Motion { angular: Vec3::ZERO, linear: motion.angular.cross(shift.linear) }
}
