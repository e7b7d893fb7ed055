//! Steps that end where friction starts or ceases to hold a joint, and where the force of an element has a kink.

use super::events::{Change, Look, Settled};
use super::method::Radau;
use super::stick::CHATTER;
use crate::account::recorder::Recorder;
use crate::collocation::STAGES;
use crate::equations::context::Context;
use crate::equations::kinks::FROM_BEHIND;
use crate::methods::stepper::{Behind, Target};
use crate::system::error::RunError;

/// Tries to end a step on a change.
const MOST_TRIES: usize = 40;

impl Radau {
    /// Ends the step that was just solved at the first change between holding and sliding or kink in it, if there is one.
    ///
    /// The step is solved anew to where its own interpolation sees the change, until the change is at its end to a thousandth
    /// of the tolerance.
    pub(super) fn settle(&mut self, cx: Context, recorder: &mut Recorder, solved: Target) -> Result<Settled, RunError> {
        let is_smooth = recorder.control.as_ref().is_none_or(|control| control.is_smooth());
        if self.step.stick.is_idle() && self.kinks.is_idle() && is_smooth {
            return Ok(Settled::At(solved));
        }
        let mut step = solved;
        let t = step.from;
        let (mut low, mut high) = (t, f64::INFINITY);
        let (mut wanted, mut from_behind) = (None, 0);
        for _ in 0..MOST_TRIES {
            let Target { to: end, size, .. } = step;
            let next = match (self.look(cx, recorder, &step)?, wanted) {
                (Look::Unclear, _) => return Ok(Settled::Shorter(0.5 * size)),
                (Look::AtEnd, _) | (Look::Nothing, None | Some(Change::Reversal)) => {
                    return Ok(Settled::At(step));
                }
                (Look::Nothing, Some(change)) => {
                    (low, from_behind) = (end, 0);
                    let [at_end, before] = [1.0, 0.999].map(|theta| self.value(cx, recorder, change, size, theta));
                    end + 0.001 * size * at_end / (before - at_end)
                }
                (Look::Within(0.0, change), _) => {
                    self.note(recorder, change);
                    return Ok(Settled::AtStart);
                }
                (Look::Within(theta, change), _) => {
                    (high, wanted) = (end, Some(change));
                    from_behind += u32::from(matches!(change, Change::Kink(_) | Change::Control(_)));
                    // Where the time is too short to tell, a few bits on.
                    (t + theta * size).max(t + 4.0 * f64::EPSILON * t)
                }
            };
            let Some(change) = wanted else { return Ok(Settled::At(step)) };
            if high - low <= 4.0 * f64::EPSILON * high {
                self.note(recorder, change);
                return Ok(Settled::At(step));
            }
            // Behind a kink a guard may hardly move, and tells little of where it is.
            let to = if from_behind < FROM_BEHIND && low < next && next < high { next } else { 0.5 * (low + high) };
            step = Target { to, size: to - t, behind: Behind::Step, ..step };
            if let Err(smaller) = self.attempt(cx, recorder, &step)? {
                return Ok(Settled::Shorter(smaller));
            }
        }
        Ok(Settled::Shorter(0.5 * step.size))
    }

    /// Notes a change that is here, whatever its value says.
    fn note(&mut self, recorder: &mut Recorder, change: Change) {
        let stick = &mut self.step.stick;
        match change {
            Change::Stop { k, .. } => {
                stick.stopping.push(k);
                stick.caught.push(k);
            }
            Change::BreakAway { .. } => stick.breaks_away = true,
            Change::Reversal => {}
            Change::Kink(_) => self.is_at_kink = true,
            Change::Control(guard) => {
                if let Some(control) = &mut recorder.control {
                    control.note(guard);
                }
            }
        }
    }

    /// No step is short enough to tell what changes in it: what moves fastest is named.
    pub(super) fn settles_nowhere(&self, step: &Target) -> RunError {
        let speeds = self.step.stages[STAGES - 1].v.iter().map(|v| v.abs());
        let fastest = speeds.enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(0, |(k, _)| k);
        RunError::NoConvergence { t: step.from, h: step.size, joint: self.step.model.v_labels()[fastest].name.clone() }
    }

    /// Brings to rest what stops at the origin.
    ///
    /// # Errors
    /// [`RunError::Chatter`]; [`RunError::NoConvergence`] where nothing rubs.
    pub(super) fn stop_sliding(&mut self, end: f64) -> Result<(), RunError> {
        let span = CHATTER * end;
        let step = &mut self.step;
        let t = step.origin.t;
        for &k in &step.stick.stopping {
            step.origin.v[k] = 0.0;
        }
        let Some(count) = step.stick.count_change(t, span) else { return Ok(()) };
        let last = step.stick.stopping.first().copied();
        let last = last.or_else(|| step.stick.rubbing().next().map(|(k, _)| k));
        let joint = step.model.v_labels()[last.unwrap_or(0)].name.clone();
        Err(match last {
            Some(_) => RunError::Chatter { t, joint, count, span },
            None => RunError::NoConvergence { t, h: span, joint },
        })
    }
}
