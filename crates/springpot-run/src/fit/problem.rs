//! The residuals of all records, and their derivatives.

use super::compared::{Predicted, Record};
use springpot::identification::{self, Failed, Loss, Parameter, Rows, Series};
use springpot_scenario::{DataKind, Fitting};

/// Changes of the cost that are those of the steps of a run, as a share.
const NOISE: f64 = 1e-9;
/// The same of a part of the samples.
const ROUGH_NOISE: f64 = 1e-6;

/// A cost for each row that noise of the standard deviations that are told leaves.
const EXPLAINED: f64 = 1.3;

/// Residuals of the records that are fitted.
pub(super) struct Problem<'a> {
    pub(super) parameters: Vec<Parameter>,
    pub(super) series: Vec<Series>,
    pub(super) records: Vec<Record<'a>>,
    /// The first series of each record, where it is fitted.
    first: Vec<Option<usize>>,
    /// Of each record an orthonormal basis of what an unknown past adds to its residuals.
    past: Vec<Vec<Vec<f64>>>,
    /// Rows of runs behind this share of their span are left out.
    pub(super) horizon: f64,
    noise: f64,
}

impl<'a> Problem<'a> {
    pub(super) fn new(fitting: &'a Fitting) -> Result<Self, String> {
        Self::thinned(fitting, usize::MAX)
    }

    /// Of long strokes about `most` rows.
    pub(super) fn thinned(fitting: &'a Fitting, most: usize) -> Result<Self, String> {
        let plan = fitting.plan();
        let records = (0..plan.data.len()).map(|k| Record::new(fitting, k, most)).collect::<Result<Vec<_>, _>>()?;
        let (mut series, mut first, mut past) = (Vec::new(), Vec::new(), Vec::new());
        for record in &records {
            let data = record.data;
            past.push(basis(record));
            first.push(data.is_fitted.then_some(series.len()));
            if !data.is_fitted {
                continue;
            }
            for column in &data.columns {
                let name = format!("{}.{}", data.name, column.name);
                let loss = data.huber.map_or(Loss::Squares, Loss::Huber);
                let has_sd = column.sd.is_some() || data.relative_sd.is_some();
                series.push(Series { name, loss, has_sd });
            }
        }
        let parameters = plan.parameters.iter().map(|one| one.sought.clone()).collect();
        let noise = if most == usize::MAX { NOISE } else { ROUGH_NOISE };
        Ok(Self { parameters, series, records, first, past, horizon: 1.0, noise })
    }

    /// Whether a stroke has more rows than that.
    pub(super) fn has_long_strokes(&self, most: usize) -> bool {
        let is_long = |record: &Record<'_>| record.data.kind == DataKind::Stroke && record.data.at.len() > most;
        self.records.iter().any(is_long)
    }

    /// Whether residuals take steps in time.
    pub(super) fn takes_steps(&self) -> bool {
        self.records.iter().any(|record| record.data.is_fitted && !record.data.kind.is_relative())
    }

    /// Whether a record takes a run.
    pub(super) fn has_runs(&self) -> bool {
        self.records.iter().any(|record| record.data.is_fitted && record.data.kind == DataKind::Run)
    }

    /// Whether a cost is what the noise of the rows leaves, as far as all of it is known beforehand.
    pub(super) fn is_explained(&self, cost: f64) -> bool {
        let fitted = self.records.iter().filter(|record| record.data.is_fitted);
        let rows: usize = fitted.map(|record| record.rows.len() * record.data.columns.len()).sum();
        self.series.iter().all(|series| series.has_sd) && cost <= EXPLAINED * rows as f64
    }

    /// The residual of a row of a column, and what it changes by with the model and with ln of it.
    fn residual(&self, record: &Record<'_>, column: usize, row: usize, model: f64) -> (f64, f64) {
        let (measured, sd) = (record.measured[column][row], record.sd(column, row));
        match record.data.kind {
            DataKind::Dma { .. } => ((model / measured).ln() / sd, 1.0 / (model * sd)),
            DataKind::Relaxation | DataKind::Creep => ((model / measured - 1.0) / sd, 1.0 / (measured * sd)),
            _ => ((model - measured) / sd, 1.0 / sd),
        }
    }

    /// What the model of a record says of a row, its zero included.
    pub(super) fn model(
        &self,
        record: &Record<'_>,
        predicted: &Predicted,
        values: &[f64],
        column: usize,
        row: usize,
    ) -> f64 {
        let offset = record.data.columns[column].offset.map_or(0.0, |at| values[at]);
        predicted.model[column][row] + offset
    }

