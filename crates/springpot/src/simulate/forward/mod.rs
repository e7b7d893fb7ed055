//! Forward dynamics: the equations of motion with the memories of the elements inside.
//!
//! Radau IIA(5) in the accelerations. The law of an element answers with its forces at the nodes and their tangents, so that the
//! Newton iteration has three unknowns for each velocity whatever the number of elements and of their exponentials. Order five
//! in time at every fractional order; rows between steps come from the cubic through the accelerations, integrated twice.
//! Source of the method: Hairer & Wanner, Solving ODEs II, IV.5 and IV.8.

mod attempt;
mod dense;
pub(super) mod drives;
mod estimate;
mod keep;
mod newton;
mod scale;
mod settle;
mod stages;
mod start;
mod stepper;
mod stick;
mod tableau;
mod watch;

use self::drives::drive;
use self::scale::Tolerance;
use self::settle::Settled;
use self::stepper::{Carried, Stepper};
use super::recorder::{Recorder, RecorderState, target};
use super::{Report, Rows, RunError, Settings, Stop, System};
use crate::fractional::step::RADAU_NODES;
use crate::law::{Singular, State};
use crate::motion::{Drive, Forward, Motion};
use crate::signal::{self, Agenda};
use serde::{Deserialize, Serialize};
use std::sync::atomic::Ordering;

/// The estimate is of order 3, the method of order 5: the estimate may reach this share of rtol^⅔.
const ESTIMATE_SHARE: f64 = 0.03;

/// The longest step as a share of the run, so that no signal is stepped over: where something varies with time, and where nothing
/// does.
const LONGEST_STEP: [f64; 2] = [1.0 / 500.0, 1.0 / 50.0];

/// Runs the forward dynamics of a `system` and hands every row to `rows`.
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
    let outcome = run.look_ahead().and_then(|()| run.start()).and_then(|h| run.march(h));
    let outcome = outcome.and_then(|()| run.recorder.verdict());
    (run.recorder.finish(), outcome)
}

/// Goes on with a run from what was kept of it.
pub(super) fn resume(
    system: &System,
    forward: &Forward,
    settings: &Settings,
    (recorder, stepper_state): (RecorderState, StepperState),
    rows: &mut dyn Rows,
    stop: &Stop,
) -> (Report, Result<(), RunError>) {
    let mut run = Run::new(system, forward, settings, rows, stop);
    run.recorder.restore(recorder);
    run.stepper.restore(stepper_state.carried);
    run.starts = run.recorder.accounts.iter().map(|account| account.memory().clone()).collect();
    run.last = stepper_state.last;
    let outcome = run.look_ahead().and_then(|()| run.march(stepper_state.h)).and_then(|()| run.recorder.verdict());
    (run.recorder.finish(), outcome)
}

/// What the next step takes over from those before.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct StepperState {
    carried: Carried,
    /// Size and error of the last step kept.
    last: Option<(f64, f64)>,
    h: f64,
}

