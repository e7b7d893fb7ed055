//! What may change within a step that was solved, each a function that passes zero where it does: friction that starts or ceases to hold a
//! joint, kinks of the elements' forces, branches of control.

use super::assembly::Equations;
use super::context::Context;
use super::control::{ControlRun, ControlSeen, Guard};
use super::evaluate::{ElementEvaluation, Evaluation, Scratch};
use super::friction::CHATTER;
use super::kinks::{Kink, Kinks, Seen};
use super::node::ElementNodes;
use super::node::Origin;
use super::resistance::sign;
use super::zero::{SAMPLES, first_zero};
use crate::collocation::{Cubic, STAGES};
use crate::elements::LastNode;
use crate::system::System;
use crate::system::error::RunError;

/// Where holding forces are looked at besides the nodes: between them.
const BETWEEN: [f64; 3] = [0.07, 0.4, 0.83];

/// Steps this short, as a share of the run, are taken as they are.
const SHORT: f64 = 1e-10;

/// Share of rtol that a change may be off, in units of the largest velocity of the step or of the limit.
const SHARE: f64 = 1e-3;

/// Where in a step a value shows which way it goes at the end, and so many bits of the time of its zero are not known.
const BEFORE: f64 = 0.999;
const LAST_BITS: f64 = 4.0 * f64::EPSILON;

/// A prescribed velocity below this share of its largest is at rest.
const AT_REST: f64 = 1e-9;

/// What a force must change by behind the others of a step to jump, in units of what it changes before.
const JUMPS: f64 = 1e3;

/// Where a velocity that leaves rest is first looked at.
const START: f64 = 1e-9;

/// What may happen within a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Change {
    /// Velocity `k`, which has the sign `direction`, comes to rest.
    Stop { k: usize, direction: f64 },
    /// Velocity `k` is no longer held against a force of the sign `direction`.
    BreakAway { k: usize, direction: f64 },
    /// A joint that signals move turns round.
    Reversal,
    /// The force of an element has a kink.
    Kink(Kink),
    /// Control leaves the branch that it is on.
    Control(Guard),
}

/// What is seen of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Look {
    /// Nothing changes.
    Nothing,
    /// Holding forces cannot be followed over so long a step.
    Unclear,
    /// The first change is at θ; at 0 something changes at the start.
    Within(f64, Change),
    /// What changes does so at the end, and is noted.
    AtEnd,
}

/// What was noted at the end of a step, beside what friction and control know of themselves.
#[derive(Debug, Default)]
pub(super) struct Changes {
    is_at_kink: bool,
    /// Elements on a kink of which the step ends, where its slopes were asked for.
    bent: Vec<usize>,
    /// An evaluation to look into a step from.
    spare: Option<Box<Evaluation>>,
}

/// The motion within a step, as its method has it.
pub(crate) trait Within {
    /// Velocity `k`, which a force drives, at θ.
    fn velocity(&mut self, cx: Context, equations: &Equations, k: usize, theta: f64) -> f64;

    /// Fills q, v, a and what drives the joints at t, which is θ.
    fn place(&mut self, cx: Context, equations: &Equations, t: f64, theta: f64, evaluation: &mut Evaluation);
}

/// A step that was solved and evaluated.
pub(crate) struct Solved<'a> {
    /// From when to when it goes, and its size, s.
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) size: f64,
    /// At the start and at the nodes.
    pub(crate) evaluations: &'a [Evaluation; STAGES + 1],
    pub(crate) scratch: &'a mut Scratch,
    pub(crate) within: &'a mut dyn Within,
    /// What rounding makes of each free velocity in the step.
    pub(crate) noise: &'a [f64],
    pub(crate) rtol: f64,
    /// The end of the run, s.
    pub(crate) end: f64,
}

/// A holding force at the start and at the nodes of a step.
struct Holding {
    cubic: Cubic,
    /// The force that breaks it, and how near a change has to be.
    breaking: f64,
    tolerance: f64,
}

/// Whether forces of elements and of control have no kinks and never jump while functions of time go on smoothly.
pub(crate) fn is_smooth(system: &System) -> bool {
    Kinks::of(system).is_idle() && ControlRun::of(system, false).is_none_or(|control| control.is_smooth())
}

impl Equations {
    /// Whether nothing ever changes within a step.
    pub(crate) fn is_smooth(&self) -> bool {
        let is_smooth = self.control.as_ref().is_none_or(|control| control.is_smooth());
        self.friction.is_idle() && self.kinks.is_idle() && is_smooth
    }

