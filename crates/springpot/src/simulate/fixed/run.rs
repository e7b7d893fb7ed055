//! A whole run in steps of one size, with rows and the energy ledger.

use super::place::{Accelerator, Between};
use super::stepper::{Place, Stepper};
use super::{FixedStep, ITERATIONS};
use crate::fractional::Form;
use crate::fractional::step::{MAX_NODES, RADAU_NODES};
use crate::law::Singular;
use crate::motion::{Forward, Motion};
use crate::simulate::moment::{Moment, Scratch};
use crate::simulate::recorder::{Recorder, RecorderState};
use crate::simulate::{self, Report, RowTimes, Rows, RunError, Settings, Stop, System};
use serde::{Deserialize, Serialize};
use std::sync::atomic::Ordering;

/// Runs the forward dynamics of a `system` in steps of one size and hands every row to `rows`.
///
/// Steps end at k·step; only the last one is shorter where the end is no multiple of the step. A row inside a step takes its
/// place from the cubic Hermite form between the ends and its velocity from a straight line; its accelerations solve the equations of
/// motion at the ends of the step. Signals are met at the stages, their kinks are stepped over. The residual of the ledger is the method's
/// own error, of its order in the step. The report is true also where the run stops early: all rows up to `t_reached` were handed over.
/// Panics unless the motion is [`Motion::Forward`].
pub fn fixed(
    system: &System,
    by: FixedStep,
    settings: &Settings,
    rows: &mut dyn Rows,
    stop: &Stop,
) -> (Report, Result<(), RunError>) {
    let Motion::Forward(forward) = &system.motion else { panic!("the motion is given in advance") };
    whole(system, forward, by, settings, rows, stop, None)
}

/// Goes on with a run from what was kept of it.
pub(in crate::simulate) fn resume(
    system: &System,
    (forward, by): (&Forward, FixedStep),
    settings: &Settings,
    kept: (RecorderState, StepperState),
    rows: &mut dyn Rows,
    stop: &Stop,
) -> (Report, Result<(), RunError>) {
    whole(system, forward, by, settings, rows, stop, Some(kept))
}

/// Where the next step starts; its number is that of the steps taken.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(in crate::simulate) struct StepperState {
    t: f64,
    q: Vec<f64>,
    v: Vec<f64>,
}

fn whole(
    system: &System,
    forward: &Forward,
    by: FixedStep,
    settings: &Settings,
    rows: &mut dyn Rows,
    stop: &Stop,
    kept: Option<(RecorderState, StepperState)>,
) -> (Report, Result<(), RunError>) {
    let mut recorder = Recorder::new(system, settings, rows);
    recorder.takes_elements_work = false;
    recorder.report.newton_iterations = Some(0);
    for step in &mut recorder.steps {
        step.singular = Singular::Moments;
        step.form = Form::Strokes;
    }
    let outcome = Stepper::new(system, forward, by.method).and_then(|stepper| {
        let accelerator = Accelerator::new(system, forward);
        let still = vec![0.0; system.model.nv()];
        let mut run = Run { system, forward, by, stop, stepper, accelerator, still };
        match kept {
            None => run.start(&mut recorder)?,
            Some((recorded, StepperState { t, q, v })) => {
                recorder.restore(recorded);
                run.stepper.go_on(t, &q, &v);
            }
        }
        run.march(&mut recorder)
    });
    (recorder.finish(), outcome)
}

struct Run<'a> {
    system: &'a System,
    forward: &'a Forward,
    by: FixedStep,
    stop: &'a Stop,
    stepper: Stepper<'a>,
    accelerator: Accelerator,
    /// No torque besides the motion's signals.
    still: Vec<f64>,
}

