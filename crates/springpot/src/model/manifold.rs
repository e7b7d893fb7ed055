//! The configuration manifold: steps between configurations and what a configuration may be.

use super::dimension::Dimension;
use super::kind::Space;
use super::robot::Model;
use super::spec::Limits;
use crate::random::Random;
use crate::spatial::{Motion, Quaternion, Rotation, Vec3};
use std::f64::consts::{PI, TAU};

/// Configurations q and the tangent vectors v between them. Joint by joint; slices of a wrong length panic.
impl Model {
    /// The configuration in which every joint stands at 0: floating joints at their origin, they and spherical ones unturned.
    pub fn neutral(&self) -> Vec<f64> {
        let mut q = vec![0.0; self.nq()];
        for (j, space) in self.own_joints_and_spaces() {
            if space.quaternion().is_some() {
                q[self.q_range(j).end - 1] = 1.0;
            }
        }
        q
    }

    /// q ⊕ v: the configuration after one second at the constant velocities `v`. A floating joint follows the twist (u, ω) in
    /// its own axes, p + R V(ω) u and R exp \[ω\]×, a spherical one the latter. `q` and `out` are nq, `v` is nv.
    ///
    /// Source: Blanco-Claraco, A tutorial on SE(3) transformation parameterizations and on-manifold optimization, 2010.
    pub fn integrate_into(&self, q: &[f64], v: &[f64], out: &mut [f64]) {
        out[..self.nq()].copy_from_slice(&q[..self.nq()]);
        for (j, space) in self.own_joints_and_spaces() {
            let (q, v) = (&mut out[self.q_range(j)], &v[self.v_range(j)]);
            match space {
                Space::Line(_) | Space::Circle => q[0] += v[0],
                Space::Attitude => q.copy_from_slice(&(attitude(q) * turn(v)).normalised().0),
                Space::Pose => {
                    let attitude = attitude(&q[3..]);
                    let moved = Rotation::from_quaternion(attitude) * left_jacobian(vector(&v[3..]), vector(v));
                    for k in 0..3 {
                        q[k] += moved.0[k];
                    }
                    q[3..].copy_from_slice(&(attitude * turn(&v[3..])).normalised().0);
                }
            }
        }
    }

