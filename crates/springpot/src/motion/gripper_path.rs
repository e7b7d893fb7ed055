//! Inverse kinematics along a gripper path, on one continuous branch.
//!
//! The velocity is the one of least norm, v = J⁺ṙ, which makes the answer unique for redundant arms: q(t) solves
//! q' = J⁺(q)ṙ(t) from the start found near the guess. Knots along the path carry q, v and a; between them a quintic Hermite
//! polynomial gives the branch, and Newton's method the position.
//!
//! a = J⁺(r̈ − J̇v) + N·J̇ᵀ·J⁺ᵀv with the null-space projector N: both J a + J̇v = r̈ and a = dv/dt hold.

use super::Wanted;
use super::hermite::{Knot, quintic_into};
use super::kinks::{branch, locate};
use super::pseudo_inverse::PseudoInverse;
use super::task::{Residual, Target};
use crate::dynamics::Kinematics;
use crate::model::Model;
use crate::signal::Signal;

pub use super::task::Task;

/// Newton stops when its step is below this, rad or m: forces need the coordinates to rounding.
const STEP_TOLERANCE: f64 = 2e-11;

/// A point counts as reached within this distance, m (rad for the orientation).
const REACHED: f64 = 1e-9;

/// Newton iterations from a good guess, and from the user's.
const ITERATIONS: usize = 40;
const START_ITERATIONS: usize = 400;

/// The gripper cannot follow its path.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("the gripper cannot reach its path at t = {t} s: {distance:.3e} m and {angle:.3e} rad away")]
pub struct PathError {
    /// Time, s.
    pub t: f64,
    /// Distance to the wanted point, m.
    pub distance: f64,
    /// Angle to the wanted orientation, rad.
    pub angle: f64,
}

/// A solved gripper path.
#[derive(Debug, Clone)]
pub struct GripperPath {
    task: Task,
    knots: Vec<Knot>,
    /// Where and why the path ends early.
    failure: Option<PathError>,
}

impl GripperPath {
    /// Follows the path from t = 0 to `end`, starting near `guess` (nv values).
    ///
    /// A path that cannot be followed to its end is no error here: [`Self::at`] says so from the time on where it happens.
    pub fn new(model: &Model, task: Task, guess: &[f64], end: f64) -> Self {
        let mut solver = Solver { model, task: &task, kinematics: Kinematics::new(model) };
        let (knots, failure) = match solver.start(guess) {
            Ok(start) => solver.follow(start, end),
            Err(failure) => (Vec::new(), Some(failure)),
        };
        Self { task, knots, failure }
    }

    /// q, v, a at t and the wanted position.
    ///
    /// # Errors
    /// [`PathError`] from the time on from which the path cannot be followed.
    pub fn at(&self, model: &Model, t: f64, q: &mut [f64], v: &mut [f64], a: &mut [f64]) -> Result<Wanted, PathError> {
        let last = self.knots.last().map_or(-1.0, |knot| knot.t);
        if let (true, Some(failure)) = (t > last, self.failure) {
            return Err(failure);
        }
        match &self.knots[..] {
            // A path that cannot be followed at all still has its start.
            [only] => q.copy_from_slice(&only.q),
            knots => {
                let next = knots.partition_point(|knot| knot.t < t).clamp(1, knots.len() - 1);
                quintic_into(&knots[next - 1], &knots[next], t, q);
            }
        }
        let mut solver = Solver { model, task: &self.task, kinematics: Kinematics::new(model) };
        let target = self.task.target(t);
        solver.newton(&target, t, q, ITERATIONS)?;
        let derivatives = solver.derivatives(&target, q);
        v.copy_from_slice(&derivatives.0);
        a.copy_from_slice(&derivatives.1);
        Ok(Wanted { position: target.position.0 })
    }

    /// Where and why the path ends early.
    pub fn failure(&self) -> Option<PathError> {
        self.failure
    }

    /// The signals of the path.
    pub fn signals(&self) -> impl Iterator<Item = &Signal> {
        self.task.signals()
    }
}

struct Solver<'a> {
    model: &'a Model,
    task: &'a Task,
    kinematics: Kinematics,
}

