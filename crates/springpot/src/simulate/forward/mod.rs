//! A robot that moves by itself: the equations of motion with the memories of the elements inside.
//!
//! Radau IIA(5) in the accelerations. The law of an element answers with its forces at the nodes and their tangents, so that the
//! Newton iteration has three unknowns for each velocity whatever the number of elements and of their exponentials. Order five
//! in time at every fractional order; rows between steps come from the cubic through the accelerations, integrated twice.
//! Source of the method: Hairer & Wanner, Solving ODEs II, IV.5 and IV.8.

pub(super) mod dense;
mod start;
mod stepper;
mod tableau;

use self::dense::{Dense, drive};
use self::stepper::{Carried, Outcome, Stepper, Tolerance};
use super::book::{Book, Books, target};
use super::moment::{Moment, Scratch};
use super::{Report, Rows, RunError, Settings, Stop, System};
use crate::fractional::step::{MAX_NODES, RADAU_NODES};
use crate::law::{Singular, State};
use crate::motion::kinks::locate;
use crate::motion::{Forward, Motion};
use serde::{Deserialize, Serialize};
use std::sync::atomic::Ordering;

/// The estimate is of order 3, the method of order 5: the estimate may reach this share of rtol^⅔.
const ESTIMATE_SHARE: f64 = 0.03;

/// Shortest step as a share of the run.
const SHORTEST_STEP: f64 = 1e-14;

/// The longest step is this share of the run, so that no signal is stepped over.
const LONGEST_STEP: f64 = 1.0 / 50.0;

/// Runs a `system` that moves by itself and hands every row to `rows`.
///
/// The report is true also where the run stops early: all rows up to `t_reached` were handed over. Panics unless the motion is
/// [`Motion::Forward`].
pub fn forward(
    system: &System,
    settings: &Settings,
    rows: &mut dyn Rows,
    stop: &Stop,
) -> (Report, Result<(), RunError>) {
    let Motion::Forward(forward) = &system.motion else { panic!("the motion is given in advance") };
    let mut run = Run::new(system, forward, settings, rows, stop);
    let outcome = run.start().and_then(|h| run.march(h));
    (run.book.finish(), outcome)
}

/// Goes on with a run from what was kept of it.
pub(super) fn resume(
    system: &System,
    forward: &Forward,
    settings: &Settings,
    (books, pace): (Books, Pace),
    rows: &mut dyn Rows,
    stop: &Stop,
) -> (Report, Result<(), RunError>) {
    let mut run = Run::new(system, forward, settings, rows, stop);
    run.book.restore(books);
    run.stepper.restore(pace.carried);
    run.last = pace.last;
    let outcome = run.march(pace.h);
    (run.book.finish(), outcome)
}

/// What the next step takes over from those before.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Pace {
    carried: Carried,
    /// Size and error of the last step kept.
    last: Option<(f64, f64)>,
    h: f64,
}

struct Run<'a> {
    book: Book<'a>,
    stepper: Stepper<'a>,
    forward: &'a Forward,
    tolerance: Tolerance,
    stop: &'a Stop,
    /// Size and error of the last step kept.
    last: Option<(f64, f64)>,
}

impl<'a> Run<'a> {
    fn new(
        system: &'a System,
        forward: &'a Forward,
        settings: &'a Settings,
        rows: &'a mut dyn Rows,
        stop: &'a Stop,
    ) -> Self {
        let rtol = settings.rtol;
        let mapped = ESTIMATE_SHARE * rtol.powf(2.0 / 3.0);
        let tolerance = Tolerance { rtol: mapped, atol: settings.atol.unwrap_or(rtol) * mapped / rtol };
        let mut book = Book::new(system, settings, rows);
        book.takes_elements_work = false;
        book.report.newton_iterations = Some(0);
        for step in &mut book.steps {
            step.singular = Singular::Moments;
        }
        Self { book, stepper: Stepper::new(system, forward, tolerance, rtol), forward, tolerance, stop, last: None }
    }

    /// The first moment and its row; returns the first step.
    fn start(&mut self) -> Result<f64, RunError> {
        let (system, settings) = (self.book.system, self.book.settings);
        let (origin, elements) = start::origin(system, self.forward)?;
        let chosen = start::first_step(system, &origin, &elements, self.tolerance, settings.end);
        let h = settings.first_step.unwrap_or(chosen).min(self.longest_step());
        let [moment, ..] = &mut self.book.moments;
        moment.q.copy_from_slice(&origin.q);
        moment.v.copy_from_slice(&origin.v);
        moment.a.copy_from_slice(&origin.a);
        drive(&system.model, self.forward, 0.0, moment);
        let is_singular = |e: usize| {
            let order = system.elements[e].law.order();
            let jumps = system.elements[e].derivative == crate::law::Derivative::RiemannLiouville;
            jumps && order > 0.0 && order < 1.0 && elements[e].jump != 0.0
        };
        if (0..elements.len()).any(is_singular) {
            moment.a.fill(f64::NAN);
            moment.driven.fill(None);
        }
        system.fill(0.0, 0.0, None, &mut self.book.scratch, moment)?;
        self.stepper.origin = origin;
        self.book.open(RADAU_NODES[0] * h)?;
        Ok(h)
    }

