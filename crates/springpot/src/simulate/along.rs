//! The time loop along a motion given in advance.
//!
//! Inner steps are chosen for the memories and for the energy ledger, never for the rows; a row between two steps' ends is
//! evaluated with the step's own polynomial. Steps end on break points and kinks of the signals.

use super::control::StepError;
use super::ledger::{Balance, NodePower, Turnover, singular_work, work, work_defect};
use super::moment::{Moment, Scratch};
use super::on_grid::{self, GridDerivatives};
use super::row::ElementRow;
use super::{Report, Rows, RunError, Settings, Stop, System};
use crate::element::Element;
use crate::fractional::step::{MAX_NODES, RADAU_NODES};
use crate::fractional::{Form, Nodes};
use crate::law::{InputValue, Observation, Point, Power, Powers, Start, State, Step};
use crate::motion::kinks::locate;
use std::sync::atomic::Ordering;

/// The longest inner step is this share of the motion, so that nothing in it is stepped over.
const LONGEST_STEP: f64 = 1.0 / 500.0;

/// The first inner step is this share of the longest.
const FIRST_STEP: f64 = 1.0 / 64.0;

/// Shortest step as a share of the motion.
const SHORTEST_STEP: f64 = 1e-13;

/// A step this short, as a share of the motion, is kept whatever it does to the energy ledger: behind a kink of the rates the
/// powers rise like t^{1−alpha}, which no step resolves, and such a step turns over next to nothing.
const SHORTEST_LEDGER_STEP: f64 = 1e-11;

/// Steps that shrink to nothing this near the end of what the gripper can reach shrink because of it; share of the motion.
const NEAR: f64 = 1e-3;

