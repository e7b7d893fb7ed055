//! The time loop along a motion given in advance.
//!
//! Inner steps are chosen for the memories and for the energy ledger, never for the rows; a row between two steps' ends is
//! evaluated with the step's own polynomial. Steps end on break points and kinks of the signals.

mod attempt;
mod kink;
mod rows;

use self::rows::on_grid_observation;
use crate::element::Element;
use crate::fractional::step::{MAX_NODES, RADAU_NODES};
use crate::law::{InputValue, Observation, Powers, Start, State};
use crate::motion::kinks::locate;
use crate::simulate::control::StepError;
use crate::simulate::ledger::{NodePower, Turnover};
use crate::simulate::moment::{Moment, Scratch};
use crate::simulate::on_grid::{self, GridDerivatives};
use crate::simulate::row::ElementRow;
use crate::simulate::{Report, Rows, RunError, Settings, Stop, System};
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
    let outcome = run.start().and_then(|()| run.march());
    run.finish();
    (run.report, outcome)
}

/// The running accounts of one element.
#[derive(Debug, Default)]
struct Account {
    /// `None` for an element with a named scheme.
    law: Option<State>,
    dissipated: f64,
    input: f64,
    /// Largest regular part of D^alpha x so far.
    scale: f64,
    /// D^alpha x at the start of the step.
    derivative: f64,
}

/// What one step works out for one element.
#[derive(Debug, Clone)]
struct ElementStep {
    stroke: [f64; MAX_NODES + 1],
    rate: [f64; MAX_NODES + 1],
    inputs: Vec<InputValue>,
    resolution: f64,
    powers: Powers,
    /// The element at the end of the step.
    end: Observation,
}

/// Powers of the step that belong to no element.
#[derive(Debug, Clone, Copy, Default)]
struct StepPowers {
    actuators: NodePower,
    joints: NodePower,
}

struct Run<'a> {
    system: &'a System,
    settings: &'a Settings,
    rows: &'a mut dyn Rows,
    stop: &'a Stop,
    scratch: Scratch,
    /// At the start of the step and at its nodes.
    moments: [Moment; MAX_NODES + 1],
    /// A moment to write rows from.
    spare: Option<Moment>,
    accounts: Vec<Account>,
    steps: Vec<ElementStep>,
    powers: StepPowers,
    grid: GridDerivatives,
    next_row: usize,
    row: Vec<f64>,
    actuators: f64,
    joints: f64,
    potential_origin: f64,
    /// Balance at t = 0.
    origin: f64,
    turnover: Turnover,
    /// A lower bound of the energy turned over, from a glance at the motion.
    energy_floor: f64,
    residual: f64,
    report: Report,
}

impl<'a> Run<'a> {
    fn new(system: &'a System, settings: &'a Settings, rows: &'a mut dyn Rows, stop: &'a Stop) -> Self {
        let moment = Moment::new(system);
        let element_step = |element: &Element| ElementStep {
            stroke: [0.0; MAX_NODES + 1],
            rate: [0.0; MAX_NODES + 1],
            inputs: vec![InputValue::default(); (MAX_NODES + 1) * element.inputs.len()],
            resolution: 0.0,
            powers: Powers::default(),
            end: Observation { derivative: 0.0, force: 0.0, stored: None },
        };
        Self {
            system,
            settings,
            rows,
            stop,
            scratch: Scratch::new(&system.model),
            moments: std::array::from_fn(|_| moment.clone()),
            spare: None,
            accounts: system.elements.iter().map(|_| Account::default()).collect(),
            steps: system.elements.iter().map(element_step).collect(),
            powers: StepPowers::default(),
            grid: Vec::new(),
            next_row: 0,
            row: Vec::new(),
            actuators: 0.0,
            joints: 0.0,
            potential_origin: 0.0,
            origin: 0.0,
            turnover: Turnover::default(),
            energy_floor: 0.0,
            residual: 0.0,
            report: Report::default(),
        }
    }

    fn longest_step(&self) -> f64 {
        self.settings.max_step.unwrap_or(self.settings.end * LONGEST_STEP).min(self.settings.end)
    }

    fn first_step(&self) -> f64 {
        self.settings.first_step.unwrap_or(self.longest_step() * FIRST_STEP).min(self.settings.end)
    }

