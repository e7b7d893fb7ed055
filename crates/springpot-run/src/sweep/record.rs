//! The record of a run: run.json.

use super::layout::Layout;
use super::{CaseResult, ForwardWork, Happened, MAX_LISTED, Outcome};
use crate::record::MOST_SHOWN;
use crate::table::Format;
use serde_json::{Map, Value, json};
use springpot::observe::Quantity;
use springpot::system::Adaptive;
use springpot_scenario::{Cases, Plan, SweptValue};
use std::ops::Range;

impl Outcome {
    /// run.json: how it ended, what was run (the first case, as resolved), what the columns are, what every case did, the format of
    /// the rows and all `files` of the run.
    pub fn record(
        &self,
        cases: &Cases,
        plan: &Plan,
        layout: &Layout,
        format: Format,
        files: &[String],
    ) -> Map<String, Value> {
        let (residual, turned_over) = self.energy_residual.unzip();
        let listed: Vec<Value> = self.cases.iter().take(2 * MAX_LISTED).map(|case| one(cases, layout, case)).collect();
        let ledger = self.no_ledger.as_ref().map(|(count, why)| {
            if cases.len() == 1 { format!("unknown: {why}") } else { format!("unknown in {count} cases: {why}") }
        });
        let record = json!({
            "status": self.status,
            "t_reached": self.t_reached,
            "title": plan.title,
            "versions": { "springpot": env!("CARGO_PKG_VERSION") },
            "wall_time": self.wall.as_secs_f64(),
            "cases_total": cases.len(),
            "cases_done": self.done,
            "cases_failed": self.failed,
            "steps": self.steps,
            "rejected_steps": self.rejected_steps,
            "energy_residual": residual,
            "energy_turned_over": turned_over,
            "ledger": ledger,
            "warnings": cases.warnings(),
            "limits": self.limits,
            "plan": plan.resolved(),
            "columns": layout.written(),
            "sweeps": sweeps(cases),
            "cases": listed,
            "format": format.name(),
            "files": files,
        });
        match record {
            Value::Object(mut map) => {
                map.extend(sensitivity(cases, plan, &self.cases));
                if !layout.events().is_empty() {
                    map.insert("events".to_owned(), counts(layout, &self.events));
                }
                if let Some(shard) = self.shard {
                    let Range { start, end } = shard.cases(cases.len());
                    let part = json!({ "number": shard.number(), "count": shard.count(), "cases": [start, end] });
                    map.insert("shard".to_owned(), part);
                }
                map.extend(self.forward.iter().flat_map(|forward| effort(forward, self.steps)));
                map
            }
            _ => unreachable!("the literal above is an object"),
        }
    }
}

/// What forward runs of so many `steps` took, and of methods that may take turns which took any.
fn effort(forward: &ForwardWork, steps: u64) -> Vec<(String, Value)> {
    let ForwardWork { newton_iterations, explicit_steps, evaluations, method_switches } = *forward;
    let mut all = vec![("newton_iterations".to_owned(), newton_iterations.into())];
    if let Some(explicit) = explicit_steps {
        let took = [(Adaptive::Explicit, explicit), (Adaptive::Radau, steps - explicit)];
        let names = took.into_iter().filter(|(_, steps)| *steps > 0).filter_map(|(method, _)| method.name());
        all.push(("methods".to_owned(), names.collect()));
        let numbers =
            [("explicit_steps", explicit), ("evaluations", evaluations), ("method_switches", method_switches)];
        all.extend(numbers.map(|(key, number)| (key.to_owned(), number.into())));
    }
    all
}

/// What is known of a run of these cases at its beginning, by the names of run.json.
pub(crate) fn begun(cases: &Cases, plan: &Plan, layout: &Layout, range: Range<usize>) -> Map<String, Value> {
    let total = range.len();
    let listed = range.take(MOST_SHOWN).map(|index| json!({ "index": index, "parameters": swept(cases, index) }));
    let record = json!({
        "status": "running",
        "title": plan.title,
        "versions": { "springpot": env!("CARGO_PKG_VERSION") },
        "cases_total": total,
        "plan": plan.resolved(),
        "columns": layout.written(),
        "sweeps": sweeps(cases),
        "cases": listed.collect::<Value>(),
    });
    match record {
        Value::Object(map) => map,
        _ => unreachable!("the literal above is an object"),
    }
}