    /// The first change in a step.
    ///
    /// # Errors
    /// What a row inside the step may show.
    pub(crate) fn look(&mut self, cx: Context, step: &mut Solved) -> Result<Look, RunError> {
        self.friction.forget_changes();
        self.changes.is_at_kink = false;
        let mut first: Option<(f64, Change)> = None;
        let mut note = |theta: f64, change: Change| {
            if first.is_none_or(|(earliest, _)| theta < earliest) {
                first = Some((theta, change));
            }
        };
        let rubbing: Vec<(usize, i8)> = self.friction.rubbing().collect();
        for &(k, direction) in rubbing.iter().filter(|(_, direction)| *direction != 0) {
            let change = Change::Stop { k, direction: f64::from(direction) };
            let [before, at_end] = [BEFORE, 1.0].map(|theta| self.value(cx, step, change, theta));
            let largest = step.evaluations.iter().fold(0.0, |largest: f64, node| largest.max(node.v[k].abs()));
            if is_at_end(step, [before, at_end], SHARE * step.rtol * largest) {
                self.friction.stopping.push(k);
            } else if let Some(theta) = self.first_stop(cx, step, k, change) {
                note(theta, change);
            }
        }
        if rubbing.iter().any(|(_, direction)| *direction == 0) {
            let between = self.look_between(cx, step)?;
            for &(k, _) in rubbing.iter().filter(|(_, direction)| *direction == 0) {
                let holding = self.holding(step, k);
                let limit = self.friction.limit(k);
                let off = BETWEEN.iter().zip(&between).map(|(theta, forces)| (holding.at(*theta) - forces[k]).abs());
                let off = off.fold(0.0, f64::max);
                let largest = (0..=SAMPLES).map(|i| holding.at(i as f64 / SAMPLES as f64).abs()).fold(0.0, f64::max);
                if largest + 4.0 * off <= limit {
                    continue;
                }
                let clear = step.rtol.sqrt().clamp(1e-6, 1e-2);
                if !(off <= clear * limit || step.size <= SHORT * step.end) {
                    return Ok(Look::Unclear);
                }
                for direction in [1.0, -1.0] {
                    let change = Change::BreakAway { k, direction };
                    let margins = [BEFORE, 1.0].map(|theta| holding.margin(direction, theta));
                    if is_at_end(step, margins, 0.5 * holding.tolerance) {
                        self.friction.breaks_away = true;
                    } else if let Some(theta) = first_zero(|theta| holding.margin(direction, theta)) {
                        note(theta, change);
                    }
                }
            }
        }
        if let Some(theta) = self.first_reversal(cx, step) {
            note(theta, Change::Reversal);
        }
        match self.look_for_kinks(step.size, step.noise) {
            Seen::Nothing => {}
            Seen::Within(theta, kink) => note(theta, Change::Kink(kink)),
            Seen::AtEnd => self.changes.is_at_kink = true,
        }
        let mut switches = false;
        if let Some(control) = &mut self.control {
            match control.look() {
                ControlSeen::Nothing => {}
                ControlSeen::Within(theta, guard) => note(theta, Change::Control(guard)),
                ControlSeen::AtEnd => switches = true,
            }
        }
        Ok(match first {
            Some((theta, change)) => Look::Within(theta, change),
            None if self.friction.changes() || self.changes.is_at_kink || switches => Look::AtEnd,
            None => Look::Nothing,
        })
    }

    /// How far a change is away at θ; negative behind it.
    pub(crate) fn value(&mut self, cx: Context, step: &mut Solved, change: Change, theta: f64) -> f64 {
        match change {
            Change::Stop { k, direction } => direction * step.within.velocity(cx, self, k, theta),
            Change::BreakAway { k, direction } => self.holding(step, k).margin(direction, theta),
            Change::Reversal => 0.0,
            Change::Kink(kink) => self.value_of_kink(kink, theta),
            Change::Control(guard) => self.control.as_ref().map_or(0.0, |control| control.guard_at(guard, theta)),
        }
    }

    /// Notes a change that is here, whatever its value says.
    pub(crate) fn note(&mut self, change: Change) {
        match change {
            Change::Stop { k, .. } => {
                self.friction.stopping.push(k);
                self.friction.caught.push(k);
            }
            Change::BreakAway { .. } => self.friction.breaks_away = true,
            Change::Reversal => {}
            Change::Kink(_) => self.changes.is_at_kink = true,
            Change::Control(guard) => {
                if let Some(control) = &mut self.control {
                    control.note(guard);
                }
            }
        }
    }

    /// Whether what follows the step starts anew, for what was noted at its end.
    pub(crate) fn starts_anew(&self) -> bool {
        self.friction.changes() || self.may_have_jumped() || self.switches()
    }

