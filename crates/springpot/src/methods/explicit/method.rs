//! The method behind the driver.

use super::between::Between;
use super::step::ExplicitStep;
use super::stiffness::{Answering, Work, calm};
use super::variation::Varied;
use crate::account::recorder::Recorder;
use crate::actuation::Forward;
use crate::dynamics::Kinematics;
use crate::equations::context::Context;
use crate::equations::drives::drive;
use crate::equations::evaluate::Evaluation;
use crate::equations::{Change, Equations, Look, Solved, Within};
use crate::methods::chosen::{Tolerance, is_too_short, no_convergence, solved, without_inertia};
use crate::methods::radau::{self, Radau};
use crate::methods::stepper::{ExplicitEffort, Stepper, Target, Trial};
use crate::observe::Snapshot;
use crate::signal::Agenda;
use crate::system::Adaptive;
use crate::system::definite::Definite;
use crate::system::error::RunError;
use crate::system::settings::Settings;
use serde::{Deserialize, Serialize};

/// What a step may err, as a share of what the run may, and the tolerance from which on errors that grow with the motion, of long steps, take more.
const SHARE: f64 = 0.05;
const COARSE: f64 = 3e-7;

/// Forward dynamics in explicit steps, and in those of Radau IIA while they are stiff.
#[derive(Debug)]
pub(crate) struct Explicit {
    /// Where steps start and what errors are measured by, and the method while it is stiff.
    pub(super) radau: Radau,
    pub(super) step: ExplicitStep,
    pub(super) tolerance: Tolerance,
    /// Size times spectral radius that a step has at most.
    pub(super) calm: f64,
    /// Whether nothing but it was asked for.
    pub(super) is_forced: bool,
    /// Whether somebody always looks into the step.
    pub(super) looks_into: bool,
    /// Size of the step that was tried last, s.
    pub(super) h: f64,
    pub(super) was_rejected: bool,
    /// Whether rounding makes more of every velocity in the step than it may err.
    pub(super) is_rounding: bool,
    pub(super) way: Vec<f64>,
    pub(super) inner: [Kinematics; 2],
    pub(super) sums: [Vec<f64>; 2],
    pub(super) xi: Vec<f64>,
    pub(super) varied: Varied,
    pub(super) kept: Kept,
}

/// What the next step takes over from those before, beside what Radau does.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Kept {
    /// Whether Radau is at work.
    pub(super) is_stiff: bool,
    /// Whether the method at work is on trial against `other_rate`, the work of the other one per second.
    pub(super) is_tried: bool,
    pub(super) other_rate: f64,
    /// Steps since a method took over or was found better.
    pub(super) taken: u32,
    pub(super) work: Work,
    /// How many times as long each method is kept before the other one is tried: the explicit one, and Radau.
    pub(super) patience: [u32; 2],
    /// Whether what changes of the accelerations at the start is that before a kink.
    pub(super) is_behind_kink: bool,
    /// Error of the last explicit step kept.
    pub(super) last: Option<f64>,
    /// Explicit steps near the edge of stability, and those off it since.
    pub(super) stiff_steps: u32,
    pub(super) other_steps: u32,
    /// Explicit steps in a row that know no more than rounding leaves.
    pub(super) rounding_steps: u32,
    pub(super) answering: Answering,
    pub(super) evaluations: u64,
    pub(super) steps: u64,
    pub(super) switches: u64,
}

/// What the next step takes over from those before.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct StepperState {
    radau: radau::StepperState,
    kept: Kept,
}

impl Explicit {
    pub(crate) fn new(cx: Context, forward: &Forward, settings: &Settings) -> Self {
        let share = SHARE / (1.0 + (settings.rtol / COARSE).sqrt());
        let model = &cx.system.model;
        Self {
            radau: Radau::new(cx, forward, settings),
            step: ExplicitStep::new(cx.system, forward),
            tolerance: Tolerance { rtol: share * settings.rtol, atol: share * settings.atol.unwrap_or(0.0) },
            calm: calm(settings.rtol),
            is_forced: settings.adaptive == Adaptive::Explicit,
            looks_into: Definite::of(model).is_some(),
            h: 0.0,
            was_rejected: false,
            is_rounding: false,
            way: Vec::new(),
            inner: std::array::from_fn(|_| Kinematics::new(model)),
            sums: Default::default(),
            xi: Vec::new(),
            varied: Varied::new(model),
            kept: Kept::new(),
        }
    }

