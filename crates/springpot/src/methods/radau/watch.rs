//! When joints stop, break away and turn round, and where forces have kinks, within a step that was just solved.

use super::events::{Change, Look};
use super::method::Radau;
use crate::account::recorder::Recorder;
use crate::actuation::Drive;
use crate::collocation::{Cubic, STAGES};
use crate::equations::context::Context;
use crate::equations::control::ControlSeen;
use crate::equations::evaluate::{ElementEvaluation, Evaluation};
use crate::equations::kinks::Seen;
use crate::equations::zero::{SAMPLES, first_zero};
use crate::methods::stepper::Target;
use crate::system::error::RunError;

/// Where holding forces are looked at besides the nodes: between them.
const BETWEEN: [f64; 3] = [0.07, 0.4, 0.83];

/// Steps this short, as a share of the run, are taken as they are.
const SHORT: f64 = 1e-10;

/// Share of rtol that a change may be off, in units of the largest velocity of the step or of the limit.
const SHARE: f64 = 1e-3;

/// A prescribed velocity below this share of its largest is at rest.
const AT_REST: f64 = 1e-9;

/// Where a velocity that leaves rest is first looked at.
const START: f64 = 1e-9;

/// A holding force at the start and at the nodes of a step.
struct Holding {
    cubic: Cubic,
    /// The force that breaks it, and how near a change has to be.
    breaking: f64,
    tolerance: f64,
}

impl Radau {
    /// The first change in a step that was solved and evaluated.
    pub(super) fn look(&mut self, cx: Context, recorder: &mut Recorder, step: &Target) -> Result<Look, RunError> {
        let h = step.size;
        self.step.stick.forget_changes();
        self.is_at_kink = false;
        let mut first: Option<(f64, Change)> = None;
        let mut note = |theta: f64, change: Change| {
            if first.is_none_or(|(earliest, _)| theta < earliest) {
                first = Some((theta, change));
            }
        };
        let rubbing: Vec<(usize, i8)> = self.step.stick.rubbing().collect();
        for &(k, direction) in rubbing.iter().filter(|(_, direction)| *direction != 0) {
            let change = Change::Stop { k, direction: f64::from(direction) };
            let [at_end, before] = [1.0, 0.999].map(|theta| self.value(cx, recorder, change, h, theta));
            if at_end.abs() <= self.near_rest(recorder, k) && at_end < before {
                self.step.stick.stopping.push(k);
            } else if let Some(theta) = self.first_zero_of(cx, recorder, change, h) {
                note(theta, change);
            }
        }
        if rubbing.iter().any(|(_, direction)| *direction == 0) {
            let between = self.look_between(cx, recorder, step)?;
            for &(k, _) in rubbing.iter().filter(|(_, direction)| *direction == 0) {
                let holding = self.holding(recorder, k);
                let limit = self.step.stick.limit(k);
                let off = BETWEEN.iter().zip(&between).map(|(theta, forces)| (holding.at(*theta) - forces[k]).abs());
                let off = off.fold(0.0, f64::max);
                let largest = (0..=SAMPLES).map(|i| holding.at(i as f64 / SAMPLES as f64).abs()).fold(0.0, f64::max);
                if largest + 4.0 * off <= limit {
                    continue;
                }
                let clear = recorder.settings.rtol.sqrt().clamp(1e-6, 1e-2);
                if !(off <= clear * limit || h <= SHORT * recorder.settings.end) {
                    return Ok(Look::Unclear);
                }
                for direction in [1.0, -1.0] {
                    let change = Change::BreakAway { k, direction };
                    let at_end = holding.margin(direction, 1.0);
                    if at_end.abs() <= 0.5 * holding.tolerance && holding.margin(direction, 0.999) > at_end {
                        self.step.stick.breaks_away = true;
                    } else if let Some(theta) = first_zero(|theta| holding.margin(direction, theta)) {
                        note(theta, change);
                    }
                }
            }
        }
        if let Some(theta) = self.first_reversal(h) {
            note(theta, Change::Reversal);
        }
        match self.kinks.look(&recorder.bank, |e| self.step.stroke_noise(e, h)) {
            Seen::Nothing => {}
            Seen::Within(theta, kink) => note(theta, Change::Kink(kink)),
            Seen::AtEnd => self.is_at_kink = true,
        }
        let mut switches = false;
        if let Some(control) = &mut recorder.control {
            match control.look() {
                ControlSeen::Nothing => {}
                ControlSeen::Within(theta, guard) => note(theta, Change::Control(guard)),
                ControlSeen::AtEnd => switches = true,
            }
        }
        Ok(match first {
            Some((theta, change)) => Look::Within(theta, change),
            None if self.step.stick.changes() || self.is_at_kink || switches => Look::AtEnd,
            None => Look::Nothing,
        })
    }

    /// How far from its change a joint is at θ; negative behind it.
    pub(super) fn value(&mut self, cx: Context, recorder: &Recorder, change: Change, h: f64, theta: f64) -> f64 {
        match change {
            Change::Stop { k, direction } => direction * self.dense(cx, recorder, h).velocity(k, theta),
            Change::BreakAway { k, direction } => self.holding(recorder, k).margin(direction, theta),
            Change::Reversal => 0.0,
            Change::Kink(kink) => self.kinks.value(&recorder.bank, kink, theta),
            Change::Control(guard) => recorder.control.as_ref().map_or(0.0, |control| control.guard_at(guard, theta)),
        }
    }

