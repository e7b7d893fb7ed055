//! The eigenvalues of every case of a sweep: rows, data and the root locus.

use super::asked::Asked;
use super::table;
use super::{Stopped, Told};
use crate::arguments::ModesOptions;
use crate::grid::{Grid, Set};
use crate::{diagnostic, terminal};
use serde_json::{Value, json};
use springpot::law::Catalog;
use springpot::linear::Modes;
use springpot_report::{Curve, Panel, Plot};
use springpot_run::linear::modes_json;
use springpot_run::numbers::{brief, count};
use springpot_scenario::{Cases, SweptValue};

/// Cases that have entries of their own in a legend.
const MOST_ENTRIES: usize = 12;

struct Case {
    asked: Asked,
    modes: Modes,
    values: Vec<SweptValue>,
    labels: Vec<String>,
    name: String,
}

pub(super) fn told(options: &ModesOptions, catalog: &Catalog) -> Result<Told, Stopped> {
    let cases = Asked::cases((&options.file, &options.overrides, &options.sweeps), catalog)?;
    diagnostic::robot_warnings(&cases);
    let mut all = Vec::new();
    for k in 0..cases.len() {
        let name = cases.name(k);
        let named = |(message, help): (String, String)| Stopped::Refused((format!("{name}: {message}"), help));
        let asked = Asked::of_case(&cases, k, options).map_err(|stopped| match stopped {
            Stopped::Refused(problem) => named(problem),
            ended => ended,
        })?;
        if k == 0 {
            asked.warn();
        }
        let modes = asked.about.linear.modes().map_err(|error| named(table::problem(error)))?;
        table::warn_of_missing(&modes, &name);
        all.push(Case { asked, modes, values: cases.values(k), labels: cases.labels(k), name });
    }
    Ok(Told {
        page: page(&cases, &all),
        csv: csv(&cases, &all),
        json: json(&cases, &all),
        plot: plot(&cases, &all),
        beside: None,
    })
}

fn page(cases: &Cases, all: &[Case]) -> String {
    let titles = ["f, Hz", "ratio", "eigenvalue, 1/s"].map(|title| (title.to_owned(), Set::Number));
    let swept = cases.parameters().iter().map(|path| (path.clone(), Set::Name));
    let mut grid = Grid::new(swept.chain([("mode".to_owned(), Set::Number)]).chain(titles));
    for case in all {
        for (k, mode) in (1..).zip(&case.modes.modes) {
            let numbers = [brief(mode.frequency()), brief(mode.damping_ratio()), table::eigenvalue(mode)];
            grid.row(case.labels.iter().cloned().chain([format!("{k}")]).chain(numbers).collect());
        }
    }
    let mut text = grid.text(terminal::stdout_columns());
    let unstable: Vec<&str> = all
        .iter()
        .filter(|case| case.modes.modes.iter().any(|mode| mode.is_unstable()))
        .map(|case| &*case.name)
        .collect();
    if !unstable.is_empty() {
        let message = format!("\nunstable in {}: {}", count(unstable.len(), "case", "cases"), unstable.join("; "));
        text.push_str(&terminal::hanging("", &message, terminal::stdout_width().or(Some(80))));
    }
    text
}

fn csv(cases: &Cases, all: &[Case]) -> String {
    let swept = cases.parameters().iter().zip(cases.units());
    let heads = swept.map(|(path, unit)| if unit.is_empty() { path.clone() } else { format!("{path} [{unit}]") });
    let mut text = heads.map(|head| table::quoted(&head) + ",").collect::<String>();
    text.push_str("mode,");
    text.push_str(table::HEADER);
    for case in all {
        let value = |value: &SweptValue| match value {
            SweptValue::Number(value) => format!("{value}"),
            SweptValue::Text(text) => table::quoted(text),
        };
        let swept: String = case.values.iter().map(|own| value(own) + ",").collect();
        let names = case.asked.about.linear.velocity_names();
        for (k, row) in (1..).zip(table::rows(&case.modes, &names)) {
            text.push_str(&format!("{swept}{k},{row}"));
        }
    }
    text
}

fn json(cases: &Cases, all: &[Case]) -> Value {
    let one = |case: &Case| {
        let mut value = modes_json(&case.asked.about, &case.modes);
        let values = case.values.iter().map(|value| match value {
            SweptValue::Number(value) => json!(value),
            SweptValue::Text(text) => json!(text),
        });
        value["set"] = cases.parameters().iter().cloned().zip(values).collect::<serde_json::Map<_, _>>().into();
        value
    };
    json!({ "cases": all.iter().map(one).collect::<Vec<_>>() })
}

/// The eigenvalues of all cases in the plane.
fn plot(cases: &Cases, all: &[Case]) -> Plot {
    let curves = all.iter().map(|case| Curve { label: case.labels.join(", "), ..table::marks(&case.modes) }).collect();
    Plot {
        title: Some("Root locus".to_owned()),
        x: "real part, 1/s".into(),
        y: "imaginary part, 1/s".into(),
        legend_title: Some(cases.parameters().join(", ")),
        hides_legend: all.len() > MOST_ENTRIES,
        panels: vec![Panel { curves, ..Panel::default() }],
        ..Plot::default()
    }
}