/// Share of rtol^⅔ that the energy ledger may err in one step, in units of the energy turned over.
const ENERGY_SHARE: f64 = 0.01;

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
            let mut across = None;
            if has_kinks && let Some(node) = self.first_other_branch(t, to) {
                let (before, after) = locate(|t| self.system.branch(t), t, node);
                let sides = self.look_across(before.max(t), after)?;
                if before <= t {
                    t = self.cross(sides)?;
                    continue;
                }
                across = Some(sides);
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
            self.emit_rows(t, to, on_break)?;
            self.commit(size);
            self.report.steps += 1;
            // A step cut short by a stop says nothing against the size chosen before.
            h = (size * error.factor()).max(if size < h { h } else { 0.0 }).min(self.longest_step());
            t = to;
            if let Some(sides) = across {
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

    /// Evaluates the step from t to `to` without keeping it; an element that turns over on the way is asked for a shorter step.
    fn attempt(&mut self, t: f64, to: f64, on_break: bool) -> Result<StepError, RunError> {
        let h = to - t;
        for (k, c) in RADAU_NODES.into_iter().enumerate() {
            let node = if c == 1.0 { to } else { t + c * h };
            let t_inputs = if c == 1.0 && on_break { to.next_down() } else { node };
            self.system.evaluate(node, t_inputs, &mut self.scratch, &mut self.moments[k + 1])?;
        }
        if let Some(element) = self.reversed(t, h)? {
            return Ok(StepError { memory: 1e3, alpha: 0.0, element: Some(element), energy: 0.0 });
        }
        self.powers = StepPowers::default();
        for (k, moment) in self.moments.iter().enumerate() {
            self.powers.actuators[k] = moment.rigid_power();
            self.powers.joints[k] = moment.joint_loss;
        }
        let mut error = StepError::NONE;
        for e in 0..self.system.elements.len() {
            self.fill_element_step(e);
            let Some(defect) = self.evaluate_element(e, t, h) else { continue };
            let alpha = self.system.elements[e].law.order();
            let scale = self.scale_with_step(e, to);
            let allowed = self.settings.atol.unwrap_or(0.0) + self.settings.rtol * scale;
            let share = if defect == 0.0 { 0.0 } else { defect / allowed };
            if share > error.memory {
                error = StepError { memory: share, alpha, element: Some(e), ..error };
            }
        }
        if h > SHORTEST_LEDGER_STEP * self.settings.end {
            error.energy = self.energy_error(h);
        }
        Ok(error)
    }

    /// An element whose direction turned by more than a right angle between two nodes: its points passed each other.
    fn reversed(&self, t: f64, h: f64) -> Result<Option<usize>, RunError> {
        for pair in self.moments.windows(2) {
            for (e, (a, b)) in pair[0].elements.iter().zip(&pair[1].elements).enumerate() {
                if a.direction.dot(b.direction) > 0.0 {
                    continue;
                }
                let element = &self.system.elements[e];
                let length = a.length.min(b.length);
                if h < 1e-9 * self.settings.end || length < 1e-9 * element.rest_length {
                    return Err(RunError::ZeroLength { t: t + 0.5 * h, element: element.name.clone(), length });
                }
                return Ok(Some(e));
            }
        }
        Ok(None)
    }

    fn fill_element_step(&mut self, e: usize) {
        let step = &mut self.steps[e];
        let inputs = self.system.elements[e].inputs.len();
        for (k, moment) in self.moments.iter().enumerate() {
            let state = &moment.elements[e];
            step.stroke[k] = state.stroke;
            step.rate[k] = state.rate;
            step.inputs[k * inputs..(k + 1) * inputs].copy_from_slice(&state.inputs);
        }
        step.resolution = self.system.elements[e].resolution(self.moments[0].elements[e].length);
    }

    /// Asks the law for the step: its powers, its state at the end, the regular power it takes from the actuators.
    /// Returns the embedded error; `None` for an element with a named scheme.
    fn evaluate_element(&mut self, e: usize, t: f64, h: f64) -> Option<f64> {
        let element = &self.system.elements[e];
        let account = &self.accounts[e];
        let state = account.law.as_ref()?;
        let step = self.steps[e].law_step(t, h);
        let response = element.law.respond(&step, state);
        let powers = element.law.powers(&step, state);
        let end = element.law.observe(&step, 1.0, &step.point(MAX_NODES), state);
        let defect = element.law.defect(&step, state);
        for k in 0..=MAX_NODES {
            let at = step.point(k);
            let force = if k == 0 { element.force_at_start(&at, account.derivative) } else { response.force[k - 1] };
            let singular = if at.t > 0.0 { singular_force(element, &at, state, at.t) } else { 0.0 };
            self.powers.actuators[k] += (force - singular) * at.rate;
        }
        self.steps[e].powers = powers;
        self.steps[e].end = end;
        Some(defect)
    }

    /// The largest regular D^alpha x so far, this step included.
    fn scale_with_step(&self, e: usize, to: f64) -> f64 {
        let account = &self.accounts[e];
        let Some(state) = &account.law else { return 0.0 };
        let regular = self.steps[e].end.derivative - self.system.elements[e].law.singular(to, state);
        account.scale.max(regular.abs())
    }

    /// Estimate of what the step adds to the error of the energy ledger, in units of its tolerance.
    fn energy_error(&self, h: f64) -> f64 {
        let turned_over = self.energy_floor.max(self.turnover.total());
        if self.actuators_unknown() || turned_over == 0.0 {
            return 0.0;
        }
        let mut defect = work_defect(&self.powers.actuators, h) + work_defect(&self.powers.joints, h);
        for step in &self.steps {
            defect += work_defect(&step.powers.map(|p| p.dissipation), h);
            defect += work_defect(&step.powers.map(|p| p.input), h);
        }
        if defect.is_nan() { 0.0 } else { defect / (ENERGY_SHARE * self.settings.rtol.powf(2.0 / 3.0) * turned_over) }
    }

    /// Forces of a named scheme are known at the rows alone.
    fn actuators_unknown(&self) -> bool {
        self.accounts.iter().any(|account| account.law.is_none())
    }

    /// Work of the actuators and losses of the joints from the start of the step to θ.
    fn work_until(&self, theta: f64) -> (f64, f64) {
        let [from, .., to] = &self.moments;
        let (t, h) = (from.t, to.t - from.t);
        let mut actuators = work(&self.powers.actuators, h, theta);
        for (e, element) in self.system.elements.iter().enumerate() {
            let Some(state) = &self.accounts[e].law else { continue };
            if element.law.singular(1.0, state) == 0.0 {
                continue;
            }
            let step = self.steps[e].law_step(t, h);
            // Without its power of t, which singular_work integrates exactly.
            let g: NodePower = std::array::from_fn(|k| {
                let at = step.point(k);
                singular_force(element, &at, state, 1.0) * at.rate
            });
            actuators += singular_work(&g, t, h, theta, element.law.order());
        }
        (actuators, work(&self.powers.joints, h, theta))
    }

    /// The time of the next row, unless it is later than `until`.
    fn next_row_until(&self, until: f64) -> Option<f64> {
        let rows = &self.settings.rows;
        (self.next_row < rows.count()).then(|| rows.at(self.next_row)).filter(|at| *at <= until)
    }

    /// The rows in (t, to], the step just attempted.
    fn emit_rows(&mut self, t: f64, to: f64, on_break: bool) -> Result<(), RunError> {
        while let Some(at) = self.next_row_until(to) {
            let mut moment = self.spare.take().unwrap_or_else(|| Moment::new(self.system));
            if at == to && !on_break {
                moment.clone_from(&self.moments[MAX_NODES]);
            } else {
                self.system.evaluate(at, at, &mut self.scratch, &mut moment)?;
            }
            let theta = if at == to { 1.0 } else { (at - t) / (to - t) };
            let rows: Vec<ElementRow> = (0..self.steps.len()).map(|e| self.element_row(e, theta, &moment)).collect();
            let (actuators, joints) = self.work_until(theta);
            self.write_row(&moment, &rows, actuators, joints)?;
            self.spare = Some(moment);
        }
        Ok(())
    }

    /// Element `e` in a row at θ, whose moment is `moment`.
    fn element_row(&self, e: usize, theta: f64, moment: &Moment) -> ElementRow {
        let element = &self.system.elements[e];
        let point = moment.elements[e].point(moment.t);
        let [from, .., to] = &self.moments;
        let Some(law) = &self.accounts[e].law else { return self.grid_row(e, &point) };
        let observation = element.law.observe(&self.steps[e].law_step(from.t, to.t - from.t), theta, &point, law);
        self.with_ledger(e, theta, observation)
    }

    /// The next row of an element with a named scheme.
    fn grid_row(&self, e: usize, point: &Point) -> ElementRow {
        let value = self.grid[e].as_ref().and_then(|values| values.get(self.next_row)).copied();
        let observation = on_grid_observation(&self.system.elements[e], point, value.unwrap_or(f64::NAN));
        ElementRow { observation, dissipated: f64::NAN, input: f64::NAN }
    }

    /// An observation at θ with what the element has dissipated and taken in until then.
    fn with_ledger(&self, e: usize, theta: f64, observation: Observation) -> ElementRow {
        let account = &self.accounts[e];
        if account.law.is_none() {
            return ElementRow { observation, dissipated: f64::NAN, input: f64::NAN };
        }
        let [from, .., to] = &self.moments;
        let energy = Power::integrate(&self.steps[e].powers, Nodes::Radau, to.t - from.t, theta);
        ElementRow {
            observation,
            dissipated: account.dissipated + energy.dissipation,
            input: account.input + energy.input,
        }
    }

    /// The balance at a moment, `actuators` and `joints` being the work since the start of the step.
    fn balance(&self, moment: &Moment, rows: &[ElementRow], actuators: f64, joints: f64) -> Balance {
        let joints = self.joints + joints;
        Balance {
            kinetic: moment.kinetic,
            potential: moment.potential - self.potential_origin,
            stored: rows.iter().map(|row| row.observation.stored.unwrap_or(f64::NAN)).sum(),
            dissipated: rows.iter().map(|row| row.dissipated).sum::<f64>() + joints,
            input: rows.iter().map(|row| row.input).sum(),
            actuators: if self.actuators_unknown() { f64::NAN } else { self.actuators + actuators },
        }
    }

    fn write_row(&mut self, moment: &Moment, rows: &[ElementRow], actuators: f64, joints: f64) -> Result<(), RunError> {
        let balance = self.balance(moment, rows, actuators, joints);
        let residual = balance.total() - self.origin;
        self.residual = if residual.is_nan() { f64::NAN } else { self.residual.max(residual.abs()) };
        let mut row = std::mem::take(&mut self.row);
        self.system.fill_row(moment, rows, &balance, self.joints + joints, residual, &mut row);
        self.rows.row(&row)?;
        self.row = row;
        self.next_row += 1;
        self.report.rows += 1;
        self.report.t_reached = Some(moment.t);
        Ok(())
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

    /// The last moment before a kink and the first one after it.
    fn look_across(&mut self, before: f64, after: f64) -> Result<[Moment; 2], RunError> {
        let [mut left, mut right] = std::array::from_fn(|_| self.moments[0].clone());
        self.system.evaluate(before, before, &mut self.scratch, &mut left)?;
        self.system.evaluate(after, after, &mut self.scratch, &mut right)?;
        for (j, joint) in self.system.model.joint_names().iter().enumerate() {
            let jump = right.q[j] - left.q[j];
            let reach = (after - before) * (left.v[j].abs() + right.v[j].abs());
            if jump.abs() > 1e-9 * (1.0 + left.q[j].abs()) + reach {
                return Err(RunError::Jump { t: after, joint: joint.clone(), jump });
            }
        }
        Ok([left, right])
    }

    /// Goes from a kink to where the next step starts: one bit behind it, since a sign is 0 while it turns.
    fn cross(&mut self, sides: [Moment; 2]) -> Result<f64, RunError> {
        let [_, Moment { t: after, .. }] = sides;
        self.book_jumps(sides);
        self.emit_rows_between_steps(after)?;
        let start = after.next_up();
        let sides = self.look_across(after, start)?;
        self.book_jumps(sides);
        self.emit_rows_between_steps(start)?;
        Ok(start)
    }

    /// The rows up to `until`, when no step is under way.
    fn emit_rows_between_steps(&mut self, until: f64) -> Result<(), RunError> {
        while self.next_row_until(until).is_some() {
            let moment = self.moments[0].clone();
            let rows: Vec<ElementRow> = (0..self.steps.len()).map(|e| self.row_between_steps(e, &moment)).collect();
            self.write_row(&moment, &rows, 0.0, 0.0)?;
        }
        Ok(())
    }

    /// An element between two steps.
    fn row_between_steps(&self, e: usize, moment: &Moment) -> ElementRow {
        let (element, account) = (&self.system.elements[e], &self.accounts[e]);
        let point = moment.elements[e].point(moment.t);
        let Some(state) = &account.law else { return self.grid_row(e, &point) };
        // D^alpha x itself does not jump, but for alpha = 1.
        let derivative = if element.law.order() == 1.0 { point.rate } else { account.derivative };
        let observation = Observation {
            derivative,
            force: element.law.force(&point, derivative),
            stored: element.law.stored(&point, state),
        };
        ElementRow { observation, dissipated: account.dissipated, input: account.input }
    }

    /// Goes on from the far side of a kink and books what jumps there.
    fn book_jumps(&mut self, [left, right]: [Moment; 2]) {
        // An impulse of the actuators makes the velocities jump; a jump of an input changes what its element stores.
        self.actuators += right.kinetic - left.kinetic;
        for (e, element) in self.system.elements.iter().enumerate() {
            let account = &mut self.accounts[e];
            let Some(state) = &account.law else { continue };
            let was = left.elements[e].point(left.t);
            let is = Point { inputs: &right.elements[e].inputs, ..was };
            if let Some((was, is)) = element.law.stored(&was, state).zip(element.law.stored(&is, state)) {
                account.input += is - was;
            }
        }
        self.moments[0] = right;
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

impl ElementStep {
    fn law_step(&self, t: f64, h: f64) -> Step<'_> {
        Step {
            t,
            h,
            nodes: Nodes::Radau,
            form: Form::Rates,
            stroke: &self.stroke,
            rate: &self.rate,
            inputs: &self.inputs,
            resolution: self.resolution,
        }
    }
}

impl Element {
    /// F at the start of a step, where D^alpha x is what the step before ended with; at alpha = 1 it follows the rate.
    fn force_at_start(&self, at: &Point, derivative: f64) -> f64 {
        self.law.force(at, if self.law.order() == 1.0 { at.rate } else { derivative })
    }
}

/// The force of the singular share of D^alpha x, that share being taken at the time `when`.
fn singular_force(element: &Element, at: &Point, state: &State, when: f64) -> f64 {
    let share = element.law.singular(when, state);
    if share == 0.0 { 0.0 } else { element.law.force(at, share) - element.law.force(at, 0.0) }
}

/// An element whose derivative comes from a named scheme: its energies are unknown.
fn on_grid_observation(element: &Element, at: &Point, derivative: f64) -> Observation {
    Observation { derivative, force: element.law.force(at, derivative), stored: None }
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
