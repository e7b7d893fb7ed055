//! What a report takes from the files beside the rows.

use super::MOST_CASES;
use super::written::{cut, quoted};
use crate::labels;
use crate::numbers::short;
use crate::results::Results;
use serde_json::Value;
use springpot_report::page::{Block, Figure, Printed, Table};
use std::path::Path;

/// Figures of a scenario, each in the first format that a page can hold.
pub(super) fn figures(results: &Results) -> Vec<Block> {
    let plan = &results.record.plan["figures"];
    let mut figures: Vec<Figure> = Vec::new();
    for planned in plan.as_array().into_iter().flatten() {
        let Some(name) = planned["name"].as_str() else { continue };
        let title = planned["title"].as_str().unwrap_or(name).to_owned();
        let of = |ending: &str| {
            let file = format!("figures/{name}.{ending}");
            results.record.files.contains(&file).then_some(file)
        };
        let read = |ending: &'static str| Some(Printed { ending, bytes: results.file(&of(ending)?)? });
        let printed = read("pdf").or_else(|| read("png"));
        let shown = [("svg", "image/svg+xml"), ("png", "image/png")].into_iter().find_map(|(ending, media)| {
            let file = of(ending)?;
            let bytes = results.file(&file)?;
            let (title, printed) = (title.clone(), printed.clone());
            Some(Figure { title, file: Some(file), media: media.to_owned(), bytes, printed })
        });
        // A page shows no PDF; it says where it is.
        let named = || {
            of("pdf").map(|file| Figure {
                title: title.clone(),
                file: Some(file),
                media: String::new(),
                bytes: Vec::new(),
                printed: printed.clone(),
            })
        };
        figures.extend(shown.or_else(named));
    }
    if figures.is_empty() { Vec::new() } else { vec![Block::Figures(figures)] }
}

/// Rows of a file of texts, with the swept values of their case.
fn rows(results: &Results, name: &str, most: usize) -> (Vec<(String, Vec<String>)>, bool) {
    let all = results.texts(name);
    let is_cut = all.len() > most;
    let names = results.record.names_by_lead();
    let named = all.into_iter().take(most).map(|(lead, fields)| (names.of(&lead), fields));
    (named.collect(), is_cut)
}

/// A number with six digits; other text as it is.
fn shortened(text: &str) -> String {
    text.parse().map_or_else(|_| cut(text.to_owned()), short)
}

/// The table of metrics.csv.
pub(super) fn metrics(results: &Results) -> Option<Table> {
    let (rows, is_cut) = rows(results, "metrics.csv", 3 * MOST_CASES);
    let is_swept = results.record.parameters().next().is_some();
    let mut table = Table::new(
        "",
        if is_swept {
            &["case", "metric", "column", "#value", "unit"]
        } else {
            &["metric", "column", "#value", "unit"]
        },
    );
    for (case, fields) in rows {
        let [name, column, value, unit] = &fields[..] else { continue };
        let value = if value.is_empty() { "none".to_owned() } else { shortened(value) };
        let case = is_swept.then_some(case);
        table.rows.push(
            case.into_iter().chain([cut(name.clone()), column.clone(), value, labels::written_unit(unit)]).collect(),
        );
    }
    table.note = is_cut.then(|| "The first ones; metrics.csv has all.".to_owned());
    (!table.rows.is_empty()).then_some(table)
}

/// The table of events.csv.
pub(super) fn events(results: &Results) -> Option<Table> {
    let (rows, is_cut) = rows(results, "events.csv", 3 * MOST_CASES);
    let is_swept = results.record.parameters().next().is_some();
    let mut table = Table::new("", if is_swept { &["case", "event", "#t, s"] } else { &["event", "#t, s"] });
    for (case, fields) in rows {
        let [name, t, ..] = &fields[..] else { continue };
        let case = is_swept.then_some(case);
        table.rows.push(case.into_iter().chain([cut(name.clone()), shortened(t)]).collect());
    }
    table.note = is_cut.then(|| "The first ones; events.csv has all.".to_owned());
    (!table.rows.is_empty()).then_some(table)
}

/// The table of summary.csv for the first case, with what the columns mean.
pub(super) fn summary(results: &Results) -> Option<Table> {
    let rows = results.texts("summary.csv");
    let first = rows.first()?.0.clone();
    let mut table = Table::new("", &["column", "#least", "#largest", "#root mean square", "unit", "meaning"]);
    for (_, fields) in rows.into_iter().take_while(|(lead, _)| *lead == first) {
        let [name, unit, least, largest, rms] = &fields[..] else { continue };
        // Another case of the same values.
        if table.rows.first().is_some_and(|row| row[0] == *name) {
            break;
        }
        let meaning = results.columns.iter().find(|column| column.name == *name).map_or("", |column| &column.meaning);
        let numbers = [least, largest, rms].map(|text| shortened(text));
        let [least, largest, rms] = numbers;
        table.rows.push(vec![name.clone(), least, largest, rms, labels::written_unit(unit), meaning.to_owned()]);
    }
    if results.record.totals.cases_total > 1 {
        table.note = Some("Of the first case; summary.csv has all.".to_owned());
    }
    (!table.rows.is_empty()).then_some(table)
}

/// The command, the scenario as it was, and the versions.
pub(super) fn reproduce(results: &Results) -> Vec<Block> {
    let record = &results.record;
    let mut blocks = Vec::new();
    let versions =
        record.versions.iter().map(|(name, version)| format!("{name} {}", version.as_str().unwrap_or_default()));
    let versions = versions.collect::<Vec<_>>().join(", ");
    if let Some(scenario) = &record.scenario {
        let is_file = Path::new(&scenario.name).extension().is_some_and(|ending| ending == "toml");
        let file = if is_file { scenario.name.as_str() } else { "scenario.toml" };
        let mut command = format!("springpot run {}", quoted(file));
        for (option, values) in [("--set", &scenario.set), ("--sweep", &scenario.sweep)] {
            for value in values {
                command.push_str(&format!(" {option} {}", quoted(value)));
            }
        }
        let words = match is_file {
            true => format!("With {versions}, and the scenario below in the place of {file}:"),
            false => format!("With {versions}, and the scenario below as scenario.toml:"),
        };
        blocks.extend([Block::Text(words), Block::Code(command)]);
        blocks.push(Block::Folded(format!("The scenario, {}", scenario.name), scenario.text.clone()));
    } else {
        blocks.push(Block::Text(format!("With {versions}.")));
    }
    let plan = serde_json::to_string_pretty(&record.plan).unwrap_or_default();
    if record.plan != Value::Null {
        blocks.push(Block::Unprinted("The first case as it was run, defaults filled in, SI".to_owned(), plan));
    }
    blocks.push(Block::Unprinted("Files of the results".to_owned(), record.files.join("\n")));
    blocks
}