    fn longest_step(&self) -> f64 {
        let end = self.book.settings.end;
        self.book.settings.max_step.unwrap_or(end * LONGEST_STEP).min(end)
    }

    fn march(&mut self, first: f64) -> Result<(), RunError> {
        let (system, end) = (self.book.system, self.book.settings.end);
        let breaks = system.break_points(end);
        let mut breaks = breaks.into_iter().peekable();
        let has_kinks = system.has_kinks();
        let mut h = first;
        while self.stepper.origin.t < end {
            let t = self.stepper.origin.t;
            let (stopped, stepper, last) = (self.stop.load(Ordering::Relaxed), &self.stepper, self.last);
            self.book
                .keep(t, stopped, || super::Pace::Forward(Box::new(Pace { carried: stepper.carried(), last, h })))?;
            if stopped {
                return Err(RunError::Interrupted { t });
            }
            if self.book.settings.max_steps.is_some_and(|limit| self.book.report.steps >= limit) {
                return Err(RunError::TooManySteps { t, limit: self.book.report.steps });
            }
            while breaks.next_if(|b| *b <= t).is_some() {}
            let next_break = breaks.peek().copied().unwrap_or(end);
            let mut to = target(t, h, self.next_sparse_row(h).map_or(next_break, |row| row.min(next_break)));
            let mut far_side = None;
            if has_kinks && let Some(node) = self.first_other_branch(t, to) {
                let (before, after) = locate(|t| system.branch(t), t, node);
                if before <= t {
                    self.cross(after)?;
                    continue;
                }
                (to, far_side) = (before, Some(after));
            }
            let size = to - t;
            let on_break = to == next_break && to < end;
            match self.attempt(to, on_break)? {
                Err(smaller) => {
                    self.book.report.rejected_steps += 1;
                    h = smaller;
                }
                Ok(factor) => {
                    self.keep(to, on_break)?;
                    // A step cut short by a stop says nothing against the size chosen before.
                    h = (size * factor).max(if size < h { h } else { 0.0 }).min(self.longest_step());
                    if on_break || far_side.is_some() {
                        self.cross(far_side.unwrap_or(to))?;
                    }
                }
            }
        }
        Ok(())
    }

    /// The next row, where rows are farther apart than steps are long: steps end there.
    fn next_sparse_row(&self, h: f64) -> Option<f64> {
        let next = self.book.next_row_until(f64::INFINITY)?;
        let last = self.book.report.t_reached.unwrap_or(0.0);
        (next > self.stepper.origin.t && next - last >= h).then_some(next)
    }

    /// The first node of the step (or its end) at which the signals are on another branch than at its start.
    fn first_other_branch(&self, t: f64, to: f64) -> Option<f64> {
        let system = self.book.system;
        let branch = system.branch(t);
        let nodes = RADAU_NODES.map(|c| if c == 1.0 { to } else { t + c * (to - t) });
        nodes.into_iter().find(|node| system.branch(*node) != branch)
    }

    /// Tries the step up to `to`: `Ok` holds the factor for the next step, `Err` the size to try instead.
    fn attempt(&mut self, to: f64, on_break: bool) -> Result<Result<f64, f64>, RunError> {
        const EXPONENT: f64 = 0.25;
        let t = self.stepper.origin.t;
        let h = to - t;
        let laws: Vec<&State> = self
            .book
            .accounts
            .iter()
            .map(|account| account.law.as_ref().expect("forward runs have no schemes"))
            .collect();
        let outcome = self.stepper.attempt(h, if on_break { to.next_down() } else { to }, &laws)?;
        let (error, worst, iterations) = match outcome {
            Outcome::Diverged { iterations } => (f64::INFINITY, None, iterations),
            Outcome::Done { iterations, .. } if self.turned_over().is_some() => (f64::INFINITY, None, iterations),
            Outcome::Done { error, worst, iterations } => (error, Some(worst), iterations),
        };
        *self.book.report.newton_iterations.get_or_insert(0) += u64::from(iterations);
        let safety = 0.9 * 15.0 / (14.0 + f64::from(iterations));
        if error > 1.0 || error.is_nan() {
            let smaller = h * if error.is_finite() { (safety * error.powf(-EXPONENT)).clamp(0.1, 0.9) } else { 0.25 };
            if smaller < SHORTEST_STEP * self.book.settings.end {
                return Err(self.step_too_small(t, h, error, worst));
            }
            return Ok(Err(smaller));
        }
        let error = error.max(1e-10);
        let mut factor = safety * error.powf(-EXPONENT);
        if let Some((size, before)) = self.last {
            factor = factor.min(safety * (h / size) * (before.max(1e-2) / (error * error)).powf(EXPONENT));
        }
        self.last = Some((h, error));
        Ok(Ok(factor.clamp(0.2, 8.0)))
    }

