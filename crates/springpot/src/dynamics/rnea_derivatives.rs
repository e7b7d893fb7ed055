//! Derivatives of the inverse dynamics.

use super::forces::pair::PairForce;
use super::forces::pair_stiffness::add_pair_stiffness;
use super::joint;
use super::kinematics::Kinematics;
use super::moments::motions;
use super::workspace::Workspace;
use crate::model::Model;
use crate::spatial::{Force, Motion, Scalar, Vec3};

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
#[inline(always)]
pub fn rnea_derivatives_into<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    a: &[T],
    pairs: &[PairForce<T>],
    workspace: &mut Workspace<T>,
    derivatives: &mut RneaDerivatives<T>,
) {
    differentiate_all(model, kinematics, a, workspace, derivatives);
    let RneaDerivatives { d_q, d_v, .. } = derivatives;
    for pair in pairs {
        add_pair_stiffness(model, kinematics, pair, workspace, d_q, d_v);
    }
}

/// [`rnea_derivatives_into`] without pairs.
#[inline(always)]
pub(super) fn differentiate_all<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    a: &[T],
    workspace: &mut Workspace<T>,
    derivatives: &mut RneaDerivatives<T>,
) {
    let n = model.nv();
    let RneaDerivatives { d_q, d_v, d_a } = &mut *derivatives;
    for matrix in [d_q, d_v, d_a] {
        matrix[..n * n].fill(T::ZERO);
    }
    differentiate(model, kinematics, a, workspace, derivatives, |_| true);
}

/// [`rnea_derivatives_into`] without pairs of a robot of which joints stand still but where `moves` says so, velocity by velocity: the rows of those that
/// move, and of the columns of others what ∂τ/∂q has there; other entries of these rows are 0, other rows stay.
#[inline(always)]
pub(crate) fn rnea_derivatives_of_moving<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    a: &[T],
    moves: &[bool],
    workspace: &mut Workspace<T>,
    derivatives: &mut RneaDerivatives<T>,
) {
    let n = model.nv();
    let RneaDerivatives { d_q, d_v, d_a } = &mut *derivatives;
    for row in (0..n).filter(|row| moves[*row]) {
        for matrix in [&mut *d_q, &mut *d_v, &mut *d_a] {
            matrix[row * n..(row + 1) * n].fill(T::ZERO);
        }
    }
    differentiate(model, kinematics, a, workspace, derivatives, |velocity| moves[velocity]);
}

/// Adds the derivatives to the rows of velocities that move.
#[inline(always)]
fn differentiate<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    a: &[T],
    workspace: &mut Workspace<T>,
    derivatives: &mut RneaDerivatives<T>,
    moves: impl Fn(usize) -> bool,
) {
    let n = model.nv();
    let RneaDerivatives { d_q, d_v, d_a } = derivatives;
    let (d_q, d_v, d_a) = (&mut d_q[..n * n], &mut d_v[..n * n], &mut d_a[..n * n]);
    if n == 0 {
        return;
    }
    motions(model, kinematics, Some(&a[..n]), workspace, &moves);
    let (ws, degrees) = (&mut *workspace, model.degrees());
    for (both, (rate, own)) in ws.axes.both_rates.iter_mut().zip(ws.axes.rate.iter().zip(&ws.axes.own_rate)) {
        *both = *rate + *own;
    }
    let two = T::from_f64(2.0);
    for j in (0..model.joint_count()).rev() {
        let (inner, outer) = ws.composite.split_at_mut(j);
        let (inner_moving, outer_moving) = ws.body_coriolis.split_at_mut(j);
        let (inertia, moving, load) = (&outer[0], &outer_moving[0], ws.force[j + 1]);
        for k in model.degrees_of(j) {
            let own = ws.axes.unit[k];
            if !moves(degrees[k].index) && joint::is_shift(&degrees[k]) {
                let (along, second) = (own.linear, ws.axes.second_rate[k].linear);
                let (linear, angular) = (second * inertia.mass, inertia.first_moment.cross(second));
                let felt = Force { linear, angular: angular + along.cross(load.linear) };
                for c in joint::carriers(model, k).filter(|c| moves(degrees[*c].index)) {
                    d_q[degrees[c].index * n + degrees[k].index] += ws.axes.unit[c].dot(felt);
                }
                continue;
            }
            let at_rest = *inertia * ws.axes.second_rate[k] + moving.times(ws.axes.rate[k].angular) * two;
            let by_position = at_rest + own.cross_force(load);
            let column = degrees[k].index;
            // Degrees of one joint move with one another.
            if !moves(column) {
                for c in joint::carriers(model, k).filter(|c| moves(degrees[*c].index)) {
                    let turned = if degrees[c].link == j + 1 { at_rest } else { by_position };
                    d_q[degrees[c].index * n + column] += ws.axes.unit[c].dot(turned);
                }
                continue;
            }
            let by_velocity = *inertia * ws.axes.both_rates[k] + moving.times(own.angular) * two;
            let momentum = *inertia * own;
            let swaying = moving.transposed_times(own) * two;
            let diagonal = column * n + column;
            d_q[diagonal] += own.dot(at_rest);
            d_v[diagonal] += own.dot(by_velocity);
            d_a[diagonal] += own.dot(momentum);
            for c in joint::carriers(model, k) {
                let row = degrees[c].index;
                let (upper, lower) = (row * n + column, column * n + row);
                // The outer joint feels that the inner one moves.
                d_q[lower] += ws.axes.second_rate[c].dot(momentum) + ws.axes.rate[c].angular.dot(swaying);
                if !moves(row) {
                    continue;
                }
                let carrier = ws.axes.unit[c];
                let turned = if degrees[c].link == j + 1 { at_rest } else { by_position };
                d_q[upper] += carrier.dot(turned);
                d_v[upper] += carrier.dot(by_velocity);
                let coupling = carrier.dot(momentum);
                d_a[upper] += coupling;
                d_a[lower] += coupling;
                d_v[lower] += ws.axes.both_rates[c].dot(momentum) + carrier.angular.dot(swaying);
            }
        }
        let parent = model.parent_link(j);
        if parent > 0 {
            inner[parent - 1] += *inertia;
            inner_moving[parent - 1] += *moving;
            ws.force[parent] += load;
        }
    }
    for (k, &rotor) in model.felt_rotors().iter().enumerate() {
        d_a[k * n + k] += T::from_f64(rotor);
    }
}

