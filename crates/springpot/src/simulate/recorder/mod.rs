//! The run recorder: what its elements remember, the energy accounts, and the rows.
//!
//! A time loop fills the moments of a step (its start and its nodes) and [`ElementStep`]s, has rows written while the step is
//! under way, and commits it.

mod between;
mod check;
mod defect;
mod elements;
mod kept;
mod rows;

use self::check::Findings;
pub(in crate::simulate) use self::kept::RecorderState;
use self::rows::on_grid_observation;
use super::ledger::{NodePower, Turnover};
use super::moment::{Moment, Scratch};
use super::on_grid::GridDerivatives;
use super::row::ElementRow;
use super::{Report, Rows, RunError, Settings, System};
use crate::element::Element;
use crate::fractional::Form;
use crate::fractional::step::MAX_NODES;
use crate::law::{InputValue, LocalError, Observation, Powers, Singular, State};
use serde::{Deserialize, Serialize};

/// The running accounts of one element.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(in crate::simulate) struct Account {
    /// `None` for an element with a named scheme.
    pub(in crate::simulate) law: Option<State>,
    pub(in crate::simulate) dissipated: f64,
    pub(in crate::simulate) input: f64,
    /// Largest regular D^order x so far, of everything that the law has a [`LocalError`] of.
    pub(in crate::simulate) scales: Vec<f64>,
}

impl Account {
    /// What the law remembers; panics for an element with a named scheme.
    pub(in crate::simulate) fn memory(&self) -> &State {
        self.law.as_ref().expect("an element without a named scheme")
    }
}

/// What one step works out for one element.
#[derive(Debug, Clone)]
pub(in crate::simulate) struct ElementStep {
    pub(in crate::simulate) stroke: [f64; MAX_NODES + 1],
    pub(in crate::simulate) rate: [f64; MAX_NODES + 1],
    pub(in crate::simulate) inputs: Vec<InputValue>,
    pub(in crate::simulate) resolution: f64,
    pub(in crate::simulate) form: Form,
    pub(in crate::simulate) singular: Singular,
    pub(in crate::simulate) powers: Powers,
    pub(in crate::simulate) errors: Vec<LocalError>,
    /// The element at the end of the step.
    pub(in crate::simulate) end: Observation,
}

/// Powers of the step that belong to no element.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::simulate) struct StepPowers {
    pub(in crate::simulate) actuators: NodePower,
    pub(in crate::simulate) joints: NodePower,
}

/// The recorder of one run.
pub(in crate::simulate) struct Recorder<'a> {
    pub(in crate::simulate) system: &'a System,
    pub(in crate::simulate) settings: &'a Settings,
    pub(in crate::simulate) rows: &'a mut dyn Rows,
    pub(in crate::simulate) scratch: Scratch,
    /// At the start of the step and at its nodes.
    pub(in crate::simulate) moments: [Moment; MAX_NODES + 1],
    /// A moment to write rows from.
    spare: Option<Moment>,
    pub(in crate::simulate) accounts: Vec<Account>,
    pub(in crate::simulate) steps: Vec<ElementStep>,
    pub(in crate::simulate) powers: StepPowers,
    /// Whether the moment at the end of the step has all that a row asks for.
    pub(in crate::simulate) end_is_whole: bool,
    /// Whether actuators move the elements, as along a motion given in advance.
    pub(in crate::simulate) takes_elements_work: bool,
    pub(in crate::simulate) grid: GridDerivatives,
    next_row: usize,
    row: Vec<f64>,
    actuators: f64,
    joints: f64,
    potential_origin: f64,
    /// Balance at t = 0.
    origin: f64,
    pub(in crate::simulate) turnover: Turnover,
    residual: f64,
    findings: Findings,
    pub(in crate::simulate) report: Report,
}

