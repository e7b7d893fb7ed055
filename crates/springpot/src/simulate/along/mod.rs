//! The time loop along a motion given in advance.
//!
//! Inner steps are chosen for the memories and for the energy ledger, never for the rows; a row between two steps' ends is
//! evaluated with the step's own polynomial. Steps end on break points and kinks of the signals.

mod attempt;
mod kink;
mod reversal;

use crate::fractional::step::RADAU_NODES;
use crate::signal::{self, Agenda};
use crate::simulate::book::{Book, Books, target};
use crate::simulate::control::StepError;
use crate::simulate::moment::{Moment, Scratch};
use crate::simulate::on_grid;
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
    let outcome = outcome.and_then(|()| run.book.verdict());
    (run.book.finish(), outcome)
}

/// Goes on with a run from what was kept of it.
pub(super) fn resume(
    system: &System,
    settings: &Settings,
    (books, pace): (Books, Pace),
    rows: &mut dyn Rows,
    stop: &Stop,
) -> (Report, Result<(), RunError>) {
    let mut run = Run::new(system, settings, rows, stop);
    let Pace { t, h, energy_floor } = pace;
    run.energy_floor = energy_floor;
    run.book.restore(books);
    let outcome = run.look_ahead().and_then(|()| run.differentiate_grid()).and_then(|()| run.march(t, h));
    let outcome = outcome.and_then(|()| run.book.verdict());
    (run.book.finish(), outcome)
}

/// What the next step takes over from those before.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Pace {
    t: f64,
    h: f64,
    energy_floor: f64,
}

struct Run<'a> {
    book: Book<'a>,
    stop: &'a Stop,
    /// What the signals do.
    agenda: Agenda,
    /// A lower bound of the energy turned over, from a glance at the motion.
    energy_floor: f64,
    /// Velocities at which friction sticks: their power has a kink where they turn round.
    rubbing: Vec<usize>,
}

impl<'a> Run<'a> {
    fn new(system: &'a System, settings: &'a Settings, rows: &'a mut dyn Rows, stop: &'a Stop) -> Self {
        Self {
            book: Book::new(system, settings, rows),
            stop,
            agenda: Agenda::default(),
            energy_floor: 0.0,
            rubbing: reversal::rubbing(&system.model),
        }
    }

    fn longest_step(&self) -> f64 {
        self.book.settings.max_step.unwrap_or(self.book.settings.end * LONGEST_STEP).min(self.book.settings.end)
    }

    fn first_step(&self) -> f64 {
        let first = self.book.settings.first_step.unwrap_or(self.longest_step() * FIRST_STEP);
        self.agenda.reach(0.0, first.min(self.book.settings.end))
    }

    /// What the signals will do.
    fn look_ahead(&mut self) -> Result<(), RunError> {
        self.agenda = self.book.system.agenda(self.book.settings, self.longest_step(), self.stop)?;
        self.book.take_agenda(&self.agenda);
        Ok(())
    }

    /// The first moment and its row; returns the first step.
    fn start(&mut self) -> Result<f64, RunError> {
        let (system, first) = (self.book.system, self.first_step());
        let [moment, ..] = &mut self.book.moments;
        system.evaluate(0.0, 0.0, &mut self.book.scratch, moment)?;
        self.differentiate_grid()?;
        self.energy_floor = self.glance();
        self.book.open(RADAU_NODES[0] * first)?;
        Ok(first)
    }

    /// The derivatives of elements with named schemes, at all rows.
    fn differentiate_grid(&mut self) -> Result<(), RunError> {
        self.book.grid = on_grid::derivatives(self.book.system, &self.book.settings.rows, &mut self.book.scratch)?;
        Ok(())
    }

    /// A lower bound of the energy that the motion turns over, from 65 glances at it.
    fn glance(&mut self) -> f64 {
        let mut moment = Moment::new(self.book.system);
        let (mut potential, mut kinetic) = ([f64::INFINITY, f64::NEG_INFINITY], 0.0f64);
        let mut strokes = vec![[f64::INFINITY, f64::NEG_INFINITY]; self.book.system.elements.len()];
        let mut forces = vec![0.0f64; self.book.system.elements.len()];
        for k in 0..=64 {
            let t = self.book.settings.end * k as f64 / 64.0;
            if self.book.system.evaluate(t, t, &mut self.book.scratch, &mut moment).is_err() {
                break;
            }
            let widen = |range: &mut [f64; 2], x: f64| *range = [range[0].min(x), range[1].max(x)];
            kinetic = kinetic.max(moment.kinetic);
            widen(&mut potential, moment.potential);
            for (e, state) in moment.elements.iter().enumerate() {
                widen(&mut strokes[e], state.stroke);
                let element = &self.book.system.elements[e];
                if let Ok(law) = element.begin(element.rest_length, &state.inputs) {
                    let force = element.law.estimate(&state.point(t), &law, 1.0 / self.book.settings.end);
                    forces[e] = forces[e].max(force.abs());
                }
            }
        }
        let elements: f64 = strokes.iter().zip(forces).map(|(range, force)| (range[1] - range[0]) * force).sum();
        kinetic + (potential[1] - potential[0]).max(0.0) + elements.max(0.0)
    }

    /// Takes step after step from t on, the first of size h.
    fn march(&mut self, mut t: f64, mut h: f64) -> Result<(), RunError> {
        let end = self.book.settings.end;
        let limit = self.book.settings.step_limit(self.agenda.switches());
        while t < end {
            let (stopped, energy_floor) = (self.stop.load(Ordering::Relaxed), self.energy_floor);
            self.book.keep(t, stopped, || simulate::Pace::Along(Pace { t, h, energy_floor }))?;
            if stopped {
                return Err(RunError::Interrupted { t });
            }
            if self.book.report.steps >= limit {
                return Err(RunError::TooManySteps { t, limit: self.book.report.steps });
            }
            if t == 0.0 && self.book.system.turns_at(t) {
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
            let reach = self.book.system.motion.reach(t, self.agenda.reach(t, h));
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
                self.book.report.rejected_steps += 1;
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
            self.book.emit_rows(t, to, on_break, &mut place)?;
            self.book.commit(size);
            self.book.report.steps += 1;
            // A step cut short by a stop says nothing against the size chosen before.
            h = (size * error.factor()).max(if size < h { h } else { 0.0 }).min(self.longest_step());
            t = to;
            if let Some(sides) = sides {
                t = self.cross(sides)?;
            } else if on_break {
                let [moment, ..] = &mut self.book.moments;
                self.book.system.evaluate(t, t, &mut self.book.scratch, moment)?;
            }
        }
        Ok(())
    }

    fn step_too_small(&self, t: f64, h: f64, error: &StepError) -> RunError {
        // At the limit of its reach the robot's rates are infinite, so that the steps shrink before the path ends.
        if let Some(failure) =
            self.book.system.motion.failure().filter(|failure| failure.t() - t < NEAR * self.book.settings.end)
        {
            return failure.into();
        }
        let subject = match error.element {
            Some(e) if error.memory >= error.energy => format!("element \"{}\"", self.book.system.elements[e].name),
            _ => "the energy ledger".into(),
        };
        RunError::StepTooSmall { t, h, error: error.worst(), subject }
    }
}
