//! The metrics of a case: its columns while it runs, its lines at the end.

use super::derivatives::{CaseDerivatives, Measured};
use super::layout::{Layout, WantedMetric};
use super::simulate::Back;
use crate::metrics::{push_line, rests_on_end, shares, value};
use serde::{Deserialize, Serialize};
use springpot::sensitivity::{Lost, Share};
use springpot::system::RunError;
use springpot_scenario::{MetricPlan, Plan};

/// What the metrics of a case are.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CaseMetrics {
    /// In the order of the scenario; NaN where there is none. Empty where the case has no row.
    pub values: Vec<f64>,
    /// Their lines in metrics.csv.
    pub(super) lines: String,
    /// The metrics as JSON, where they are not those of the first case.
    pub(super) own: Option<String>,
    /// What is worked out of its derivatives.
    pub derivatives: CaseDerivatives,
}

/// The columns that metrics are taken from, over all rows of a case.
#[derive(Debug)]
pub(super) struct Watched {
    /// Where t and the columns stand among the kept ones.
    places: Vec<usize>,
    /// Their values.
    columns: Vec<Vec<f64>>,
    /// For each metric the index of its column, and of its derivatives.
    of: Vec<(usize, Option<Vec<usize>>)>,
    /// The last row, where an event ended the case at it: along the event, and the derivatives of its time; of those none where the run has no tangents.
    ended: Option<(Vec<f64>, Vec<f64>)>,
}

impl Watched {
    /// Nothing yet; `None` where there are no metrics.
    pub(super) fn of(layout: &Layout) -> Option<Self> {
        let wanted = layout.metrics();
        let mut places = vec![layout.kept_time()?];
        let mut find = |place: usize| {
            places.iter().position(|known| *known == place).unwrap_or_else(|| {
                places.push(place);
                places.len() - 1
            })
        };
        let changes = |metric: &WantedMetric, find: &mut dyn FnMut(usize) -> usize| {
            metric.changes.as_ref().map(|changes| changes.iter().map(|place| find(*place)).collect())
        };
        let of = wanted.iter().map(|metric| (find(metric.place), changes(metric, &mut find))).collect();
        Some(Self { columns: vec![Vec::new(); places.len()], places, of, ended: None })
    }

    /// Takes the kept values of a row.
    pub(super) fn add(&mut self, values: &[f64]) {
        for (column, place) in self.columns.iter_mut().zip(&self.places) {
            column.push(values[*place]);
        }
    }

    /// Takes the kept values of the row of an event that ends the case, and the derivatives of its time.
    pub(super) fn ended(&mut self, values: &[f64], later: &[f64]) {
        let values = self.places.iter().map(|place| values[*place]).collect();
        self.ended.get_or_insert((values, later.to_vec()));
    }

    /// The gradients of the metrics, back through the run; `of` says which quantity each of them is of.
    fn back(
        &self,
        (plans, of): (&[MetricPlan], &[Option<usize>]),
        Back { tape, stop }: Back,
    ) -> Result<Vec<Option<Vec<f64>>>, RunError> {
        let t = &self.columns[0];
        let shares = plans.iter().zip(&self.of).zip(of).map(|((plan, (at, _)), quantity)| {
            let rows = shares(&plan.metric, t, &self.columns[*at])?;
            let share = |(row, slope): (usize, f64)| Some(Share { row, quantity: (*quantity)?, slope });
            rows.into_iter().map(share).collect::<Option<Vec<Share>>>()
        });
        let shares: Vec<Option<Vec<Share>>> = shares.collect();
        let known: Vec<Vec<Share>> = shares.iter().flatten().cloned().collect();
        let mut gradients = tape.gradients(&known, stop)?.into_iter();
        Ok(shares.into_iter().map(|shares| shares.and_then(|_| gradients.next())).collect())
    }

    /// Gradients that were found by going back, but of metrics that hang on the last row where an event ended the case: at what time is not known that
    /// way. Whether there are any.
    fn without_moving_end(
        &self,
        plans: &[MetricPlan],
        mut gradients: Vec<Option<Vec<f64>>>,
    ) -> (Vec<Option<Vec<f64>>>, bool) {
        let t = &self.columns[0];
        let mut moves = false;
        for ((plan, (at, _)), gradient) in plans.iter().zip(&self.of).zip(&mut gradients) {
            if self.ended.is_some() && rests_on_end(&plan.metric, t, &self.columns[*at]) {
                gradient.iter_mut().flatten().for_each(|slope| *slope = f64::NAN);
                moves |= gradient.is_some();
            }
        }
        (gradients, moves)
    }

    /// The metrics of the case whose swept values are `lead`, with their gradients back through a tape, where there is one.
    ///
    /// # Errors
    /// What keeps the tape from being gone back through.
    pub(super) fn metrics(
        &self,
        layout: &Layout,
        (plan, back): (&Plan, Option<Back>),
        lead: &str,
    ) -> Result<CaseMetrics, RunError> {
        let (plans, mut metrics) = (&plan.metrics, CaseMetrics::default());
        let t = &self.columns[0];
        if t.is_empty() {
            return Ok(metrics);
        }
        for ((plan, (at, _)), wanted) in plans.iter().zip(&self.of).zip(layout.metrics()) {
            let value = value(&plan.metric, t, &self.columns[*at]);
            push_line(&mut metrics.lines, lead, &plan.metric, &wanted.column, value);
            metrics.values.push(value);
        }
        if let Some(sensitivity) = &plan.sensitivity {
            let column = |at: &usize| &self.columns[*at][..];
            let columns = self.of.iter().map(|(at, changes)| {
                (column(at), changes.as_ref().map(|changes| changes.iter().map(column).collect()))
            });
            let gradients = back.zip(sensitivity.adjoint.as_deref()).map(|(back, of)| self.back((plans, of), back));
            let gradients = gradients.transpose()?.map(|gradients| self.without_moving_end(plans, gradients));
            if gradients.as_ref().is_some_and(|(_, moves)| *moves) {
                let why =
                    "an event ends the run, and going back does not know how that moves: take method = \"forward\"";
                let lost = |parameter| Lost { parameter, t: t[t.len() - 1], why: why.to_owned() };
                metrics.derivatives.lost = (0..sensitivity.parameters.len()).map(lost).collect();
            }
            let ended = self.ended.as_ref().filter(|(_, later)| !later.is_empty());
            let ended = ended.map(|(values, later)| {
                let last = |changes: &Vec<usize>| changes.iter().map(|at| values[*at]).collect();
                (self.of.iter().map(|(_, changes)| changes.as_ref().map(last)).collect(), &later[..])
            });
            let gradients = gradients.map(|(gradients, _)| gradients);
            let measured = Measured { lead, t, columns: columns.collect(), ended, gradients };
            metrics.derivatives.gradients(layout, (plans, sensitivity), &measured, &metrics.values);
        }
        let is_own = plans.iter().zip(layout.metrics()).any(|(plan, wanted)| plan.metric != wanted.first);
        let all: Vec<_> = plans.iter().map(|plan| &plan.metric).collect();
        metrics.own = is_own.then(|| serde_json::to_string(&all).unwrap_or_default());
        Ok(metrics)
    }
}
