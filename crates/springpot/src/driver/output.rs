//! The rows of a run, and what they tell of it: whether its steps saw what the motion does, and whether its energies balance.

use super::report::Report;
use super::rows::Rows;
use super::time_loop::Driver;
use super::written::Written;
use crate::equations::context::Context;
use crate::equations::control::Misread;
use crate::observe::{Quantity, Snapshot};
use crate::system::error::RunError;
use crate::system::settings::Settings;

/// How much more than the tolerance the balance may be off, in units of the energy turned over, and what it may in any case.
const IMBALANCE: f64 = 1e3;
const LEAST_IMBALANCE: f64 = 1e-4;

/// What rounding does to a balance, in units of the energies and of the works that it is made of.
const ROUNDING: f64 = 256.0 * f64::EPSILON;

/// Writes the rows of a run.
pub(super) struct Output<'a> {
    pub(super) rows: &'a mut dyn Rows,
    pub(super) written: Written,
    snapshot: Snapshot,
    quantities: Vec<Quantity>,
    row: Vec<f64>,
    /// Parameters whose derivatives were told to have ended.
    lost: Vec<usize>,
}

impl<'a> Output<'a> {
    pub(super) fn new(cx: Context, rows: &'a mut dyn Rows, written: Written) -> Self {
        let quantities = cx.system.observables().quantities();
        Self { rows, written, snapshot: Snapshot::new(cx.system), quantities, row: Vec::new(), lost: Vec::new() }
    }

    /// The time of the next row.
    pub(super) fn next(&self, settings: &Settings) -> Option<f64> {
        let rows = &settings.rows;
        (self.written.rows < rows.count()).then(|| rows.at(self.written.rows))
    }

    /// Writes the rows of what the driver just did.
    pub(super) fn emit(&mut self, cx: Context, driver: &mut Driver) -> Result<(), RunError> {
        while let Some(at) = self.next(&driver.recorder.settings).filter(|at| driver.shows(*at)) {
            let theta = driver.show(cx, at, self.written.rows, &mut self.snapshot)?;
            driver.keep_row(theta, self.written.rows, &self.snapshot)?;
            if let Some(theta) = theta {
                let t = self.snapshot.t();
                if self.written.departure.is_none() {
                    let departure = driver.recorder.departure(theta, &self.snapshot);
                    self.written.departure = departure.map(|(e, size)| (t, e, size));
                }
                if self.written.misread.is_none() {
                    self.written.misread = driver.recorder.misread(cx, &self.snapshot).map(|misread| (t, misread));
                }
            }
            self.write(cx, driver)?;
        }
        Ok(())
    }

    /// Writes a last row where the run ends before its time.
    pub(super) fn end_here(&mut self, cx: Context, driver: &mut Driver) -> Result<(), RunError> {
        let t = driver.reached();
        if self.written.last == Some(t) {
            return Ok(());
        }
        let theta = driver.show(cx, t, self.written.rows, &mut self.snapshot)?;
        driver.keep_row(theta, self.written.rows, &self.snapshot)?;
        self.write(cx, driver)
    }

    /// Tells the row at the time of an event, which comes later by so much, parameter by parameter.
    pub(super) fn event(
        &mut self,
        cx: Context,
        driver: &mut Driver,
        (event, at): (usize, f64),
        later: &[f64],
    ) -> Result<(), RunError> {
        driver.show(cx, at, self.written.rows, &mut self.snapshot)?;
        self.take_row(cx, driver)?;
        self.follow_event(cx, driver, later)?;
        self.tell_lost(driver);
        // Back through a run, columns stand for other things than parameters.
        let later = if driver.is_recorded() { &[] } else { later };
        self.rows.event(event, &self.row, later)?;
        Ok(())
    }

    /// Adds what the time of an event, which comes later by so much, changes of the derivatives of its row.
    fn follow_event(&mut self, cx: Context, driver: &mut Driver, later: &[f64]) -> Result<(), RunError> {
        let Some(by) = cx.system.sensitivity.as_deref().filter(|by| !by.columns.is_empty()) else { return Ok(()) };
        let mut of: Vec<Quantity> = by.columns.iter().map(|column| column.of).collect();
        of.dedup();
        let rates = driver.rates(cx, &of, &self.snapshot)?;
        for (quantity, value) in self.quantities.iter().zip(&mut self.row) {
            let Quantity::Derivative(k) = quantity else { continue };
            let column = &by.columns[*k];
            let rate = of.iter().position(|of| *of == column.of).map_or(f64::NAN, |at| rates[at]);
            let later = later[column.by];
            *value += if later == 0.0 { 0.0 } else { rate * later };
        }
        Ok(())
    }

