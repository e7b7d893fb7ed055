//! The method behind the driver.

use super::attempt::is_too_short;
use super::dense::{Dense, Scratch};
use super::events::Settled;
use super::sizes::Tolerance;
use super::start;
use super::step::{Carried, RadauStep};
use crate::account::recorder::Recorder;
use crate::actuation::{Drive, Forward};
use crate::dynamics::Kinematics;
use crate::equations::context::Context;
use crate::equations::drives::drive;
use crate::equations::evaluate::Evaluation;
use crate::equations::kinks::Kinks;
use crate::law::Course;
use crate::methods::stepper::{Behind, Stepper, Target, Trial};
use crate::signal::Agenda;
use crate::system::error::RunError;
use crate::system::settings::Settings;
use crate::system::{Motion, System};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The estimate is of order 3, the method of order 5: the estimate may reach this share of rtol^⅔.
const ESTIMATE_SHARE: f64 = 0.03;

/// The longest step as a share of the run, so that no signal is stepped over: where something varies with time, and where nothing
/// does.
const LONGEST_STEP: [f64; 2] = [1.0 / 500.0, 1.0 / 50.0];

/// Forward dynamics in steps that are chosen for the tolerance.
#[derive(Debug)]
pub(crate) struct Radau {
    pub(super) step: RadauStep,
    /// Whether signals prescribe joints.
    pub(super) has_paths: bool,
    /// Size and error of the last step kept.
    pub(super) last: Option<(f64, f64)>,
    /// Whether a law has inner variables, of which the motion may show nothing.
    pub(super) has_inner_variables: bool,
    /// Whether a law keeps inner strokes, whose energies no stroke shows either.
    pub(super) has_inner_strokes: bool,
    pub(super) newton_iterations: u64,
    /// Kinks of forces, and whether the step ends on one.
    pub(super) kinks: Kinks,
    pub(super) is_at_kink: bool,
    pub(super) scratch: Scratch,
}

/// What the next step takes over from those before.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct StepperState {
    carried: Carried,
    /// Size and error of the last step kept.
    last: Option<(f64, f64)>,
    newton_iterations: u64,
}

impl Radau {
    pub(crate) fn new(cx: Context, forward: &Arc<Forward>, settings: &Settings) -> Self {
        let rtol = settings.rtol;
        let mapped = ESTIMATE_SHARE * rtol.powf(2.0 / 3.0);
        let tolerance = Tolerance { rtol: mapped, atol: settings.atol.unwrap_or(0.0) * mapped / rtol };
        let has_inner_strokes = cx.system.elements.iter().any(|element| element.law.hidden_errors() == usize::MAX);
        let mut step = RadauStep::new(cx, forward, tolerance, rtol);
        if has_inner_strokes {
            step.sizes.set_steep();
        }
        Self {
            step,
            has_paths: forward.has_paths(),
            last: None,
            has_inner_variables: cx.system.elements.iter().any(|element| element.law.hidden_errors() > 0),
            has_inner_strokes,
            newton_iterations: 0,
            kinks: Kinks::of(cx.system),
            is_at_kink: false,
            scratch: Scratch::default(),
        }
    }

    /// What the next step takes over from those before.
    pub(crate) fn save(&self) -> StepperState {
        let (carried, last, newton_iterations) = (self.step.carried(), self.last, self.newton_iterations);
        StepperState { carried, last, newton_iterations }
    }

    /// Goes on from what was saved.
    pub(crate) fn load(&mut self, state: StepperState) {
        let StepperState { carried, last, newton_iterations } = state;
        self.step.restore(carried);
        (self.last, self.newton_iterations) = (last, newton_iterations);
    }

    /// How large a motion the forces at the origin begin.
    pub(super) fn expect(&mut self, cx: Context, recorder: &mut Recorder) -> Result<(), RunError> {
        let (t, bank) = (self.step.origin.t, &mut recorder.bank);
        bank.start(t, 0.0);
        self.step.take_inputs(cx, bank, 0.0, t)?;
        self.step.linearise(cx, bank, recorder.control.as_deref_mut())?;
        if let Some(control) = &recorder.control {
            control.write_inputs(cx, 0, bank);
        }
        self.step.sizes.take(&self.step.model, t, &self.step.origin.q, &self.step.origin.v);
        self.step.expect(cx, bank, 1.0 / recorder.settings.end);
        let stretch = self.longest_step(cx, &recorder.settings).min(self.step.sizes.response());
        // What moves has a size; samples and breaks come by the thousand.
        if t < 2.0 * self.step.sizes.looked() && !self.step.rests() {
            return Ok(());
        }
        let (ahead, stretch) = self.step.foresee(cx, bank, recorder.control.as_deref(), stretch)?;
        self.step.sizes.look_ahead(ahead, stretch);
        Ok(())
    }

    /// The step of size `h` that was fitted, as a function of time.
    pub(super) fn dense<'s>(&'s mut self, cx: Context<'s>, recorder: &'s Recorder, h: f64) -> Dense<'s> {
        Dense { cx, step: &self.step, bank: &recorder.bank, h, scratch: &mut self.scratch }
    }
}

impl Stepper for Radau {
    fn longest_step(&self, cx: Context, settings: &Settings) -> f64 {
        let [varying, constant] = LONGEST_STEP;
        let share = if cx.system.varies() { varying } else { constant };
        settings.max_step.unwrap_or(settings.end * share).min(settings.end)
    }

    fn set_up(&self, recorder: &mut Recorder) {
        recorder.takes_elements_work = false;
        recorder.bank.set_course(Course::Sought);
    }

    fn ends_on_sparse_rows(&self) -> bool {
        true
    }