struct Run<'a> {
    recorder: Recorder<'a>,
    stepper: Stepper<'a>,
    forward: &'a Forward,
    stop: &'a Stop,
    /// What the signals do.
    agenda: Agenda,
    longest_step: f64,
    /// Whether signals prescribe joints.
    has_paths: bool,
    /// Size and error of the last step kept.
    last: Option<(f64, f64)>,
    /// Whether a law has inner variables, of which the motion may show nothing.
    has_inner_variables: bool,
    /// The laws' states that tell of singular starts.
    starts: Vec<State>,
    scratch: dense::Scratch,
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
        let tolerance = Tolerance { rtol: mapped, atol: settings.atol.unwrap_or(0.0) * mapped / rtol };
        let mut recorder = Recorder::new(system, settings, rows);
        recorder.takes_elements_work = false;
        recorder.report.newton_iterations = Some(0);
        for step in &mut recorder.steps {
            step.singular = Singular::Moments;
        }
        let [varying, constant] = LONGEST_STEP;
        let share = if system.varies() { varying } else { constant };
        Self {
            recorder,
            stepper: Stepper::new(system, forward, tolerance, rtol),
            forward,
            stop,
            agenda: Agenda::default(),
            longest_step: settings.max_step.unwrap_or(settings.end * share).min(settings.end),
            has_paths: forward.drives.iter().any(|drive| matches!(drive, Drive::Prescribed(_))),
            last: None,
            has_inner_variables: system.elements.iter().any(|element| element.law.has_inner_variables()),
            starts: Vec::new(),
            scratch: dense::Scratch::default(),
        }
    }

    /// What the signals will do.
    fn look_ahead(&mut self) -> Result<(), RunError> {
        self.agenda = self.recorder.system.agenda(self.recorder.settings, self.longest_step, self.stop)?;
        self.recorder.take_agenda(&self.agenda);
        Ok(())
    }

    /// The first moment and its row; returns the first step.
    fn start(&mut self) -> Result<f64, RunError> {
        let (system, settings) = (self.recorder.system, self.recorder.settings);
        let (origin, elements) = start::origin(system, self.forward, &mut self.stepper.stick)?;
        self.stepper.free = self.stepper.stick.free();
        let [moment, ..] = &mut self.recorder.moments;
        moment.q.copy_from_slice(&origin.q);
        moment.v.copy_from_slice(&origin.v);
        moment.a.copy_from_slice(&origin.a);
        drive(&system.model, self.forward, 0.0, moment);
        self.starts = start::states(system, &elements)?;
        let is_singular = self.starts.iter().any(State::is_singular);
        if is_singular {
            moment.a.fill(f64::NAN);
            moment.driven.fill(None);
        }
        system.fill(0.0, 0.0, None, &mut self.recorder.scratch, moment)?;
        self.stepper.origin = origin;
        self.stepper.is_singular = is_singular;
        self.expect()?;
        let strict = Tolerance { rtol: settings.rtol, atol: settings.atol.unwrap_or(0.0) };
        let chosen = start::first_step(&self.stepper, &elements, strict, settings.end);
        let h = self.agenda.reach(0.0, settings.first_step.unwrap_or(chosen).min(self.longest_step));
        self.recorder.open(RADAU_NODES[0] * h)?;
        Ok(h)
    }

    /// How large a motion the forces at the origin begin.
    fn expect(&mut self) -> Result<(), RunError> {
        let t = self.stepper.origin.t;
        self.stepper.take_inputs(0.0, t)?;
        self.stepper.linearise()?;
        self.stepper.sizes.take(&self.recorder.system.model, &self.stepper.origin.q, &self.stepper.origin.v);
        self.stepper.expect(1.0 / self.recorder.settings.end);
        Ok(())
    }

    fn march(&mut self, first: f64) -> Result<(), RunError> {
        let (system, end) = (self.recorder.system, self.recorder.settings.end);
        let limit = self.recorder.settings.step_limit(self.agenda.switches());
        let mut h = first;
        while self.stepper.origin.t < end {
            let t = self.stepper.origin.t;
            let (stopped, stepper, last) = (self.stop.load(Ordering::Relaxed), &self.stepper, self.last);
            self.recorder.keep(t, stopped, || {
                super::StepperState::Forward(Box::new(StepperState { carried: stepper.carried(), last, h }))
            })?;
            if stopped {
                return Err(RunError::Interrupted { t });
            }
            if self.recorder.report.steps >= limit {
                return Err(RunError::TooManySteps { t, limit: self.recorder.report.steps });
            }
            if t == 0.0 && system.turns_at(t) {
                self.cross(f64::EPSILON * f64::EPSILON * end)?;
                continue;
            }
            let stop = self.agenda.next_stop(t);
            if let Some(signal::Stop { before, after: Some(after) }) = stop
                && before <= t
            {
                self.cross(after)?;
                continue;
            }
            let stop_at = stop.map_or(end, |stop| stop.before);
            let reach = self.agenda.reach(t, h);
            let to = target(t, reach, self.next_sparse_row(reach).map_or(stop_at, |row| row.min(stop_at)));
            let far_side = stop.filter(|_| to == stop_at).and_then(|stop| stop.after);
            // The size itself where it may be: a sum and a difference would change its last bits, and with them the tables of lags.
            let size = if to == t + h { h } else { to - t };
            let on_break = stop.is_some() && to == stop_at && far_side.is_none();
            match self.attempt(to, size, on_break)? {
                Err(smaller) => {
                    self.recorder.report.rejected_steps += 1;
                    h = smaller;
                }
                Ok(factor) => {
                    let (whole, planned) = (size, to);
                    let (to, size) = match self.settle(to, size)? {
                        Settled::At { to, size } => (to, size),
                        Settled::Shorter(smaller) => {
                            self.recorder.report.rejected_steps += 1;
                            h = smaller;
                            continue;
                        }
                        Settled::AtStart => {
                            self.stop_sliding()?;
                            self.cross(t)?;
                            continue;
                        }
                    };
                    let (on_break, far_side) = if to == planned { (on_break, far_side) } else { (false, None) };
                    self.keep(to, size, on_break)?;
                    // A step cut short by a stop says nothing against the size chosen before.
                    h = (whole * factor).max(if size < h { h } else { 0.0 }).min(self.longest_step);
                    let changes = self.stepper.stick.changes();
                    if changes {
                        self.stop_sliding()?;
                    }
                    if changes || on_break || far_side.is_some() {
                        self.cross(far_side.unwrap_or(to))?;
                    }
                }
            }
        }
        Ok(())
    }

    /// The next row, where rows are farther apart than steps are long: steps end there.
    fn next_sparse_row(&self, h: f64) -> Option<f64> {
        let next = self.recorder.next_row_until(f64::INFINITY)?;
        let last = self.recorder.report.t_reached.unwrap_or(0.0);
        (next > self.stepper.origin.t && next - last >= h).then_some(next)
    }
}

impl System {
    /// Whether anything that drives the robot varies with time.
    fn varies(&self) -> bool {
        let Motion::Forward(forward) = &self.motion else { return true };
        let drives = forward.drives.iter().any(|drive| match drive {
            Drive::Force(signals) => signals.iter().any(|signal| signal.is_constant().is_none()),
            Drive::Prescribed(_) => true,
            Drive::Locked => false,
        });
        drives || self.elements.iter().flat_map(|e| &e.inputs).any(|signal| signal.is_constant().is_none())
    }
}