    /// Whether the step up to `t` ends on a kink of a force, which is forgotten; `end` is that of the run.
    ///
    /// # Errors
    /// [`RunError::ForceChatter`] where a force jumps to and fro.
    pub(crate) fn take_kink(&mut self, system: &System, t: f64, end: f64) -> Result<bool, RunError> {
        let may_jump = self.may_have_jumped();
        let is_at_kink = std::mem::take(&mut self.changes.is_at_kink);
        let Some((count, span)) = may_jump.then(|| self.kinks.count_jump(t, end)).flatten() else {
            return Ok(is_at_kink);
        };
        let mut jumping = self.kinks.elements().iter().map(|&e| &system.elements[e]);
        let element = jumping.find(|element| element.law.jumps()).map_or(String::new(), |element| element.name.clone());
        Err(RunError::ForceChatter { t, element, count, span })
    }

    /// Whether control leaves a branch at the end of the step, or at its start.
    pub(crate) fn switches(&self) -> bool {
        self.control.as_ref().is_some_and(|control| control.changes())
    }

    /// Whether friction starts or ceases to hold a joint at the end of the step.
    pub(crate) fn sticks_or_slips(&self) -> bool {
        self.friction.changes()
    }

    /// The velocities that come to rest at the end of the step, or at its start, for what was noted there.
    pub(crate) fn stopping(&self) -> &[usize] {
        &self.friction.stopping
    }

    /// Whether the step ends on a kink where the force of an element may jump.
    pub(crate) fn may_have_jumped(&self) -> bool {
        self.changes.is_at_kink && self.kinks.may_jump()
    }

    /// Whether the last node of the step alone is behind a jump of the force of an element; such a step is as short as the jump asks for.
    pub(crate) fn has_jumped_at_end(&self) -> bool {
        self.may_have_jumped()
            && self.kinks.elements().iter().any(|&e| {
                let [a, b, c, ..] = self.bank.response(e).force;
                let start = self.force_at_start(e);
                let before = (b - a).abs() + (a - start).abs();
                (c - b).abs() > JUMPS * before.max(f64::EPSILON * c.abs())
            })
    }

    /// Whether friction holds velocity `k`.
    pub(crate) fn holds(&self, k: usize) -> bool {
        self.friction.holds(k)
    }

    /// The direction in which velocity `k`, which is `v`, slides where its friction sticks: −1, 0 (held) or 1.
    pub(crate) fn sliding(&self, k: usize, v: f64) -> f64 {
        let found = self.friction.rubbing().find(|(other, _)| *other == k);
        found.map_or_else(|| sign(v), |(_, direction)| f64::from(direction))
    }

    /// Whether the force of an element may have kinks.
    pub(crate) fn has_kinks(&self) -> bool {
        !self.kinks.is_idle()
    }

    /// The first kink of a force in the step that the bank was told.
    pub(crate) fn look_for_kinks(&mut self, h: f64, noise: &[f64]) -> Seen {
        let Self { kinks, bank, elements, free, .. } = self;
        kinks.look(bank, |e| rounded(&elements[e], free, h, noise))
    }

    /// Tells elements on a kink of which the step ends, of size `h`, that it ends just before: its slopes are those of the near side. To be followed by
    /// [`Self::stand`].
    pub(crate) fn lean(&mut self, h: f64, noise: &[f64]) -> Vec<(usize, LastNode)> {
        let Self { kinks, bank, elements, free, changes, .. } = self;
        changes.bent.clear();
        if !kinks.is_idle() {
            changes.bent = kinks.at_end(bank, |e| rounded(&elements[e], free, h, noise));
        }
        self.lean_again()
    }

    /// The same of the step that was asked about last.
    pub(crate) fn lean_again(&mut self) -> Vec<(usize, LastNode)> {
        let Self { bank, changes, .. } = self;
        changes.bent.iter().map(|&e| (e, bank.lean(e))).collect()
    }

    /// Which they are.
    pub(crate) fn leaning(&self) -> &[usize] {
        &self.changes.bent
    }

    /// Tells them where it ends again.
    pub(crate) fn stand(&mut self, leaning: Vec<(usize, LastNode)>) {
        leaning.into_iter().for_each(|(e, last)| self.bank.stand(e, last));
    }

    /// How far a kink is away at θ; negative behind it.
    pub(crate) fn value_of_kink(&mut self, kink: Kink, theta: f64) -> f64 {
        self.kinks.value(&self.bank, kink, theta)
    }

    /// Brings to rest what stops at the origin; `end` is that of the run.
    ///
    /// # Errors
    /// [`RunError::Chatter`]; [`RunError::NoConvergence`] where nothing rubs.
    pub(crate) fn stop_sliding(&mut self, cx: Context, origin: &mut Origin, end: f64) -> Result<(), RunError> {
        let (t, span, friction) = (origin.t, CHATTER * end, &mut self.friction);
        friction.stopping.iter().for_each(|&k| origin.v[k] = 0.0);
        let Some(count) = friction.count_change(t, span) else { return Ok(()) };
        let last = friction.stopping.first().copied();
        let last = last.or_else(|| friction.rubbing().next().map(|(k, _)| k));
        let joint = cx.system.model.v_labels()[last.unwrap_or(0)].name.clone();
        Err(match last {
            Some(_) => RunError::Chatter { t, joint, count, span },
            None => RunError::NoConvergence { t, h: span, joint },
        })
    }