impl<'a> Recorder<'a> {
    pub(in crate::simulate) fn new(system: &'a System, settings: &'a Settings, rows: &'a mut dyn Rows) -> Self {
        let moment = Moment::new(system);
        let element_step = |element: &Element| ElementStep {
            stroke: [0.0; MAX_NODES + 1],
            rate: [0.0; MAX_NODES + 1],
            inputs: vec![InputValue::default(); (MAX_NODES + 1) * element.inputs.len()],
            resolution: 0.0,
            form: Form::Rates,
            singular: Singular::Value,
            powers: Powers::default(),
            errors: Vec::new(),
            end: Observation { derivative: 0.0, regular: 0.0, singular: 0.0, stored: None },
        };
        Self {
            system,
            settings,
            rows,
            scratch: Scratch::new(&system.model),
            moments: std::array::from_fn(|_| moment.clone()),
            spare: None,
            accounts: system.elements.iter().map(|_| Account::default()).collect(),
            steps: system.elements.iter().map(element_step).collect(),
            powers: StepPowers::default(),
            end_is_whole: true,
            takes_elements_work: true,
            grid: Vec::new(),
            next_row: 0,
            row: Vec::new(),
            actuators: 0.0,
            joints: 0.0,
            potential_origin: 0.0,
            origin: 0.0,
            turnover: Turnover::default(),
            residual: 0.0,
            findings: Findings::default(),
            report: Report::default(),
        }
    }

    /// Opens the accounts at the first moment, `moments[0]`, and writes its row; `delta` is the shortest lag that the first step
    /// asks for.
    pub(in crate::simulate) fn open(&mut self, delta: f64) -> Result<(), RunError> {
        let (system, settings) = (self.system, self.settings);
        let [moment, ..] = &self.moments;
        self.potential_origin = moment.potential;
        let mut rows = Vec::new();
        for (e, (element, account)) in system.elements.iter().zip(&mut self.accounts).enumerate() {
            let state = &moment.elements[e];
            let point = state.point(0.0);
            let observation = match self.grid.get(e).and_then(Option::as_ref) {
                Some(derivatives) => on_grid_observation(element, &point, derivatives, 0)?,
                None => {
                    let law = element.open(state, settings.memory_rtol, delta, settings.end)?;
                    let observation = element.law.now(&point, &law);
                    account.law = Some(law);
                    observation
                }
            };
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

    /// Forces of a named scheme are known at the rows alone.
    pub(in crate::simulate) fn actuators_unknown(&self) -> bool {
        self.accounts.iter().any(|account| account.law.is_none())
    }

    /// Takes the step that was just attempted into the past.
    pub(in crate::simulate) fn commit(&mut self, h: f64) {
        let (actuators, joints) = self.work_until(1.0);
        let rows: Vec<ElementRow> =
            (0..self.steps.len()).map(|e| self.with_ledger(e, 1.0, self.steps[e].end)).collect();
        let balance = self.balance(&self.moments[MAX_NODES], &rows, actuators, joints);
        self.turnover.take(&balance);
        self.actuators += actuators;
        self.joints += joints;
        let t = self.moments[0].t;
        for (e, row) in rows.iter().enumerate() {
            let scales = (0..self.steps[e].errors.len()).map(|m| self.scale_with_step(e, m)).collect();
            let account = &mut self.accounts[e];
            account.dissipated = row.dissipated;
            account.input = row.input;
            account.scales = scales;
            if let Some(law) = &mut account.law {
                self.system.elements[e].law.commit(&self.steps[e].law_step(t, h), law);
            }
        }
        self.moments.swap(0, MAX_NODES);
    }

    /// What the run did.
    pub(in crate::simulate) fn finish(mut self) -> Report {
        let known = self.report.rows > 0 && self.residual.is_finite();
        self.report.energy_residual = known.then_some(self.residual);
        self.report.energy_turned_over = known.then(|| self.turnover.total());
        let states = self.accounts.iter().filter_map(|account| account.law.as_ref());
        self.report.modes = states.map(State::modes).sum();
        self.report
    }
}

/// The end of a step of size h from t that must not pass `stop`; the last two steps before it share what is left.
pub(in crate::simulate) fn target(t: f64, h: f64, stop: f64) -> f64 {
    let left = stop - t;
    if h >= left * (1.0 - 1e-9) {
        stop
    } else if h > 0.5 * left {
        t + 0.5 * left
    } else {
        t + h
    }
}