/// What weights of efforts carry from link to link, M sets of weights side by side: of every link in turn (the world first) M numbers.
#[derive(Debug)]
pub(super) struct Weighed<T> {
    /// Σ J_b μ_b of the degrees that carry a link.
    pub(super) motions: Vec<Motion<T>>,
    /// Σ I_c J_c μ_c of the degrees from a link on, and what sways with them, Σ 2 B_cᵀ J_c μ_c.
    pub(super) momenta: Vec<Force<T>>,
    swaying: Vec<Vec3<T>>,
}

impl<T> Weighed<T> {
    #[inline(always)]
    pub(super) fn of_nothing() -> Self {
        Self { motions: Vec::new(), momenta: Vec::new(), swaying: Vec::new() }
    }
}

/// Σ_b μ_b ∂τ_b/∂q_c of a robot of which joints stand still but where `moves` says so, for the velocities c that stand still, added to M numbers each in
/// `by_place`; μ has M numbers for each velocity, of which those that move count. As [`rnea_derivatives_of_moving`] contracted, in one pass over the links.
#[inline(always)]
pub(super) fn weigh_places<T: Scalar>(
    model: &Model,
    kinematics: &Kinematics<T>,
    a: &[T],
    (moves, workspace): (&[bool], &mut Workspace<T>),
    (weights, count): (&[T], usize),
    weighed: &mut Weighed<T>,
    by_place: &mut [T],
) {
    let n = model.nv();
    if n == 0 {
        return;
    }
    motions(model, kinematics, Some(&a[..n]), workspace, |velocity| moves[velocity]);
    let (ws, degrees, links) = (workspace, model.degrees(), model.joint_count() + 1);
    weighed.motions.clear();
    weighed.motions.resize(links * count, Motion::ZERO);
    weighed.momenta.clear();
    weighed.momenta.resize(links * count, Force::ZERO);
    weighed.swaying.clear();
    weighed.swaying.resize(links * count, Vec3::ZERO);
    for j in 0..model.joint_count() {
        let parent = model.parent_link(j);
        for m in 0..count {
            let mut motion = weighed.motions[parent * count + m];
            for k in model.degrees_of(j).filter(|k| moves[degrees[*k].index]) {
                motion += ws.axes.unit[k] * weights[degrees[k].index * count + m];
            }
            weighed.motions[(j + 1) * count + m] = motion;
        }
    }
    let two = T::from_f64(2.0);
    for j in (0..model.joint_count()).rev() {
        let (inner, outer) = ws.composite.split_at_mut(j);
        let (inner_moving, outer_moving) = ws.body_coriolis.split_at_mut(j);
        let (inertia, moving, load) = (&outer[0], &outer_moving[0], ws.force[j + 1]);
        let parent = model.parent_link(j);
        for k in model.degrees_of(j) {
            let (own, index) = (ws.axes.unit[k], degrees[k].index);
            if moves[index] {
                let (momentum, swaying) = (*inertia * own, moving.transposed_times(own) * two);
                for m in 0..count {
                    let (weight, at) = (weights[index * count + m], (j + 1) * count + m);
                    weighed.momenta[at] += momentum * weight;
                    weighed.swaying[at] += swaying * weight;
                }
                continue;
            }
            let (rate, second) = (ws.axes.rate[k], ws.axes.second_rate[k]);
            let felt = if joint::is_shift(&degrees[k]) {
                let linear = second.linear * inertia.mass;
                let angular = inertia.first_moment.cross(second.linear) + own.linear.cross(load.linear);
                Force { linear, angular }
            } else {
                *inertia * second + moving.times(rate.angular) * two + own.cross_force(load)
            };
            for m in 0..count {
                let at = (j + 1) * count + m;
                let outer = second.dot(weighed.momenta[at]) + rate.angular.dot(weighed.swaying[at]);
                by_place[index * count + m] += weighed.motions[parent * count + m].dot(felt) + outer;
            }
        }
        if parent > 0 {
            inner[parent - 1] += *inertia;
            inner_moving[parent - 1] += *moving;
            ws.force[parent] += load;
        }
        for m in 0..count {
            let (momentum, swaying) = (weighed.momenta[(j + 1) * count + m], weighed.swaying[(j + 1) * count + m]);
            weighed.momenta[parent * count + m] += momentum;
            weighed.swaying[parent * count + m] += swaying;
        }
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
