//! Which method goes on: stability keeps explicit steps short where something is stiff, and sums of work decide whether the other method is worth it.
//!
//! Work is counted in solves for accelerations, as numbers of operations have it, never as time: what is chosen follows from the motion alone.

use super::method::{Explicit, Kept};
use super::radius::spectral_radius;
use super::tableau::STAGES;
use crate::equations::Equations;
use crate::equations::context::Context;
use crate::system::error::RunError;

/// Size times spectral radius that a step has at most, at tolerances from 1e-6 on, and how that falls with the tolerance below: well before the edge of
/// stability, 6.1 on the real axis, what answers fast dies away no longer, and rows between the ends know least of it. Steps near that are kept short
/// by stability, not by errors.
const CALM: f64 = 2.5;
const CALM_FROM: f64 = 1e-6;
const CALMER: f64 = 1.0 / 16.0;
const NEAR: f64 = 0.9;
const EDGE: f64 = 6.1;

/// That of a run of this tolerance.
pub(super) fn calm(rtol: f64) -> f64 {
    CALM * (rtol / CALM_FROM).min(1.0).powf(CALMER)
}

/// The share of the longest step from which on a step is as long as it may be.
const LONG: f64 = 0.5;

/// So many steps near the edge, with not as many off it in between, have the other method tried.
const STIFF_STEPS: u32 = 15;
const OTHERS: u32 = 6;

/// Accepted steps from one look at how fast the motion answers to the next, looks that tell nothing yet, the share of each in the mean, and how
/// far off the way a look goes in units of what moves.
const EVERY: u64 = 4;
const ENOUGH: u32 = 4;
const MEAN: f64 = 0.25;
const SMALL: f64 = 1e-6;

/// Explicit steps after which the other method is tried in any case: more each time in vain. Where a motion is led along smoothly, the estimates
/// of the explicit method ask for more than they need.
const EXPLORE: u32 = 150;

/// Steps in which a method that is tried finds its size, and those by which its work is measured.
const WARM: u32 = 8;
const WINDOW: u32 = 16;

/// Steps of the implicit method after which the explicit one is tried again, if it is stable in steps of that size: more each time in vain.
const WAIT: u32 = 60;
const MORE: u32 = 4;
const MOST_PATIENCE: u32 = 1 << 16;

/// Steps at the edge of stability to the end of a run that are too many where no other method may take over.
const TOO_MANY: f64 = 20_000.0;

/// What a step of the other method takes beside its iterations, and each of these.
const LINEARISED: f64 = 4.0;
const ITERATION: f64 = 2.5;

/// Matrices of n velocities take so many more of them: n/6 solves for n accelerations, measured on chains of 50 to 200 links.
const FACTORED: f64 = 6.0;

/// Work over a stretch of time.
#[derive(Debug, Clone, Copy, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Work {
    from: f64,
    sum: f64,
}

impl Work {
    /// Per second until t.
    fn rate(&self, t: f64) -> f64 {
        self.sum / (t - self.from)
    }

    pub(super) fn of_explicit_try(&mut self) {
        self.sum += STAGES as f64;
    }

    /// Of tries of the other method with `n` velocities and so many iterations.
    pub(super) fn of_implicit_try(&mut self, n: usize, iterations: u64) {
        self.sum += LINEARISED + ITERATION * iterations as f64 + n as f64 / FACTORED;
    }
}

/// How fast the motion answers to what moves it off its way: the spectral radius of its slopes, by one step of power iteration here and there.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Answering {
    /// ξ of all velocities, then v, in units of what a step measures them by.
    way: Vec<f64>,
    /// Logarithm of the rate, 1/s, and how many looks it is of.
    rate: f64,
    looks: u32,
}

impl Answering {
    /// The rate, 1/s; 0 where too little was seen.
    fn rate(&self) -> f64 {
        if self.looks < ENOUGH { 0.0 } else { self.rate.exp() }
    }

    /// The longest step in which all that answers fast dies away, s.
    pub(super) fn longest(&self, calm: f64) -> f64 {
        calm / self.rate()
    }

    fn take(&mut self, growth: f64) {
        self.looks += 1;
        // What swings grows now more, now less; the first looks are those of a way that is not yet one of the fastest.
        let share = if self.looks < ENOUGH { 1.0 } else { MEAN };
        self.rate += share * (growth.max(f64::MIN_POSITIVE).ln() - self.rate);
    }
}

