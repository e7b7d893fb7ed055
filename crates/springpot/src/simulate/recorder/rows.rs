//! Rows, and the balance of energies in them.

use super::Recorder;
use crate::element::Element;
use crate::fractional::Nodes;
use crate::fractional::step::MAX_NODES;
use crate::law::{Observation, Point, Power};
use crate::simulate::ledger::{Balance, NodePower, singular_work, work};
use crate::simulate::moment::{Moment, Scratch};
use crate::simulate::row::ElementRow;
use crate::simulate::{RunError, System};

/// Fills the moment at a time and θ inside the step.
pub(in crate::simulate) type Place<'a> =
    &'a mut dyn FnMut(&System, &mut Scratch, f64, f64, &mut Moment) -> Result<(), RunError>;

impl Recorder<'_> {
    /// Work of the actuators and losses of the joints from the start of the step to θ.
    pub(in crate::simulate) fn work_until(&self, theta: f64) -> (f64, f64) {
        let [from, .., to] = &self.moments;
        let (t, h) = (from.t, to.t - from.t);
        let mut actuators = work(&self.powers.actuators, h, theta);
        for (e, element) in self.system.elements.iter().enumerate() {
            let Some(state) = &self.accounts[e].law else { continue };
            if !self.takes_elements_work || !state.is_singular() {
                continue;
            }
            let step = self.steps[e].law_step(t, h);
            // Without their power of t, which singular_work integrates exactly.
            let mut shares: Vec<(f64, NodePower)> = Vec::new();
            for k in 0..=MAX_NODES {
                let (at, mut m) = (step.point(k), 0);
                element.law.for_each_singularity(at.inputs, state, &mut |term| {
                    if k == 0 {
                        shares.push((term.order, [0.0; MAX_NODES + 1]));
                    }
                    shares[m].1[k] = term.coefficient * at.rate;
                    m += 1;
                });
            }
            actuators += shares.iter().map(|(alpha, g)| singular_work(g, t, h, theta, *alpha)).sum::<f64>();
        }
        (actuators, work(&self.powers.joints, h, theta))
    }

    /// The time of the next row, unless it is later than `until`.
    pub(in crate::simulate) fn next_row_until(&self, until: f64) -> Option<f64> {
        let rows = &self.settings.rows;
        (self.next_row < rows.count()).then(|| rows.at(self.next_row)).filter(|at| *at <= until)
    }

    /// The rows in (t, to], the step just worked out.
    pub(in crate::simulate) fn emit_rows(
        &mut self,
        t: f64,
        to: f64,
        on_break: bool,
        place: Place<'_>,
    ) -> Result<(), RunError> {
        while let Some(at) = self.next_row_until(to) {
            let mut moment = self.spare.take().unwrap_or_else(|| Moment::new(self.system));
            let theta = if at == to { 1.0 } else { (at - t) / (to - t) };
            if at == to && !on_break {
                if !self.end_is_whole {
                    self.system.fill(at, at, None, &mut self.scratch, &mut self.moments[MAX_NODES])?;
                    self.end_is_whole = true;
                }
                moment.clone_from(&self.moments[MAX_NODES]);
            } else {
                place(self.system, &mut self.scratch, at, theta, &mut moment)?;
            }
            let rows = (0..self.steps.len()).map(|e| self.element_row(e, theta, &moment));
            let rows = rows.collect::<Result<Vec<ElementRow>, _>>()?;
            self.compare_with_step(theta, &moment, &rows);
            let (actuators, joints) = self.work_until(theta);
            self.write_row(&moment, &rows, actuators, joints)?;
            self.spare = Some(moment);
        }
        Ok(())
    }

    /// Element `e` in a row at θ, whose moment is `moment`.
    pub(in crate::simulate) fn element_row(
        &self,
        e: usize,
        theta: f64,
        moment: &Moment,
    ) -> Result<ElementRow, RunError> {
        let element = &self.system.elements[e];
        let point = moment.elements[e].point(moment.t);
        let [from, .., to] = &self.moments;
        let Some(law) = &self.accounts[e].law else { return self.grid_row(e, &point) };
        let observation = element.law.at(&self.steps[e].law_step(from.t, to.t - from.t), theta, &point, law);
        Ok(self.with_ledger(e, theta, observation))
    }

    /// The next row of an element with a named scheme.
    pub(in crate::simulate) fn grid_row(&self, e: usize, point: &Point) -> Result<ElementRow, RunError> {
        let derivatives = self.grid[e].as_deref().unwrap_or_default();
        let observation = on_grid_observation(&self.system.elements[e], point, derivatives, self.next_row)?;
        Ok(ElementRow { observation, dissipated: f64::NAN, input: f64::NAN })
    }

    /// An observation at θ with what the element has dissipated and taken in until then.
    pub(in crate::simulate) fn with_ledger(&self, e: usize, theta: f64, observation: Observation) -> ElementRow {
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
    pub(in crate::simulate) fn balance(
        &self,
        moment: &Moment,
        rows: &[ElementRow],
        actuators: f64,
        joints: f64,
    ) -> Balance {
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

    pub(in crate::simulate) fn write_row(
        &mut self,
        moment: &Moment,
        rows: &[ElementRow],
        actuators: f64,
        joints: f64,
    ) -> Result<(), RunError> {
        let balance = self.balance(moment, rows, actuators, joints);
        let residual = balance.total() - self.origin;
        self.take_residual(residual, moment, rows);
        let mut row = std::mem::take(&mut self.row);
        self.system.fill_row(moment, rows, &balance, self.joints + joints, residual, &mut row);
        if let Some(k) = row.iter().position(|value| value.is_infinite()) {
            let what = self.system.columns().swap_remove(k).name;
            return Err(RunError::NotFinite { t: moment.t, what, value: row[k] });
        }
        self.rows.row(&row)?;
        self.row = row;
        self.next_row += 1;
        self.report.rows += 1;
        self.report.t_reached = Some(moment.t);
        Ok(())
    }
}

/// An element whose `derivatives` come from a named scheme, one list for each memory, at row `row`: its energies are unknown.
pub(in crate::simulate) fn on_grid_observation(
    element: &Element,
    at: &Point,
    derivatives: &[Vec<f64>],
    row: usize,
) -> Result<Observation, RunError> {
    let begun = element.begin(element.rest_length, at.inputs);
    let mut state = begun.map_err(|source| RunError::Kernel { element: element.name.clone(), source })?;
    for (memory, values) in state.memories_mut().iter_mut().zip(derivatives) {
        memory.tell(values.get(row).copied().unwrap_or(f64::NAN));
    }
    Ok(Observation { stored: None, ..element.law.now(at, &state) })
}
