//! What a fit found.

use super::compared::Predicted;
use super::problem::Problem;
use springpot::identification::{Fit, Status as Ended};
use springpot_scenario::Fitting;

/// How a fit ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// At a minimum.
    Converged,
    /// After too many steps, at the best so far.
    NotConverged,
    /// By hand, at the best so far.
    Interrupted,
}

impl Status {
    /// Its word in fit.json.
    pub fn name(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::NotConverged => "not-converged",
            Self::Interrupted => "interrupted",
        }
    }
}

/// A fit, and how well it meets the records.
#[derive(Debug)]
pub struct Outcome {
    /// How it ended.
    pub status: Status,
    /// What was fitted: with the law that was chosen, where there were several.
    pub fitting: Fitting,
    /// Values, covariance, criteria.
    pub fit: Fit,
    /// The interval of each parameter.
    pub intervals: Vec<[f64; 2]>,
    /// Of parameters whose interval is by the cost, points of the profile: value, and √ of the rise of the cost in variances.
    pub profiles: Vec<(usize, Vec<[f64; 2]>)>,
    /// By record.
    pub records: Vec<RecordScore>,
    /// Names of the series of the fit.
    pub series: Vec<String>,
    /// Law by law cost, parameters, AICc and BIC, where there were several.
    pub laws: Vec<(String, f64, usize, [f64; 2])>,
    /// The law that was chosen.
    pub chosen: Option<String>,
    /// What deserves a warning.
    pub warnings: Vec<String>,
}

/// How well a record is met.
#[derive(Debug, Clone)]
pub struct RecordScore {
    /// The rows that count, by their place in the record.
    pub rows: Vec<usize>,
    /// Column by column.
    pub columns: Vec<ColumnScore>,
    /// Σ of the squares of its residuals.
    pub cost: f64,
}

/// How well a column is met.
#[derive(Debug, Clone)]
pub struct ColumnScore {
    /// What was measured, SI.
    pub measured: Vec<f64>,
    /// What the model says.
    pub model: Vec<f64>,
    /// In units of the standard deviation.
    pub residuals: Vec<f64>,
    /// Root of the mean square of model less measured, SI.
    pub rms: f64,
    /// 1 less the mean square over the variance of what was measured.
    pub r2: f64,
}

impl From<Ended> for Status {
    fn from(ended: Ended) -> Self {
        match ended {
            Ended::Converged => Self::Converged,
            Ended::NotConverged => Self::NotConverged,
            Ended::Interrupted => Self::Interrupted,
        }
    }
}

/// How well these values meet record `k`; nothing where its model has none.
pub(super) fn score(problem: &Problem<'_>, k: usize, values: &[f64]) -> Option<RecordScore> {
    let record = &problem.records[k];
    let predicted: Predicted = record.predict(values, &vec![false; values.len()], record.rows.len()).ok()?;
    let mut cost = 0.0;
    let columns = (0..record.data.columns.len()).map(|column| {
        let (residuals, _) = problem.column(k, &predicted, values, column);
        let measured = record.measured[column].clone();
        // What an unknown past adds is part of the model.
        let own = |row: usize| {
            let plain = problem.model(record, &predicted, values, column, row);
            match record.stroke.as_ref().is_some_and(|stroke| !stroke.rates.is_empty()) {
                true => measured[row] + residuals[row] * record.sd(column, row),
                false => plain,
            }
        };
        let model: Vec<f64> = (0..measured.len()).map(own).collect();
        cost += residuals.iter().map(|r| r * r).sum::<f64>();
        let count = measured.len() as f64;
        let mean = measured.iter().sum::<f64>() / count;
        let square = model.iter().zip(&measured).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / count;
        let variance = measured.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
        ColumnScore { rms: square.sqrt(), r2: 1.0 - square / variance, measured, model, residuals }
    });
    let columns = columns.collect();
    Some(RecordScore { rows: record.rows.clone(), columns, cost })
}