    /// [`Model::integrate_into`], allocating.
    pub fn integrate(&self, q: &[f64], v: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.nq()];
        self.integrate_into(q, v, &mut out);
        out
    }

    /// to ⊖ from: the velocities `v` (nv) that lead from one configuration to the other in one second, `from` ⊕ v = `to`.
    ///
    /// The shorter way round where there are two: the turn of a continuous, spherical or floating joint is at most π.
    pub fn difference_into(&self, from: &[f64], to: &[f64], v: &mut [f64]) {
        for (j, space) in self.own_joints_and_spaces() {
            let (from, to, v) = (&from[self.q_range(j)], &to[self.q_range(j)], &mut v[self.v_range(j)]);
            match space {
                Space::Line(_) => v[0] = to[0] - from[0],
                Space::Circle => v[0] = wrapped(to[0] - from[0]),
                Space::Attitude => {
                    v.copy_from_slice(&(attitude(from).conjugate() * attitude(to)).rotation_vector().0);
                }
                Space::Pose => {
                    let (start, end) = (attitude(&from[3..]), attitude(&to[3..]));
                    let turn = (start.conjugate() * end).rotation_vector();
                    let line = Vec3([to[0] - from[0], to[1] - from[1], to[2] - from[2]]);
                    let shift = inverse_left_jacobian(turn, Rotation::from_quaternion(start).unrotate(line));
                    v[..3].copy_from_slice(&shift.0);
                    v[3..].copy_from_slice(&turn.0);
                }
            }
        }
    }

    /// [`Model::difference_into`], allocating.
    pub fn difference(&self, from: &[f64], to: &[f64]) -> Vec<f64> {
        let mut v = vec![0.0; self.nv()];
        self.difference_into(from, to, &mut v);
        v
    }

    /// Brings `q` back to the manifold, where it already is but for rounding: quaternions to length 1 (with qw ≥ 0), angles
    /// of continuous joints into (−π, π]. A quaternion of length 0 becomes NaN.
    pub fn normalise(&self, q: &mut [f64]) {
        for (j, space) in self.own_joints_and_spaces() {
            let q = &mut q[self.q_range(j)];
            match space {
                Space::Line(_) => {}
                Space::Circle => q[0] = wrapped(q[0]),
                Space::Attitude => upright(q),
                Space::Pose => upright(&mut q[3..]),
            }
        }
    }

    /// A random configuration, the same for the same `seed`: within finite limits; else angles in (−π, π), shifts within one
    /// metre, all attitudes equally likely.
    pub fn random(&self, seed: u64) -> Vec<f64> {
        let mut numbers = Random::of(seed);
        let mut uniform = || numbers.share();
        let mut q = self.neutral();
        for (j, space) in self.own_joints_and_spaces() {
            let q = &mut q[self.q_range(j)];
            let Limits { lower, upper, .. } = *self.limits(j);
            let mut within = |reach: f64| {
                let (low, high) = if lower.is_finite() && upper.is_finite() { (lower, upper) } else { (-reach, reach) };
                low + (high - low) * uniform()
            };
            match space {
                Space::Line(Dimension::Angle) => q[0] = within(PI),
                Space::Line(_) => q[0] = within(1.0),
                Space::Circle => q[0] = PI * (2.0 * uniform() - 1.0),
                Space::Attitude => q.copy_from_slice(&any_attitude(&mut uniform)),
                Space::Pose => {
                    q[..3].fill_with(|| 2.0 * uniform() - 1.0);
                    q[3..].copy_from_slice(&any_attitude(&mut uniform));
                }
            }
        }
        q
    }

    /// How fast the tangent vector `xi` of q(t) = q_0 ⊕ ξ(t) changes while the robot has the velocities `v`: v itself for joints
    /// of one degree; for a floating or spherical joint v + ½ \[ξ, v\] + A \[ξ, \[ξ, v\]\] + B \[ξ, … \[ξ, v\]\] (four brackets), singular at turns
    /// of 2π. All slices are nv.
    ///
    /// Source: Bullo and Murray, Proportional derivative (PD) control on the Euclidean group, 1995 (the inverse of the
    /// exponential's differential).
    pub fn tangent_rate_into(&self, xi: &[f64], v: &[f64], rate: &mut [f64]) {
        for (j, space) in self.own_joints_and_spaces() {
            let range = self.v_range(j);
            let (xi, v, rate) = (&xi[range.clone()], &v[range.clone()], &mut rate[range]);
            match space {
                Space::Line(_) | Space::Circle => rate[0] = v[0],
                Space::Attitude => {
                    let spin = |v: &[f64]| Motion { angular: vector(v), ..Motion::ZERO };
                    rate.copy_from_slice(&bent(spin(xi), spin(v)).angular.0);
                }
                Space::Pose => {
                    let twist = |v: &[f64]| Motion { linear: vector(v), angular: vector(&v[3..]) };
                    let sum = bent(twist(xi), twist(v));
                    rate[..3].copy_from_slice(&sum.linear.0);
                    rate[3..].copy_from_slice(&sum.angular.0);
                }
            }
        }
    }

    /// How fast coordinate `k` of q changes at the velocities v.
    pub(crate) fn coordinate_rate(&self, q: &[f64], v: &[f64], k: usize) -> f64 {
        let joint = self.own_joints().find(|&j| self.q_range(j).contains(&k)).expect("a coordinate of a joint");
        let place = self.q_range(joint);
        let slopes = self.joint_space(joint).slopes(&q[place.clone()], k - place.start);
        slopes.iter().zip(&v[self.v_range(joint)]).map(|(slope, v)| slope * v).sum()
    }

    /// The joints that have coordinates of their own.
    pub fn own_joints(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.joint_count()).filter(|&j| self.followed(j).is_none())
    }

    pub(super) fn own_joints_and_spaces(&self) -> impl Iterator<Item = (usize, Space)> + '_ {
        self.own_joints().map(|j| (j, self.joint_space(j)))
    }
}

