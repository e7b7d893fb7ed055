//! What is taken of the rows of a case, wherever they go.

use super::Layout;
use super::events::CaseEvents;
use super::kept::Kept;
use super::metrics::CaseMetrics;
use super::simulate::Back;
use crate::table::{Statistics, push_fields, push_number, push_text};
use springpot::system::{RunError, System};
use springpot_scenario::{Cases, Plan, SweptValue};

/// Statistics, events, and what figures and metrics keep of a case.
#[derive(Debug)]
pub(super) struct Taken<'a> {
    layout: &'a Layout,
    /// The swept values, which begin every row.
    pub(super) lead: String,
    pub(super) selected: Vec<usize>,
    /// Of the selected columns, and of those beside them whose size is to be known.
    pub(super) statistics: Vec<Statistics>,
    pub(super) events: CaseEvents,
    pub(super) kept: Option<Kept<'a>>,
}

impl<'a> Taken<'a> {
    /// Nothing yet of case `index`.
    pub(super) fn of(cases: &Cases, layout: &'a Layout, index: usize) -> Self {
        let selected: Vec<usize> = layout.selected().map(|(k, _)| k).collect();
        let beside = layout.differentiated().map_or(0, |differentiated| differentiated.beside.len());
        Self {
            layout,
            lead: lead(cases, index),
            statistics: vec![Statistics::default(); selected.len() + beside],
            events: CaseEvents::default(),
            selected,
            kept: Kept::of(layout, index),
        }
    }

    /// Takes a row; returns its values that figures and metrics keep.
    pub(super) fn row(&mut self, row: &[f64]) -> &[f64] {
        let beside = self.layout.differentiated().map_or(&[][..], |differentiated| &differentiated.beside);
        for (statistics, &k) in self.statistics.iter_mut().zip(self.selected.iter().chain(beside)) {
            statistics.add(row[k]);
        }
        self.kept.as_mut().map_or(&[], |kept| kept.row(row))
    }

    /// Takes the row of an event.
    pub(super) fn event(&mut self, system: &System, event: usize, row: &[f64]) {
        self.events.take(system, &self.lead, event, row);
    }

    /// Takes the row of an event that ends the case, and the derivatives of its time.
    pub(super) fn ended(&mut self, row: &[f64], later: &[f64]) {
        self.kept.iter_mut().for_each(|kept| kept.ended(row, later));
    }

    /// What the metrics are of the rows so far, and what matters most.
    pub(super) fn metrics(&self, plan: &Plan, back: Option<Back>) -> Result<CaseMetrics, RunError> {
        let kept = self.kept.as_ref();
        let own = |kept: &Kept| kept.metrics(self.layout, (plan, back), &self.lead);
        let mut metrics = kept.map_or_else(|| Ok(CaseMetrics::default()), own)?;
        if let Some(sensitivity) = &plan.sensitivity {
            metrics.derivatives.rank(self.layout, sensitivity, &self.statistics, &self.lead);
        }
        Ok(metrics)
    }
}

/// The swept values of a case, each with its comma.
pub(super) fn lead(cases: &Cases, index: usize) -> String {
    let mut lead = String::new();
    for value in cases.values(index) {
        match value {
            SweptValue::Number(number) => push_number(&mut lead, number),
            SweptValue::Text(text) => push_text(&mut lead, &text),
        }
        lead.push(',');
    }
    lead
}

/// One row of results.csv: the swept values, then the others.
pub(crate) fn push_row(text: &mut String, lead: &str, mut values: impl Iterator<Item = f64>) {
    text.push_str(lead);
    push_number(text, values.next().unwrap_or(f64::NAN));
    push_fields(text, values);
    text.push('\n');
}
