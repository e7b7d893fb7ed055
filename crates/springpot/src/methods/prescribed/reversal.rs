//! Where joints turn round against friction that sticks: its power |v|·F has a kink there, on which steps end.

use super::Prescribed;
use crate::account::recorder::Recorder;
use crate::collocation::{Cubic, STAGES};
use crate::equations::context::Context;
use crate::equations::resistance::holding_forces;
use crate::equations::zero::{first_zero_of, zero_between};
use crate::methods::stepper::Target;
use crate::model::Model;
use crate::system::error::RunError;

/// A velocity below this share of the step's largest is at rest.
const AT_REST: f64 = 1e-9;

/// Where a step is first looked at: at its start a joint may have turned round just now.
const EARLY: f64 = 1.0 / 64.0;

/// Velocities at which friction sticks.
pub(super) fn rubbing(model: &Model) -> Vec<usize> {
    let limits = holding_forces(model);
    (0..model.nv()).filter(|&k| limits[k] > 0.0).collect()
}

impl Prescribed {
    /// The first θ in the step that was just evaluated at which a joint turns round against friction that sticks.
    pub(super) fn first_reversal(
        &self,
        cx: Context,
        recorder: &Recorder,
        step: &Target,
    ) -> Result<Option<f64>, RunError> {
        let Target { from: t, to, size: h, .. } = *step;
        let mut first: Option<f64> = None;
        for &k in &self.rubbing {
            let values: [f64; STAGES + 1] = std::array::from_fn(|node| recorder.evaluations[node].v[k]);
            let largest = values.iter().fold(0.0, |largest: f64, v| largest.max(v.abs()));
            let cubic = Cubic::through(&values);
            let sign = cubic.at(EARLY).signum();
            if values[STAGES].abs() <= AT_REST * largest {
                continue;
            }
            let ahead = if sign < 0.0 { -cubic } else { cubic };
            let Some(near) = first_zero_of(&ahead, EARLY) else { continue };
            // The velocity itself, from a place before the zero to one behind it.
            let [_, .., end] = &recorder.evaluations;
            let (mut q, mut v, mut a) = (end.q.clone(), end.v.clone(), end.a.clone());
            let mut velocity = |theta: f64| -> Result<f64, RunError> {
                self.trajectory.at(&cx.system.model, t + theta * h, &mut q, &mut v, &mut a)?;
                Ok(sign * v[k])
            };
            let (mut low, mut high) = (EARLY, f64::NAN);
            for theta in [near, near + 0.05 * (1.0 - near), near + 0.3 * (1.0 - near), 1.0] {
                if velocity(theta)? <= 0.0 {
                    high = theta;
                    break;
                }
                low = theta;
            }
            if !(high > low && velocity(low)? > 0.0) {
                continue;
            }
            let mut failure = None;
            let zero = zero_between(
                &mut |theta| {
                    velocity(theta).unwrap_or_else(|error| {
                        failure = Some(error);
                        0.0
                    })
                },
                low,
                high,
            );
            if let Some(error) = failure {
                return Err(error);
            }
            first = Some(first.map_or(zero, |first| first.min(zero)));
        }
        Ok(first.filter(|theta| t < t + theta * h && t + theta * h < to))
    }
}
