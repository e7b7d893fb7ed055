//! The metrics of a case: its columns while it runs, its lines at the end.

use super::Layout;
use crate::metrics::{push_line, value};
use serde::{Deserialize, Serialize};
use springpot_scenario::MetricPlan;

/// What the metrics of a case are.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CaseMetrics {
    /// In the order of the scenario; NaN where there is none. Empty where the case has no row.
    pub values: Vec<f64>,
    /// Their lines in metrics.csv.
    pub(super) lines: String,
    /// The metrics as JSON, where they are not those of the first case.
    pub(super) own: Option<String>,
}

/// The columns that metrics are taken from, over all rows of a case.
#[derive(Debug)]
pub(super) struct Watched {
    /// Where t and the columns stand among the kept ones.
    places: Vec<usize>,
    /// Their values.
    columns: Vec<Vec<f64>>,
    /// For each metric the index of its column.
    of: Vec<usize>,
}

impl Watched {
    /// Nothing yet; `None` where there are no metrics.
    pub(super) fn of(layout: &Layout) -> Option<Self> {
        let wanted = layout.metrics();
        let mut places = vec![layout.kept_time()?];
        let of = wanted.iter().map(|metric| {
            let known = places.iter().position(|place| *place == metric.place);
            known.unwrap_or_else(|| {
                places.push(metric.place);
                places.len() - 1
            })
        });
        let of = of.collect();
        Some(Self { columns: vec![Vec::new(); places.len()], places, of })
    }

    /// Takes the kept values of a row.
    pub(super) fn add(&mut self, values: &[f64]) {
        for (column, place) in self.columns.iter_mut().zip(&self.places) {
            column.push(values[*place]);
        }
    }

    /// The metrics `plans` of the case whose swept values are `lead`.
    pub(super) fn metrics(&self, layout: &Layout, plans: &[MetricPlan], lead: &str) -> CaseMetrics {
        let mut metrics = CaseMetrics::default();
        let t = &self.columns[0];
        if t.is_empty() {
            return metrics;
        }
        for ((plan, &at), wanted) in plans.iter().zip(&self.of).zip(layout.metrics()) {
            let value = value(&plan.metric, t, &self.columns[at]);
            push_line(&mut metrics.lines, lead, &plan.metric, &wanted.column, value);
            metrics.values.push(value);
        }
        let is_own = plans.iter().zip(layout.metrics()).any(|(plan, wanted)| plan.metric != wanted.first);
        let all: Vec<_> = plans.iter().map(|plan| &plan.metric).collect();
        metrics.own = is_own.then(|| serde_json::to_string(&all).unwrap_or_default());
        metrics
    }
}
