//! What a report says of the elements and of the robot.

use super::curves::{Asked, Drawn};
use super::written;
use crate::labels;
use crate::numbers::short;
use crate::results::Results;
use serde_json::Value;
use springpot_report::page::{Block, LawSection, Table};
use springpot_report::scene::LawText;

/// Elements that have pictures.
const MOST_ELEMENTS: usize = 12;

fn loop_title(name: &str) -> String {
    format!("{name}: force over stroke")
}

fn force_title(name: &str) -> String {
    format!("{name}: force over time")
}

/// The pictures of the elements.
pub(super) fn figures(results: &Results) -> Vec<Asked> {
    let laws = results.record.laws.iter().take(MOST_ELEMENTS);
    let of = |law: &LawText| {
        let column = |what: &str| format!("{}.{what}", law.name);
        let force =
            Asked { title: force_title(&law.name), x: "t".to_owned(), y: vec![column("force")], is_first: false };
        let over_stroke = Asked { title: loop_title(&law.name), x: column("stroke"), ..force.clone() };
        [over_stroke, force]
    };
    laws.flat_map(of).collect()
}

/// Every element with its law.
pub(super) fn all(results: &Results, drawn: &Drawn) -> Vec<Block> {
    let elements = results.record.plan["elements"].as_array();
    let planned = |name: &str| {
        elements.into_iter().flatten().find(|element| element["name"] == name).cloned().unwrap_or_default()
    };
    let mut blocks: Vec<Block> = Vec::new();
    for law in &results.record.laws {
        let figures = drawn.titled(&[&loop_title(&law.name), &force_title(&law.name)]);
        let place = place(&planned(&law.name));
        let section = LawSection { parameters: parameters(results, law), text: law.clone(), place, figures };
        blocks.push(Block::Law(Box::new(section)));
    }
    if results.record.laws.len() > MOST_ELEMENTS {
        let words = format!("Pictures of the first {MOST_ELEMENTS} of {} elements.", results.record.laws.len());
        blocks.push(Block::Text(words));
    }
    blocks
}

/// Parameters and inputs; of what is swept, all values.
fn parameters(results: &Results, law: &LawText) -> Table {
    let mut table = Table::new("", &["$", "#value", "unit", "meaning"]);
    let swept = |name: &str| {
        let path = format!("element.{}.{name}", law.name);
        let sweep = results.record.sweeps.iter().find(|sweep| sweep.parameters == [path.as_str()])?;
        let values = labels::values(&sweep.labels);
        let shown: Vec<&str> = values.iter().take(12).map(String::as_str).collect();
        Some(format!("{}{}", shown.join("; "), if values.len() > shown.len() { "; …" } else { "" }))
    };
    for parameter in &law.parameters {
        let value = swept(&parameter.name).unwrap_or_else(|| short(parameter.value));
        let unit = labels::written_unit(&parameter.unit);
        table.rows.push(vec![parameter.name.clone(), value, unit, parameter.meaning.clone()]);
    }
    for input in &law.inputs {
        let value = swept(&input.name)
            .unwrap_or_else(|| written::cut(labels::values(std::slice::from_ref(&input.written)).concat()));
        table.rows.push(vec![input.name.clone(), value, labels::written_unit(&input.unit), "input".to_owned()]);
    }
    if results.record.totals.cases_total > 1 && !table.rows.is_empty() {
        table.note = Some("Where other values are swept: those of the first case.".to_owned());
    }
    table
}

/// Where an element is, in a line.
fn place(element: &Value) -> String {
    let end = |value: &Value| format!("{} {}", written::plain(&value["body"]), written::plain(&value["point"]));
    let mut parts = Vec::new();
    if let Some(joint) = element["joint"].as_str() {
        parts.push(format!("at joint {joint}, rest at {}", written::plain(&element["rest"])));
    } else if element["from"].is_object() {
        let via = element["via"].as_array().into_iter().flatten().map(|point| format!(" via {}", end(point)));
        let via: String = via.collect();
        parts.push(format!("from {}{via} to {}, m", end(&element["from"]), end(&element["to"])));
    }
    if let Some(component) = element["bushing"].as_str() {
        parts.push(format!("component {component} of a bushing"));
    }
    if !element["rest_length"].is_null() {
        parts.push(format!("rest length {} m", written::plain(&element["rest_length"])));
    }
    for (key, usual) in [("derivative", "caputo"), ("scheme", "exact")] {
        if let Some(value) = element[key].as_str().filter(|value| *value != usual) {
            parts.push(format!("{key} {value}"));
        }
    }
    for key in ["past", "shift", "thermal", "heat"] {
        if !element[key].is_null() {
            let rows = written::flat(&element[key]).into_iter().map(|row| row.join(" ").trim().to_owned());
            parts.push(format!("{key}: {}", rows.collect::<Vec<_>>().join(", ")));
        }
    }
    parts.join("; ")
}

/// The robot.
pub(super) fn model(results: &Results) -> Vec<Block> {
    let plan = &results.record.plan;
    let mut words = Vec::new();
    if let Some(file) = plan["urdf"]["file"].as_str() {
        words.push(format!("Robot {} of {file}", written::plain(&plan["urdf"]["robot"])));
    }
    words.push(format!("gravity {} m/s²", written::plain(&plan["gravity"])));
    if plan["gripper"].is_object() {
        let gripper = &plan["gripper"];
        words.push(format!(
            "gripper at {} of {}, m",
            written::plain(&gripper["point"]),
            written::plain(&gripper["body"])
        ));
    }
    let columns = ["body", "#mass, kg", "centre of mass, m", "on", "joint", "kind", "axis", "origin, m"];
    let mut table = Table::new("Bodies", &columns);
    for body in plan["bodies"].as_array().into_iter().flatten() {
        let joint = &body["joint"];
        let shown = [
            &body["name"],
            &body["mass"],
            &body["com"],
            &body["parent"],
            &joint["name"],
            &joint["kind"],
            &joint["axis"],
            &joint["origin"],
        ];
        table.rows.push(shown.iter().map(|value| written::plain(value)).collect());
    }
    vec![Block::Text(format!("{}.", words.join("; "))), Block::Table(table)]
}