    /// The state at t = 0, its row, and the scales.
    fn start(&mut self) -> Result<(), RunError> {
        let (system, settings) = (self.system, self.settings);
        let [moment, ..] = &mut self.moments;
        system.evaluate(0.0, 0.0, &mut self.scratch, moment)?;
        self.grid = on_grid::derivatives(system, &settings.rows, &mut self.scratch)?;
        self.energy_floor = self.glance();
        let delta = RADAU_NODES[0] * self.first_step();
        let [moment, ..] = &self.moments;
        self.potential_origin = moment.potential;
        let mut rows = Vec::new();
        for (e, (element, account)) in system.elements.iter().zip(&mut self.accounts).enumerate() {
            let state = &moment.elements[e];
            let point = state.point(0.0);
            let observation = match &self.grid[e] {
                Some(values) => on_grid_observation(element, &point, values[0]),
                None => {
                    let start = Start {
                        stroke: state.stroke,
                        jump: element.jump(state.length),
                        tolerance: settings.memory_rtol,
                        delta,
                        horizon: settings.end,
                    };
                    let begun = element.law.begin(&start);
                    let law = begun.map_err(|source| RunError::Kernel { element: element.name.clone(), source })?;
                    let observation = element.law.observe_start(&point, &law);
                    account.law = Some(law);
                    observation
                }
            };
            account.derivative = if observation.derivative.is_finite() { observation.derivative } else { 0.0 };
            rows.push(ElementRow { observation, dissipated: 0.0, input: 0.0 });
        }
        let balance = self.balance(&self.moments[0], &rows, 0.0, 0.0);
        self.origin = balance.total();
        // Taken here and at the ends of steps, never from rows: they must not change the steps.
        self.turnover.take(&balance);
        if settings.rows.count() > 0 && settings.rows.at(0) == 0.0 {
            let moment = self.moments[0].clone();
            self.write_row(&moment, &rows, 0.0, 0.0)?;
        }
        Ok(())
    }

    /// A lower bound of the energy that the motion turns over, from 65 glances at it.
    fn glance(&mut self) -> f64 {
        let mut moment = Moment::new(self.system);
        let (mut potential, mut kinetic) = ([f64::INFINITY, f64::NEG_INFINITY], 0.0f64);
        let mut strokes = vec![[f64::INFINITY, f64::NEG_INFINITY]; self.system.elements.len()];
        let mut forces = vec![0.0f64; self.system.elements.len()];
        for k in 0..=64 {
            let t = self.settings.end * k as f64 / 64.0;
            if self.system.evaluate(t, t, &mut self.scratch, &mut moment).is_err() {
                break;
            }
            let widen = |range: &mut [f64; 2], x: f64| *range = [range[0].min(x), range[1].max(x)];
            kinetic = kinetic.max(moment.kinetic);
            widen(&mut potential, moment.potential);
            for (e, state) in moment.elements.iter().enumerate() {
                widen(&mut strokes[e], state.stroke);
                let slow = state.stroke * self.settings.end.powf(-self.system.elements[e].law.order());
                forces[e] = forces[e].max(self.system.elements[e].law.force(&state.point(t), slow).abs());
            }
        }
        let elements: f64 = strokes.iter().zip(forces).map(|(range, force)| (range[1] - range[0]) * force).sum();
        kinetic + (potential[1] - potential[0]).max(0.0) + elements.max(0.0)
    }