impl Space {
    /// ∂q_i/∂v of coordinate `i` of a joint that stands at `q`: by how much it changes under each of its velocities, ṗ = R u and
    /// q̇ = ½ q ⊗ (ω, 0) of a floating joint, the latter of a spherical one.
    pub(crate) fn slopes(self, q: &[f64], i: usize) -> [f64; 6] {
        let Some(first) = self.quaternion() else { return [1.0, 0.0, 0.0, 0.0, 0.0, 0.0] };
        let mut slopes = [0.0; 6];
        let units = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        if i < first {
            let turned = Rotation::from_quaternion(attitude(&q[first..]));
            slopes.iter_mut().zip(units).for_each(|(slope, unit)| *slope = (turned * Vec3(unit)).0[i]);
            return slopes;
        }
        // (½ω, 0) is a quaternion without length.
        for (slope, [x, y, z]) in slopes[first..].iter_mut().zip(units) {
            *slope = (attitude(&q[first..]) * Quaternion([0.5 * x, 0.5 * y, 0.5 * z, 0.0])).0[i - first];
        }
        slopes
    }
}

pub(super) fn vector(v: &[f64]) -> Vec3 {
    Vec3([v[0], v[1], v[2]])
}

fn attitude(q: &[f64]) -> Quaternion {
    Quaternion::new([q[0], q[1], q[2], q[3]]).normalised()
}

fn turn(v: &[f64]) -> Quaternion {
    Quaternion::from_rotation_vector(vector(v))
}

/// Length 1 and qw ≥ 0.
fn upright(q: &mut [f64]) {
    let unit = attitude(q).0;
    let sign = if unit[3] < 0.0 { -1.0 } else { 1.0 };
    q.copy_from_slice(&unit.map(|x| sign * x));
}

/// Shoemake, Uniform random rotations, Graphics Gems III, 1992.
fn any_attitude(mut uniform: impl FnMut() -> f64) -> [f64; 4] {
    let (share, first, second) = (uniform(), TAU * uniform(), TAU * uniform());
    let (a, b) = ((1.0 - share).sqrt(), share.sqrt());
    [a * first.sin(), a * first.cos(), b * second.sin(), b * second.cos()]
}

/// The sum of brackets of [`Model::tangent_rate_into`].
fn bent(xi: Motion, v: Motion) -> Motion {
    let (second, fourth) = bracket_factors(xi.angular.norm());
    let once = xi.cross(v);
    let twice = xi.cross(once);
    v + once * 0.5 + twice * second + xi.cross(xi.cross(twice)) * fourth
}

/// The angle in (−π, π] that differs from `angle` by full turns.
fn wrapped(angle: f64) -> f64 {
    let rest = angle.rem_euclid(TAU);
    if rest > PI { rest - TAU } else { rest }
}

/// V(ω) u with V = 1 + (1 − cos θ)/θ² \[ω\]× + (θ − sin θ)/θ³ \[ω\]×²: how far a constant twist (u, ω) leads in one second.
pub(super) fn left_jacobian(omega: Vec3, u: Vec3) -> Vec3 {
    let square = omega.dot(omega);
    let theta = square.sqrt();
    let (first, second) = if theta < 1e-2 {
        // Both series, to 1e-17.
        let first = 0.5 - square / 24.0 * (1.0 - square / 30.0 * (1.0 - square / 56.0));
        (first, (1.0 - square / 20.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0))) / 6.0)
    } else {
        let half = (0.5 * theta).sin();
        (2.0 * half * half / square, (theta - theta.sin()) / (square * theta))
    };
    let once = omega.cross(u);
    omega.cross(once).times_plus(second, once.times_plus(first, u))
}

