//! How steps on the manifold of configurations answer to changes, of joints that turn freely.
//!
//! A change of such a joint is a twist η in its own axes, q ⊕ εη. Along q_0 ⊕ ξ with ξ' = J⁻¹(ξ) v ([`Model::tangent_rate_into`]) it is
//! η = Ad(exp −ξ) η_0 + J(ξ) δξ, δξ' = J⁻¹(ξ) δv + ∂(J⁻¹(ξ) v)/∂ξ δξ.

use super::kind::Space;
use super::manifold::{bracket_factors, bracket_slopes, vector};
use super::robot::Model;
use crate::linalg::Lu;
use crate::spatial::{Motion, Quaternion, Rotation};
use std::ops::Range;

/// As many velocities as a joint may have.
const MOST: usize = 6;

/// A matrix over the velocities of a joint, row by row; only its first rows and columns count.
pub(crate) type Turned = [[f64; MOST]; MOST];

/// A joint that turns freely: a floating one, or a spherical one.
#[derive(Debug, Clone)]
pub(crate) struct FreeTurn {
    /// Its velocities.
    pub(crate) velocities: Range<usize>,
}

impl Model {
    /// The joints that turn freely.
    pub(crate) fn free_turns(&self) -> impl Iterator<Item = FreeTurn> + '_ {
        let free = self.own_joints_and_spaces().filter(|(_, space)| matches!(space, Space::Attitude | Space::Pose));
        free.map(|(j, _)| FreeTurn { velocities: self.v_range(j) })
    }
}

impl FreeTurn {
    /// Number of its velocities.
    pub(crate) fn count(&self) -> usize {
        self.velocities.len()
    }

    fn twist(&self, of: &[f64]) -> Motion {
        let of = &of[self.velocities.clone()];
        match self.count() {
            3 => Motion { angular: vector(of), ..Motion::ZERO },
            _ => Motion { linear: vector(of), angular: vector(&of[3..]) },
        }
    }

    fn columns(&self, of: impl Fn(Motion) -> Motion) -> Turned {
        let mut matrix = Turned::default();
        for column in 0..self.count() {
            let mut unit = vec![0.0; self.velocities.end];
            unit[self.velocities.start + column] = 1.0;
            let Motion { linear, angular } = of(self.twist(&unit));
            let sum: [f64; MOST] = match self.count() {
                3 => [angular.0[0], angular.0[1], angular.0[2], 0.0, 0.0, 0.0],
                _ => [linear.0[0], linear.0[1], linear.0[2], angular.0[0], angular.0[1], angular.0[2]],
            };
            matrix.iter_mut().zip(sum).for_each(|(row, entry)| row[column] = entry);
        }
        matrix
    }

    /// Adds v ×* p: what the momentum p (nv) changes by as its axes turn along with the velocities v (nv).
    pub(crate) fn add_moment(&self, v: &[f64], p: &[f64], to: &mut [f64]) {
        let (twist, push) = (self.twist(v), self.twist(p));
        let angular = twist.angular.cross(push.angular) + twist.linear.cross(push.linear);
        let linear = twist.angular.cross(push.linear);
        let to = &mut to[self.velocities.clone()];
        let parts = if self.count() == 3 { vec![angular] } else { vec![linear, angular] };
        to.iter_mut().zip(parts.iter().flat_map(|part| part.0)).for_each(|(to, part)| *to += part);
    }

    /// J⁻¹(ξ), and ∂(J⁻¹(ξ) v)/∂ξ; ξ and v are nv.
    pub(crate) fn rate_slopes(&self, xi: &[f64], v: &[f64]) -> [Turned; 2] {
        let (xi, v) = (self.twist(xi), self.twist(v));
        let (second, fourth) = bracket_factors(xi.angular.norm());
        let [by_second, by_fourth] = bracket_slopes(xi.angular.norm());
        let by_velocity = self.columns(|v| {
            let once = xi.cross(v);
            let twice = xi.cross(once);
            v + once * 0.5 + twice * second + xi.cross(xi.cross(twice)) * fourth
        });
        let once = xi.cross(v);
        let twice = xi.cross(once);
        let thrice = xi.cross(twice);
        let by_turn = self.columns(|by| {
            let d_once = by.cross(v);
            let d_twice = by.cross(once) + xi.cross(d_once);
            let d_thrice = by.cross(twice) + xi.cross(d_twice);
            let d_fourth = by.cross(thrice) + xi.cross(d_thrice);
            // Of |ω|².
            let square = 2.0 * xi.angular.dot(by.angular);
            d_once * 0.5
                + d_twice * second
                + d_fourth * fourth
                + twice * (by_second * square)
                + xi.cross(thrice) * (by_fourth * square)
        });
        [by_velocity, by_turn]
    }