    fn write(&mut self, cx: Context, driver: &Driver) -> Result<(), RunError> {
        self.take_residual(cx, driver);
        self.take_row(cx, driver)?;
        self.tell_lost(driver);
        self.rows.row(&self.row)?;
        self.written.rows += 1;
        self.written.last = Some(self.snapshot.t());
        Ok(())
    }

    /// Takes the numbers of the row; what is none fails, but for what a start or a ledger leaves unknown.
    fn take_row(&mut self, cx: Context, driver: &Driver) -> Result<(), RunError> {
        self.row.clear();
        // No field says -0.
        self.row.extend(self.quantities.iter().map(|quantity| self.snapshot.value(*quantity) + 0.0));
        let (t, recorder) = (self.snapshot.t(), &driver.recorder);
        let mut values = self.quantities.iter().zip(&self.row);
        let is_wrong = |(quantity, value): (&Quantity, &f64)| {
            !(value.is_finite() || value.is_nan() && recorder.may_be_unknown(t, quantity))
        };
        if let Some(k) = values.position(is_wrong) {
            let what = cx.system.columns().swap_remove(k).name;
            return Err(RunError::NotFinite { t, what, value: self.row[k] });
        }
        Ok(())
    }

    /// Takes in how far the balance is off, and what rounding makes of it.
    fn take_residual(&mut self, cx: Context, driver: &Driver) {
        let (Snapshot { evaluation, elements, residual, .. }, written) = (&self.snapshot, &mut self.written);
        if residual.abs() > written.residual {
            written.residual_at = evaluation.t;
        }
        written.residual = if residual.is_nan() { f64::NAN } else { written.residual.max(residual.abs()) };
        // Strokes are differences of coordinates, heights of bodies are counted from the world's origin.
        let forces = elements.iter().zip(&evaluation.elements).enumerate().map(|(e, (row, at))| {
            let coordinate = at.reading.coordinate.abs();
            (row.observation.force().abs() + ROUNDING * driver.stiffness(cx, e) * coordinate) * coordinate
        });
        let origin = driver.recorder.potential_origin().abs();
        let sizes = evaluation.potential.abs() + origin + forces.filter(|x| x.is_finite()).sum::<f64>();
        written.rounding = written.rounding.max(ROUNDING * sizes);
    }

    /// Tells where derivatives ended since the last row.
    fn tell_lost(&mut self, driver: &Driver) {
        for lost in driver.lost() {
            if !self.lost.contains(&lost.parameter) {
                self.lost.push(lost.parameter);
                self.rows.lost(lost.clone());
            }
        }
    }

    /// Whether the run may be believed; to be asked at its end.
    ///
    /// # Errors
    /// [`RunError::Missed`] and [`RunError::MissedKink`] where a row contradicts its step, [`RunError::Unbalanced`] where the energies do not balance.
    pub(super) fn verdict(&self, cx: Context, driver: &Driver) -> Result<(), RunError> {
        let Written { departure, misread, residual, residual_at: t, rounding, .. } = self.written;
        if let Some((t, misread)) = misread {
            let (expression, column) = driver.recorder.equations.words(&misread, cx.system);
            let Misread { is, used, .. } = misread;
            return Err(RunError::MissedKink { t, expression, column, is, used });
        }
        if let Some((t, e, departure)) = departure {
            return Err(RunError::Missed { t, element: cx.system.elements[e].name.clone(), departure });
        }
        let allowed = LEAST_IMBALANCE.max(IMBALANCE * driver.recorder.settings.rtol);
        let turned_over = driver.recorder.turned_over();
        if residual > allowed * turned_over + rounding {
            return Err(RunError::Unbalanced { t, residual, turned_over });
        }
        Ok(())
    }

    /// What the run did.
    pub(super) fn report(&self, driver: &Driver) -> Report {
        let Written { rows, last, residual, .. } = self.written;
        let known = rows > 0 && residual.is_finite();
        Report {
            rows: rows as u64,
            t_reached: last,
            energy_residual: known.then_some(residual),
            energy_turned_over: known.then(|| driver.recorder.turned_over()),
            energy_rounding: known.then_some(self.written.rounding),
            ..driver.report()
        }
    }
}

impl Report {
    /// Whether the energies of the run balance as far as a figure can show; `true` where they are not known.
    pub fn is_balanced(&self) -> bool {
        let Self { energy_residual, energy_turned_over, energy_rounding, .. } = self;
        let known = energy_residual.zip(*energy_turned_over);
        let rounding = energy_rounding.unwrap_or(0.0);
        known.is_none_or(|(residual, turned_over)| residual <= LEAST_IMBALANCE * turned_over + rounding)
    }
}
