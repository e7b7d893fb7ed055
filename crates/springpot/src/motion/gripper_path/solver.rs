//! The inverse kinematics at one time.
//!
//! The velocity is the one of least norm, v = J⁺ṙ, and a = J⁺(r̈ − J̇v) + N·J̇ᵀ·J⁺ᵀv with the null-space projector N: both J a + J̇v = r̈
//! and a = dv/dt hold.

use super::hermite::Knot;
use super::task::{CONDITIONS, Residual, Target, Task};
use crate::dynamics::Kinematics;
use crate::linalg::LeastNorm;
use crate::model::Model;

/// Newton stops when its step is below this, rad or m: forces need the coordinates to rounding.
pub(in crate::motion) const STEP_TOLERANCE: f64 = 2e-11;

/// A point counts as reached within this distance, m (rad for the orientation).
const REACHED: f64 = 1e-9;

/// Newton iterations from a good guess, and from the user's.
pub(super) const ITERATIONS: usize = 40;
pub(super) const START_ITERATIONS: usize = 400;

/// How far the gripper stays away from where it should be: m, rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Miss {
    pub(super) distance: f64,
    pub(super) angle: f64,
}

/// What the model and the task need at one time.
pub(super) struct Solver<'a> {
    pub(super) model: &'a Model,
    pub(super) task: &'a Task,
    pub(super) freedom: Freedom,
    kinematics: Kinematics,
    least: LeastNorm<CONDITIONS>,
    rates: Vec<f64>,
    step: Vec<f64>,
    before: Vec<f64>,
}

/// What a configuration of the robot leaves to choose, away from singular ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Freedom {
    /// Conditions that are independent.
    pub(super) rank: usize,
    /// Whether coordinates remain that the path does not determine, though they move the gripper.
    pub(super) is_redundant: bool,
}

impl<'a> Solver<'a> {
    pub(super) fn new(model: &'a Model, task: &'a Task) -> Self {
        let n = model.nv();
        Self {
            model,
            task,
            freedom: Freedom { rank: task.size(), is_redundant: false },
            kinematics: Kinematics::new(model),
            least: LeastNorm::new(task.size(), n),
            rates: vec![0.0; task.size() * n],
            step: vec![0.0; n],
            before: vec![0.0; n],
        }
    }

    fn residual(&mut self, target: &Target, q: &[f64]) -> Residual {
        self.kinematics.update_position(self.model, q);
        self.task.residual(&self.kinematics, target)
    }

    /// Takes J where the kinematics are.
    fn take_jacobian(&mut self) {
        let Self { model, task, kinematics, least, .. } = self;
        least.take(|rows| task.jacobian_into(model, kinematics, rows));
    }

    /// Looks at the freedom in general position: of configurations around `q`, those that leave least of it.
    pub(super) fn look_around(&mut self, q: &[f64]) {
        let (mut rank, mut moving) = (0, vec![false; q.len()]);
        for k in 0..4 {
            let aside = |j: usize| 0.4 * (1.7 * (k * q.len() + j) as f64 + 0.6).sin();
            let aside: Vec<f64> = q.iter().enumerate().map(|(j, q)| q + aside(j)).collect();
            self.kinematics.update_position(self.model, &aside);
            self.take_jacobian();
            rank = rank.max(self.least.rank());
            moving.iter_mut().zip(self.least.moving()).for_each(|(all, moves)| *all |= moves);
        }
        self.freedom = Freedom { rank, is_redundant: moving.iter().filter(|moves| **moves).count() > rank };
    }

    /// How far J is from losing rank at t, near `q`; 0 where the path is not reached.
    pub(super) fn conditioning(&mut self, t: f64, q: &mut [f64]) -> f64 {
        if self.newton(&self.task.target(t), q, ITERATIONS).is_err() {
            return 0.0;
        }
        self.kinematics.update_position(self.model, q);
        self.take_jacobian();
        self.least.conditioning(self.freedom.rank)
    }

    /// Least-norm Newton steps, damped while the goal is far or the Jacobian nearly singular, halved while they do not help.
    pub(super) fn newton(&mut self, target: &Target, q: &mut [f64], iterations: usize) -> Result<(), Miss> {
        let mut residual = self.residual(target, q);
        for _ in 0..iterations {
            self.take_jacobian();
            let error = norm(&residual.error);
            let damping = if self.least.is_regular() && error <= 0.1 { 0.0 } else { 0.1 * error.min(1.0) };
            let mut step = std::mem::take(&mut self.step);
            if damping == 0.0 {
                self.least.solve_roughly_into(&residual.error, &mut step);
            } else {
                self.least.solve_damped_into(&residual.error, damping, &mut step);
            }
            // At most half a radian at a time keeps the branch.
            let longest = step.iter().fold(0.0f64, |m, s| m.max(s.abs()));
            let mut scale = (0.5 / longest).min(1.0);
            self.before.copy_from_slice(q);
            loop {
                q.iter_mut().zip(&self.before).zip(&step).for_each(|((q, q0), s)| *q = q0 + scale * s);
                residual = self.residual(target, q);
                if norm(&residual.error) < error || is_settled(scale * longest) {
                    break;
                }
                scale *= 0.5;
            }
            self.step = step;
            if is_settled(scale * longest) {
                break;
            }
        }
        let Residual { distance, angle, .. } = residual;
        if distance <= REACHED && angle <= REACHED { Ok(()) } else { Err(Miss { distance, angle }) }
    }

