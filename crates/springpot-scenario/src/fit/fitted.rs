//! The scenario with other numbers, everything else as it is written.

use super::Fitting;
use super::plan::{FitParameter, Role};
use crate::changes::path::{self, Step};
use crate::text::document::{Node, Value};
use crate::text::quoted::{toml_key, toml_text};
use std::ops::Range;

/// What takes the place of a stretch of the text.
type Edit = (Range<usize>, String);

impl Fitting {
    /// The text of the scenario with what `--set` said and these values of the parameters put in; comments stay. Parameters of one record go into its
    /// `set`.
    pub fn fitted(&self, values: &[f64]) -> String {
        let scenario = &self.scenario;
        let mut edits: Vec<Edit> = Vec::new();
        let mut lost = Vec::new();
        let parameters: Vec<(&[Step], String, &str)> = self.global(values).collect();
        for one in &scenario.overrides {
            let ctx = self.context();
            let Ok(target) = path::resolve(&ctx, &scenario.document, &one.path, &one.place) else { continue };
            let is_sought = parameters.iter().any(|(steps, ..)| *steps == target.steps.as_slice());
            let Some(value) = one.value.as_ref().filter(|_| !is_sought) else { continue };
            let text = match &value.value {
                Value::Text(text) => toml_text(text),
                _ => value.place.text().to_owned(),
            };
            put(&scenario.document, &target.steps, text, &mut edits).unwrap_or_else(|| lost.push(one.path.clone()));
        }
        for (steps, text, written) in parameters {
            put(&scenario.document, steps, text, &mut edits).unwrap_or_else(|| lost.push(written.to_owned()));
        }
        for record in 0..self.plan.data.len() {
            let is_own = |parameter: &FitParameter| parameter.role == Role::Number { record: Some(record) };
            let own = self.plan.parameters.iter().zip(values).filter(|(parameter, _)| is_own(parameter));
            let own: Vec<(&str, String)> =
                own.map(|(parameter, value)| (&*parameter.paths[0], quantity(*value, &parameter.unit))).collect();
            let table = |key: &str| Step::Key(key.to_owned());
            let steps = [table("data"), Step::Index(record), table("set")];
            let data = scenario.document.get("data").and_then(|data| data.items()?.get(record).cloned());
            if data.is_some_and(|data| data.get("set").is_none()) && !own.is_empty() {
                let entries = own.iter().map(|(path, text)| format!("{} = {text}", toml_key(path)));
                let text = format!("{{ {} }}", entries.collect::<Vec<_>>().join(", "));
                put(&scenario.document, &steps, text, &mut edits).unwrap_or_else(|| lost.push("set".to_owned()));
                continue;
            }
            for (path, text) in own {
                let steps: Vec<Step> = steps.iter().cloned().chain([table(path)]).collect();
                put(&scenario.document, &steps, text, &mut edits).unwrap_or_else(|| lost.push(path.to_owned()));
            }
        }
        let mut text = scenario.source.text.to_string();
        // From the end, so that places before stay; of insertions at one place the first comes first.
        let mut order: Vec<usize> = (0..edits.len()).collect();
        order.sort_by_key(|k| (std::cmp::Reverse(edits[*k].0.start), std::cmp::Reverse(*k)));
        for k in order {
            let (span, with) = &edits[k];
            text.replace_range(span.clone(), with);
        }
        for name in lost {
            text.push_str(&format!("# {name} has no place in this file\n"));
        }
        text
    }

    /// Where the numbers of all records stand, as they are to be written, and their paths.
    fn global(&self, values: &[f64]) -> impl Iterator<Item = (&[Step], String, &str)> {
        let all = &self.records[0].asked.by;
        let sought = self.plan.parameters.iter().zip(values).zip(all);
        let sought = sought.filter(|((parameter, _), _)| parameter.role == Role::Number { record: None });
        sought.flat_map(move |((parameter, value), by)| {
            by.targets.iter().map(move |target| {
                let is_text = path::get(&self.scenario.document, target).is_some_and(|node| node.text().is_some());
                let text = if is_text { quantity(*value, &parameter.unit) } else { number(*value) };
                (target.steps.as_slice(), text, target.written.as_str())
            })
        })
    }
}

/// A number as TOML has it.
fn number(value: f64) -> String {
    format!("{value:?}")
}

fn quantity(value: f64, unit: &str) -> String {
    if unit.is_empty() { number(value) } else { toml_text(&format!("{value:?} {unit}")) }
}

/// Puts a text where steps lead; `None` where there is no place for it.
fn put(document: &Node, steps: &[Step], text: String, edits: &mut Vec<Edit>) -> Option<()> {
    let mut node = document;
    for (at, step) in steps.iter().enumerate() {
        let next = match (step, &node.value) {
            (Step::Index(k), Value::Array(items)) => items.get(*k).map(|item| &**item),
            (Step::Key(key), Value::Table(_)) => node.get(key).map(|node| &**node),
            _ => None,
        };
        let Some(next) = next else { return insert(node, &steps[at..], &text, edits) };
        node = next;
    }
    edits.push((node.place.span.clone(), text));
    Some(())
}

/// Writes keys that are not there into a table.
fn insert(table: &Node, rest: &[Step], text: &str, edits: &mut Vec<Edit>) -> Option<()> {
    let keys: Option<Vec<String>> = rest
        .iter()
        .map(|step| match step {
            Step::Key(key) => Some(toml_key(key)),
            Step::Index(_) => None,
        })
        .collect();
    let source = &table.place.source.text;
    let span = &table.place.span;
    let is_inline = source.get(span.clone()).is_some_and(|own| own.starts_with('{') && own.ends_with('}'));
    let entries = table.entries()?;
    if is_inline {
        let line = format!("{} = {text}", keys?.join("."));
        let (at, line) = match entries.last() {
            Some(last) => (last.node.place.span.end, format!(", {line}")),
            None => (span.start + 1, format!(" {line} ")),
        };
        edits.push((at..at, line));
        return Some(());
    }
    let line = format!("{} = {text}", keys?.join("."));
    // Behind the last of its entries that stands in the lines below its header.
    let last = entries
        .iter()
        .filter(|entry| !matches!(&entry.node.value, Value::Table(_)) || entry.node.place.text().starts_with('{'));
    let last = last.map(|entry| entry.node.place.span.end).max()?;
    let end = source[last..].find('\n').map_or(source.len(), |at| last + at);
    edits.push((end..end, format!("\n{line}")));
    Some(())
}
