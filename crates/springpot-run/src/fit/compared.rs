//! A record made ready to be compared, and what a model says of it.

use super::stroke::Stroke;
use springpot_scenario::{DataKind, DataPlan, Fitting};

/// A record made ready to be compared.
pub(super) struct Record<'a> {
    pub(super) fitting: &'a Fitting,
    pub(super) index: usize,
    pub(super) data: &'a DataPlan,
    /// The rows that count.
    pub(super) rows: Vec<usize>,
    /// What was measured at those rows, filtered where the record asks for it, by column.
    pub(super) measured: Vec<Vec<f64>>,
    pub(super) stroke: Option<Stroke>,
}

/// What the model says of the rows that count.
#[derive(Debug, Clone, Default)]
pub(super) struct Predicted {
    pub(super) is_differentiated: bool,
    /// By column, without zeros and lateness.
    pub(super) model: Vec<Vec<f64>>,
    /// By column, row by row, by each parameter of the record; empty where none was asked for.
    pub(super) slopes: Vec<Vec<f64>>,
    /// By column d/dt, where it may be late.
    pub(super) rates: Vec<Vec<f64>>,
}

impl<'a> Record<'a> {
    /// Of `most` rows of a stroke at most.
    pub(super) fn new(fitting: &'a Fitting, index: usize, most: usize) -> Result<Self, String> {
        let data = &fitting.plan().data[index];
        let is_stroke = data.kind == DataKind::Stroke;
        let step = if is_stroke { data.at.len().div_ceil(most) } else { 1 };
        let stroke = is_stroke.then(|| Stroke::new(fitting, index, step)).transpose()?;
        let mut rows: Vec<usize> = data.counted().filter(|row| row % step == 0).collect();
        if let Some(stroke) = &stroke {
            rows.retain(|row| data.at[*row] - data.at[0] >= stroke.unused);
        }
        let own = |k: usize, values: &[f64]| -> Vec<f64> {
            let filtered = stroke.as_ref().and_then(|stroke| stroke.force.as_deref()).filter(|_| k == 0);
            let values = filtered.unwrap_or(values);
            rows.iter().map(|row| values[*row]).collect()
        };
        let measured = data.columns.iter().enumerate().map(|(k, column)| own(k, &column.measured)).collect();
        Ok(Self { fitting, index, data, rows, measured, stroke })
    }

    /// Whether a derivative is wanted by what it follows from.
    pub(super) fn is_wanted(&self, wanted: &[bool]) -> bool {
        let beside = self.data.columns.iter().flat_map(|column| [column.offset, column.delay]).flatten();
        self.data.parameters.iter().copied().chain(beside).any(|at| wanted[at])
    }

    /// The standard deviation of the rows of a column; 1 where it is estimated.
    pub(super) fn sd(&self, column: usize, row: usize) -> f64 {
        match (&self.data.columns[column].sd, self.data.relative_sd) {
            (Some(sd), _) => sd[self.rows[row]],
            (None, Some(sd)) => sd,
            (None, None) => 1.0,
        }
    }
}