    fn first_zero_of(&mut self, cx: Context, recorder: &Recorder, change: Change, h: f64) -> Option<f64> {
        let Change::Stop { k, .. } = change else { return None };
        // A joint that was at rest is to leave it: over θ, so that the start is no zero.
        let from_rest = self.step.origin.v[k] == 0.0;
        first_zero(|theta| {
            if from_rest {
                let theta = theta.max(START);
                self.value(cx, recorder, change, h, theta) / theta
            } else {
                self.value(cx, recorder, change, h, theta)
            }
        })
    }

    /// A velocity of a joint that slides that counts as rest.
    fn near_rest(&self, recorder: &Recorder, k: usize) -> f64 {
        let nodes = self.step.stages.iter().map(|stage| stage.v[k].abs());
        SHARE * recorder.settings.rtol * nodes.fold(self.step.origin.v[k].abs(), f64::max)
    }

    /// The force with which friction holds velocity `k` at the start and at the nodes.
    fn holding(&self, recorder: &Recorder, k: usize) -> Holding {
        let bank = &recorder.bank;
        let (mut values, mut size) = ([0.0; STAGES + 1], 0.0f64);
        for (i, (value, evaluation)) in values.iter_mut().zip(&recorder.evaluations).enumerate() {
            let driven = evaluation.driven[k].unwrap_or(0.0);
            let (mut pull, mut terms) = (0.0, driven.abs() + evaluation.rigid[k].abs());
            for (e, element) in evaluation.elements.iter().enumerate() {
                let force = match i {
                    0 => bank.now(e, &element.point(evaluation.t)).map_or(0.0, |observation| observation.force()),
                    STAGES => bank.end(e).force(),
                    _ => bank.response(e).force[i - 1],
                };
                let share = force * element.gradient[k];
                pull += share;
                terms += share.abs();
            }
            *value = driven - evaluation.rigid[k] - pull;
            size = if terms.is_finite() { size.max(terms) } else { size };
        }
        // At a singular start nothing is known.
        if !values[0].is_finite() {
            values[0] = values[1];
        }
        let stick = &self.step.stick;
        let tolerance = SHARE * recorder.settings.rtol * stick.limit(k);
        Holding { cubic: Cubic::through(&values), breaking: stick.breaking(k, size) + 0.5 * tolerance, tolerance }
    }

    /// The forces (nv) with which friction would hold every velocity, between the nodes.
    fn look_between(&mut self, cx: Context, recorder: &mut Recorder, step: &Target) -> Result<[Vec<f64>; 3], RunError> {
        let mut evaluation = self.step.stick.spare.take().unwrap_or_else(|| Evaluation::new(cx.system));
        let mut forces: [Vec<f64>; 3] = Default::default();
        for (theta, forces) in BETWEEN.into_iter().zip(&mut forces) {
            let at = (step.from + theta * step.size).min(step.to);
            self.dense(cx, recorder, step.size).place(at, theta, &mut evaluation);
            cx.fill(at, at, None, &mut recorder.scratch, &mut evaluation)?;
            recorder.control(cx, Some(theta), &mut evaluation)?;
            let pull = |(e, element): (usize, &ElementEvaluation)| recorder.bank.at(e, theta, &element.point(at));
            let pulls = evaluation.elements.iter().enumerate().map(pull);
            let pulls: Vec<f64> = pulls.map(|seen| seen.map_or(0.0, |observation| observation.force())).collect();
            forces.extend((0..cx.system.model.nv()).map(|k| {
                let pull = pulls.iter().zip(&evaluation.elements).map(|(force, element)| force * element.gradient[k]);
                evaluation.driven[k].unwrap_or(0.0) - evaluation.rigid[k] - pull.sum::<f64>()
            }));
        }
        self.step.stick.spare = Some(evaluation);
        Ok(forces)
    }

    /// Where the first joint turns round that signals move against friction that sticks.
    fn first_reversal(&self, h: f64) -> Option<f64> {
        let (t, step) = (self.step.origin.t, &self.step);
        let mut first: Option<f64> = None;
        for (j, drive) in step.model.own_joints().zip(&step.forward.drives) {
            let Drive::Prescribed(path) = drive else { continue };
            if !step.stick.led().contains(&j) {
                continue;
            }
            let velocity = |theta: f64| {
                let [mut q, mut v, mut a] = [[0.0]; 3];
                path.at(t + theta * h, &mut q, &mut v, &mut a);
                v[0]
            };
            let nodes = step.stages.each_ref().map(|stage| stage.v[step.model.v_range(j).start]);
            let largest = nodes.into_iter().fold(0.0, |largest: f64, v| largest.max(v.abs()));
            // At the start it may have turned round just now.
            let early = velocity(0.25 / SAMPLES as f64);
            if nodes[STAGES - 1].abs() <= AT_REST * largest || early == 0.0 {
                continue;
            }
            let zero = first_zero(|theta| early.signum() * velocity(theta.max(0.25 / SAMPLES as f64)));
            first = first.into_iter().chain(zero).reduce(f64::min);
        }
        first
    }
}

impl Holding {
    fn at(&self, theta: f64) -> f64 {
        self.cubic.at(theta)
    }

    /// What is missing to break away in a direction.
    fn margin(&self, direction: f64, theta: f64) -> f64 {
        self.breaking - direction * self.at(theta)
    }
}