impl Explicit {
    /// Looks at how fast the motion answers, every so many steps; what the step was measured by is known.
    ///
    /// # Errors
    /// What a signal or an input says.
    pub(super) fn look_at_answer(&mut self, cx: Context, equations: &mut Equations) -> Result<(), RunError> {
        let Self { kept: Kept { answering, steps, .. }, step, radau, way, .. } = self;
        if !steps.is_multiple_of(EVERY) {
            return Ok(());
        }
        let (origin, sized) = (&radau.step.origin, &radau.step.errors.sized);
        let (n, free) = (origin.v.len(), equations.free().to_vec());
        if answering.way.len() != 2 * n {
            answering.way = (0..2 * n).map(|k| if k % 2 == 0 { 1.0 } else { -1.0 }).collect();
        }
        way.clear();
        way.resize(2 * n, 0.0);
        let mut square = 0.0;
        for (&k, [speed, travel]) in free.iter().zip(sized) {
            (way[k], way[n + k]) = (answering.way[k] * travel, answering.way[n + k] * speed);
            square += answering.way[k].powi(2) + answering.way[n + k].powi(2);
        }
        step.probe(cx, equations, origin, (way, SMALL / square.sqrt()))?;
        let mut grown = 0.0;
        for (&k, [speed, travel]) in free.iter().zip(sized) {
            let own = [way[k] / travel, way[n + k] / speed];
            (answering.way[k], answering.way[n + k]) = (own[0], own[1]);
            grown += own[0].powi(2) + own[1].powi(2);
        }
        let growth = (grown / square).sqrt();
        if !(growth.is_normal()) {
            *answering = Answering::default();
            return Ok(());
        }
        answering.way.iter_mut().for_each(|own| *own /= grown.sqrt());
        answering.take(growth);
        Ok(())
    }

    /// Counts in the step that was accepted, which ended at t, and changes to the other method where that has become worth it; `longest` is the size that
    /// steps may have, `end` that of the run.
    ///
    /// # Errors
    /// [`RunError::TooStiff`] where it must not.
    pub(super) fn reconsider(
        &mut self,
        equations: &Equations,
        (t, h): (f64, f64),
        (longest, end): (f64, f64),
    ) -> Result<(), RunError> {
        let (stiffness, near, is_forced) = (h * self.kept.answering.rate(), NEAR * self.calm, self.is_forced);
        let kept = &mut self.kept;
        if is_forced {
            if kept.count_stiff(stiffness, near, t) && end - t > TOO_MANY * h {
                return Err(RunError::TooStiff { t, h });
            }
            return Ok(());
        }
        kept.taken += 1;
        kept.rounding_steps = if self.is_rounding && !kept.is_stiff { kept.rounding_steps + 1 } else { 0 };
        let changes = if kept.rounding_steps > STIFF_STEPS {
            // Stages weigh rounding eight times, the other method's do not.
            (kept.is_tried, kept.patience[1]) = (false, MOST_PATIENCE);
            true
        } else if kept.is_tried {
            if kept.taken == WARM {
                kept.begin_work(t);
            }
            let is_known = kept.taken == WARM + WINDOW;
            let is_worse = is_known && kept.work.rate(t) >= kept.other_rate;
            if is_known {
                kept.is_tried = false;
                kept.taken = 0;
            }
            if is_worse {
                let patience = &mut kept.patience[usize::from(!kept.is_stiff)];
                *patience = (MORE * *patience).min(MOST_PATIENCE);
            }
            is_worse
        } else {
            let is_due = if kept.is_stiff {
                let due = WAIT.saturating_mul(kept.patience[1]);
                if kept.taken == due - WINDOW {
                    kept.begin_work(t);
                }
                let is_over = kept.taken == due;
                if is_over {
                    kept.taken = 0;
                }
                is_over && h * spectral_radius(equations) <= EDGE
            } else {
                let due = EXPLORE.saturating_mul(kept.patience[0]);
                if kept.taken == due - WINDOW {
                    kept.begin_work(t);
                }
                // Of steps that may be no longer the other method's take less.
                let stiffness = if h >= LONG * longest { f64::INFINITY } else { stiffness };
                kept.count_stiff(stiffness, near, t) || kept.taken >= due
            };
            if is_due {
                kept.other_rate = kept.work.rate(t);
                kept.is_tried = true;
            }
            is_due
        };
        if changes {
            kept.change_over();
            self.step.forget();
            self.radau.begin_anew();
        }
        Ok(())
    }
}

impl Kept {
    /// Counts a step of this `stiffness` in, which ended at t: whether there were enough of `least`.
    fn count_stiff(&mut self, stiffness: f64, least: f64, t: f64) -> bool {
        if stiffness > least {
            (self.stiff_steps, self.other_steps) = (self.stiff_steps + 1, 0);
            if self.stiff_steps == 1 {
                self.begin_work(t);
            }
        } else {
            self.other_steps += 1;
            if self.other_steps >= OTHERS {
                self.stiff_steps = 0;
            }
        }
        self.stiff_steps > STIFF_STEPS.saturating_mul(self.patience[0])
    }

    fn begin_work(&mut self, t: f64) {
        self.work = Work { from: t, sum: 0.0 };
    }

    /// To the other method.
    fn change_over(&mut self) {
        self.is_stiff = !self.is_stiff;
        (self.last, self.taken, self.stiff_steps, self.other_steps) = (None, 0, 0, 0);
        (self.is_behind_kink, self.switches) = (true, self.switches + 1);
    }
}
