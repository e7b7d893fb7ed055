//! Inverse kinematics along a gripper path, on one continuous branch.
//!
//! The velocity is the one of least norm, v = J⁺ṙ, which makes the answer unique for redundant arms: q(t) solves
//! q' = J⁺(q)ṙ(t) from the start found near the guess. Knots along the path carry q, v and a; between them a quintic Hermite
//! polynomial gives the branch, and Newton's method the position. Around singular configurations a polynomial of higher order gives
//! q, v and a, by continuation of the branch.

mod chebyshev;
mod course;
mod follow;
mod hermite;
mod passage;
mod point;
mod solver;
mod task;

pub use course::Course;
pub use point::GripperPoint;
pub use task::Task;

use super::source::Source;
use super::{PathError, Wanted};
use crate::model::Model;
use crate::signal::Signal;
use follow::Follower;
use hermite::Knots;
use passage::Passage;
use solver::{ITERATIONS, Miss, STEP_TOLERANCE, Solver};
use std::fmt;

/// A solved gripper path.
#[derive(Clone)]
pub struct GripperPath {
    task: Task,
    knots: Knots,
    passages: Vec<Passage>,
    /// Where and why the path ends early.
    failure: Option<PathError>,
}

impl GripperPath {
    /// Follows the path from t = 0 to the end of the `course`, starting near `guess` (nv values).
    ///
    /// A path that cannot be followed to its end is no error here: [`Source::at`] says so from the time on where it happens. An
    /// interrupted one is a path that ends there.
    pub fn new(model: &Model, task: Task, guess: &[f64], course: &Course) -> Self {
        let (knots, passages, failure) = match Follower::new(Solver::new(model, &task), course) {
            Ok(mut follower) => {
                let failure = follower.follow(guess).err();
                (follower.knots, follower.passages, failure)
            }
            Err(failure) => (Knots::default(), Vec::new(), Some(failure)),
        };
        Self { task, knots, passages, failure }
    }
}

impl Source for GripperPath {
    fn at(
        &self,
        model: &Model,
        t: f64,
        q: &mut [f64],
        v: &mut [f64],
        a: &mut [f64],
    ) -> Result<Option<Wanted>, PathError> {
        let last = self.knots.times().last().copied().unwrap_or(-1.0);
        if let (true, Some(failure)) = (t > last, self.failure) {
            return Err(failure);
        }
        let target = self.task.target(t);
        let wanted = Wanted { position: target.position.0, velocity: target.velocity() };
        let next = self.passages.partition_point(|passage| passage.to < t);
        if let Some(passage) = self.passages.get(next).filter(|passage| passage.from <= t) {
            passage.polynomial.at(t, [q, v, a]);
            return Ok(Some(wanted));
        }
        self.knots.interpolate_into(t, q);
        let mut solver = Solver::new(model, &self.task);
        if let Err(Miss { distance, angle }) = solver.newton(&target, q, ITERATIONS) {
            return Err(PathError::OutOfReach { t, at: t, distance, angle });
        }
        solver.derivatives_into(&target, q, v, a);
        Ok(Some(wanted))
    }

    fn signals(&self) -> Vec<&Signal> {
        self.task.signals().collect()
    }

    fn named_signals(&self, _: &Model) -> Vec<(String, &Signal)> {
        self.task.signals().map(|signal| ("the gripper's path".to_owned(), signal)).collect()
    }

    fn solved_to(&self) -> f64 {
        STEP_TOLERANCE
    }

    fn has_path(&self) -> bool {
        true
    }

    /// As long as a stretch of the path, two knots apart, wherever it leads.
    fn reach(&self, t: f64, h: f64) -> f64 {
        let times = self.knots.times();
        let first = times.partition_point(|knot| *knot <= t).saturating_sub(1);
        let mut reach = h;
        for pair in times.get(first..).unwrap_or_default().windows(2) {
            let (ahead, apart) = (pair[0] - t, pair[1] - pair[0]);
            if ahead >= reach {
                break;
            }
            // The sides of a kink are no stretch.
            if apart > 4.0 * f64::EPSILON * pair[1] {
                reach = reach.min(ahead.max(2.0 * apart));
            }
        }
        reach
    }

    fn failure(&self) -> Option<PathError> {
        self.failure
    }
}

/// What the path was made from; the rest follows.
impl fmt::Debug for GripperPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("GripperPath").field("task", &self.task).finish_non_exhaustive()
    }
}
