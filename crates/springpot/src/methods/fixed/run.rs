//! Steps of one size behind the driver: with the energy ledger, and what rows ask for where there are some.

use super::between::{Accelerator, Between};
use super::step::{ITERATIONS, OneStage};
use crate::account::recorder::Recorder;
use crate::actuation::Forward;
use crate::collocation::Nodes;
use crate::collocation::{RADAU_NODES, STAGES};
use crate::elements::ElementBank;
use crate::equations::ROW;
use crate::equations::context::Context;
use crate::equations::drives::drive;
use crate::equations::evaluate::Evaluation;
use crate::equations::resistance::joint_loss;
use crate::fractional::Form;
use crate::law::Course;
use crate::methods::stepper::{Stepper, Target};
use crate::observe::Snapshot;
use crate::signal::Agenda;
use crate::system::error::RunError;
use crate::system::fixed_step::FixedStep;
use crate::system::sensitivity::SensitivityError;
use crate::system::settings::Settings;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Forward dynamics in steps of one size.
///
/// A row inside a step takes its place from the cubic Hermite form between the ends and its velocity from a straight line; its accelerations
/// solve the equations of motion at the ends of the step. Signals are met at the stages, their kinks are stepped over. The residual of the
/// ledger is the method's own error, of its order in the step.
#[derive(Debug)]
pub(crate) struct Fixed {
    by: FixedStep,
    step: OneStage,
    accelerator: Accelerator,
    /// Whether signals prescribe joints, whose actuators follow from all forces.
    has_paths: bool,
    newton_iterations: u64,
}

/// Where the next step starts.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct StepperState {
    t: f64,
    q: Vec<f64>,
    v: Vec<f64>,
    newton_iterations: u64,
}

impl Fixed {
    pub(crate) fn new(cx: Context, forward: &Arc<Forward>, by: FixedStep) -> Result<Self, RunError> {
        Ok(Self {
            by,
            step: OneStage::new(cx, forward, by.method)?,
            accelerator: Accelerator::new(cx, forward),
            has_paths: forward.has_paths(),
            newton_iterations: 0,
        })
    }

    /// What the next step takes over from those before.
    pub(crate) fn save(&self) -> StepperState {
        let origin = &self.step.origin;
        let (t, q, v) = (origin.t, origin.q.clone(), origin.v.clone());
        StepperState { t, q, v, newton_iterations: self.newton_iterations }
    }

    /// Goes on from what was saved.
    pub(crate) fn load(&mut self, cx: Context, state: StepperState) {
        self.newton_iterations = state.newton_iterations;
        self.step.go_on(cx, state.t, &state.q, &state.v);
    }

    /// Tells the bank the step at the nodes of the ledger: coordinates of the measures on a straight line between its ends,
    /// as its memories take it, and the rates of the cubic through coordinates and rates there.
    fn tell_ledger(&self, cx: Context, bank: &mut ElementBank, target: &Target) {
        bank.set_nodes(Nodes::Radau);
        for (e, (element, [from, to])) in cx.system.elements.iter().zip(self.step.equations.ends()).enumerate() {
            bank.set_resolution(e, element.resolution(from.coordinate));
            for (k, c) in [0.0].into_iter().chain(RADAU_NODES).enumerate() {
                let travel = to.coordinate - from.coordinate;
                let rate = 6.0 * c * (1.0 - c) * travel / target.size
                    + (1.0 - c) * (1.0 - 3.0 * c) * from.rate
                    + c * (3.0 * c - 2.0) * to.rate;
                bank.set_stroke(e, k, element.stroke(from.coordinate + c * travel), rate);
                cx.inputs_at(e, target.from + c * target.size, bank.inputs_mut(e, k));
            }
        }
    }

    /// Fills the evaluations at the nodes of the ledger as far as it asks for them.
    fn fill_evaluations(&self, cx: Context, recorder: &mut Recorder, target: &Target) -> Result<(), RunError> {
        let (step, bank) = (&self.step, &recorder.equations.bank);
        for (evaluation, c) in recorder.evaluations[1..].iter_mut().zip(RADAU_NODES) {
            let at = if c == 1.0 { target.to } else { target.from + c * target.size };
            if self.has_paths {
                let ends = [&step.origin, &step.end];
                Between::new(cx, step.equations.forward(), ends, [&step.a, &step.a], target.size)
                    .place(at, c, evaluation);
                cx.fill(at, at, None, &mut recorder.scratch, evaluation)?;
                continue;
            }
            for (v, (from, to)) in evaluation.v.iter_mut().zip(step.origin.v.iter().zip(&step.end.v)) {
                *v = from + c * (to - from);
            }
            drive(cx, step.equations.forward(), at, evaluation);
            evaluation.joint_loss = joint_loss(cx.system, &evaluation.v);
        }
        let end = &mut recorder.evaluations[STAGES];
        end.q.copy_from_slice(&step.end.q);
        end.v.copy_from_slice(&step.end.v);
        if !self.has_paths {
            let ends = step.equations.ends().enumerate();
            let elements = ends.map(|(e, [_, end])| (end, bank.point(e, STAGES).inputs));
            cx.fill_energies(target.to, &step.end.kinematics, elements, end);
        }
        Ok(())
    }

    /// What parameters change of the accelerations at the start (0) or at the end (1) of the step.
    fn accelerate_variation(&self, recorder: &mut Recorder, end: usize) {
        let Recorder { evaluations, equations, variation: Some(variation), .. } = recorder else { return };
        let (at, OneStage { free, limits, .. }) = (&evaluations[end * STAGES], &self.step);
        let rests = |k: usize| limits[k] > 0.0 && at.v[k] == 0.0;
        variation.accelerate_end(equations, end, at, (free, rests));
    }

