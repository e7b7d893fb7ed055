//! The search for the first change in a step: the step is solved anew to where its own interpolation sees the change, until that is at its end.

use crate::account::recorder::Recorder;
use crate::equations::context::Context;
use crate::equations::{Change, Look};
use crate::methods::stepper::{Behind, Stepper, Target, Trial};
use crate::system::error::RunError;

/// Tries to end a step on a change.
pub(super) const MOST_TRIES: usize = 40;

/// Tries to reach a change from behind it in a row; then the way is halved.
const FROM_BEHIND: u32 = 2;

/// Between which ends of a step a change is known to be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bracket {
    low: f64,
    high: f64,
}

impl Bracket {
    /// After the start of a step at `from`.
    pub(super) fn new(from: f64) -> Self {
        Self { low: from, high: f64::INFINITY }
    }

    /// A step to `end` does not come to it.
    pub(super) fn is_behind(&mut self, end: f64) {
        self.low = end;
    }

    /// A step to `end` goes over it.
    pub(super) fn is_before(&mut self, end: f64) {
        self.high = end;
    }

    /// Whether it is known to `near`.
    pub(super) fn is_closed(&self, near: f64) -> bool {
        self.high - self.low <= near
    }

    /// The end of the next step: the `guess` where it lies between, if there is one, else the middle.
    pub(super) fn next(&self, guess: Option<f64>) -> f64 {
        guess.filter(|end| self.low < *end && *end < self.high).unwrap_or(0.5 * (self.low + self.high))
    }

    /// The last bits of its time.
    fn bits(&self) -> f64 {
        4.0 * f64::EPSILON * self.high
    }
}

/// What becomes of a step that was solved within its tolerance.
enum Settled {
    /// It stands like this, and has been solved so.
    At(Target),
    /// A step of this size is to be tried instead.
    Shorter(f64),
    /// Something changes at its start.
    AtStart,
}

/// Tries a step, which ends at the first change in it.
///
/// # Errors
/// Where no step leads on.
pub(super) fn try_step(
    stepper: &mut dyn Stepper,
    cx: Context,
    recorder: &mut Recorder,
    target: Target,
) -> Result<Trial, RunError> {
    let next = match stepper.solve(cx, recorder, &target)? {
        Err(size) => return Ok(Trial::Rejected { size }),
        Ok(next) => next,
    };
    match settle(stepper, cx, recorder, target)? {
        Settled::At(step) => stepper.judge(cx, recorder, step, next),
        Settled::Shorter(size) => match stepper.gives_up(cx, recorder, &target, size) {
            Some(error) => Err(error),
            None => Ok(Trial::Rejected { size }),
        },
        Settled::AtStart => {
            stepper.change_at_start(cx, recorder)?;
            recorder.change_branches(cx)?;
            Ok(Trial::Changes)
        }
    }
}

fn settle(
    stepper: &mut dyn Stepper,
    cx: Context,
    recorder: &mut Recorder,
    solved: Target,
) -> Result<Settled, RunError> {
    let (mut step, mut bracket) = (solved, Bracket::new(solved.from));
    let (mut wanted, mut from_behind) = (None, 0);
    for _ in 0..MOST_TRIES {
        let Target { from, to: end, size, .. } = step;
        let next = match (stepper.look(cx, recorder, &step)?, wanted) {
            (Look::Unclear, _) => return Ok(Settled::Shorter(0.5 * size)),
            (Look::AtEnd, _) | (Look::Nothing, None | Some(Change::Reversal)) => return Ok(Settled::At(step)),
            (Look::Nothing, Some(change)) => {
                bracket.is_behind(end);
                from_behind = 0;
                let [at_end, before] = [1.0, 0.999].map(|theta| stepper.value(cx, recorder, &step, change, theta));
                end + 0.001 * size * at_end / (before - at_end)
            }
            (Look::Within(0.0, change), _) => {
                recorder.equations.note(change);
                return Ok(Settled::AtStart);
            }
            (Look::Within(theta, change), _) => {
                bracket.is_before(end);
                wanted = Some(change);
                from_behind += u32::from(matches!(change, Change::Kink(_) | Change::Control(_)));
                // Where the time is too short to tell, a few bits on.
                (from + theta * size).max(from + 4.0 * f64::EPSILON * from)
            }
        };
        let Some(change) = wanted else { return Ok(Settled::At(step)) };
        if bracket.is_closed(bracket.bits()) {
            recorder.equations.note(change);
            return Ok(Settled::At(step));
        }
        // Behind a kink a guard may hardly move, and tells little of where it is.
        let to = bracket.next(Some(next).filter(|_| from_behind < FROM_BEHIND));
        step = Target { to, size: to - from, behind: Behind::Step, ..step };
        if let Err(smaller) = stepper.solve(cx, recorder, &step)? {
            return Ok(Settled::Shorter(smaller));
        }
    }
    Ok(Settled::Shorter(0.5 * step.size))
}