    /// What the next step takes over from those before.
    pub(crate) fn save(&self) -> StepperState {
        StepperState {
            radau: self.radau.save(),
            kept: Kept { evaluations: self.step.evaluations, ..self.kept.clone() },
        }
    }

    /// Goes on from what was saved.
    pub(crate) fn load(&mut self, state: StepperState) {
        let StepperState { radau, kept } = state;
        self.radau.load(radau);
        (self.step.evaluations, self.kept) = (kept.evaluations, kept);
        self.begin_anew();
    }

    /// The next step has another start than the end of the last one.
    fn begin_anew(&mut self) {
        self.step.forget();
        self.was_rejected = false;
    }

    /// Hands over the step that was worked out and told, and the equations that it solves.
    fn solved<T>(
        &mut self,
        recorder: &mut Recorder,
        step: &Target,
        take: impl FnOnce(&mut Equations, &mut Solved) -> T,
    ) -> T {
        let Self { radau, step: own, xi, .. } = self;
        let mut within = Between { step: own, origin: &radau.step.origin, h: step.size, xi };
        solved(recorder, step, (&mut within, &radau.step.errors.noise), take)
    }

    /// Goes on to the end of the step.
    ///
    /// # Errors
    /// [`RunError::ForceChatter`].
    fn go_on(&mut self, cx: Context, recorder: &mut Recorder, step: &Target) -> Result<(), RunError> {
        let Recorder { equations, settings, .. } = recorder;
        let (own, radau) = (&mut self.step, &mut self.radau);
        radau.step.arrive(step.to, [&own.end.q, &own.end.v, &own.end.a]);
        equations.arrive(&own.forces, &mut own.kinematics);
        own.accept(equations.free());
        self.kept.steps += 1;
        if equations.take_kink(cx.system, step.to, settings.end)? {
            (self.kept.last, self.kept.is_behind_kink) = (None, true);
            self.begin_anew();
        }
        Ok(())
    }
}

impl Kept {
    fn new() -> Self {
        Self {
            is_stiff: false,
            is_tried: false,
            other_rate: 0.0,
            taken: 0,
            work: Work::default(),
            patience: [1; 2],
            is_behind_kink: false,
            last: None,
            stiff_steps: 0,
            other_steps: 0,
            rounding_steps: 0,
            answering: Answering::default(),
            evaluations: 0,
            steps: 0,
            switches: 0,
        }
    }
}

impl Stepper for Explicit {
    fn longest_step(&self, cx: Context, settings: &Settings) -> f64 {
        self.radau.longest_step(cx, settings)
    }

    fn set_up(&self, recorder: &mut Recorder) {
        self.radau.set_up(recorder);
    }

    fn ends_on_sparse_rows(&self) -> bool {
        true
    }

    fn is_cubic(&self) -> bool {
        self.kept.is_stiff
    }

    fn start(&mut self, cx: Context, recorder: &mut Recorder, agenda: &Agenda) -> Result<f64, RunError> {
        self.radau.start(cx, recorder, agenda)
    }

    fn solve(&mut self, cx: Context, recorder: &mut Recorder, target: &Target) -> Result<Result<f64, f64>, RunError> {
        if self.kept.is_stiff {
            recorder.works = None;
            let before = self.radau.newton_iterations;
            let solved = self.radau.solve(cx, recorder, target);
            let count = recorder.equations.free().len();
            self.kept.work.of_implicit_try(count, self.radau.newton_iterations - before);
            return solved;
        }
        self.kept.work.of_explicit_try();
        Ok(self.attempt(cx, recorder, target)?.map(|factor| target.size * factor))
    }

    fn look(&mut self, cx: Context, recorder: &mut Recorder, step: &Target) -> Result<Look, RunError> {
        if self.kept.is_stiff || recorder.equations.is_smooth() {
            return self.radau.look(cx, recorder, step);
        }
        self.solved(recorder, step, |equations, solved| equations.look(cx, solved))
    }

    fn value(&mut self, cx: Context, recorder: &mut Recorder, step: &Target, change: Change, theta: f64) -> f64 {
        if self.kept.is_stiff {
            return self.radau.value(cx, recorder, step, change, theta);
        }
        self.solved(recorder, step, |equations, solved| equations.value(cx, solved, change, theta))
    }