/// V(ω)⁻¹ u with V⁻¹ = 1 − ½ \[ω\]× + (1 − (θ/2) cot(θ/2))/θ² \[ω\]×².
fn inverse_left_jacobian(omega: Vec3, u: Vec3) -> Vec3 {
    let square = omega.dot(omega);
    let half = 0.5 * square.sqrt();
    let second = if half < 5e-2 {
        1.0 / 12.0 + square / 720.0 * (1.0 + square / 42.0 * (1.0 + square / 40.0))
    } else {
        (1.0 - half / half.tan()) / square
    };
    let once = omega.cross(u);
    omega.cross(once).times_plus(second, once.times_plus(-0.5, u))
}

/// A and B of [`Model::tangent_rate_into`] for a turn of θ: with α = (θ/2) cot(θ/2) and β = (θ/2)²/sin²(θ/2),
/// A = (2 (1 − α) + (α − β)/2)/θ², B = (1 − α + (α − β)/2)/θ⁴.
pub(super) fn bracket_factors(theta: f64) -> (f64, f64) {
    let square = theta * theta;
    if theta < 0.3 {
        // 1/12 + O(θ⁴) and −1/720 + O(θ²), from the series of α and β.
        let second =
            1.0 / 12.0 - square * square * (1.0 / 30_240.0 + square * (1.0 / 604_800.0 + square / 15_966_720.0));
        let fourth = -1.0 / 720.0 - square * (1.0 / 15_120.0 + square * (1.0 / 403_200.0 + square / 11_975_040.0));
        return (second, fourth);
    }
    let half = 0.5 * theta;
    let (alpha, beta) = (half / half.tan(), (half / half.sin()).powi(2));
    let spread = 0.5 * (alpha - beta);
    ((2.0 * (1.0 - alpha) + spread) / square, (1.0 - alpha + spread) / (square * square))
}

/// Their derivatives by θ²: with α and β as there, dα/dθ² = (α − β)/2θ² and dβ/dθ² = β (1 − α)/θ².
pub(super) fn bracket_slopes(theta: f64) -> [f64; 2] {
    let square = theta * theta;
    if theta < 0.3 {
        let second = -square * (1.0 / 15_120.0 + square * (1.0 / 201_600.0 + square / 3_991_680.0));
        let fourth = -1.0 / 15_120.0 - square * (1.0 / 201_600.0 + square / 3_991_680.0);
        return [second, fourth];
    }
    let half = 0.5 * theta;
    let (alpha, beta) = (half / half.tan(), (half / half.sin()).powi(2));
    let [by_alpha, by_beta] = [0.5 * (alpha - beta) / square, beta * (1.0 - alpha) / square];
    let (second, fourth) = bracket_factors(theta);
    let spread = 0.5 * (by_alpha - by_beta);
    [(spread - 2.0 * by_alpha - second) / square, ((spread - by_alpha) / square - 2.0 * fourth) / square]
}

#[cfg(test)]
mod tests {
    use crate::model::{BodySpec, JointSpec, ModelBuilder, Parent};

    #[test]
    fn slopes_are_those_of_small_steps() {
        let body = BodySpec {
            name: "b".into(),
            parent: Parent::World,
            joint: JointSpec::floating("f", [0.0; 3]),
            mass: 1.0,
            com: [0.0; 3],
            inertia: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        };
        let mut builder = ModelBuilder::new([0.0; 3]);
        builder.push(body).unwrap();
        let model = builder.finish().unwrap();
        let (q, h) = (model.random(7), 1e-6);
        for i in 0..model.nq() {
            let slopes = model.joint_space(0).slopes(&q, i);
            for k in 0..model.nv() {
                let mut v = vec![0.0; model.nv()];
                v[k] = h;
                let ahead = model.integrate(&q, &v)[i];
                v[k] = -h;
                let back = model.integrate(&q, &v)[i];
                let wanted = (ahead - back) / (2.0 * h);
                assert!((slopes[k] - wanted).abs() < 1e-9, "{i} {k}: {} {wanted}", slopes[k]);
            }
        }
    }
}
