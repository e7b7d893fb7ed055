//! The periodic past of an element along a motion given in advance.

use super::evaluate::{Evaluation, Scratch};
use super::pose::State;
use crate::law::{Past, Periodic};
use crate::system::error::RunError;
use crate::system::{Motion, System};

/// Fewest and most strokes that a period is made of.
const FEWEST: usize = 64;
const MOST: usize = 1 << 14;

/// Share of the largest harmonic that those may have that are left out.
const LEFT_OUT: f64 = 1e-12;

/// Difference after a period, in units of the range of the stroke, and times at which it is looked at.
const SAME: f64 = 1e-9;
const LOOKED_AT: usize = 16;
const GOLDEN: f64 = 0.618_033_988_749_895;

/// Why an element has no periodic past.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SteadyError {
    /// The motion follows from forces.
    #[error("the robot moves by itself: a steady past needs a motion that is given in advance")]
    Forward,
    /// The motion is not known over the period.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The stroke is another one a period later.
    #[error(
        "the stroke is not periodic with {period} s: from t = {t} s to a period later it changes by {change:.3e} m"
    )]
    NotPeriodic {
        /// The period, s.
        period: f64,
        /// The time, s.
        t: f64,
        /// The change, m or rad.
        change: f64,
    },
    /// The stroke has a kink or a jump, or far more swings than one.
    #[error("the stroke of a period of {period} s has a kink, or swings too often, for its harmonics to end")]
    Rough {
        /// The period, s.
        period: f64,
    },
}

impl System {
    /// The past of element `e` whose stroke was always what it is over the `period`, s, from t = 0 on; `end` is that of the run, s, in which it
    /// must be the same after each period.
    ///
    /// # Errors
    /// [`SteadyError`].
    pub fn steady_past(&self, e: usize, period: f64, end: f64) -> Result<Past, SteadyError> {
        if matches!(self.motion, Motion::Forward(_)) {
            return Err(SteadyError::Forward);
        }
        let mut evaluation = Evaluation::new(self);
        let mut scratch = Scratch::new(&self.model);
        let mut stroke = |t: f64| -> Result<f64, RunError> {
            let State { q, v, a } = self.state(t)?;
            (evaluation.q, evaluation.v, evaluation.a) = (q, v, a);
            self.context().fill(t, t, None, &mut scratch, &mut evaluation)?;
            Ok(evaluation.elements[e].stroke)
        };
        let resolution = |stroke: f64| self.elements[e].resolution(self.elements[e].rest + stroke);
        let (mut looks, mut changes) = (Vec::new(), Vec::new());
        for k in 0..=LOOKED_AT {
            let t = period * (k as f64 * GOLDEN).fract();
            let x = stroke(t)?;
            looks.push((t, x));
            if k == 0 || t + period <= end {
                changes.push((t, stroke(t + period)? - x));
            }
        }
        let range = looks.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], (_, x)| [a.min(*x), b.max(*x)]);
        let allowed = SAME * (range[1] - range[0]) + resolution(range[1]);
        if let Some(&(t, change)) = changes.iter().find(|(_, change)| change.abs() > allowed) {
            return Err(SteadyError::NotPeriodic { period, t, change });
        }
        let mut count = FEWEST;
        loop {
            let times = (0..count).map(|k| period * k as f64 / count as f64);
            let strokes = times.map(&mut stroke).collect::<Result<Vec<f64>, _>>()?;
            let (past, [largest, left_out]) = Periodic::new(period, &strokes);
            // What swings with the samples looks smooth on them.
            let is_met = || looks.iter().all(|(t, x)| (past.stroke(*t) - x).abs() <= allowed);
            if left_out <= LEFT_OUT * largest + resolution(strokes[0]) && is_met() {
                return Ok(Past::Periodic(past));
            }
            if count == MOST {
                return Err(SteadyError::Rough { period });
            }
            count *= 4;
        }
    }
}
