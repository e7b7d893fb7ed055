//! fit.json.

use super::outcome::Outcome;
use serde_json::{Map, Value, json};
use springpot::identification::Side;
use springpot_scenario::FitParameter;

/// The record of a fit: all numbers SI, null where they are not finite.
pub fn json(outcome: &Outcome) -> Value {
    let fit = &outcome.fit;
    let plan = outcome.fitting.plan();
    let parameters: Vec<Value> =
        plan.parameters.iter().enumerate().map(|(j, own)| parameter(outcome, j, own)).collect();
    let undetermined: Vec<Value> = fit
        .undetermined
        .iter()
        .map(|open| {
            let parts = open.combination.iter().map(|(j, part)| (name(outcome, *j).to_owned(), number(*part)));
            json!({ "combination": parts.collect::<Map<_, _>>(), "text": open.text(|j| name(outcome, j).to_owned()) })
        })
        .collect();
    let by_series = |values: &[f64]| -> Map<String, Value> {
        outcome.series.iter().zip(values).map(|(name, value)| (name.clone(), number(*value))).collect()
    };
    let data: Vec<Value> = plan
        .data
        .iter()
        .zip(&outcome.records)
        .map(|(data, score)| {
            let each = |of: &dyn Fn(&super::ColumnScore) -> f64| -> Map<String, Value> {
                data.columns
                    .iter()
                    .zip(&score.columns)
                    .map(|(column, own)| (column.name.clone(), number(of(own))))
                    .collect()
            };
            json!({
                "name": data.name, "kind": data.kind.name(), "rows": score.rows.len(), "skipped": data.skipped,
                "use": if data.is_fitted { "fit" } else { "validation" }, "cost": number(score.cost),
                "rms": each(&|own| own.rms), "r2": each(&|own| own.r2),
            })
        })
        .collect();
    let laws: Vec<Value> = outcome
        .laws
        .iter()
        .map(|(law, cost, p, [aicc, bic])| json!({ "law": law, "cost": number(*cost), "p": p, "aicc": number(*aicc), "bic": number(*bic) }))
        .collect();
    json!({
        "status": outcome.status.name(),
        "parameters": parameters,
        "undetermined": undetermined,
        "cost": number(fit.cost),
        "n": fit.rows,
        "p": fit.parameters + fit.eliminated,
        "sigma": by_series(&fit.sigma),
        "aicc": number(fit.criteria.aicc),
        "bic": number(fit.criteria.bic),
        "lag1": by_series(&fit.lag1),
        "starts": { "tried": fit.starts[0], "reached": fit.starts[1] },
        "data": data,
        "laws": laws,
        "chosen": outcome.chosen,
        "warnings": outcome.warnings,
    })
}

fn parameter(outcome: &Outcome, j: usize, own: &FitParameter) -> Value {
    let fit = &outcome.fit;
    let path = match &own.paths[..] {
        [] => Value::Null,
        [one] => one.clone().into(),
        several => several.into(),
    };
    let others =
        (0..fit.values.len()).filter(|k| *k != j).map(|k| (name(outcome, k).to_owned(), number(fit.correlation(j, k))));
    let sd = if fit.unseen.contains(&j) { f64::INFINITY } else { fit.sd(j) };
    json!({
        "name": own.sought.name, "path": path, "value": number(fit.values[j]), "unit": own.unit,
        "sd": number(sd), "interval": outcome.intervals[j].map(number), "start": number(own.sought.start[0]),
        "at_bound": side(fit.at_bound[j]), "correlation": others.collect::<Map<_, _>>(),
    })
}

/// The word of a bound.
pub(super) fn side(side: Option<Side>) -> Option<&'static str> {
    side.map(|side| if side == Side::Lower { "lower" } else { "upper" })
}

pub(super) fn name(outcome: &Outcome, j: usize) -> &str {
    &outcome.fitting.plan().parameters[j].sought.name
}

/// A number, or null where it is none.
fn number(value: f64) -> Value {
    if value.is_finite() { value.into() } else { Value::Null }
}