    fn judge(&mut self, cx: Context, recorder: &mut Recorder, step: Target, next: f64) -> Result<Trial, RunError> {
        self.radau.judge(cx, recorder, step, next)
    }

    fn vary(&mut self, cx: Context, recorder: &mut Recorder, step: &Target) -> Result<(), RunError> {
        if self.kept.is_stiff {
            return self.radau.vary(cx, recorder, step);
        }
        // What shares in the choice of steps was worked out with the step.
        let shares = recorder.variation.as_ref().is_some_and(|variation| variation.shares_in_steps());
        if shares || self.vary_step(recorder, step) { Ok(()) } else { Err(without_inertia(step.from)) }
    }

    fn vary_within(&mut self, recorder: &mut Recorder, within: Option<(f64, f64)>, shown: &Snapshot) {
        match self.kept.is_stiff {
            true => self.radau.vary_within(recorder, within, shown),
            false => self.vary_row(recorder, within, shown),
        }
    }

    fn starts_with(&self) -> Option<[&[f64]; 2]> {
        self.radau.starts_with()
    }

    fn gives_up(&self, cx: Context, recorder: &Recorder, step: &Target, size: f64) -> Option<RunError> {
        if self.kept.is_stiff {
            return self.radau.gives_up(cx, recorder, step, size);
        }
        is_too_short(step, size, 0.0).then(|| no_convergence(step, &cx.system.model, &self.step.end.v))
    }

    fn change_at_start(&mut self, cx: Context, recorder: &mut Recorder) -> Result<(), RunError> {
        self.begin_anew();
        self.radau.change_at_start(cx, recorder)
    }

    fn place(
        &mut self,
        cx: Context,
        recorder: &mut Recorder,
        at: f64,
        theta: f64,
        evaluation: &mut Evaluation,
    ) -> Result<(), RunError> {
        if self.kept.is_stiff {
            return self.radau.place(cx, recorder, at, theta, evaluation);
        }
        self.fill_between(cx, recorder)?;
        let Self { radau, step, xi, h, .. } = self;
        let mut between = Between { step, origin: &radau.step.origin, h: *h, xi };
        between.place(cx, &recorder.equations, at, theta, evaluation);
        Ok(())
    }

    fn kinematics<'s>(&'s self, equations: &'s Equations, node: usize) -> Option<&'s Kinematics> {
        if self.kept.is_stiff { self.radau.kinematics(equations, node) } else { None }
    }

    fn interpolate(
        &mut self,
        cx: Context,
        recorder: &mut Recorder,
        at: f64,
        theta: f64,
        evaluation: &mut Evaluation,
    ) -> Result<(), RunError> {
        if self.kept.is_stiff {
            return self.radau.interpolate(cx, recorder, at, theta, evaluation);
        }
        self.place(cx, recorder, at, theta, evaluation)?;
        let Recorder { equations, scratch, .. } = recorder;
        let Evaluation { q, v, a, .. } = &mut *evaluation;
        self.step.accelerate(cx, equations, at, [q, v, a])?;
        drive(cx, equations.forward(), at, evaluation);
        cx.fill(at, at, None, scratch, evaluation)
    }

    fn accept(&mut self, cx: Context, recorder: &mut Recorder, step: &Target) -> Result<(), RunError> {
        match self.kept.is_stiff {
            true => self.radau.accept(cx, recorder, step)?,
            false => self.go_on(cx, recorder, step)?,
        }
        let settings = &recorder.settings;
        let longest = self.longest_step(cx, settings);
        self.reconsider(&recorder.equations, (step.to, step.size), (longest, settings.end))
    }

    fn cross(&mut self, cx: Context, recorder: &mut Recorder, after: f64) -> Result<(), RunError> {
        self.begin_anew();
        self.kept.last = None;
        self.radau.cross(cx, recorder, after)
    }

    fn newton_iterations(&self) -> Option<u64> {
        self.radau.newton_iterations()
    }

    fn explicit(&self) -> Option<ExplicitEffort> {
        let Kept { steps, switches, .. } = self.kept;
        Some(ExplicitEffort { steps, evaluations: self.step.evaluations, switches })
    }
}