    /// Accelerations and all else that a row asks for, at the start (0) or at the end (1) of the step.
    fn accelerate(&mut self, cx: Context, recorder: &mut Recorder, end: usize) -> Result<(), RunError> {
        let Recorder { evaluations, equations, scratch, is_whole, .. } = recorder;
        let bank = &equations.bank;
        let evaluation = &mut evaluations[end * STAGES];
        let force = |e: usize, evaluation: &Evaluation| match end {
            0 => bank.now(e, &evaluation.elements[e].point(evaluation.t)).map_or(0.0, |now| now.finite_force()),
            _ => bank.end(e).force(),
        };
        self.accelerator.fill(cx, self.step.equations.forward(), evaluation.t, scratch, evaluation, force)?;
        is_whole[end] = true;
        Ok(())
    }
}

impl Stepper for Fixed {
    fn longest_step(&self, _: Context, _: &Settings) -> f64 {
        self.by.step
    }

    fn fixed_step(&self) -> Option<f64> {
        Some(self.by.step)
    }

    fn set_up(&self, recorder: &mut Recorder) {
        recorder.takes_elements_work = false;
        recorder.equations.bank.set_course(Course::Sought);
        (0..recorder.equations.bank.len()).for_each(|e| recorder.equations.bank.set_form(e, Form::Strokes));
    }

    fn start(&mut self, cx: Context, recorder: &mut Recorder, _: &Agenda) -> Result<f64, RunError> {
        let [evaluation, ..] = &mut recorder.evaluations;
        evaluation.q.copy_from_slice(&self.step.origin.q);
        evaluation.v.copy_from_slice(&self.step.origin.v);
        cx.fill(0.0, 0.0, None, &mut recorder.scratch, evaluation)?;
        recorder.begin(cx)?;
        self.accelerate(cx, recorder, 0)?;
        if recorder.equations.bank.has_singular() {
            let [evaluation, ..] = &mut recorder.evaluations;
            evaluation.a.fill(f64::NAN);
            evaluation.driven.fill(None);
        }
        Ok(self.by.step)
    }

    fn solve(&mut self, cx: Context, recorder: &mut Recorder, target: &Target) -> Result<Result<f64, f64>, RunError> {
        self.step.attempt(cx, &mut recorder.equations.bank, target.to, target.size)?;
        self.newton_iterations += u64::from(ITERATIONS);
        if let Recorder { equations, variation: Some(variation), .. } = recorder {
            if !self.step.vary(equations, variation, target.size) {
                let what = format!("a motion without inertia at t = {} s", target.from);
                return Err(SensitivityError::Unknown { what }.into());
            }
            if !self.step.is_found() {
                variation
                    .lose_all(target.from, "a step ends before its iterations have found it: friction bends within it");
            }
            variation.tell_ledger([target.from, target.to], target.size);
        }
        self.tell_ledger(cx, &mut recorder.equations.bank, target);
        self.fill_evaluations(cx, recorder, target)?;
        (0..recorder.equations.bank.len()).for_each(|e| _ = recorder.equations.bank.account(e));
        recorder.is_whole[1] = false;
        if self.has_paths {
            self.accelerate(cx, recorder, 1)?;
        }
        recorder.take_powers(|_, e, _| self.step.equations.force(e));
        Ok(Ok(self.by.step))
    }

    fn vary_within(&mut self, recorder: &mut Recorder, within: Option<(f64, f64)>, _: &Snapshot) {
        match within {
            None => {
                self.accelerate_variation(recorder, 0);
                recorder.variation.iter_mut().for_each(|variation| variation.take_start(ROW));
            }
            Some((1.0, _)) => {
                self.accelerate_variation(recorder, 1);
                recorder.variation.iter_mut().for_each(|variation| variation.take_end());
            }
            Some((theta, h)) => {
                (0..2).for_each(|end| self.accelerate_variation(recorder, end));
                let Recorder { evaluations: [start, ..], variation, .. } = recorder;
                let has_first = start.a.iter().all(|a| a.is_finite());
                if let Some(variation) = variation {
                    variation.go_between(theta, h, has_first);
                    self.step.turn_between(variation, theta, h);
                }
            }
        }
    }

    fn complete(&mut self, cx: Context, recorder: &mut Recorder, end: usize) -> Result<(), RunError> {
        if recorder.is_whole[end] { Ok(()) } else { self.accelerate(cx, recorder, end) }
    }

    fn place(
        &mut self,
        cx: Context,
        recorder: &mut Recorder,
        at: f64,
        theta: f64,
        evaluation: &mut Evaluation,
    ) -> Result<(), RunError> {
        self.complete(cx, recorder, 0)?;
        self.complete(cx, recorder, 1)?;
        let [start, .., end] = &recorder.evaluations;
        let step = &self.step;
        // Of a singular start there are none.
        let first = if start.a.iter().all(|a| a.is_finite()) { &start.a } else { &step.a };
        let h = recorder.equations.bank.size();
        let within = Between::new(cx, step.equations.forward(), [&step.origin, &step.end], [first, &end.a], h);
        within.place(at, theta, evaluation);
        Ok(())
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

    fn accept(&mut self, _: Context, _: &mut Recorder, _: &Target) -> Result<(), RunError> {
        self.step.accept();
        Ok(())
    }

    fn cross(&mut self, cx: Context, recorder: &mut Recorder, to: f64) -> Result<(), RunError> {
        let mut right = recorder.evaluations[0].clone();
        cx.fill(to, to, None, &mut recorder.scratch, &mut right)?;
        recorder.jump(cx, right)?;
        // Its accelerations are worked out where a row asks for them.
        recorder.is_whole[0] = false;
        Ok(())
    }

    fn newton_iterations(&self) -> Option<u64> {
        Some(self.newton_iterations)
    }
}
