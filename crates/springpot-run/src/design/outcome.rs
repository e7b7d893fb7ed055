//! What a design came to: design.json, steps.csv, the designed scenario.

use super::problem::{Evaluated, Problem};
use super::{HOLDS, Start};
use crate::table::{push_fields, push_number, push_text};
use serde_json::{Value, json};
use springpot::optimisation::Status;
use springpot_scenario::ParameterPlan;

/// A run of the search.
#[derive(Debug, Clone)]
pub struct Tried {
    /// Of which start, from 0.
    pub start: usize,
    /// The values of the parameters, SI.
    pub values: Vec<f64>,
    /// The objective, SI; NaN where the run failed.
    pub objective: f64,
    /// The metrics of the constraints, in the case that is worst.
    pub constraints: Vec<f64>,
}

impl Tried {
    pub(super) fn of(problem: &Problem<'_>, start: usize, values: &[f64], found: Option<&Evaluated>) -> Self {
        let constraints = &problem.plan().constraints;
        let constrained = |found: &Evaluated| constraints.iter().map(|one| problem.constrained(found, one)).collect();
        Self {
            start,
            values: values.to_vec(),
            objective: found.map_or(f64::NAN, |found| problem.objective(found)),
            constraints: found.map_or_else(|| vec![f64::NAN; constraints.len()], constrained),
        }
    }
}

/// Where one start led.
#[derive(Debug, Clone)]
pub struct Reached {
    /// How it ended.
    pub status: &'static str,
    /// The objective there, SI; NaN where nothing could be run.
    pub objective: f64,
    /// Whether the constraints hold there.
    pub is_admissible: bool,
    /// The values of the parameters.
    pub values: Vec<f64>,
    /// Runs that it took.
    pub runs: usize,
}

/// What a design came to.
#[derive(Debug, Clone)]
pub struct Designed {
    /// `converged`, `not-converged`, `stalled`, `infeasible`, `failed` or `interrupted`.
    pub status: &'static str,
    /// The parameters.
    pub parameters: Vec<ParameterPlan>,
    /// Their values, SI.
    pub values: Vec<f64>,
    /// The metric, its unit, and whether it is to be large.
    pub metric: (String, String, bool),
    /// The objective with the values of the file; NaN where that run fails.
    pub before: f64,
    /// With those that were found.
    pub after: f64,
    /// Its derivatives by the parameters there.
    pub gradient: Vec<f64>,
    /// By constraint: metric, its value, its limit, whether it is active, and its multiplier.
    pub constraints: Vec<(String, f64, f64, bool, f64)>,
    /// Where the starts led.
    pub starts: Vec<Reached>,
    /// All runs, start by start.
    pub tried: Vec<Tried>,
    /// The text of the scenario with the values, comments kept.
    pub text: String,
}

fn word(status: Status) -> &'static str {
    match status {
        Status::Converged => "converged",
        Status::Stalled => "stalled",
        Status::Spent => "not-converged",
        Status::Infeasible => "infeasible",
        Status::Failed => "failed",
    }
}

