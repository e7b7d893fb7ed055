//! What methods share that choose the sizes of their steps: what a step may err, when it is too short, and who looks into it once it was tried.

mod errors;
mod sizes;

pub(super) use errors::Errors;
pub(super) use sizes::{Sizes, Tolerance};

use super::stepper::Target;
use crate::account::recorder::Recorder;
use crate::equations::kinks::Seen;
use crate::equations::{Equations, Solved, Within};
use crate::model::Model;
use crate::system::error::RunError;
use crate::system::sensitivity::SensitivityError;

/// Shortest step as a share of the run, and of the time that has passed.
const SHORTEST_STEP: [f64; 2] = [1e-20, 2.0 * f64::EPSILON];

/// Velocities whose squares are finite.
const FASTEST: f64 = 1e150;

/// Whether no step of a run that ends at `end` may be as short as `h` where `tried` was not short enough, or ends where that one did.
pub(super) fn is_too_short(tried: &Target, h: f64, end: f64) -> bool {
    let [of_run, of_time] = SHORTEST_STEP;
    h < (of_run * end).max(of_time * tried.from) || tried.from + h >= tried.to
}

/// Refuses velocities at `t` whose energy is beyond double precision.
pub(super) fn refuse_overflow(model: &Model, v: &[f64], t: f64) -> Result<(), RunError> {
    let Some(k) = v.iter().position(|v| v.abs() > FASTEST) else { return Ok(()) };
    Err(RunError::NotFinite { t, what: format!("v.{}", model.v_labels()[k].name), value: f64::INFINITY })
}

/// That what parameters change of a motion has no accelerations at `t`.
pub(super) fn without_inertia(t: f64) -> RunError {
    SensitivityError::Unknown { what: format!("a motion without inertia at t = {t} s") }.into()
}

/// That no step as short as `tried` leads on, by its fastest joint: velocities `v` at its end.
pub(super) fn no_convergence(tried: &Target, model: &Model, v: &[f64]) -> RunError {
    let speeds = v.iter().map(|v| v.abs()).enumerate();
    let fastest = speeds.max_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(0, |(k, _)| k);
    RunError::NoConvergence { t: tried.from, h: tried.size, joint: model.v_labels()[fastest].name.clone() }
}

/// The size to try in place of `h`, in which an error was found: `smaller`, but where a kink makes that, a step up to it has none of it.
pub(super) fn up_to_kink(equations: &mut Equations, (h, smaller): (f64, f64), noise: &[f64]) -> f64 {
    match equations.look_for_kinks(h, noise) {
        Seen::Within(theta, _) => smaller.max((1.01 * theta).min(0.9) * h),
        _ => smaller,
    }
}

/// Hands over a step that was worked out and told, and the equations that it solves: `within` knows the motion in it, `noise` is what rounding makes of
/// each free velocity.
pub(super) fn solved<T>(
    recorder: &mut Recorder,
    step: &Target,
    (within, noise): (&mut dyn Within, &[f64]),
    take: impl FnOnce(&mut Equations, &mut Solved) -> T,
) -> T {
    let Recorder { evaluations, equations, scratch, settings, .. } = recorder;
    let (rtol, end) = (settings.rtol, settings.end);
    let Target { from, to, size, .. } = *step;
    take(equations, &mut Solved { from, to, size, evaluations, scratch, within, noise, rtol, end })
}