impl Run<'_> {
    /// The first moment and its row.
    fn start(&mut self, recorder: &mut Recorder) -> Result<(), RunError> {
        let (system, forward) = (self.system, self.forward);
        let [moment, ..] = &mut recorder.moments;
        moment.q.copy_from_slice(&self.stepper.origin.q);
        moment.v.copy_from_slice(&self.stepper.origin.v);
        let mut is_singular = false;
        let force = |e: usize, moment: &Moment| {
            let (element, state) = (&system.elements[e], &moment.elements[e]);
            // What cannot begin is refused when the recorder is opened.
            let law = element.begin(state.length, &state.inputs).unwrap_or_default();
            is_singular |= law.is_singular();
            element.law.now(&state.point(0.0), &law).regular
        };
        self.accelerator.fill(system, forward, 0.0, &mut recorder.scratch, moment, force)?;
        if is_singular {
            moment.a.fill(f64::NAN);
            moment.driven.fill(None);
        }
        recorder.open(RADAU_NODES[0] * self.by.step)
    }

    fn march(&mut self, recorder: &mut Recorder) -> Result<(), RunError> {
        let step = self.by.step;
        let ends = RowTimes::Step { step, end: recorder.settings.end };
        // Every step ends where the table says, so that the steps taken tell where the next one ends.
        for to in (recorder.report.steps as usize + 1..ends.count()).map(|k| ends.at(k)) {
            let Place { t, ref q, ref v, .. } = self.stepper.origin;
            let stopped = self.stop.load(Ordering::Relaxed);
            recorder.keep(t, stopped, || {
                simulate::StepperState::Fixed(Box::new(StepperState { t, q: q.clone(), v: v.clone() }))
            })?;
            if stopped {
                return Err(RunError::Interrupted { t });
            }
            if recorder.report.steps >= recorder.settings.step_limit(0) {
                return Err(RunError::TooManySteps { t, limit: recorder.report.steps });
            }
            // To the bit where it can be, so that the tables of the exponentials are made once.
            let h = if (to - t - step).abs() <= 1e-9 * step { step } else { to - t };
            for (e, account) in recorder.accounts.iter_mut().enumerate() {
                account.law.iter_mut().for_each(|state| self.stepper.prepare(e, h, state));
            }
            let laws = &recorder.accounts;
            self.stepper.attempt(to, h, &self.still, |e| laws[e].memory())?;
            self.keep(recorder, t, to, h)?;
            self.stepper.accept();
            recorder.report.steps += 1;
            *recorder.report.newton_iterations.get_or_insert(0) += u64::from(ITERATIONS);
        }
        Ok(())
    }

    /// Writes the rows of the step that was just worked out, and takes it into the past.
    fn keep(&mut self, recorder: &mut Recorder, t: f64, to: f64, h: f64) -> Result<(), RunError> {
        let (system, forward, stepper) = (self.system, self.forward, &self.stepper);
        let [from, end] = [&stepper.origin, &stepper.end];
        let within = Between::new(system, forward, [from, end], [&stepper.a, &stepper.a], h);
        for (k, c) in RADAU_NODES.into_iter().enumerate() {
            let at = if k + 1 == MAX_NODES { to } else { t + c * h };
            let moment = &mut recorder.moments[k + 1];
            within.place(at, c, moment);
            if k + 1 == MAX_NODES {
                moment.q.copy_from_slice(&end.q);
                moment.v.copy_from_slice(&end.v);
            }
            system.fill(at, at, None, &mut recorder.scratch, moment)?;
        }
        for e in 0..system.elements.len() {
            recorder.fill_element_step(e);
            // What the memory was told: a straight line.
            let [first, .., last] = recorder.steps[e].stroke;
            for (stroke, c) in recorder.steps[e].stroke[1..].iter_mut().zip(RADAU_NODES) {
                *stroke = first + c * (last - first);
            }
            recorder.evaluate_element(e, t, h);
        }
        let Recorder { moments, steps, scratch, .. } = &mut *recorder;
        let moment = &mut moments[MAX_NODES];
        self.accelerator.fill(system, forward, to, scratch, moment, |e, _| steps[e].end.force())?;
        self.fill_powers(recorder);
        let a_at_start = recorder.moments[0].a.clone();
        let a_at_end = recorder.moments[MAX_NODES].a.clone();
        // Of a singular start there are none.
        let first = if a_at_start.iter().all(|a| a.is_finite()) { &a_at_start } else { &self.stepper.a };
        let within = Between::new(system, forward, [from, end], [first, &a_at_end], h);
        let mut place = |system: &System, scratch: &mut Scratch, at: f64, theta: f64, moment: &mut Moment| {
            within.place(at, theta, moment);
            system.fill(at, at, None, scratch, moment)
        };
        recorder.emit_rows(t, to, false, &mut place)?;
        recorder.commit(h);
        Ok(())
    }

    /// Powers of actuators and joints at the start and at the nodes, elements with the force of the step.
    fn fill_powers(&self, recorder: &mut Recorder) {
        for (k, moment) in recorder.moments.iter().enumerate() {
            let of_joint = |j: usize| {
                let pull = self.stepper.elements.iter().zip(&moment.elements);
                let computed = || {
                    let pull: f64 = pull.map(|(step, at)| step.response.force[0] * at.gradient[j]).sum();
                    moment.rigid[j] + pull
                };
                moment.driven[j].unwrap_or_else(computed)
            };
            recorder.powers.actuators[k] = moment.v.iter().enumerate().map(|(j, v)| of_joint(j) * v).sum();
            recorder.powers.joints[k] = moment.joint_loss;
        }
    }
}