    /// An element whose direction turned by more than a right angle between two nodes: its points passed each other.
    fn turned_over(&self) -> Option<usize> {
        self.stepper.elements.iter().position(|element| {
            element.pairs.windows(2).any(|pair| match (&pair[0], &pair[1]) {
                (Some(a), Some(b)) => b.check().is_err() || a.direction.dot(b.direction) <= 0.0,
                _ => false,
            })
        })
    }

    fn step_too_small(&self, t: f64, h: f64, error: f64, worst: Option<usize>) -> RunError {
        if let Some(e) = self.turned_over() {
            let length =
                self.stepper.elements[e].pairs.iter().flatten().map(|pair| pair.length).fold(f64::INFINITY, f64::min);
            return RunError::ZeroLength { t, element: self.book.system.elements[e].name.clone(), length };
        }
        let labels = self.book.system.model.v_labels();
        let subject = match worst {
            Some(k) => format!("joint \"{}\"", labels[k].name),
            None => "the iteration, which does not converge".to_owned(),
        };
        RunError::StepTooSmall { t, h, error, subject }
    }

    /// Writes the rows of the step that was just tried, and takes it into the past.
    fn keep(&mut self, to: f64, on_break: bool) -> Result<(), RunError> {
        let Self { book, stepper, forward, .. } = self;
        let (system, t) = (book.system, stepper.origin.t);
        let h = to - t;
        let is_singular = stepper.elements.iter().any(|element| element.response.singular != [0.0; MAX_NODES]);
        let yields = if is_singular { stepper.yield_of_elements() } else { Vec::new() };
        let laws: Vec<State> = if is_singular {
            book.accounts.iter().filter_map(|account| account.law.clone()).collect()
        } else {
            Vec::new()
        };
        let dense = Dense {
            system,
            forward,
            origin: &stepper.origin,
            h,
            stages: &stepper.stages,
            regular: &stepper.regular,
            yields: &yields,
            laws: &laws,
        };
        for k in 0..MAX_NODES {
            let at = if k + 1 == MAX_NODES { to } else { t + RADAU_NODES[k] * h };
            let t_inputs = if k + 1 == MAX_NODES && on_break { to.next_down() } else { at };
            let moment = &mut book.moments[k + 1];
            dense.place(at, RADAU_NODES[k], moment);
            moment.q.copy_from_slice(&stepper.stages[k].q);
            moment.v.copy_from_slice(&stepper.stages[k].v);
            system.fill(at, t_inputs, None, &mut book.scratch, moment)?;
        }
        for (e, element) in stepper.elements.iter().enumerate() {
            book.steps[e].form = element.form;
            book.fill_element_step(e);
            book.evaluate_element(e, t, h);
        }
        for k in 0..=MAX_NODES {
            let moment = &book.moments[k];
            let mut power = 0.0;
            for (j, v) in moment.v.iter().enumerate() {
                let computed = || {
                    let forces = stepper.elements.iter().zip(&moment.elements).zip(&stepper.origin.forces);
                    let pull = forces.map(|((element, state), start)| {
                        let force = if k == 0 { *start } else { element.response.force[k - 1] };
                        force * state.gradient[j]
                    });
                    moment.rigid[j] + pull.sum::<f64>()
                };
                power += moment.driven[j].unwrap_or_else(computed) * v;
            }
            book.powers.actuators[k] = power;
            book.powers.joints[k] = moment.joint_loss;
        }
        let mut place = |system: &System, scratch: &mut Scratch, at: f64, theta: f64, moment: &mut Moment| {
            dense.place(at, theta, moment);
            system.fill(at, at, None, scratch, moment)
        };
        book.emit_rows(t, to, on_break, &mut place)?;
        book.commit(h);
        book.report.steps += 1;
        stepper.accept(h);
        stepper.origin.t = to;
        Ok(())
    }

    /// Goes to the far side of a break or kink of the signals, where accelerations may jump.
    fn cross(&mut self, after: f64) -> Result<(), RunError> {
        let Self { book, stepper, forward, .. } = self;
        let system = book.system;
        // One bit behind it, since a sign is 0 while it turns.
        let to = if system.branch(after) == system.branch(after.next_up()) { after } else { after.next_up() };
        stepper.origin.t = to;
        stepper.forget();
        self.last = None;
        let derivatives: Vec<f64> = book
            .accounts
            .iter()
            .zip(&system.elements)
            .map(|(account, element)| {
                let singular = account.law.as_ref().map_or(0.0, |law| element.law.singular(to, law));
                account.derivative - if to > 0.0 { singular } else { 0.0 }
            })
            .collect();
        start::accelerate(system, forward, &mut stepper.origin, |element, point| {
            let e = system.elements.iter().position(|other| std::ptr::eq(other, element)).expect("its own element");
            if element.law.order() == 1.0 { point.rate } else { derivatives[e] }
        })?;
        let left = book.moments[0].clone();
        let mut right = left.clone();
        right.a.copy_from_slice(&stepper.origin.a);
        right.q.copy_from_slice(&stepper.origin.q);
        right.v.copy_from_slice(&stepper.origin.v);
        drive(&system.model, forward, to, &mut right);
        system.fill(to, to, None, &mut book.scratch, &mut right)?;
        book.jump([left, right]);
        book.emit_rows_between_steps(to)
    }
}