    /// Ad(exp −ξ), and J(ξ); ξ is nv.
    pub(crate) fn step_slopes(&self, xi: &[f64]) -> [Turned; 2] {
        let [inverse, _] = self.rate_slopes(xi, xi);
        let (turn, n) = (self.twist(xi), self.count());
        let rotation = Rotation::from_quaternion(Quaternion::from_rotation_vector(turn.angular));
        let shift = super::manifold::left_jacobian(turn.angular, turn.linear);
        let carried = self.columns(|by| Motion {
            linear: rotation.unrotate(by.linear - shift.cross(by.angular)),
            angular: rotation.unrotate(by.angular),
        });
        let mut lu = Lu::default();
        let regular = lu.factor(n, |matrix| {
            for (line, row) in matrix.chunks_exact_mut(n).zip(&inverse) {
                line.copy_from_slice(&row[..n]);
            }
        });
        let mut moved = Turned::default();
        for column in 0..n {
            let mut unit = [0.0; MOST];
            unit[column] = if regular { 1.0 } else { f64::NAN };
            if regular {
                lu.solve(&mut unit[..n]);
            }
            moved.iter_mut().zip(unit).for_each(|(row, entry)| row[column] = entry);
        }
        [carried, moved]
    }
}

/// Adds M x to a block of `count` numbers for each row of `to`, x being those of `from`.
pub(crate) fn add_turned(to: &mut [f64], matrix: &Turned, from: &[f64], count: usize) {
    for (to, row) in to.chunks_exact_mut(count.max(1)).zip(matrix) {
        for (entry, from) in row.iter().zip(from.chunks_exact(count.max(1))) {
            to.iter_mut().zip(from).for_each(|(to, from)| *to += entry * from);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{BodySpec, JointSpec, ModelBuilder, Parent};

    fn robot(joint: JointSpec) -> Model {
        let body = BodySpec {
            name: "b".into(),
            parent: Parent::World,
            joint,
            mass: 1.0,
            com: [0.0; 3],
            inertia: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        };
        let mut builder = ModelBuilder::new([0.0; 3]);
        builder.push(body).unwrap();
        builder.finish().unwrap()
    }

    fn applied(matrix: &Turned, to: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; to.len()];
        add_turned(&mut out, matrix, to, 1);
        out
    }

    /// Slopes of rates and of steps, small turns and large ones, against differences of the manifold itself.
    #[test]
    fn slopes_are_those_of_the_manifold() {
        for model in [robot(JointSpec::floating("f", [0.1, 0.0, 0.2])), robot(JointSpec::spherical("s", [0.0; 3]))] {
            let (free, n) = (model.free_turns().next().unwrap(), model.nv());
            let numbers = |seed: f64| -> Vec<f64> { (0..n).map(|k| (seed + 1.7 * k as f64).sin()).collect() };
            let (v, by, start) = (numbers(0.3), numbers(1.1), model.random(5));
            let moved = |at: &[f64], by: &[f64], h: f64| -> Vec<f64> {
                at.iter().zip(by).map(|(at, by)| at + h * by).collect()
            };
            for size in [0.0, 1e-3, 0.05, 0.31, 1.2] {
                let xi: Vec<f64> = numbers(2.2).iter().map(|x| size * x).collect();
                let difference = |of: &dyn Fn(f64) -> Vec<f64>| -> Vec<f64> {
                    let (h, all) = (1e-3, [1.0, -1.0, 2.0, -2.0]);
                    let [a, b, c, d] = all.map(|k| of(k * h));
                    (0..a.len()).map(|k| (8.0 * (a[k] - b[k]) - (c[k] - d[k])) / (12.0 * h)).collect()
                };
                let near = |found: &[f64], wanted: &[f64]| {
                    for (found, wanted) in found.iter().zip(wanted) {
                        assert!((found - wanted).abs() < 1e-10, "{size}: {found} {wanted}");
                    }
                };
                let rate = |xi: &[f64], v: &[f64]| {
                    let mut rate = vec![0.0; n];
                    model.tangent_rate_into(xi, v, &mut rate);
                    rate
                };
                let [by_velocity, by_turn] = free.rate_slopes(&xi, &v);
                near(&applied(&by_velocity, &by), &rate(&xi, &by));
                near(&applied(&by_turn, &by), &difference(&|h| rate(&moved(&xi, &by, h), &v)));
                let [carried, along] = free.step_slopes(&xi);
                let end = model.integrate(&start, &xi);
                let away = |q: &[f64]| model.difference(&end, q);
                let still = vec![0.0; n];
                let turned = |h: f64| model.integrate(&start, &moved(&still, &by, h));
                near(&applied(&carried, &by), &difference(&|h| away(&model.integrate(&turned(h), &xi))));
                near(&applied(&along, &by), &difference(&|h| away(&model.integrate(&start, &moved(&xi, &by, h)))));
            }
        }
    }
}
