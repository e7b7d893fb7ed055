//! One step tried: its error, the size of the next one, and what of it the recorder and those who look into it are told.

use super::between::Between;
use super::method::Explicit;
use super::tableau::{FIFTH, THIRD};
use crate::account::recorder::Recorder;
use crate::collocation::{RADAU_NODES, STAGES};
use crate::equations::context::Context;
use crate::equations::drives::drive;
use crate::equations::{Node, Within};
use crate::methods::chosen::{is_too_short, refuse_overflow, up_to_kink};
use crate::methods::stepper::Target;
use crate::system::error::RunError;

/// 1/8 less what the error before counts, and that: control of steps after Gustafsson (Hairer & Wanner, Solving ODEs II, IV.2).
const EXPONENT: f64 = 1.0 / 8.0 - 0.2 * BEFORE;
const BEFORE: f64 = 0.04;

const SAFETY: f64 = 0.9;

/// Smallest and largest change of the size from step to step.
const CHANGE: [f64; 2] = [0.2, 6.0];

/// Errors below this count as it.
const LEAST: f64 = 1e-8;

impl Explicit {
    /// Tries the step `target`: `Ok` holds the factor for the next step, `Err` the size to try instead.
    pub(super) fn attempt(
        &mut self,
        cx: Context,
        recorder: &mut Recorder,
        target: &Target,
    ) -> Result<Result<f64, f64>, RunError> {
        let h = target.size;
        let turned_over = recorder.turned_over();
        let equations = &mut recorder.equations;
        let (origin, errors) = (&self.radau.step.origin, &mut self.radau.step.errors);
        equations.stand_at(cx, origin.node(), h)?;
        errors.energy = turned_over;
        self.h = h;
        let is_found = self.step.attempt(cx, equations, origin, (h, target.end_inputs()))?;
        let mut worst = equations.free()[0];
        let mut error = f64::INFINITY;
        if is_found {
            let end = &self.step.end;
            let own = |k: usize| h * end.a[k].abs().max(origin.a[k].abs());
            errors.allow(cx, equations, (origin, h), self.tolerance, own);
            let strict = recorder.settings.rtol;
            let mut sizes = errors.noise.iter().zip(&errors.sized);
            self.is_rounding = sizes.all(|(noise, [speed, _])| *noise > strict * speed);
            (error, worst) = self.estimate(recorder, h);
        }
        refuse_overflow(&cx.system.model, &self.step.end.v, target.to)?;
        if error <= 1.0 {
            self.tell(cx, recorder, target)?;
            error = error.max(self.variation_error(recorder, target));
        }
        if error <= 1.0 {
            let error = error.max(LEAST);
            let before = self.kept.last.unwrap_or(error);
            let factor = SAFETY * error.powf(-EXPONENT) * before.powf(BEFORE);
            let [least, most] = CHANGE;
            let most = if std::mem::take(&mut self.was_rejected) { 1.0 } else { most };
            self.kept.last = Some(error);
            return Ok(Ok(factor.clamp(least, most).min(self.kept.answering.longest(self.calm) / h)));
        }
        let mut smaller = h * if error.is_finite() { (SAFETY * error.powf(-0.125)).clamp(0.1, 0.9) } else { 0.25 };
        if error.is_finite() && recorder.equations.has_kinks() {
            self.take_nodes(cx, recorder, target)?;
            smaller = up_to_kink(&mut recorder.equations, (h, smaller), &self.radau.step.errors.noise);
        }
        self.was_rejected = true;
        if is_too_short(target, smaller, recorder.settings.end) {
            return Err(self.too_small(cx, target, error, worst));
        }
        Ok(Err(smaller))
    }

    /// Estimate of the error in units of the tolerance, and the velocity with the largest share of it.
    fn estimate(&mut self, recorder: &Recorder, h: f64) -> (f64, usize) {
        let (n, free) = (self.radau.step.origin.v.len(), recorder.equations.free());
        let Self { step, radau, sums, .. } = self;
        let [fifth, third] = sums;
        step.integrated.sum_of(FIFTH, fifth);
        step.integrated.sum_of(THIRD, third);
        let (mut of_fifth, mut of_third, mut count) = (0.0, 0.0, 2 * free.len());
        let (mut worst, mut largest) = (free[0], -1.0);
        for (&k, [of_velocity, of_travel]) in free.iter().zip(&radau.step.errors.allowed) {
            let square = |sum: &[f64]| (h * sum[k] / of_travel).powi(2) + (h * sum[n + k] / of_velocity).powi(2);
            let own = square(fifth);
            if own > largest {
                (worst, largest) = (k, own);
            }
            of_fifth += own;
            of_third += square(third);
        }
        // What moves joints that signals move is seen by the ledger alone.
        let allowed = self.tolerance.rtol * recorder.turned_over();
        if radau.has_paths && allowed > 0.0 {
            let net = |sum: &[f64]| h * (sum[2 * n] - sum[2 * n + 1]) / allowed;
            of_fifth += net(fifth).powi(2);
            of_third += net(third).powi(2);
            count += 1;
        }
        (corrected(of_fifth / count as f64, of_third / count as f64), worst)
    }

