//! Derivatives of the inverse dynamics.

use super::moments::{Sway, reference, unit_motion};
use super::pair_stiffness::add_pair_stiffness;
use super::{Kinematics, PairForce, Workspace, joint};
use crate::model::Model;
use crate::spatial::{Force, Inertia, Motion, Scalar, Vec3};

/// Derivatives of τ = RNEA(q, v, a), each nv × nv, row-major: row b belongs to τ_b, column c to the variable with index c.
#[derive(Debug, Clone, PartialEq)]
pub struct RneaDerivatives<T = f64> {
    /// ∂τ/∂q.
    pub d_q: Vec<T>,
    /// ∂τ/∂v.
    pub d_v: Vec<T>,
    /// ∂τ/∂a, the mass matrix (symmetric).
    pub d_a: Vec<T>,
}

impl<T: Scalar> RneaDerivatives<T> {
    /// Room for the derivatives of `model`.
    pub fn new(model: &Model) -> Self {
        let zero = || vec![T::ZERO; model.nv() * model.nv()];
        Self { d_q: zero(), d_v: zero(), d_a: zero() }
    }
}

/// ∂τ/∂q, ∂τ/∂v and ∂τ/∂a of the inverse dynamics [`rnea_into`](super::rnea_into), with the derivatives of the pair forces
/// themselves.
///
/// `a` (nv); needs velocities; all entries of `derivatives` are written. With v, a the velocity and acceleration (less gravity)
/// of a link, λ its parent and J_c the unit motion of joint c, all at one point in world axes,
///
/// - ψ̇_c = v_λ × J_c, ψ̈_c = a_λ × J_c + v_λ × ψ̇_c, so that ∂v_i/∂q_c = J_c × v_i + ψ̇_c and ∂a_i/∂q_c = J_c × a_i + ψ̈_c − v_i × ψ̇_c;
/// - for b carrying c: ∂τ_b/∂q_c = J_b·(I_c ψ̈_c + 2 B_c ψ̇_c + J_c ×* f_c), ∂τ_b/∂v_c = J_b·(2 I_c ψ̇_c + 2 B_c J_c), ∂τ_b/∂a_c = J_b·I_c J_c;
/// - for c carrying b: ∂τ_b/∂q_c = J_b·(I_b ψ̈_c + 2 B_b ψ̇_c), ∂τ_b/∂v_c = J_b·(2 I_b ψ̇_c + 2 B_b J_c),
///
/// with I, f and B = ½((v×*) I − I (v×) + (I v)×̄*) summed over all that the outer joint carries. A pair adds, from
/// −Q_b = F ∂_b l, F ∂²l/∂q_b∂q_c + ∂_b l (∂F/∂l ∂_c l + ∂F/∂l' ∂_c l') to ∂τ_b/∂q_c and ∂_b l ∂F/∂l' ∂_c l to ∂τ_b/∂v_c. A pair
/// of length 0 gives NaN.
///
/// Sources: Carpentier and Mansard, Analytical derivatives of rigid body dynamics algorithms, RSS 2018; Singh, Russell and
/// Wensing, Efficient analytical derivatives of rigid-body dynamics using spatial vector algebra, IEEE RA-L 7(2), 2022.
pub fn rnea_derivatives_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    a: &[T],
    pairs: &[PairForce<T>],
    workspace: &mut Workspace<T>,
    derivatives: &mut RneaDerivatives<T>,
) {
    let n = model.nv();
    let RneaDerivatives { d_q, d_v, d_a } = derivatives;
    let (d_q, d_v, d_a) = (&mut d_q[..n * n], &mut d_v[..n * n], &mut d_a[..n * n]);
    for matrix in [&mut *d_q, &mut *d_v, &mut *d_a] {
        matrix.fill(T::ZERO);
    }
    if n == 0 {
        return;
    }
    outward(model, kinematics, &a[..n], workspace);
    let ws = &mut *workspace;
    let (two, force) = (T::from_f64(2.0), &mut ws.force[..=n]);
    let (unit, rate, second_rate) = (&ws.unit[..n], &ws.unit_rate[..n], &ws.unit_second_rate[..n]);
    let (composite, sway) = (&mut ws.composite[..n], &mut ws.sway[..n]);
    for c in (0..n).rev() {
        let (inertia, moving, load) = (composite[c], sway[c], force[c + 1]);
        let own = unit[c];
        let by_position = inertia * second_rate[c] + moving.times(rate[c].angular) * two + own.cross_force(load);
        let by_velocity = (inertia * rate[c] + moving.times(own.angular)) * two;
        let momentum = inertia * own;
        let swaying = moving.transposed_times(own) * two;
        d_q[c * n + c] = own.dot(by_position);
        d_v[c * n + c] = own.dot(by_velocity);
        d_a[c * n + c] = own.dot(momentum);
        for b in joint::path_to_world(model, model.parent_link(c)) {
            let (upper, lower) = (b * n + c, c * n + b);
            let carrier = unit[b];
            d_q[upper] = carrier.dot(by_position);
            d_v[upper] = carrier.dot(by_velocity);
            d_a[upper] = carrier.dot(momentum);
            d_a[lower] = d_a[upper];
            // The outer joint feels that the inner one moves.
            d_q[lower] = second_rate[b].dot(momentum) + rate[b].angular.dot(swaying);
            d_v[lower] = two * rate[b].dot(momentum) + carrier.angular.dot(swaying);
        }
        let parent = model.parent_link(c);
        if parent > 0 {
            composite[parent - 1] += inertia;
            sway[parent - 1] += moving;
            force[parent] += load;
        }
    }
    for pair in pairs {
        add_pair_stiffness(model, kinematics, pair, workspace, d_q, d_v);
    }
}

