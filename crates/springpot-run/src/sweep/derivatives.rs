//! What is worked out of the derivatives of a case at its end: gradients of its metrics, and what matters most.

use super::Layout;
use crate::metrics::gradient;
use crate::table::{Statistics, push_fields, push_number, push_text};
use serde::{Deserialize, Serialize};
use springpot::observe::Quantity;
use springpot::table::Column;
use springpot_scenario::{MetricPlan, SensitivityPlan};

/// The columns of ranking.csv behind the swept parameters.
pub(super) const RANKING_COLUMNS: [&str; 4] = ["column", "parameter", "rms", "share"];

/// What a run is differentiated by, and which columns of a row rank its parameters.
#[derive(Debug, Clone)]
pub(super) struct Differentiated {
    /// How many parameters.
    count: usize,
    /// Columns beside the written ones whose size is to be known, by their index in a row.
    pub(super) beside: Vec<usize>,
    ranked: Vec<Pair>,
}

/// A column and its derivative, by their places among the columns whose statistics are known.
#[derive(Debug, Clone)]
struct Pair {
    of: usize,
    derivative: usize,
    by: usize,
    name: String,
}

/// What is worked out of the derivatives of a case.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CaseDerivatives {
    /// By metric and parameter, in their order: the derivative, SI; NaN where there is none. Empty where nothing is differentiated.
    pub gradients: Vec<Vec<f64>>,
    /// What changes columns most, the largest share first.
    pub ranking: Vec<Ranked>,
    /// Their lines in gradient.csv and ranking.csv.
    pub(super) lines: [String; 2],
}

/// How much a parameter changes a column.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Ranked {
    /// The column.
    pub column: String,
    /// Which parameter.
    pub parameter: usize,
    /// Root mean square over the rows of the derivative, times the typical size of the parameter.
    pub rms: f64,
    /// That over the root mean square of the column; NaN where that is 0.
    pub share: f64,
}

impl Differentiated {
    /// Of a run whose rows have `columns`, the `selected` ones written.
    pub(super) fn of(sensitivity: &SensitivityPlan, columns: &[Column], selected: &[usize]) -> Self {
        let first = columns.len() - sensitivity.columns.len();
        let (mut beside, mut ranked) = (Vec::new(), Vec::new());
        for (k, told) in sensitivity.columns.iter().enumerate() {
            let (name, parameter) = Quantity::of_derivative(&told.name).unwrap_or_default();
            let of = columns.iter().position(|column| column.name == name);
            let by = sensitivity.parameters.iter().position(|own| own.name == parameter);
            let (Some(of), Some(by)) = (of, by) else { continue };
            let known = selected.iter().position(|at| *at == of).unwrap_or_else(|| {
                let there = beside.iter().position(|at| *at == of).unwrap_or_else(|| {
                    beside.push(of);
                    beside.len() - 1
                });
                selected.len() + there
            });
            let derivative = selected.iter().position(|at| *at == first + k);
            let derivative = derivative.expect("derivatives are written, whatever is asked for");
            ranked.push(Pair { of: known, derivative, by, name: name.to_owned() });
        }
        Self { count: sensitivity.parameters.len(), beside, ranked }
    }

    /// What changes columns most of a case with these statistics.
    pub(super) fn rank(&self, plan: &SensitivityPlan, statistics: &[Statistics]) -> Vec<Ranked> {
        let one = |pair: &Pair| {
            let rms = plan.parameters[pair.by].typical * statistics[pair.derivative].rms();
            let size = statistics[pair.of].rms();
            let share = if size > 0.0 { rms / size } else { f64::NAN };
            Ranked { column: pair.name.clone(), parameter: pair.by, rms, share }
        };
        let mut ranked: Vec<Ranked> = self.ranked.iter().map(one).collect();
        // What has no share stands last.
        let key = |ranked: &Ranked| if ranked.share.is_nan() { -1.0 } else { ranked.share };
        ranked.sort_by(|one, other| key(other).total_cmp(&key(one)));
        ranked
    }
}

/// What metrics and their gradients are worked out of.
pub(super) struct Measured<'a> {
    /// The swept values, each with its comma.
    pub(super) lead: &'a str,
    pub(super) t: &'a [f64],
    /// Of each metric its column, and those of its derivatives where they are known.
    pub(super) columns: Vec<(&'a [f64], Option<Vec<&'a [f64]>>)>,
}

impl CaseDerivatives {
    /// Of a case whose metrics have these `values`.
    pub(super) fn gradients(
        &mut self,
        layout: &Layout,
        (plans, sensitivity): (&[MetricPlan], &SensitivityPlan),
        measured: &Measured<'_>,
        values: &[f64],
    ) {
        let Some(differentiated) = layout.differentiated() else { return };
        let of = plans.iter().zip(layout.metrics()).zip(&measured.columns);
        for (((plan, wanted), (own, changes)), value) in of.zip(values) {
            let slopes = match changes {
                Some(changes) => gradient(&plan.metric, measured.t, own, changes),
                None => vec![f64::NAN; differentiated.count],
            };
            let unit = plan.metric.kind.unit(&wanted.column.unit);
            for (parameter, slope) in sensitivity.parameters.iter().zip(&slopes) {
                let text = &mut self.lines[0];
                text.push_str(measured.lead);
                push_text(text, &plan.metric.name);
                text.push(',');
                push_number(text, *value);
                text.push(',');
                push_text(text, unit);
                text.push(',');
                push_text(text, &parameter.name);
                text.push(',');
                push_number(text, *slope);
                text.push(',');
                push_text(text, &parameter.over(unit));
                push_fields(text, [parameter.value * slope / value].into_iter());
                text.push('\n');
            }
            self.gradients.push(slopes);
        }
    }

    /// Ranks what a case with these statistics is differentiated by.
    pub(super) fn rank(&mut self, layout: &Layout, plan: &SensitivityPlan, statistics: &[Statistics], lead: &str) {
        let Some(differentiated) = layout.differentiated() else { return };
        self.ranking = differentiated.rank(plan, statistics);
        for Ranked { column, parameter, rms, share } in &self.ranking {
            let text = &mut self.lines[1];
            text.push_str(lead);
            push_text(text, column);
            text.push(',');
            push_text(text, &plan.parameters[*parameter].name);
            push_fields(text, [*rms, *share].into_iter());
            text.push('\n');
        }
    }
}