    /// Tells the recorder the end of the step, and what lies before it where that may change anything.
    fn tell(&mut self, cx: Context, recorder: &mut Recorder, target: &Target) -> Result<(), RunError> {
        let Recorder { evaluations, equations, works, is_whole, .. } = &mut *recorder;
        let (step, end) = (&self.step, &mut evaluations[STAGES]);
        end.q.copy_from_slice(&step.end.q);
        end.v.copy_from_slice(&step.end.v);
        end.a.copy_from_slice(&step.end.a);
        drive(cx, equations.forward(), target.to, end);
        let inputs = (0..cx.system.elements.len()).map(|e| equations.bank.point(e, 1).inputs);
        cx.fill_energies(target.to, &step.kinematics, step.found.readings.iter().zip(inputs), end);
        equations.add_torques(cx, STAGES, end);
        for (e, element) in end.elements.iter().enumerate() {
            equations.bank.account_end(e, &element.point(target.to));
        }
        is_whole[1] = false;
        step.tell_works(works.get_or_insert_default());
        self.look_at_answer(cx, equations)?;
        // What is held between samples is not known to whoever looks into the step later.
        if !equations.is_smooth() || self.looks_into || !cx.system.control.is_empty() {
            self.take_nodes(cx, recorder, target)?;
        }
        Ok(())
    }

    /// The polynomial between the ends of the step.
    pub(super) fn fill_between(&mut self, cx: Context, recorder: &mut Recorder) -> Result<(), RunError> {
        let Recorder { equations, works, .. } = recorder;
        self.step.fill_between(cx, equations, &self.radau.step.origin, self.h)?;
        self.step.tell_works(works.get_or_insert_default());
        Ok(())
    }

    /// Works out the step at its nodes, for those who look at it there.
    fn take_nodes(&mut self, cx: Context, recorder: &mut Recorder, target: &Target) -> Result<(), RunError> {
        self.fill_between(cx, recorder)?;
        let Recorder { evaluations, equations, .. } = recorder;
        let Self { step, radau, inner, xi, h, .. } = self;
        let (model, origin) = (&*cx.system.model, &radau.step.origin);
        for ((evaluation, kinematics), c) in evaluations[1..].iter_mut().zip(&mut *inner).zip(RADAU_NODES) {
            let t = target.from + c * *h;
            Between { step, origin, h: *h, xi }.place(cx, equations, t, c, evaluation);
            evaluation.t = t;
            kinematics.update_velocity(model, &evaluation.q, &evaluation.v);
        }
        if equations.is_smooth() {
            return Ok(());
        }
        let [_, first, second, _] = &*evaluations;
        let nodes = [
            Node { t: first.t, q: &first.q, v: &first.v, a: &first.a },
            Node { t: second.t, q: &second.q, v: &second.v, a: &second.a },
            Node { t: target.end_inputs(), q: &step.end.q, v: &step.end.v, a: &step.end.a },
        ];
        let [first, second] = &*inner;
        equations.take_nodes(cx, nodes, [first, second, &step.kinematics])
    }

    fn too_small(&self, cx: Context, target: &Target, error: f64, worst: usize) -> RunError {
        let (t, h) = (target.from, target.size);
        if let Some((e, why)) = self.step.found.lost {
            return cx.system.elements[e].without_direction(t, why);
        }
        let subject = format!("joint \"{}\"", cx.system.model.v_labels()[worst].name);
        RunError::StepTooSmall { t, h, error, subject }
    }
}

/// The estimate of order 5, corrected by that of order 3 (Hairer, Nørsett & Wanner, Solving ODEs I, II.10), of their squares.
pub(super) fn corrected(fifth: f64, third: f64) -> f64 {
    if fifth == 0.0 || fifth.is_infinite() { fifth } else { fifth / (fifth + 0.01 * third).sqrt() }
}
