//! What is told of a run with derivatives: the ranking, gradients, steps, and the comparison.

use super::compare::Compared;
use crate::grid::{Grid, Set};
use crate::terminal;
use serde_json::{Value, json};
use springpot_run::Finished;
use springpot_run::numbers::{count, rough, short};
use springpot_run::sweep::{CaseDerivatives, CaseResult, Ranked};
use springpot_scenario::{Plan, SensitivityPlan};

/// Lines of the ranking that are printed; ranking.csv has all.
const RANKED: usize = 16;
/// And lines of gradients; gradient.csv has all.
const SHOWN: usize = 48;

/// All that is told.
pub(super) struct Told<'a> {
    pub(super) finished: &'a Finished,
    /// Of the first case.
    pub(super) plan: &'a Plan,
    pub(super) sensitivity: &'a SensitivityPlan,
    /// Steps of the same case without derivatives.
    pub(super) plain_steps: u64,
    pub(super) compared: &'a [Compared],
}

impl Told<'_> {
    /// The first case, which everything printed is of.
    fn case(&self) -> Option<&CaseResult> {
        self.finished.outcome.cases.first()
    }

    fn derivatives(&self) -> CaseDerivatives {
        self.case().map_or_else(CaseDerivatives::default, |case| case.metrics.derivatives.clone())
    }

    /// For the terminal.
    pub(super) fn text(&self, width: Option<usize>) -> String {
        let derivatives = self.derivatives();
        let mut text = String::new();
        if self.finished.cases.len() > 1 {
            text.push_str(&format!("\nof the first case, {}:\n", self.finished.cases.name(0)));
        }
        let name = |parameter: usize| self.sensitivity.parameters[parameter].name.clone();
        let mut ranking = Grid::new([
            ("column", Set::Name),
            ("parameter", Set::Name),
            ("changes by", Set::Number),
            ("rms", Set::Number),
        ]);
        for Ranked { column, parameter, rms, share } in derivatives.ranking.iter().take(RANKED) {
            let share = if share.is_finite() { format!("{} %", rough(100.0 * share)) } else { String::new() };
            ranking.row(vec![column.clone(), name(*parameter), share, rough(*rms)]);
        }
        text.push_str(&format!("\n{}", ranking.text(width)));
        if let Some(more @ 1..) = derivatives.ranking.len().checked_sub(RANKED) {
            text.push_str(&format!("{} in ranking.csv\n", count(more, "more line", "more lines")));
        }
        if !derivatives.gradients.is_empty() {
            let mut grid = Grid::new([
                ("metric", Set::Name),
                ("value", Set::Number),
                ("", Set::Text),
                ("parameter", Set::Name),
                ("derivative", Set::Number),
                ("", Set::Text),
                ("elasticity", Set::Number),
            ]);
            let lines = self.gradients(&derivatives);
            let more = lines.len().saturating_sub(SHOWN);
            for line in lines.into_iter().take(SHOWN) {
                let number = |value: f64| if value.is_finite() { short(value) } else { "none".to_owned() };
                let Gradient { metric, value, unit, parameter, derivative, derivative_unit, elasticity } = line;
                grid.row(vec![
                    metric,
                    number(value),
                    unit,
                    parameter,
                    number(derivative),
                    derivative_unit,
                    if elasticity.is_finite() { rough(elasticity) } else { String::new() },
                ]);
            }
            text.push_str(&format!("\n{}", grid.text(width)));
            if more > 0 {
                text.push_str(&format!("{} in gradient.csv\n", count(more, "more line", "more lines")));
            }
        }
        let steps = self.case().map_or(0, |case| case.report.steps);
        let words = format!("{}, {} without derivatives", count(steps, "step", "steps"), self.plain_steps);
        text.push_str(&format!("\n{}", terminal::hanging("steps    ", &words, width)));
        for one in self.compared {
            let Compared { parameter, off, column, step, open, open_column } = one;
            let verdict = if one.is_close() { "agrees" } else { "DIFFERS" };
            let column = if column.is_empty() { String::new() } else { format!(", most in {column}") };
            let (off, step) = (rough(*off), rough(*step));
            let told = match *open {
                0.0 => String::new(),
                open => format!(", which tell d({open_column}) no better than {}", rough(open)),
            };
            let words = format!(
                "{parameter} {verdict}: {off} of the largest value{column}; differences in steps of {step}{told}"
            );
            text.push_str(&terminal::hanging("check    ", &words, width));
        }
        text
    }

    fn gradients(&self, derivatives: &CaseDerivatives) -> Vec<Gradient> {
        let values = self.case().map_or(&[][..], |case| &case.metrics.values);
        let metrics = self.finished.metrics.iter().zip(values).zip(&derivatives.gradients);
        metrics
            .flat_map(|(([metric, unit], value), slopes)| {
                self.sensitivity.parameters.iter().zip(slopes).map(move |(parameter, slope)| Gradient {
                    metric: metric.clone(),
                    value: *value,
                    unit: unit.clone(),
                    parameter: parameter.name.clone(),
                    derivative: *slope,
                    derivative_unit: parameter.over(unit),
                    elasticity: parameter.value * slope / value,
                })
            })
            .collect()
    }

    /// For programs.
    pub(super) fn json(&self) -> String {
        let derivatives = self.derivatives();
        let parameters = &self.sensitivity.parameters;
        let ranking: Vec<Value> = derivatives
            .ranking
            .iter()
            .map(|Ranked { column, parameter, rms, share }| {
                json!({ "column": column, "parameter": parameters[*parameter].name, "rms": rms, "share": share })
            })
            .collect();
        let gradient: Vec<Value> = self
            .gradients(&derivatives)
            .into_iter()
            .map(|line| {
                json!({
                    "metric": line.metric, "value": line.value, "unit": line.unit, "parameter": line.parameter,
                    "derivative": line.derivative, "derivative_unit": line.derivative_unit, "elasticity": line.elasticity,
                })
            })
            .collect();
        let check: Vec<Value> = self
            .compared
            .iter()
            .map(|one| {
                json!({
                    "parameter": one.parameter, "off": one.off, "column": one.column, "step": one.step,
                    "agrees": one.is_close(),
                })
            })
            .collect();
        let told = json!({
            "title": self.plan.title,
            "results": self.finished.folder.path(),
            "steps": self.case().map(|case| case.report.steps),
            "plain_steps": self.plain_steps,
            "ranking": ranking,
            "gradient": gradient,
            "check": check,
        });
        format!("{told:#}\n")
    }
}

/// A line of gradient.csv.
struct Gradient {
    metric: String,
    value: f64,
    unit: String,
    parameter: String,
    derivative: f64,
    derivative_unit: String,
    elasticity: f64,
}
