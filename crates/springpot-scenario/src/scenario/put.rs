//! A scenario as a text with other values put in, everything else as it is written.

use super::Scenario;
use super::root::SCENARIO;
use crate::changes::path::{self, Step};
use crate::reader::Context;
use crate::reader::files::{CsvCache, DescriptionCache};
use crate::text::document::{Node, Value};
use crate::text::quoted::{toml_key, toml_text};
use springpot::law::Catalog;
use std::cmp::Reverse;
use std::ops::Range;

impl Scenario {
    /// The text with the values that were set put in; comments stay. A key that is taken out stays too, and what finds no place is told in a comment at
    /// its end.
    pub fn with_values(&self, catalog: &Catalog) -> String {
        let (tables, robots) = (CsvCache::default(), DescriptionCache::default());
        let ctx = Context::new(catalog, &self.folder, &tables, &robots).of_whole(&SCENARIO);
        let mut edits = Edits::default();
        for set in &self.overrides {
            let target = path::resolve(&ctx, &self.document, &set.path, &set.place).ok();
            match target.zip(set.value.as_ref()) {
                Some((target, value)) => edits.put(&self.document, &target.steps, written(value), &set.path),
                None => edits.lose(&set.path),
            }
        }
        edits.applied(&self.source.text, "was set, and has")
    }
}

/// A value of the command line as it stands in a file.
pub(crate) fn written(value: &Node) -> String {
    match &value.value {
        Value::Text(text) => toml_text(text),
        _ => value.place.text().to_owned(),
    }
}

/// What is put into the text of a scenario.
#[derive(Debug, Default)]
pub(crate) struct Edits {
    /// What takes the place of stretches of the text.
    spans: Vec<(Range<usize>, String)>,
    /// What finds no place in it.
    lost: Vec<String>,
}

impl Edits {
    /// Puts a text where steps lead, to what is called `name`.
    pub(crate) fn put(&mut self, document: &Node, steps: &[Step], text: String, name: &str) {
        let Some((span, line)) = place(document, steps, &text) else { return self.lose(name) };
        // Another component of three numbers that are put in already.
        let own = path::component(&steps[steps.len().saturating_sub(2)..]).and_then(|(_, component)| {
            let (before, numbers) = line.split_once('[')?;
            let inserted = |(at, other): &(Range<usize>, String)| *at == span && other.starts_with(before);
            let known = self.spans.iter().position(inserted)?;
            let mut all: Vec<String> =
                numbers.trim_end().trim_end_matches(']').split(", ").map(str::to_owned).collect();
            let other = self.spans[known].1.split_once('[')?.1;
            let other: Vec<&str> = other.trim_end().trim_end_matches(']').split(", ").collect();
            (0..3).filter(|k| *k != component).for_each(|k| all[k] = other[k].to_owned());
            Some((known, format!("{before}[{}]", all.join(", "))))
        });
        match own {
            Some((known, line)) => self.spans[known].1 = line,
            None => self.spans.push((span, line)),
        }
    }

    fn lose(&mut self, name: &str) {
        self.lost.push(name.to_owned());
    }

    /// The text with all of it; what found no place is told in comments at its end, that it `has` none.
    pub(crate) fn applied(self, text: &str, has: &str) -> String {
        let Self { spans, lost } = self;
        let mut text = text.to_owned();
        // From the end, so that places before stay; of insertions at one place the first comes first.
        let mut order: Vec<usize> = (0..spans.len()).collect();
        order.sort_by_key(|k| (Reverse(spans[*k].0.start), Reverse(*k)));
        for k in order {
            let (span, with) = &spans[k];
            text.replace_range(span.clone(), with);
        }
        for name in lost {
            text.push_str(&format!("# {name} {has} no place in this file\n"));
        }
        text
    }
}

/// What is written where for a text where steps lead; `None` where there is no place for it.
fn place(document: &Node, steps: &[Step], text: &str) -> Option<(Range<usize>, String)> {
    let mut node = document;
    for (at, step) in steps.iter().enumerate() {
        let next = match (step, &node.value) {
            (Step::Index(k), Value::Array(items)) => items.get(*k).map(|item| &**item),
            (Step::Key(key), Value::Table(_)) => node.get(key).map(|node| &**node),
            _ => None,
        };
        let Some(next) = next else { return insertion(node, &steps[at..], text) };
        node = next;
    }
    Some((node.place.span.clone(), text.to_owned()))
}

/// The same of keys that are not yet in a table.
fn insertion(table: &Node, rest: &[Step], text: &str) -> Option<(Range<usize>, String)> {
    let key = |step: &Step| match step {
        Step::Key(key) => Some(toml_key(key)),
        Step::Index(_) => None,
    };
    let keys: Vec<String> = rest.iter().map(key).collect::<Option<_>>()?;
    let line = match path::component(rest) {
        Some((vector, component)) => {
            let mut numbers = vector.map(|number| format!("{number:?}"));
            numbers[component] = text.to_owned();
            format!("{} = [{}]", keys[0], numbers.join(", "))
        }
        None => format!("{} = {text}", keys.join(".")),
    };
    let (source, span, entries) = (&table.place.source.text, &table.place.span, table.entries()?);
    if source.get(span.clone()).is_some_and(|own| own.starts_with('{') && own.ends_with('}')) {
        return Some(match entries.last() {
            Some(last) => (last.node.place.span.end..last.node.place.span.end, format!(", {line}")),
            None => (span.start + 1..span.start + 1, format!(" {line} ")),
        });
    }
    // Behind the last of its entries that stands in the lines below its header.
    let is_line = |node: &Node| match &node.value {
        Value::Table(_) => node.place.text().starts_with('{'),
        // Of [[tables]] each stands below a header of its own.
        Value::Array(items) => items.iter().all(|item| item.entries().is_none() || item.place.text().starts_with('{')),
        _ => true,
    };
    let ends = entries.iter().filter(|entry| is_line(&entry.node)).map(|entry| entry.node.place.span.end);
    let last = ends.max()?;
    let end = source[last..].find('\n').map_or(source.len(), |at| last + at);
    Some((end..end, format!("\n{line}")))
}