    /// v and a on the path at q, where J has its full rank.
    pub(super) fn derivatives_into(&mut self, target: &Target, q: &[f64], v: &mut [f64], a: &mut [f64]) {
        self.kinematics.update_position(self.model, q);
        self.take_jacobian();
        self.least.solve_into(&target.rate, v);
        self.kinematics.update_velocity(self.model, q, v);
        self.task.jacobian_rate_into(self.model, &self.kinematics, &mut self.rates);
        let n = v.len();
        let mut bias = [0.0; CONDITIONS];
        for ((bias, wanted), row) in bias.iter_mut().zip(target.acceleration).zip(self.rates.chunks(n)) {
            *bias = wanted - row.iter().zip(&*v).map(|(j, v)| j * v).sum::<f64>();
        }
        self.least.solve_into(&bias, a);
        if self.least.rank() < n {
            let y = self.least.transpose_solve(v);
            let drift = &mut self.step;
            for (j, drift) in drift.iter_mut().enumerate() {
                *drift = self.rates.chunks(n).zip(y).map(|(row, y)| row[j] * y).sum();
            }
            self.least.project_to_null_space(drift);
            a.iter_mut().zip(drift).for_each(|(a, d)| *a += *d);
        }
    }

    /// The path's q, v, a at t, from the guess `q`.
    pub(super) fn knot(&mut self, t: f64, mut q: Vec<f64>, iterations: usize) -> Result<Knot, Miss> {
        let target = self.task.target(t);
        self.newton(&target, &mut q, iterations)?;
        let [mut v, mut a] = [vec![0.0; q.len()], vec![0.0; q.len()]];
        self.derivatives_into(&target, &q, &mut v, &mut a);
        Ok(Knot { t, q, v, a, conditioning: self.least.conditioning(self.freedom.rank) })
    }

    /// Whether nothing is to move at t.
    pub(super) fn rests(&self, t: f64) -> bool {
        let target = self.task.target(t);
        target.rate.iter().chain(&target.acceleration).all(|x| *x == 0.0)
    }

    /// What of x moves the gripper not at all, at the configuration that was last looked at; the largest of it.
    pub(super) fn idle_part(&self, x: &mut [f64]) -> f64 {
        self.least.project_to_null_space(x);
        x.iter().fold(0.0, |m, x| m.max(x.abs()))
    }

    /// v = J⁺ṙ at t and q.
    fn velocity_into(&mut self, t: f64, q: &[f64], v: &mut [f64]) {
        self.kinematics.update_position(self.model, q);
        self.take_jacobian();
        self.least.solve_roughly_into(&self.task.target(t).rate, v);
    }

    /// q at `to` by q' = J⁺ṙ: the modified midpoint rule with 2, 4, 6, 8 steps, extrapolated to order 8 (Gragg, Bulirsch, Stoer).
    pub(super) fn extrapolate(&mut self, from: &Knot, to: f64) -> Vec<f64> {
        const STEPS: [usize; 4] = [2, 4, 6, 8];
        let n = from.q.len();
        let mut row: [Vec<f64>; STEPS.len()] = Default::default();
        let [mut previous, mut current, mut rate] = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
        for (k, &steps) in STEPS.iter().enumerate() {
            let h = (to - from.t) / steps as f64;
            previous.copy_from_slice(&from.q);
            (0..n).for_each(|j| current[j] = from.q[j] + h * from.v[j]);
            for i in 1..steps {
                self.velocity_into(from.t + i as f64 * h, &current, &mut rate);
                for j in 0..n {
                    (previous[j], current[j]) = (current[j], previous[j] + 2.0 * h * rate[j]);
                }
            }
            self.velocity_into(to, &current, &mut rate);
            let smoothed = (0..n).map(|j| 0.5 * (current[j] + previous[j] + h * rate[j])).collect();
            // Aitken–Neville in the squares of the step numbers.
            let mut newest: Vec<f64> = smoothed;
            for i in 0..k {
                let ratio = (steps as f64 / STEPS[k - i - 1] as f64).powi(2);
                let next = newest.iter().zip(&row[i]).map(|(new, old)| new + (new - old) / (ratio - 1.0)).collect();
                row[i] = std::mem::replace(&mut newest, next);
            }
            row[k] = newest;
        }
        row.into_iter().next_back().unwrap_or_default()
    }
}

/// Whether a Newton step changes nothing any more; one that is no number leads nowhere either.
fn is_settled(step: f64) -> bool {
    step.is_nan() || step < STEP_TOLERANCE
}

fn norm(values: &[f64]) -> f64 {
    values.iter().map(|x| x * x).sum::<f64>().sqrt()
}
