//! Steps that end where friction starts or ceases to hold a joint.

use super::Run;
use super::stick::CHATTER;
use super::watch::{Change, Look};
use crate::simulate::RunError;

/// Tries to end a step on a change.
const MOST_TRIES: usize = 40;

/// What becomes of a step that was solved within its tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Settled {
    /// It stands as far as `to`, and has been solved so.
    At { to: f64, size: f64 },
    /// A step of this size is to be tried instead.
    Shorter(f64),
    /// Something changes at its start.
    AtStart,
}

impl Run<'_> {
    /// Ends the step of size `h` that was just solved at the first change between holding and sliding in it, if there is one.
    ///
    /// The step is solved anew to where its own interpolation sees the change, until the change is at its end to a thousandth
    /// of the tolerance.
    pub(super) fn settle(&mut self, to: f64, h: f64) -> Result<Settled, RunError> {
        if self.stepper.stick.is_idle() {
            return Ok(Settled::At { to, size: h });
        }
        let t = self.stepper.origin.t;
        let (mut low, mut high, mut end, mut size) = (t, f64::INFINITY, to, h);
        let mut wanted = None;
        for _ in 0..MOST_TRIES {
            let next = match (self.look(end, size)?, wanted) {
                (Look::Unclear, _) => return Ok(Settled::Shorter(0.5 * size)),
                (Look::AtEnd, _) | (Look::Nothing, None | Some(Change::Reversal)) => {
                    return Ok(Settled::At { to: end, size });
                }
                (Look::Nothing, Some(change)) => {
                    low = end;
                    let (at_end, before) = (self.value(change, size, 1.0), self.value(change, size, 0.999));
                    end + 0.001 * size * at_end / (before - at_end)
                }
                (Look::Within(0.0, change), _) => {
                    self.note(change);
                    return Ok(Settled::AtStart);
                }
                (Look::Within(theta, change), _) => {
                    (high, wanted) = (end, Some(change));
                    // Where the time is too short to tell, a few bits on.
                    (t + theta * size).max(t + 4.0 * f64::EPSILON * t)
                }
            };
            let Some(change) = wanted else { return Ok(Settled::At { to: end, size }) };
            if high - low <= 4.0 * f64::EPSILON * high {
                self.note(change);
                return Ok(Settled::At { to: end, size });
            }
            end = if low < next && next < high { next } else { 0.5 * (low + high) };
            size = end - t;
            if let Err(smaller) = self.attempt(end, size, false)? {
                return Ok(Settled::Shorter(smaller));
            }
        }
        Ok(Settled::Shorter(0.5 * size))
    }

    /// Notes a change that is here, whatever its value says.
    fn note(&mut self, change: Change) {
        let stick = &mut self.stepper.stick;
        match change {
            Change::Stop { k, .. } => {
                stick.stopping.push(k);
                stick.caught.push(k);
            }
            Change::BreakAway { .. } => stick.breaks_away = true,
            Change::Reversal => {}
        }
    }

    /// Brings to rest what stops at the origin.
    ///
    /// # Errors
    /// [`RunError::Chatter`].
    pub(super) fn stop_sliding(&mut self) -> Result<(), RunError> {
        let span = CHATTER * self.recorder.settings.end;
        let stepper = &mut self.stepper;
        let t = stepper.origin.t;
        for &k in &stepper.stick.stopping {
            stepper.origin.v[k] = 0.0;
        }
        let Some(count) = stepper.stick.count_change(t, span) else { return Ok(()) };
        let last = stepper.stick.stopping.first().copied();
        let last = last.or_else(|| stepper.stick.rubbing().next().map(|(k, _)| k)).unwrap_or(0);
        Err(RunError::Chatter { t, joint: stepper.model.v_labels()[last].name.clone(), count, span })
    }
}
