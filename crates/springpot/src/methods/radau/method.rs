//! The method behind the driver.

use super::dense::{Dense, Scratch};
use super::start;
use super::step::{Carried, RadauStep};
use crate::account::recorder::Recorder;
use crate::actuation::Forward;
use crate::collocation::STAGES;
use crate::dynamics::Kinematics;
use crate::equations::context::Context;
use crate::equations::drives::drive;
use crate::equations::evaluate::Evaluation;
use crate::equations::{Change, Equations, Look, ROW, Solved, Within};
use crate::law::Course;
use crate::methods::chosen::{Tolerance, is_too_short, no_convergence, solved, without_inertia};
use crate::methods::stepper::{Behind, Stepper, Target, Trial};
use crate::observe::Snapshot;
use crate::signal::Agenda;
use crate::system::error::RunError;
use crate::system::settings::Settings;
use serde::{Deserialize, Serialize};

/// The estimate is of order 3, the method of order 5: the estimate may reach this share of rtol^⅔.
const ESTIMATE_SHARE: f64 = 0.03;

/// The longest step as a share of the run, so that no signal is stepped over: where something varies with time, and where nothing
/// does.
const LONGEST_STEP: [f64; 2] = [1.0 / 500.0, 1.0 / 50.0];

/// Forward dynamics in steps that are chosen for the tolerance.
#[derive(Debug)]
pub(crate) struct Radau {
    pub(in crate::methods) step: RadauStep,
    /// Whether signals prescribe joints.
    pub(in crate::methods) has_paths: bool,
    /// Size and error of the last step kept.
    pub(in crate::methods) last: Option<(f64, f64)>,
    /// Whether a law has inner variables, of which the motion may show nothing.
    pub(super) has_inner_variables: bool,
    /// Whether a law keeps inner strokes, whose energies no stroke shows either.
    pub(super) has_inner_strokes: bool,
    pub(in crate::methods) newton_iterations: u64,
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
    pub(crate) fn new(cx: Context, forward: &Forward, settings: &Settings) -> Self {
        let rtol = settings.rtol;
        let mapped = ESTIMATE_SHARE * rtol.powf(2.0 / 3.0);
        let tolerance = Tolerance { rtol: mapped, atol: settings.atol.unwrap_or(0.0) * mapped / rtol };
        let hidden = cx.system.elements.iter().map(|element| element.law.hidden_errors()).max().unwrap_or(0);
        let has_inner_strokes = hidden == usize::MAX;
        let mut step = RadauStep::new(&cx.system.model, forward, tolerance, rtol);
        if has_inner_strokes {
            step.errors.sizes.set_steep();
        }
        Self {
            step,
            has_paths: forward.has_paths(),
            last: None,
            has_inner_variables: hidden > 0,
            has_inner_strokes,
            newton_iterations: 0,
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

    /// Takes over from another method, of whose steps nothing is predicted.
    pub(in crate::methods) fn begin_anew(&mut self) {
        self.last = None;
        self.step.restart();
    }

    /// How large a motion the forces at the origin begin.
    pub(super) fn expect(&mut self, cx: Context, recorder: &mut Recorder) -> Result<(), RunError> {
        let (equations, settings, t) = (&mut recorder.equations, &recorder.settings, self.step.origin.t);
        if equations.begin(cx, self.step.origin.node(), 0.0, t)? {
            self.step.take_off_singular(equations);
        }
        let longest = self.longest_step(cx, settings);
        self.step.expect(cx, equations, settings.end, longest)
    }

    /// Hands over the step that was solved and evaluated, and the equations that it solves.
    fn solved<T>(
        &mut self,
        recorder: &mut Recorder,
        step: &Target,
        take: impl FnOnce(&mut Equations, &mut Solved) -> T,
    ) -> T {
        let mut within = Dense { step: &self.step, h: step.size, scratch: &mut self.scratch };
        solved(recorder, step, (&mut within, &self.step.errors.noise), take)
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
        recorder.equations.bank.set_course(Course::Sought);
    }

    fn ends_on_sparse_rows(&self) -> bool {
        true
    }

    fn start(&mut self, cx: Context, recorder: &mut Recorder, agenda: &Agenda) -> Result<f64, RunError> {
        let settings = recorder.settings.clone();
        let (origin, elements) = recorder.equations.at_start(cx)?;
        let [evaluation, ..] = &mut recorder.evaluations;
        evaluation.q.copy_from_slice(&origin.q);
        evaluation.v.copy_from_slice(&origin.v);
        evaluation.a.copy_from_slice(&origin.a);
        drive(cx, recorder.equations.forward(), 0.0, evaluation);
        cx.fill(0.0, 0.0, None, &mut recorder.scratch, evaluation)?;
        recorder.take_inputs_at_start(cx);
        let jolts = recorder.begin_with_jolts(cx)?;
        recorder.equations.add_torques(cx, 0, &mut recorder.evaluations[0]);
        self.step.origin = origin;
        recorder.equations.kick(cx, &elements, &jolts, &mut self.step.origin);
        if recorder.equations.is_singular() {
            let [evaluation, ..] = &mut recorder.evaluations;
            evaluation.a.fill(f64::NAN);
            evaluation.driven.fill(None);
            cx.fill(0.0, 0.0, None, &mut recorder.scratch, evaluation)?;
        }
        self.expect(cx, recorder)?;
        let strict = Tolerance { rtol: settings.rtol, atol: settings.atol.unwrap_or(0.0) };
        let chosen = start::first_step(cx, (&self.step, &recorder.equations), &elements, strict, settings.end);
        Ok(agenda.reach(0.0, settings.first_step.unwrap_or(chosen).min(self.longest_step(cx, &settings))))
    }

    fn solve(&mut self, cx: Context, recorder: &mut Recorder, target: &Target) -> Result<Result<f64, f64>, RunError> {
        Ok(self.attempt(cx, recorder, target)?.map(|factor| target.size * factor))
    }

    fn look(&mut self, cx: Context, recorder: &mut Recorder, step: &Target) -> Result<Look, RunError> {
        if recorder.equations.is_smooth() {
            return Ok(Look::Nothing);
        }
        self.solved(recorder, step, |equations, solved| equations.look(cx, solved))
    }

    fn value(&mut self, cx: Context, recorder: &mut Recorder, step: &Target, change: Change, theta: f64) -> f64 {
        self.solved(recorder, step, |equations, solved| equations.value(cx, solved, change, theta))
    }

    fn judge(&mut self, _: Context, recorder: &mut Recorder, step: Target, next: f64) -> Result<Trial, RunError> {
        let changes = recorder.equations.starts_anew() && step.behind == Behind::Step;
        let behind = if changes { Behind::Change } else { step.behind };
        Ok(Trial::Accepted { step: Target { behind, ..step }, next })
    }

    fn vary(&mut self, _: Context, recorder: &mut Recorder, step: &Target) -> Result<(), RunError> {
        let Recorder { equations, variation, recording, .. } = recorder;
        let Some(variation) = variation else { return Ok(()) };
        // What shares in the choice of steps was worked out with the step.
        if variation.shares_in_steps() {
            return Ok(());
        }
        let leaning = equations.lean(step.size, &self.step.errors.noise);
        let (size, t_end) = (step.size, step.end_inputs());
        let is_regular = match recording.as_deref().filter(|recording| recording.takes_whole(variation, equations)) {
            Some(recording) => self.step.keep(equations, (variation, recording), size, t_end),
            None => self.step.vary(equations, variation, size, t_end),
        };
        equations.stand(leaning);
        if is_regular { Ok(()) } else { Err(without_inertia(step.from)) }
    }

    fn starts_with(&self) -> Option<[&[f64]; 2]> {
        Some([&self.step.origin.v, &self.step.origin.a])
    }

    fn vary_within(&mut self, recorder: &mut Recorder, within: Option<(f64, f64)>, _: &Snapshot) {
        let Recorder { equations, variation: Some(variation), .. } = recorder else { return };
        if let (Some((_, size)), true) = (within, variation.is_unsolved())
            && let Some(t_end) = variation.follow_columns()
        {
            // It was regular when it was kept.
            let leaning = equations.lean(size, &self.step.errors.noise);
            self.step.vary(equations, variation, size, t_end);
            equations.stand(leaning);
        }
        match within {
            Some((theta, size)) => self.step.vary_within(variation, theta, size),
            None => variation.take_start(ROW),
        }
    }

    fn gives_up(&self, _: Context, _: &Recorder, step: &Target, size: f64) -> Option<RunError> {
        // At a start the first motion may be as small as it likes.
        is_too_short(step, size, 0.0).then(|| no_convergence(step, &self.step.model, &self.step.stages[STAGES - 1].v))
    }

    fn change_at_start(&mut self, cx: Context, recorder: &mut Recorder) -> Result<(), RunError> {
        let equations = &mut recorder.equations;
        // What expressions alone change is counted with them.
        if equations.sticks_or_slips() || !equations.switches() {
            equations.stop_sliding(cx, &mut self.step.origin, recorder.settings.end)?;
        }
        Ok(())
    }

    fn place(
        &mut self,
        cx: Context,
        recorder: &mut Recorder,
        at: f64,
        theta: f64,
        evaluation: &mut Evaluation,
    ) -> Result<(), RunError> {
        let equations = &recorder.equations;
        let mut dense = Dense { step: &self.step, h: equations.bank.size(), scratch: &mut self.scratch };
        dense.place(cx, equations, at, theta, evaluation);
        Ok(())
    }

    fn kinematics<'s>(&'s self, equations: &'s Equations, node: usize) -> Option<&'s Kinematics> {
        Some(match node {
            0 => equations.kinematics_at_start(),
            _ => &self.step.stages[node - 1].kinematics,
        })
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

    fn accept(&mut self, cx: Context, recorder: &mut Recorder, step: &Target) -> Result<(), RunError> {
        let equations = &mut recorder.equations;
        self.step.accept(step.size, step.to);
        equations.accept(&mut self.step.stages[STAGES - 1].kinematics);
        if equations.take_kink(cx.system, step.to, recorder.settings.end)? {
            // What follows is another function: neither the cubic nor the errors before tell anything of it.
            (self.last, self.step.fitted.last) = (None, None);
        }
        if equations.sticks_or_slips() {
            equations.stop_sliding(cx, &mut self.step.origin, recorder.settings.end)?;
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