    fn march(&mut self) -> Result<(), RunError> {
        let end = self.settings.end;
        let breaks = self.system.break_points(end);
        let mut breaks = breaks.into_iter().peekable();
        let has_kinks = self.system.has_kinks();
        let (mut t, mut h) = (0.0, self.first_step());
        while t < end {
            if self.stop.load(Ordering::Relaxed) {
                return Err(RunError::Interrupted { t });
            }
            if self.settings.max_steps.is_some_and(|limit| self.report.steps >= limit) {
                return Err(RunError::TooManySteps { t, limit: self.report.steps });
            }
            while breaks.next_if(|b| *b <= t).is_some() {}
            let stop = breaks.peek().copied().unwrap_or(end);
            let mut to = target(t, h, stop);
            // Only one side of a kink belongs to the step.
            let mut far_side = None;
            if has_kinks && let Some(node) = self.first_other_branch(t, to) {
                let (before, after) = locate(|t| self.system.branch(t), t, node);
                if before <= t {
                    let sides = self.look_across(t, after)?;
                    t = self.cross(sides)?;
                    continue;
                }
                far_side = Some(after);
                to = before;
            }
            let size = to - t;
            let on_break = to == stop && to < end;
            let error = self.attempt(t, to, on_break)?;
            if !error.accepted() {
                self.report.rejected_steps += 1;
                h = size * error.factor().min(0.7);
                if h < SHORTEST_STEP * end {
                    return Err(self.step_too_small(t, size, &error));
                }
                continue;
            }
            // Before any row is written, since a jump must leave none behind.
            let sides = far_side.map(|after| self.look_across(to, after)).transpose()?;
            self.emit_rows(t, to, on_break)?;
            self.commit(size);
            self.report.steps += 1;
            // A step cut short by a stop says nothing against the size chosen before.
            h = (size * error.factor()).max(if size < h { h } else { 0.0 }).min(self.longest_step());
            t = to;
            if let Some(sides) = sides {
                t = self.cross(sides)?;
            } else if on_break {
                let [moment, ..] = &mut self.moments;
                self.system.evaluate(t, t, &mut self.scratch, moment)?;
            }
        }
        Ok(())
    }

    /// The first node of the step (or its end) at which the signals are on another branch than at its start.
    fn first_other_branch(&self, t: f64, to: f64) -> Option<f64> {
        let branch = self.system.branch(t);
        let nodes = RADAU_NODES.map(|c| if c == 1.0 { to } else { t + c * (to - t) });
        nodes.into_iter().find(|node| self.system.branch(*node) != branch)
    }

    /// Forces of a named scheme are known at the rows alone.
    fn actuators_unknown(&self) -> bool {
        self.accounts.iter().any(|account| account.law.is_none())
    }

    /// Takes the step that was just attempted into the past.
    fn commit(&mut self, h: f64) {
        let (actuators, joints) = self.work_until(1.0);
        let rows: Vec<ElementRow> =
            (0..self.steps.len()).map(|e| self.with_ledger(e, 1.0, self.steps[e].end)).collect();
        let balance = self.balance(&self.moments[MAX_NODES], &rows, actuators, joints);
        self.turnover.take(&balance);
        self.actuators += actuators;
        self.joints += joints;
        let t = self.moments[0].t;
        let to = self.moments[MAX_NODES].t;
        for (e, row) in rows.iter().enumerate() {
            let scale = self.scale_with_step(e, to);
            let account = &mut self.accounts[e];
            account.dissipated = row.dissipated;
            account.input = row.input;
            account.scale = scale;
            account.derivative = row.observation.derivative;
            if let Some(law) = &mut account.law {
                self.system.elements[e].law.commit(&self.steps[e].law_step(t, h), law);
            }
        }
        self.moments.swap(0, MAX_NODES);
    }

    fn step_too_small(&self, t: f64, h: f64, error: &StepError) -> RunError {
        // At the limit of its reach the robot's rates are infinite, so that the steps shrink before the path ends.
        if let Some(failure) = self.system.motion.failure().filter(|failure| failure.t - t < NEAR * self.settings.end) {
            return failure.into();
        }
        let subject = match error.element {
            Some(e) if error.memory >= error.energy => format!("element \"{}\"", self.system.elements[e].name),
            _ => "the energy ledger".into(),
        };
        RunError::StepTooSmall { t, h, error: error.worst(), subject }
    }

    fn finish(&mut self) {
        let known = self.report.rows > 0 && self.residual.is_finite();
        self.report.energy_residual = known.then_some(self.residual);
        self.report.energy_turned_over = known.then(|| self.turnover.total());
        let states = self.accounts.iter().filter_map(|account| account.law.as_ref());
        self.report.modes = states.map(State::modes).sum();
    }
}

/// The end of a step of size h from t that must not pass `stop`; the last two steps before it share what is left.
fn target(t: f64, h: f64, stop: f64) -> f64 {
    let left = stop - t;
    if h >= left * (1.0 - 1e-9) {
        stop
    } else if h > 0.5 * left {
        t + 0.5 * left
    } else {
        t + h
    }
}