/// [`rnea_derivatives_into`] at `q` (nq), `v`, `a` (nv), allocating.
pub fn rnea_derivatives<T: Scalar>(
    model: &Model,
    q: &[T],
    v: &[T],
    a: &[T],
    pairs: &[PairForce<T>],
) -> RneaDerivatives<T> {
    let mut derivatives = RneaDerivatives::new(model);
    let kinematics = Kinematics::at_velocity(model, q, v);
    rnea_derivatives_into(model, &kinematics, a, pairs, &mut Workspace::new(model), &mut derivatives);
    derivatives
}

/// Columns, inertias and forces of all links at the reference point.
fn outward<T: Scalar>(model: &Model, kinematics: &Kinematics<T>, a: &[T], ws: &mut Workspace<T>) {
    let n = model.nv();
    let (origin, v) = (reference(kinematics), &kinematics.joint_velocities()[..n]);
    ws.velocity[0] = Motion::ZERO;
    ws.acceleration[0] = Motion { angular: Vec3::ZERO, linear: -Vec3::from_f64(model.gravity().into()) };
    ws.force[0] = Force::ZERO;
    for j in 0..n {
        let (link, parent) = (kinematics.link(j + 1), model.parent_link(j));
        let arm = link.translation - origin;
        let unit = unit_motion(model, j, link, arm);
        let (carrier, pushed) = (ws.velocity[parent], ws.acceleration[parent]);
        let rate = carrier.cross(unit);
        let velocity = carrier + unit * v[j];
        let acceleration = pushed + unit * a[j] + rate * v[j];
        let inertia = Inertia::from_f64(model.link_inertia(j)).rotated(&link.rotation).shifted(arm);
        let momentum = inertia * velocity;
        ws.force[j + 1] = inertia * acceleration + velocity.cross_force(momentum);
        ws.sway[j] = Sway::new(&inertia, velocity, momentum);
        ws.unit_second_rate[j] = pushed.cross(unit) + carrier.cross(rate);
        (ws.unit[j], ws.unit_rate[j], ws.composite[j]) = (unit, rate, inertia);
        (ws.velocity[j + 1], ws.acceleration[j + 1]) = (velocity, acceleration);
    }
}
