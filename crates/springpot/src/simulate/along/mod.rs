//! The time loop along a motion given in advance.
//!
//! Inner steps are chosen for the memories and for the energy ledger, never for the rows; a row between two steps' ends is
//! evaluated with the step's own polynomial. Steps end on break points and kinks of the signals.

mod attempt;
mod kink;
mod reversal;

use crate::fractional::step::RADAU_NODES;
use crate::signal::{self, Agenda};
use crate::simulate::control::StepError;
use crate::simulate::moment::{Moment, Scratch};
use crate::simulate::on_grid;
use crate::simulate::recorder::{Recorder, RecorderState, target};
use crate::simulate::{self, Report, Rows, RunError, Settings, Stop, System};
use serde::{Deserialize, Serialize};
use std::sync::atomic::Ordering;

/// The longest inner step is this share of the motion, so that nothing in it is stepped over.
const LONGEST_STEP: f64 = 1.0 / 500.0;

/// The first inner step is this share of the longest.
const FIRST_STEP: f64 = 1.0 / 64.0;

/// Shortest step as a share of the motion.
const SHORTEST_STEP: f64 = 1e-13;

/// Steps that shrink to nothing this near the end of what the gripper can reach shrink because of it; share of the motion.
const NEAR: f64 = 1e-3;

/// Runs `system` along its motion and hands every row to `rows`.
///
/// The report is true also where the run stops early: all rows up to `t_reached` were handed over.
pub fn along(system: &System, settings: &Settings, rows: &mut dyn Rows, stop: &Stop) -> (Report, Result<(), RunError>) {
    let mut run = Run::new(system, settings, rows, stop);
    let outcome = run.look_ahead().and_then(|()| run.start()).and_then(|first| run.march(0.0, first));
    let outcome = outcome.and_then(|()| run.recorder.verdict());
    (run.recorder.finish(), outcome)
}

/// Goes on with a run from what was kept of it.
pub(super) fn resume(
    system: &System,
    settings: &Settings,
    (recorder, stepper_state): (RecorderState, StepperState),
    rows: &mut dyn Rows,
    stop: &Stop,
) -> (Report, Result<(), RunError>) {
    let mut run = Run::new(system, settings, rows, stop);
    let StepperState { t, h, energy_floor } = stepper_state;
    run.energy_floor = energy_floor;
    run.recorder.restore(recorder);
    let outcome = run.look_ahead().and_then(|()| run.differentiate_grid()).and_then(|()| run.march(t, h));
    let outcome = outcome.and_then(|()| run.recorder.verdict());
    (run.recorder.finish(), outcome)
}

/// What the next step takes over from those before.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct StepperState {
    t: f64,
    h: f64,
    energy_floor: f64,
}

struct Run<'a> {
    recorder: Recorder<'a>,
    stop: &'a Stop,
    /// What the signals do.
    agenda: Agenda,
    /// A lower bound of the energy turned over, estimated beforehand.
    energy_floor: f64,
    /// Velocities at which friction sticks: their power has a kink where they turn round.
    rubbing: Vec<usize>,
}

impl<'a> Run<'a> {
    fn new(system: &'a System, settings: &'a Settings, rows: &'a mut dyn Rows, stop: &'a Stop) -> Self {
        Self {
            recorder: Recorder::new(system, settings, rows),
            stop,
            agenda: Agenda::default(),
            energy_floor: 0.0,
            rubbing: reversal::rubbing(&system.model),
        }
    }

    fn longest_step(&self) -> f64 {
        self.recorder
            .settings
            .max_step
            .unwrap_or(self.recorder.settings.end * LONGEST_STEP)
            .min(self.recorder.settings.end)
    }

    fn first_step(&self) -> f64 {
        let first = self.recorder.settings.first_step.unwrap_or(self.longest_step() * FIRST_STEP);
        self.agenda.reach(0.0, first.min(self.recorder.settings.end))
    }

    /// What the signals will do.
    fn look_ahead(&mut self) -> Result<(), RunError> {
        self.agenda = self.recorder.system.agenda(self.recorder.settings, self.longest_step(), self.stop)?;
        self.recorder.take_agenda(&self.agenda);
        Ok(())
    }

    /// The first moment and its row; returns the first step.
    fn start(&mut self) -> Result<f64, RunError> {
        let (system, first) = (self.recorder.system, self.first_step());
        let [moment, ..] = &mut self.recorder.moments;
        system.evaluate(0.0, 0.0, &mut self.recorder.scratch, moment)?;
        self.differentiate_grid()?;
        self.energy_floor = self.estimate_energy_scale();
        self.recorder.open(RADAU_NODES[0] * first)?;
        Ok(first)
    }

    /// The derivatives of elements with named schemes, at all rows.
    fn differentiate_grid(&mut self) -> Result<(), RunError> {
        self.recorder.grid =
            on_grid::derivatives(self.recorder.system, &self.recorder.settings.rows, &mut self.recorder.scratch)?;
        Ok(())
    }