impl Solver<'_> {
    fn residual(&mut self, target: &Target, q: &[f64]) -> Residual {
        self.kinematics.update_position(self.model, q);
        self.task.residual(&self.kinematics, target)
    }

    /// Least-norm Newton steps, damped while the goal is far or the Jacobian nearly singular, halved while they do not help.
    fn newton(&mut self, target: &Target, t: f64, q: &mut [f64], iterations: usize) -> Result<(), PathError> {
        let mut residual = self.residual(target, q);
        for _ in 0..iterations {
            let inverse = PseudoInverse::new(&self.task.jacobian(self.model, &self.kinematics));
            let error = norm(&residual.error);
            let near_singular = inverse.conditioning() < 1e-3 || inverse.rank() < self.task.size();
            let damping = if near_singular || error > 0.1 { 0.1 * error.min(1.0) } else { 0.0 };
            let mut step = inverse.solve(&residual.error, damping);
            // At most half a radian at a time keeps the branch.
            let longest = step.iter().fold(0.0f64, |m, s| m.max(s.abs()));
            let mut scale = (0.5 / longest).min(1.0);
            let before = q.to_vec();
            loop {
                q.iter_mut().zip(&before).zip(&step).for_each(|((q, q0), s)| *q = q0 + scale * s);
                residual = self.residual(target, q);
                if norm(&residual.error) < error || is_settled(scale * longest) {
                    break;
                }
                scale *= 0.5;
            }
            step.iter_mut().for_each(|s| *s *= scale);
            if is_settled(scale * longest) {
                break;
            }
        }
        let Residual { distance, angle, .. } = residual;
        if distance <= REACHED && angle <= REACHED { Ok(()) } else { Err(PathError { t, distance, angle }) }
    }

    /// v and a on the path at q.
    fn derivatives(&mut self, target: &Target, q: &[f64]) -> (Vec<f64>, Vec<f64>) {
        self.kinematics.update_position(self.model, q);
        let inverse = PseudoInverse::new(&self.task.jacobian(self.model, &self.kinematics));
        let v = inverse.solve(&target.rate, 0.0);
        self.kinematics.update_velocity(self.model, q, &v);
        let rates = self.task.jacobian_rate(self.model, &self.kinematics);
        let bias: Vec<f64> = rates
            .iter()
            .zip(&target.acceleration)
            .map(|(row, wanted)| wanted - row.iter().zip(&v).map(|(j, v)| j * v).sum::<f64>())
            .collect();
        let mut a = inverse.solve(&bias, 0.0);
        if inverse.rank() < v.len() {
            let y = inverse.transpose_solve(&v);
            let mut drift: Vec<f64> =
                (0..v.len()).map(|j| rates.iter().zip(&y).map(|(row, y)| row[j] * y).sum()).collect();
            inverse.project_to_null_space(&mut drift);
            a.iter_mut().zip(drift).for_each(|(a, d)| *a += d);
        }
        (v, a)
    }

    fn knot(&mut self, t: f64, mut q: Vec<f64>, iterations: usize) -> Result<Knot, PathError> {
        let target = self.task.target(t);
        self.newton(&target, t, &mut q, iterations)?;
        let (v, a) = self.derivatives(&target, &q);
        Ok(Knot { t, q, v, a })
    }

    fn start(&mut self, guess: &[f64]) -> Result<Knot, PathError> {
        self.knot(0.0, guess.to_vec(), START_ITERATIONS)
    }

    /// Knots from `start` to `end`, and why they end early.
    fn follow(&mut self, start: Knot, end: f64) -> (Vec<Knot>, Option<PathError>) {
        self.kinematics.update_position(self.model, &start.q);
        let rank = PseudoInverse::new(&self.task.jacobian(self.model, &self.kinematics)).rank();
        let redundant = self.model.nv() > rank;
        let mut stops: Vec<f64> = self.task.signals().flat_map(|signal| signal.break_points()).copied().collect();
        stops.retain(|t| 0.0 < *t && *t < end);
        stops.push(end);
        stops.sort_by(f64::total_cmp);
        stops.dedup();
        let has_kinks = self.task.signals().any(|signal| signal.has_kinks());

        let (mut knots, mut h) = (vec![start], end / 64.0);
        for stop in stops {
            while knots.last().expect("the start").t < stop {
                let from = knots.last().expect("the start").clone();
                let mut to = if from.t + h < stop { from.t + h } else { stop };
                if has_kinks && self.branch(to) != self.branch(from.t) {
                    let (before, after) = locate(|t| self.branch(t), from.t, to);
                    if before <= from.t {
                        // Across the kink the coordinates go on, their rates do not.
                        match self.knot(after, from.q.clone(), ITERATIONS) {
                            Ok(knot) => knots.push(knot),
                            Err(failure) => return (knots, Some(failure)),
                        }
                        continue;
                    }
                    to = before;
                }
                match self.advance(&from, to, redundant) {
                    Ok((middle, last, growth)) => {
                        knots.extend([middle, last]);
                        if to == from.t + h || growth < 1.0 {
                            h = (h * growth).min(end / 16.0);
                        }
                    }
                    Err(failure) => {
                        h = 0.3 * (to - from.t);
                        if h < 1e-10 * end {
                            return (knots, failure.or(Some(self.nearest(&from, to))));
                        }
                    }
                }
            }
        }
        (knots, None)
    }

    fn branch(&self, t: f64) -> u64 {
        branch(self.task.signals(), t)
    }

    /// How near the gripper comes at `t` from the configuration of `from`.
    fn nearest(&mut self, from: &Knot, t: f64) -> PathError {
        let target = self.task.target(t);
        let Residual { distance, angle, .. } = self.residual(&target, &from.q);
        PathError { t, distance, angle }
    }

    /// Knots at the middle and at `to`, and by how much the next stretch may be longer; an error asks for a shorter one.
    fn advance(&mut self, from: &Knot, to: f64, redundant: bool) -> Result<(Knot, Knot, f64), Option<PathError>> {
        let h = to - from.t;
        let middle_t = from.t + 0.5 * h;
        let (middle, last, integration) = if redundant {
            let coarse = self.extrapolate(from, to);
            let middle = self.extrapolate(from, middle_t);
            let middle = self.knot(middle_t, middle, ITERATIONS).map_err(Some)?;
            let fine = self.extrapolate(&middle, to);
            let difference = distance(&coarse, &fine);
            (middle, self.knot(to, fine, ITERATIONS).map_err(Some)?, difference)
        } else {
            let middle = self.knot(middle_t, taylor(from, 0.5 * h), ITERATIONS).map_err(Some)?;
            let last = self.knot(to, taylor(&middle, 0.5 * h), ITERATIONS).map_err(Some)?;
            (middle, last, 0.0)
        };
        let mut guess = vec![0.0; from.q.len()];
        quintic_into(from, &last, middle_t, &mut guess);
        // Halving the stretch, as the middle knot does, divides the interpolation error by 64.
        let tolerance = if redundant { 3e-10 } else { 1e-5 };
        let error = (distance(&guess, &middle.q) / tolerance).max(integration / 1e-11);
        if error > 1.0 || !error.is_finite() {
            return Err(None);
        }
        Ok((middle, last, (0.8 * error.powf(-1.0 / 6.0)).clamp(0.5, 3.0)))
    }

    /// q at `to` by q' = J⁺ṙ: the modified midpoint rule with 2, 4, 6, 8 steps, extrapolated to order 8 (Gragg, Bulirsch, Stoer).
    fn extrapolate(&mut self, from: &Knot, to: f64) -> Vec<f64> {
        const STEPS: [usize; 4] = [2, 4, 6, 8];
        let mut row: Vec<Vec<f64>> = Vec::new();
        for (k, &steps) in STEPS.iter().enumerate() {
            let h = (to - from.t) / steps as f64;
            let mut previous = from.q.clone();
            let mut current = sum(&from.q, &from.v, h);
            for i in 1..steps {
                let rate = self.velocity(from.t + i as f64 * h, &current);
                let next = sum(&previous, &rate, 2.0 * h);
                previous = std::mem::replace(&mut current, next);
            }
            let rate = self.velocity(to, &current);
            let smoothed: Vec<f64> =
                (0..current.len()).map(|j| 0.5 * (current[j] + previous[j] + h * rate[j])).collect();
            // Aitken–Neville in the squares of the step numbers.
            let mut next = vec![smoothed];
            for (j, older) in row.iter().enumerate() {
                let ratio = (steps as f64 / STEPS[k - j - 1] as f64).powi(2);
                next.push(next[j].iter().zip(older).map(|(new, old)| new + (new - old) / (ratio - 1.0)).collect());
            }
            row = next;
        }
        row.pop().expect("four rows")
    }

    fn velocity(&mut self, t: f64, q: &[f64]) -> Vec<f64> {
        self.kinematics.update_position(self.model, q);
        PseudoInverse::new(&self.task.jacobian(self.model, &self.kinematics)).solve(&self.task.target(t).rate, 0.0)
    }
}

/// Whether a Newton step changes nothing any more; one that is no number leads nowhere either.
fn is_settled(step: f64) -> bool {
    step.is_nan() || step < STEP_TOLERANCE
}

fn taylor(knot: &Knot, h: f64) -> Vec<f64> {
    (0..knot.q.len()).map(|j| knot.q[j] + h * (knot.v[j] + 0.5 * h * knot.a[j])).collect()
}

fn sum(q: &[f64], v: &[f64], h: f64) -> Vec<f64> {
    q.iter().zip(v).map(|(q, v)| q + h * v).collect()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn norm(values: &[f64]) -> f64 {
    values.iter().map(|x| x * x).sum::<f64>().sqrt()
}
