//! One step tried: its errors, the size of the next one, and what to say where no step is small enough.

use super::method::Radau;
use super::newton::Outcome;
use crate::account::recorder::Recorder;
use crate::collocation::STAGES;
use crate::equations::TANGENTS;
use crate::equations::context::Context;
use crate::methods::chosen::{is_too_short, refuse_overflow, up_to_kink};
use crate::methods::stepper::Target;
use crate::system::error::RunError;

/// Growth that is not worth a new size.
const KEPT: f64 = 1.2;

/// 1/(order of the estimate + 1).
const EXPONENT: f64 = 0.25;

/// What makes most of the error of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Worst {
    Velocity(usize),
    Element(usize),
    Energy,
    /// The iteration did not converge, for this velocity least of all.
    Newton(usize),
}

impl Radau {
    /// Tries the step `target`: `Ok` holds the factor for the next step, `Err` the size to try instead.
    pub(super) fn attempt(
        &mut self,
        cx: Context,
        recorder: &mut Recorder,
        target: &Target,
    ) -> Result<Result<f64, f64>, RunError> {
        let Target { from: t, size: h, .. } = *target;
        self.step.errors.energy = recorder.turned_over();
        let outcome = self.step.attempt(cx, &mut recorder.equations, h, target.end_inputs())?;
        let (mut error, mut worst, iterations) = match outcome {
            Outcome::Diverged { iterations, worst } => (f64::INFINITY, Worst::Newton(worst), iterations),
            Outcome::Converged { iterations } => {
                let (error, worst) = self.step.estimate(&recorder.equations, h);
                (error, Worst::Velocity(worst), iterations)
            }
        };
        self.newton_iterations += u64::from(iterations);
        if let Some((e, _)) = recorder.equations.lost() {
            (error, worst) = (f64::INFINITY, Worst::Element(e));
        }
        refuse_overflow(&self.step.model, &self.step.stages[STAGES - 1].v, t + h)?;
        if error <= 1.0 {
            self.evaluate_step(cx, recorder, target)?;
            let whole = self.has_paths || recorder.equations.holds_any();
            if whole || self.has_inner_variables {
                (error, worst) = self.recorder_error(cx, recorder, h, whole, (error, worst));
            }
            if error <= 1.0 {
                error = error.max(self.variation_error(recorder, target));
            }
        }
        let safety = 0.9 * 15.0 / (14.0 + f64::from(iterations));
        if error > 1.0 || error.is_nan() {
            let mut smaller =
                h * if error.is_finite() { (safety * error.powf(-EXPONENT)).clamp(0.1, 0.9) } else { 0.25 };
            if error.is_finite() {
                smaller = up_to_kink(&mut recorder.equations, (h, smaller), &self.step.errors.noise);
            }
            if is_too_short(target, smaller, recorder.settings.end) {
                return Err(step_too_small(cx, recorder, (t, h), error, worst));
            }
            return Ok(Err(smaller));
        }
        let error = error.max(1e-10);
        let mut factor = safety * error.powf(-EXPONENT);
        if let Some((size, before)) = self.last {
            factor = factor.min(safety * (h / size) * (before.max(1e-2) / (error * error)).powf(EXPONENT));
        }
        self.last = Some((h, error));
        // A step that changes little keeps its size, and with it the tables of the exponentials.
        Ok(Ok(if (1.0..KEPT).contains(&factor) { 1.0 } else { factor.clamp(0.2, 8.0) }))
    }

    /// The error of what parameters change over the step, where that shares in the choice of steps.
    fn variation_error(&mut self, recorder: &mut Recorder, target: &Target) -> f64 {
        let Recorder { equations, variation, .. } = recorder;
        let Some(variation) = variation.as_deref_mut().filter(|variation| variation.shares_in_steps()) else {
            return 0.0;
        };
        let leaning = equations.lean(target.size, &self.step.errors.noise);
        let is_regular = self.step.vary(equations, variation, target.size, target.end_inputs());
        equations.stand(leaning);
        if is_regular {
            let hidden = variation.hidden_error(equations, (TANGENTS * recorder.settings.rtol, recorder.settings.end));
            self.step.estimate_variation(equations, variation, target.size).max(hidden)
        } else {
            f64::INFINITY
        }
    }

    /// The largest of `error` and of what the estimate of the free joints may not see: the errors of the energy ledger, and of D^alpha x of
    /// laws with inner variables, of all laws where `whole`, other joints being prescribed. In units of their tolerances, brought to the
    /// order of that estimate.
    fn recorder_error(
        &self,
        cx: Context,
        recorder: &Recorder,
        h: f64,
        whole: bool,
        (mut error, mut worst): (f64, Worst),
    ) -> (f64, Worst) {
        let (equations, sizes) = (&recorder.equations, &self.step.errors.sizes);
        // Beside a singular start there is no ledger, and what the actuators do against it is integrated by its moments.
        let counts = !equations.is_singular() && (whole || self.has_inner_strokes);
        let energy = if counts { recorder.energy_error(h, 0.0) } else { 0.0 };
        if energy > error {
            (error, worst) = (energy, Worst::Energy);
        }
        for e in 0..cx.system.elements.len() {
            let errors = if whole { usize::MAX } else { equations.bank.hidden_errors(e) };
            if errors == 0 {
                continue;
            }
            let coming = equations.coming_rate(e, |k| sizes.coming(k, self.step.origin.t + h));
            let (share, falls) = recorder.memory_error(e, errors, coming, sizes.since());
            let memory = share.powf(1.0 / (EXPONENT * falls));
            if memory > error {
                (error, worst) = (memory, Worst::Element(e));
            }
        }
        (error, worst)
    }
}

fn step_too_small(cx: Context, recorder: &Recorder, (t, h): (f64, f64), error: f64, worst: Worst) -> RunError {
    let system = cx.system;
    let joint = |k: usize| system.model.v_labels()[k].name.clone();
    if let Some((e, why)) = recorder.equations.lost() {
        return system.elements[e].without_direction(t, why);
    }
    let subject = match worst {
        Worst::Velocity(k) => format!("joint \"{}\"", joint(k)),
        Worst::Element(e) => format!("element \"{}\"", system.elements[e].name),
        Worst::Energy => "the energy ledger".to_owned(),
        Worst::Newton(k) => return RunError::NoConvergence { t, h, joint: joint(k) },
    };
    RunError::StepTooSmall { t, h, error, subject }
}