    /// A lower bound of the energy that the motion turns over, from 65 samples of it.
    fn estimate_energy_scale(&mut self) -> f64 {
        let mut moment = Moment::new(self.recorder.system);
        let (mut potential, mut kinetic) = ([f64::INFINITY, f64::NEG_INFINITY], 0.0f64);
        let mut strokes = vec![[f64::INFINITY, f64::NEG_INFINITY]; self.recorder.system.elements.len()];
        let mut forces = vec![0.0f64; self.recorder.system.elements.len()];
        for k in 0..=64 {
            let t = self.recorder.settings.end * k as f64 / 64.0;
            if self.recorder.system.evaluate(t, t, &mut self.recorder.scratch, &mut moment).is_err() {
                break;
            }
            let widen = |range: &mut [f64; 2], x: f64| *range = [range[0].min(x), range[1].max(x)];
            kinetic = kinetic.max(moment.kinetic);
            widen(&mut potential, moment.potential);
            for (e, state) in moment.elements.iter().enumerate() {
                widen(&mut strokes[e], state.stroke);
                let element = &self.recorder.system.elements[e];
                if let Ok(law) = element.begin(element.rest_length, &state.inputs) {
                    let force = element.law.estimate(&state.point(t), &law, 1.0 / self.recorder.settings.end);
                    forces[e] = forces[e].max(force.abs());
                }
            }
        }
        let elements: f64 = strokes.iter().zip(forces).map(|(range, force)| (range[1] - range[0]) * force).sum();
        kinetic + (potential[1] - potential[0]).max(0.0) + elements.max(0.0)
    }

    /// Takes step after step from t on, the first of size h.
    fn march(&mut self, mut t: f64, mut h: f64) -> Result<(), RunError> {
        let end = self.recorder.settings.end;
        let limit = self.recorder.settings.step_limit(self.agenda.switches());
        while t < end {
            let (stopped, energy_floor) = (self.stop.load(Ordering::Relaxed), self.energy_floor);
            self.recorder.keep(t, stopped, || simulate::StepperState::Along(StepperState { t, h, energy_floor }))?;
            if stopped {
                return Err(RunError::Interrupted { t });
            }
            if self.recorder.report.steps >= limit {
                return Err(RunError::TooManySteps { t, limit: self.recorder.report.steps });
            }
            if t == 0.0 && self.recorder.system.turns_at(t) {
                let sides = self.look_across(t, f64::EPSILON * f64::EPSILON * end)?;
                t = self.cross(sides)?;
                continue;
            }
            let stop = self.agenda.next_stop(t);
            if let Some(signal::Stop { before, after: Some(after) }) = stop
                && before <= t
            {
                let sides = self.look_across(t, after)?;
                t = self.cross(sides)?;
                continue;
            }
            let stop_at = stop.map_or(end, |stop| stop.before);
            let reach = self.recorder.system.motion.reach(t, self.agenda.reach(t, h));
            let to = target(t, reach, stop_at);
            // Only one side of a kink belongs to the step.
            let far_side = stop.filter(|_| to == stop_at).and_then(|stop| stop.after);
            let size = to - t;
            let on_break = stop.is_some() && to == stop_at && far_side.is_none();
            let mut error = self.attempt(t, to, on_break)?;
            let turn = self.first_reversal(t, to)?;
            let (to, size, on_break, far_side) =
                turn.map_or((to, size, on_break, far_side), |turn| (turn, turn - t, false, None));
            if turn.is_some() {
                error = self.attempt(t, to, on_break)?;
            }
            if !error.accepted() {
                self.recorder.report.rejected_steps += 1;
                h = size * error.factor().min(0.7);
                if h < SHORTEST_STEP * end {
                    return Err(self.step_too_small(t, size, &error));
                }
                continue;
            }
            // Before any row is written, since a jump must leave none behind.
            let sides = far_side.map(|after| self.look_across(to, after)).transpose()?;
            let mut place = |system: &System, scratch: &mut Scratch, at: f64, _: f64, moment: &mut Moment| {
                system.evaluate(at, at, scratch, moment)
            };
            self.recorder.emit_rows(t, to, on_break, &mut place)?;
            self.recorder.commit(size);
            self.recorder.report.steps += 1;
            // A step cut short by a stop says nothing against the size chosen before.
            h = (size * error.factor()).max(if size < h { h } else { 0.0 }).min(self.longest_step());
            t = to;
            if let Some(sides) = sides {
                t = self.cross(sides)?;
            } else if on_break {
                let [moment, ..] = &mut self.recorder.moments;
                self.recorder.system.evaluate(t, t, &mut self.recorder.scratch, moment)?;
            }
        }
        Ok(())
    }

    fn step_too_small(&self, t: f64, h: f64, error: &StepError) -> RunError {
        // At the limit of its reach the robot's rates are infinite, so that the steps shrink before the path ends.
        if let Some(failure) =
            self.recorder.system.motion.failure().filter(|failure| failure.t() - t < NEAR * self.recorder.settings.end)
        {
            return failure.into();
        }
        let subject = match error.element {
            Some(e) if error.memory >= error.energy => format!("element \"{}\"", self.recorder.system.elements[e].name),
            _ => "the energy ledger".into(),
        };
        RunError::StepTooSmall { t, h, error: error.worst(), subject }
    }
}
