//! A scenario as a text with what was set put in, everything else as it is written.

use super::Scenario;
use super::root::SCENARIO;
use crate::changes::path::{self, Step};
use crate::reader::Context;
use crate::reader::files::{CsvCache, UrdfCache};
use crate::text::document::{Node, Value};
use crate::text::quoted::{toml_key, toml_text};
use springpot::law::Catalog;
use std::cmp::Reverse;
use std::ops::Range;

/// What takes the place of a stretch of the text.
type Edit = (Range<usize>, String);

impl Scenario {
    /// The text with the values that were set put in; comments stay. A key that is taken out stays too, and what finds no place is told in a comment at
    /// its end.
    pub fn with_values(&self, catalog: &Catalog) -> String {
        let (tables, robots) = (CsvCache::default(), UrdfCache::default());
        let ctx = Context::new(catalog, &self.folder, &tables, &robots).of_whole(&SCENARIO);
        let (mut edits, mut lost): (Vec<Edit>, Vec<&str>) = Default::default();
        for set in &self.overrides {
            let target = path::resolve(&ctx, &self.document, &set.path, &set.place).ok();
            let done = target.zip(set.value.as_ref()).and_then(|(target, value)| {
                let text = match &value.value {
                    Value::Text(text) => toml_text(text),
                    _ => value.place.text().to_owned(),
                };
                put(&self.document, &target.steps, text, &mut edits)
            });
            if done.is_none() {
                lost.push(&set.path);
            }
        }
        let mut text = self.source.text.to_string();
        // From the end, so that places before stay; of insertions at one place the first comes first.
        let mut order: Vec<usize> = (0..edits.len()).collect();
        order.sort_by_key(|k| (Reverse(edits[*k].0.start), Reverse(*k)));
        for k in order {
            let (span, with) = &edits[k];
            text.replace_range(span.clone(), with);
        }
        for name in lost {
            text.push_str(&format!("# {name} was set, and has no place in this file\n"));
        }
        text
    }
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
    let key = |step: &Step| match step {
        Step::Key(key) => Some(toml_key(key)),
        Step::Index(_) => None,
    };
    let keys: Vec<String> = rest.iter().map(key).collect::<Option<_>>()?;
    let line = format!("{} = {text}", keys.join("."));
    let (source, span, entries) = (&table.place.source.text, &table.place.span, table.entries()?);
    if source.get(span.clone()).is_some_and(|own| own.starts_with('{') && own.ends_with('}')) {
        edits.push(match entries.last() {
            Some(last) => (last.node.place.span.end..last.node.place.span.end, format!(", {line}")),
            None => (span.start + 1..span.start + 1, format!(" {line} ")),
        });
        return Some(());
    }
    // Behind the last of its entries that stands in the lines below its header.
    let is_line = |node: &Node| !matches!(node.value, Value::Table(_)) || node.place.text().starts_with('{');
    let ends = entries.iter().filter(|entry| is_line(&entry.node)).map(|entry| entry.node.place.span.end);
    let last = ends.max()?;
    let end = source[last..].find('\n').map_or(source.len(), |at| last + at);
    edits.push((end..end, format!("\n{line}")));
    Some(())
}