/// By what the first case is differentiated, and what; where derivatives of any case end. Nothing where it is not.
fn sensitivity(cases: &Cases, plan: &Plan, done: &[CaseResult]) -> Option<(String, Value)> {
    let sensitivity = plan.sensitivity.as_ref().filter(|sensitivity| sensitivity.is_asked())?;
    let parameters = sensitivity.parameters.iter().map(|parameter| {
        json!({
            "name": parameter.name, "path": parameter.paths.join(", "), "value": parameter.value,
            "unit": parameter.unit, "typical": parameter.typical,
        })
    });
    let columns = sensitivity.columns.iter().map(|column| {
        let (of, by) = Quantity::of_derivative(&column.name).unwrap_or_default();
        json!({ "name": column.name, "column": of, "parameter": by, "unit": column.unit })
    });
    let (parameters, columns): (Value, Value) = (parameters.collect(), columns.collect());
    let lost: Vec<Value> = done
        .iter()
        .flat_map(|case| case.metrics.derivatives.lost.iter().map(move |lost| (case.index, lost)))
        .map(|(index, lost)| {
            let name = sensitivity.parameters.get(lost.parameter).map(|parameter| &parameter.name);
            let mut told = json!({ "parameter": name, "t": lost.t, "why": lost.why });
            if cases.len() > 1 {
                told["case"] = index.into();
            }
            told
        })
        .collect();
    let record = json!({ "parameters": parameters, "columns": columns, "lost": lost, "method": sensitivity.method() });
    Some(("sensitivity".to_owned(), record))
}

/// Swept values of a case by path.
fn swept(cases: &Cases, index: usize) -> Map<String, Value> {
    cases.parameters().iter().cloned().zip(cases.values(index).iter().map(value)).collect()
}

/// How often each event happened, by name.
fn counts(layout: &Layout, happened: &Happened) -> Value {
    let count = |k: usize| happened.counts.get(k).copied().unwrap_or(0);
    let named = layout.events().iter().enumerate().map(|(k, name)| (name.clone(), json!(count(k))));
    named.collect::<Map<_, _>>().into()
}

/// Values of a sweep that are listed.
const MAX_VALUES: usize = 1_000;

/// What is swept: the paths that move together, the values by their names or as written, and as the rows have them.
fn sweeps(cases: &Cases) -> Value {
    let mut stride = cases.len();
    let mut first = 0;
    let sweeps = (0..cases.axis_count()).map(|axis| {
        let (count, shown) = (cases.axis_len(axis), cases.axis_len(axis).min(MAX_VALUES));
        stride /= count;
        let parameters: Vec<&str> = cases.axis_parameters(axis).collect();
        let columns = first..first + parameters.len();
        first = columns.end;
        let labels: Vec<String> = (0..shown).map(|k| cases.axis_label(axis, k)).collect();
        let values = (0..shown).map(|k| cases.values(k * stride)[columns.clone()].iter().map(value).collect::<Value>());
        let mut sweep =
            json!({ "parameters": parameters, "count": count, "labels": labels, "values": values.collect::<Value>() });
        if let Some(names) = cases.axis_names(axis) {
            sweep["names"] = json!(names[..shown]);
        }
        // Where labels do not say it, the values of each parameter as written.
        if cases.axis_names(axis).is_some() || parameters.len() > 1 {
            let written = |k| parameters.iter().map(|path| cases.axis_label_of(axis, path, k)).collect::<Vec<_>>();
            sweep["written"] = (0..shown).map(written).collect();
        }
        sweep
    });
    sweeps.collect()
}

fn value(value: &SweptValue) -> Value {
    match value {
        SweptValue::Number(number) => json!(number),
        SweptValue::Text(text) => json!(text),
    }
}

fn one(cases: &Cases, layout: &Layout, case: &CaseResult) -> Value {
    let status = match (&case.error, case.interrupted) {
        (None, _) => "done",
        (_, true) => "interrupted",
        _ => "failed",
    };
    let mut record = json!({
        "index": case.index,
        "parameters": swept(cases, case.index),
        "status": status,
        "error": case.error.as_ref().map(|trouble| &trouble.message),
        "ledger": case.no_ledger.as_ref().map(|why| format!("unknown: {why}")),
        "limits": case.limits,
        "wall_time": case.wall.as_secs_f64(),
    });
    if let (Value::Object(record), Ok(Value::Object(report))) = (&mut record, serde_json::to_value(case.report)) {
        let name = cases.given_name(case.index);
        if !name.is_empty() {
            record.insert("name".to_owned(), name.into());
        }
        if !layout.events().is_empty() {
            record.insert("events".to_owned(), counts(layout, &case.events));
            let stopped_by = case.events.stopped_by.map(|event| &layout.events()[event]);
            record.insert("stopped_by".to_owned(), json!(stopped_by));
        }
        if let Some(own) = &case.metrics.own {
            record.insert("metrics".to_owned(), serde_json::from_str(own).unwrap_or_default());
        }
        // What does not belong to a way of running says nothing.
        let silent = |key: &str| {
            let explicit = ["explicit_steps", "evaluations", "method_switches"];
            ["newton_iterations", "switches", "resolution"].into_iter().chain(explicit).any(|own| own == key)
        };
        if let Some(trouble) = &case.error {
            let told = [
                ("error_place", json!(trouble.place)),
                ("error_help", json!(trouble.help)),
                ("error_t", json!(trouble.t)),
            ];
            record.extend(
                told.into_iter().filter(|(_, value)| !value.is_null()).map(|(key, value)| (key.to_owned(), value)),
            );
        }
        record.extend(report.into_iter().filter(|(key, value)| !(value.is_null() && silent(key))));
    }
    record
}