    fn start(&mut self, cx: Context, recorder: &mut Recorder, agenda: &Agenda) -> Result<f64, RunError> {
        let settings = recorder.settings.clone();
        let forward = self.step.forward.clone();
        let control = recorder.control.as_deref_mut();
        let (origin, elements) = start::origin(cx, &forward, &mut self.step.stick, control)?;
        self.step.free = self.step.stick.free();
        let [evaluation, ..] = &mut recorder.evaluations;
        evaluation.q.copy_from_slice(&origin.q);
        evaluation.v.copy_from_slice(&origin.v);
        evaluation.a.copy_from_slice(&origin.a);
        drive(cx, &forward, 0.0, evaluation);
        cx.fill(0.0, 0.0, None, &mut recorder.scratch, evaluation)?;
        recorder.take_inputs_at_start(cx);
        let jolts = start::jolts(cx, &recorder.evaluations[0], &settings)?;
        recorder.jolts = jolts.iter().map(Option::is_some).collect();
        recorder.begin(cx)?;
        if let (Some(control), [evaluation, ..]) = (&recorder.control, &mut recorder.evaluations) {
            control.add_torques(cx, 0, evaluation);
        }
        self.step.origin = origin;
        start::kick(cx, &elements, &jolts, &self.step.free, &mut self.step.origin);
        self.step.is_singular = recorder.bank.has_singular();
        if self.step.is_singular {
            let [evaluation, ..] = &mut recorder.evaluations;
            evaluation.a.fill(f64::NAN);
            evaluation.driven.fill(None);
            cx.fill(0.0, 0.0, None, &mut recorder.scratch, evaluation)?;
        }
        self.expect(cx, recorder)?;
        let strict = Tolerance { rtol: settings.rtol, atol: settings.atol.unwrap_or(0.0) };
        let chosen = start::first_step(cx, (&self.step, &recorder.bank), &elements, strict, settings.end);
        Ok(agenda.reach(0.0, settings.first_step.unwrap_or(chosen).min(self.longest_step(cx, &settings))))
    }

    fn try_step(&mut self, cx: Context, recorder: &mut Recorder, target: Target) -> Result<Trial, RunError> {
        let factor = match self.attempt(cx, recorder, &target)? {
            Err(size) => return Ok(Trial::Rejected { size }),
            Ok(factor) => factor,
        };
        let step = match self.settle(cx, recorder, target)? {
            // At a start the first motion may be as small as it likes.
            Settled::Shorter(size) if is_too_short(&target, size, 0.0) => {
                return Err(self.settles_nowhere(&target));
            }
            Settled::Shorter(size) => return Ok(Trial::Rejected { size }),
            Settled::AtStart => {
                // What expressions alone change is counted with them.
                if self.step.stick.changes() || !recorder.control.as_ref().is_some_and(|control| control.changes()) {
                    self.stop_sliding(recorder.settings.end)?;
                }
                recorder.change_branches(cx, false)?;
                return Ok(Trial::Changes);
            }
            Settled::At(step) => step,
        };
        let jumps = self.is_at_kink && self.kinks.may_jump();
        let switches = recorder.control.as_ref().is_some_and(|control| control.changes());
        let changes = (self.step.stick.changes() || jumps || switches) && step.behind == Behind::Step;
        let behind = if changes { Behind::Change } else { step.behind };
        Ok(Trial::Accepted { step: Target { behind, ..step }, next: target.size * factor })
    }

    fn place(
        &mut self,
        cx: Context,
        recorder: &mut Recorder,
        at: f64,
        theta: f64,
        evaluation: &mut Evaluation,
    ) -> Result<(), RunError> {
        let h = recorder.bank.size();
        self.dense(cx, recorder, h).place(at, theta, evaluation);
        Ok(())
    }

    fn kinematics(&self, node: usize) -> Option<&Kinematics> {
        Some(if node == 0 { &self.step.start } else { &self.step.stages[node - 1].kinematics })
    }

    fn interpolate(
        &mut self,
        cx: Context,
        recorder: &mut Recorder,
        at: f64,
        theta: f64,
        evaluation: &mut Evaluation,
    ) -> Result<(), RunError> {
        self.place(cx, recorder, at, theta, evaluation)?;
        cx.fill(at, at, None, &mut recorder.scratch, evaluation)
    }

    fn accept(&mut self, _: Context, recorder: &Recorder, step: &Target) -> Result<(), RunError> {
        self.step.accept(&recorder.bank, step.size, step.to);
        if self.is_at_kink {
            // What follows is another function: neither the cubic nor the errors before tell anything of it.
            (self.last, self.step.last, self.is_at_kink) = (None, None, false);
        }
        if self.step.stick.changes() {
            self.stop_sliding(recorder.settings.end)?;
        }
        Ok(())
    }

    fn cross(&mut self, cx: Context, recorder: &mut Recorder, after: f64) -> Result<(), RunError> {
        self.restart_at(cx, recorder, after)
    }

    fn newton_iterations(&self) -> Option<u64> {
        Some(self.newton_iterations)
    }
}

impl System {
    /// Whether anything that drives the robot varies with time.
    pub(super) fn varies(&self) -> bool {
        let Motion::Forward(forward) = &self.motion else { return true };
        let drives = forward.drives.iter().any(|drive| match drive {
            Drive::Force(signals) => signals.iter().any(|signal| signal.is_constant().is_none()),
            Drive::Prescribed(_) => true,
            Drive::Locked => false,
        });
        let feedback = self.control.laws().any(|(law, _)| !law.parts_of_time().is_empty());
        let aims = self.control.controller.as_ref().is_some_and(|controlled| {
            controlled.reference.trajectory().signals().iter().any(|signal| signal.is_constant().is_none())
        });
        drives
            || feedback
            || aims
            || self.elements.iter().flat_map(|e| &e.inputs).any(|signal| signal.is_constant().is_none())
    }
}