    /// The residuals of a column of a record, and row by row their derivatives by all parameters; what an unknown past explains taken out.
    pub(super) fn column(
        &self,
        k: usize,
        predicted: &Predicted,
        values: &[f64],
        column: usize,
    ) -> (Vec<f64>, Vec<f64>) {
        let record = &self.records[k];
        let (n, own) = (values.len(), record.data.parameters.len());
        let slopes = &predicted.slopes[column];
        let rows = predicted.model[column].len();
        let is_differentiated = predicted.is_differentiated;
        let mut residuals = Vec::with_capacity(rows);
        let mut jacobian = vec![0.0; if is_differentiated { rows * n } else { 0 }];
        for row in 0..rows {
            let (residual, by) = self.residual(record, column, row, self.model(record, predicted, values, column, row));
            residuals.push(residual);
            if !is_differentiated {
                continue;
            }
            let line = &mut jacobian[row * n..(row + 1) * n];
            for (p, at) in record.data.parameters.iter().enumerate() {
                line[*at] += by * slopes[row * own + p];
            }
            if let Some(at) = record.data.columns[column].offset {
                line[at] += by;
            }
            if let Some(at) = record.data.columns[column].delay {
                line[at] -= by * predicted.rates[column][row];
            }
        }
        self.clear(k, &mut residuals, &mut jacobian, n);
        (residuals, jacobian)
    }

    /// Takes out what an unknown past explains.
    fn clear(&self, k: usize, residuals: &mut [f64], jacobian: &mut [f64], n: usize) {
        for direction in &self.past[k] {
            let share: f64 = direction.iter().zip(residuals.iter()).map(|(d, r)| d * r).sum();
            residuals.iter_mut().zip(direction).for_each(|(r, d)| *r -= share * d);
            for j in 0..if jacobian.is_empty() { 0 } else { n } {
                let share: f64 = direction.iter().enumerate().map(|(row, d)| d * jacobian[row * n + j]).sum();
                direction.iter().enumerate().for_each(|(row, d)| jacobian[row * n + j] -= share * d);
            }
        }
    }

    /// How many rows of a record are within the horizon.
    fn within(&self, record: &Record<'_>) -> usize {
        if self.horizon >= 1.0 || record.data.kind != DataKind::Run {
            return record.rows.len();
        }
        let at = |row: usize| record.data.at[record.rows[row]];
        let last = at(record.rows.len() - 1);
        (0..record.rows.len()).take_while(|row| at(*row) <= self.horizon * last).count()
    }
}

/// What an unknown past adds: exponentials and a zero, over the standard deviation of each row.
fn basis(record: &Record<'_>) -> Vec<Vec<f64>> {
    let Some(stroke) = record.stroke.as_ref().filter(|stroke| !stroke.rates.is_empty()) else { return Vec::new() };
    let has_zero = record.data.columns[0].offset.is_some();
    let first = record.data.at[0];
    let zero = (!has_zero).then_some(0.0);
    let mut found: Vec<Vec<f64>> = Vec::new();
    for rate in zero.into_iter().chain(stroke.rates.iter().copied()) {
        let own = |(row, at): (usize, &usize)| (-rate * (record.data.at[*at] - first)).exp() / record.sd(0, row);
        let mut column: Vec<f64> = record.rows.iter().enumerate().map(own).collect();
        let size = column.iter().map(|x| x * x).sum::<f64>().sqrt();
        for _ in 0..2 {
            for direction in &found {
                let share: f64 = direction.iter().zip(&column).map(|(d, c)| d * c).sum();
                column.iter_mut().zip(direction).for_each(|(c, d)| *c -= share * d);
            }
        }
        let rest = column.iter().map(|x| x * x).sum::<f64>().sqrt();
        if rest > 1e-9 * size {
            column.iter_mut().for_each(|c| *c /= rest);
            found.push(column);
        }
    }
    found
}

impl identification::Problem for Problem<'_> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn series(&self) -> &[Series] {
        &self.series
    }

    fn eliminated(&self) -> usize {
        let fitted = self.past.iter().zip(&self.first).filter(|(_, first)| first.is_some());
        fitted.map(|(past, _)| past.len()).sum()
    }

    fn noise(&self) -> f64 {
        if self.takes_steps() { self.noise } else { 0.0 }
    }

    fn rows(&self, values: &[f64], wanted: &[bool], take: &mut dyn FnMut(Rows<'_>)) -> Result<(), Failed> {
        for (k, record) in self.records.iter().enumerate() {
            let Some(first) = self.first[k] else { continue };
            let data = record.data;
            let predicted = record.predict(values, wanted, self.within(record))?;
            for column in 0..data.columns.len() {
                let (residuals, mut jacobian) = self.column(k, &predicted, values, column);
                if jacobian.is_empty() && wanted.contains(&true) {
                    jacobian = vec![0.0; residuals.len() * values.len()];
                }
                take(Rows { series: first + column, residuals: &residuals, jacobian: &jacobian });
            }
        }
        Ok(())
    }
}