impl Designed {
    pub(super) fn of(problem: &Problem<'_>, before: Option<&Evaluated>, found: Vec<Start>, interrupted: bool) -> Self {
        let design = problem.plan();
        let own = &problem.case().metrics[design.metric].metric;
        let column = problem.case().row_columns().into_iter().find(|column| column.name == own.of);
        let unit = own.kind.unit(column.as_ref().map_or("", |column| &column.unit)).into_owned();
        let sign = if design.maximise { -1.0 } else { 1.0 };
        let holds = |tried: &Tried| {
            design.constraints.iter().zip(&tried.constraints).all(|(one, value)| {
                let beyond = if one.is_min { one.limit - value } else { value - one.limit };
                beyond <= HOLDS * one.limit.abs().max(1e-3 * value.abs())
            })
        };
        let starts: Vec<Reached> = found
            .iter()
            .map(|start| {
                let values = problem.values(&start.descent.x);
                let last = start.tried.iter().rev().find(|tried| tried.values == values);
                Reached {
                    status: word(start.descent.status),
                    objective: last.map_or(f64::NAN, |tried| tried.objective),
                    is_admissible: last.is_some_and(|tried| tried.objective.is_finite() && holds(tried)),
                    values,
                    runs: start.tried.len(),
                }
            })
            .collect();
        // The best of those that hold, else the one that is nearest to it is not known: the first.
        let least = |among: &dyn Fn(&Reached) -> bool| {
            (0..starts.len())
                .filter(|k| starts[*k].is_admissible && among(&starts[*k]))
                .min_by(|one, other| (sign * starts[*one].objective).total_cmp(&(sign * starts[*other].objective)))
        };
        // One that has converged, where none is better by more than constraints may be missed by.
        let [converged, best] = [least(&|start| start.status == "converged"), least(&|_| true)];
        let is_as_good = |one: usize, best: usize| {
            let [one, best] = [one, best].map(|k| sign * starts[k].objective);
            one - best <= 10.0 * HOLDS * best.abs().max(one.abs())
        };
        let as_good = converged.zip(best).filter(|(one, best)| is_as_good(*one, *best)).map(|(one, _)| one);
        let best = as_good.or(best);
        let file: Vec<f64> = problem.parameters().iter().map(|parameter| parameter.value).collect();
        let values = best.map_or_else(|| file.clone(), |k| starts[k].values.clone());
        let after = if interrupted { None } else { problem.evaluate(&values) };
        let status = match best {
            _ if interrupted => "interrupted",
            Some(k) => starts[k].status,
            None if starts.iter().all(|start| start.status == "failed") => "failed",
            None => "infeasible",
        };
        let multipliers = best.map_or_else(Vec::new, |k| found[k].descent.multipliers.clone());
        let tried = best.and_then(|k| found[k].tried.iter().rev().find(|tried| tried.values == values));
        let constraints = design.constraints.iter().enumerate().map(|(k, one)| {
            let known = tried.map_or(f64::NAN, |tried| tried.constraints[k]);
            let value = after.as_ref().map_or(known, |after| problem.constrained(after, one));
            let multiplier = multipliers.get(k).copied().unwrap_or(0.0);
            let active = (value - one.limit).abs() <= 10.0 * HOLDS * one.limit.abs().max(1e-3 * value.abs());
            (problem.case().metrics[one.metric].metric.name.clone(), value, one.limit, active, multiplier)
        });
        let constraints: Vec<_> = constraints.collect();
        Self {
            status,
            parameters: problem.parameters().to_vec(),
            metric: (own.name.clone(), unit, design.maximise),
            before: before.map_or(f64::NAN, |before| problem.objective(before)),
            after: after
                .as_ref()
                .map_or_else(|| best.map_or(f64::NAN, |k| starts[k].objective), |after| problem.objective(after)),
            gradient: after.map_or_else(|| vec![f64::NAN; values.len()], |after| problem.gradient(&after)),
            constraints,
            text: problem.text(&values),
            values,
            starts,
            tried: found.into_iter().flat_map(|start| start.tried).collect(),
        }
    }

    /// Whether a minimum was found.
    pub fn has_converged(&self) -> bool {
        self.status == "converged"
    }

    /// Whether any point was found that the constraints admit.
    pub fn is_admissible(&self) -> bool {
        self.starts.iter().any(|start| start.is_admissible)
    }

    /// At which of its bounds a parameter is.
    pub fn at_bound(&self, p: usize) -> Option<&'static str> {
        let [low, high] = self.parameters[p].bounds?;
        match self.values[p] {
            value if value == low => Some("lower"),
            value if value == high => Some("upper"),
            _ => None,
        }
    }

    /// design.json.
    pub fn json(&self) -> String {
        let parameters: Vec<Value> = self
            .parameters
            .iter()
            .enumerate()
            .map(|(p, own)| {
                json!({
                    "name": own.name, "path": own.paths.join(", "), "value": self.values[p], "unit": own.unit,
                    "before": own.value, "at_bound": self.at_bound(p), "gradient": self.gradient[p],
                })
            })
            .collect();
        let constraints: Vec<Value> = self
            .constraints
            .iter()
            .map(|(metric, value, limit, active, multiplier)| {
                json!({ "metric": metric, "value": value, "limit": limit, "active": active, "multiplier": multiplier })
            })
            .collect();
        let starts: Vec<Value> = self
            .starts
            .iter()
            .map(|one| {
                json!({
                    "status": one.status, "objective": one.objective, "admissible": one.is_admissible,
                    "values": one.values, "runs": one.runs,
                })
            })
            .collect();
        let (metric, unit, maximise) = &self.metric;
        let told = json!({
            "status": self.status,
            "objective": { "metric": metric, "before": self.before, "after": self.after, "unit": unit, "maximise": maximise },
            "parameters": parameters,
            "constraints": constraints,
            "starts": starts,
            "runs": self.tried.len(),
        });
        format!("{told:#}\n")
    }

    /// steps.csv: every run of the search.
    pub fn steps(&self) -> String {
        let mut text = String::from("run,start,objective");
        let constraints = self.constraints.iter().map(|(metric, ..)| metric);
        for name in constraints.chain(self.parameters.iter().map(|own| &own.name)) {
            text.push(',');
            push_text(&mut text, name);
        }
        text.push('\n');
        for (run, one) in self.tried.iter().enumerate() {
            text.push_str(&format!("{run},{},", one.start));
            push_number(&mut text, one.objective);
            push_fields(&mut text, one.constraints.iter().chain(&one.values).copied());
            text.push('\n');
        }
        text
    }
}
