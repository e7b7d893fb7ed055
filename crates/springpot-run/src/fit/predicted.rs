//! What a record's model says at some values of the parameters.

use super::compared::{Predicted, Record};
use super::moduli;
use super::walk::{self, Ask};
use springpot::identification::Failed;
use springpot::observe::{ElementQuantity, Quantity};
use springpot_scenario::DataKind;

impl Record<'_> {
    /// What the model says of the first `rows` at these values of all parameters, with its derivatives by those that are `wanted`.
    pub(super) fn predict(&self, values: &[f64], wanted: &[bool], rows: usize) -> Result<Predicted, Failed> {
        if self.data.kind.is_relative() {
            return moduli::predict(self, values, wanted);
        }
        let late = |k: usize| self.data.columns[k].delay.map(|at| values[at]);
        let quantities: Vec<Quantity> = match self.data.kind {
            DataKind::Stroke => vec![Quantity::Element(0, ElementQuantity::Force)],
            _ => self.fitting.quantities(self.index).to_vec(),
        };
        let first = if self.stroke.is_some() { self.data.at[0] } else { 0.0 };
        let mut asks = Vec::new();
        for (column, quantity) in quantities.iter().enumerate() {
            for (row, at) in self.rows.iter().enumerate().take(rows) {
                let t = self.data.at[*at] - first - late(column).unwrap_or(0.0);
                asks.push(Ask { t, column, row, quantity: *quantity, wants_rate: late(column).is_some() });
            }
        }
        let count = self.data.parameters.len();
        let is_differentiated = self.is_wanted(wanted);
        let sought: Vec<usize> = (0..count).filter(|p| wanted[self.data.parameters[*p]]).collect();
        let mut predicted = Predicted {
            is_differentiated,
            model: vec![vec![f64::NAN; rows]; quantities.len()],
            slopes: vec![vec![0.0; if is_differentiated { rows * count } else { 0 }]; quantities.len()],
            rates: (0..quantities.len()).map(|k| vec![0.0; if late(k).is_some() { rows } else { 0 }]).collect(),
        };
        match &self.stroke {
            Some(stroke) => {
                let (system, settings, by) = stroke.system(self.fitting, self.index, values, wanted)?;
                walk::walk(system, settings, asks, &by, count, &mut predicted)?;
            }
            None => {
                let plan = self.fitting.run_at(self.index, values, wanted).map_err(Failed)?;
                walk::walk(plan.system(), plan.settings, asks, &sought, count, &mut predicted)?;
            }
        }
        if predicted.model.iter().flatten().any(|x| !x.is_finite()) {
            return Err(Failed("a column of the run is empty at a row".to_owned()));
        }
        Ok(predicted)
    }
}