    fn first_stop(&mut self, cx: Context, step: &mut Solved, k: usize, change: Change) -> Option<f64> {
        // A joint that was at rest is to leave it: over θ, so that the start is no zero.
        let from_rest = step.evaluations[0].v[k] == 0.0;
        first_zero(|theta| {
            if from_rest {
                let theta = theta.max(START);
                self.value(cx, step, change, theta) / theta
            } else {
                self.value(cx, step, change, theta)
            }
        })
    }

    /// The force with which friction holds velocity `k` at the start and at the nodes.
    fn holding(&self, step: &Solved, k: usize) -> Holding {
        let bank = &self.bank;
        let (mut values, mut size) = ([0.0; STAGES + 1], 0.0f64);
        for (i, (value, evaluation)) in values.iter_mut().zip(step.evaluations).enumerate() {
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
        let tolerance = SHARE * step.rtol * self.friction.limit(k);
        let breaking = self.friction.breaking(k, size) + 0.5 * tolerance;
        Holding { cubic: Cubic::through(&values), breaking, tolerance }
    }

    /// The forces (nv) with which friction would hold every velocity, between the nodes.
    fn look_between(&mut self, cx: Context, step: &mut Solved) -> Result<[Vec<f64>; 3], RunError> {
        let mut evaluation = self.changes.spare.take().unwrap_or_else(|| Box::new(Evaluation::new(cx.system)));
        let mut forces: [Vec<f64>; 3] = Default::default();
        for (theta, forces) in BETWEEN.into_iter().zip(&mut forces) {
            let at = (step.from + theta * step.size).min(step.to);
            step.within.place(cx, self, at, theta, &mut evaluation);
            cx.fill(at, at, None, step.scratch, &mut evaluation)?;
            self.complete(cx, Some(theta), &mut evaluation)?;
            let pull = |(e, element): (usize, &ElementEvaluation)| self.bank.at(e, theta, &element.point(at));
            let pulls = evaluation.elements.iter().enumerate().map(pull);
            let pulls: Vec<f64> = pulls.map(|seen| seen.map_or(0.0, |observation| observation.force())).collect();
            forces.extend((0..cx.system.model.nv()).map(|k| {
                let pull = pulls.iter().zip(&evaluation.elements).map(|(force, element)| force * element.gradient[k]);
                evaluation.driven[k].unwrap_or(0.0) - evaluation.rigid[k] - pull.sum::<f64>()
            }));
        }
        self.changes.spare = Some(evaluation);
        Ok(forces)
    }

    /// Where the first joint turns round that signals move against friction that sticks.
    fn first_reversal(&self, cx: Context, step: &Solved) -> Option<f64> {
        let mut first: Option<f64> = None;
        for (j, path) in self.forward.paths(&cx.system.model) {
            if !self.friction.led().contains(&j) {
                continue;
            }
            let velocity = |theta: f64| {
                let [mut q, mut v, mut a] = [[0.0]; 3];
                path.at(step.from + theta * step.size, &mut q, &mut v, &mut a);
                v[0]
            };
            let k = cx.system.model.v_range(j).start;
            let [_, nodes @ ..] = step.evaluations;
            let largest = nodes.iter().fold(0.0, |largest: f64, node| largest.max(node.v[k].abs()));
            // At the start it may have turned round just now.
            let early = velocity(0.25 / SAMPLES as f64);
            if nodes[STAGES - 1].v[k].abs() <= AT_REST * largest || early == 0.0 {
                continue;
            }
            let zero = first_zero(|theta| early.signum() * velocity(theta.max(0.25 / SAMPLES as f64)));
            first = first.into_iter().chain(zero).reduce(f64::min);
        }
        first
    }
}

/// Whether what was positive ends the step at zero, by its value there or by the time of it, whose last bits tell no more: of values at [`BEFORE`]
/// and at the end.
fn is_at_end(step: &Solved, [before, at_end]: [f64; 2], tolerance: f64) -> bool {
    let a_bit = LAST_BITS * step.to / ((1.0 - BEFORE) * step.size) * (before - at_end);
    at_end < before && at_end.abs() <= tolerance.max(a_bit)
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

/// What rounding of the accelerations does to the stroke of an element in a step of size `h`.
fn rounded(element: &ElementNodes, free: &[usize], h: f64, noise: &[f64]) -> f64 {
    free.iter().zip(noise).map(|(&k, noise)| element.gradient[k].abs() * h * noise).sum()
}
