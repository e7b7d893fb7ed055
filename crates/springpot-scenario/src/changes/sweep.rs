//! `[[sweep]]`: which parameters move, and through which values.

use crate::changes::path::{self, Target};
use crate::keys::{MAX_BLOCKS, MAX_CASES, MAX_TOGETHER, SPAN, SWEEP};
use crate::reader::spacing::Spacing;
use crate::reader::{Field, Read, Table, all};
use crate::text::document::{Node, Value, shorten, shortest, whole};
use crate::text::names;
use crate::text::refusal::{Place, RefusalKind, Remark, SWEEP_OPTION};
use crate::units;
use std::collections::HashMap;
use std::sync::Arc;

/// One `[[sweep]]`: parameters that move together, and their values.
#[derive(Debug, Clone)]
pub(crate) struct Axis {
    pub(crate) targets: Vec<Target>,
    pub(crate) values: Values,
    /// What its values are called, where the file says so.
    pub(crate) names: Option<Vec<String>>,
    pub(crate) place: Place,
}

/// The values of a sweep.
#[derive(Debug, Clone)]
pub(crate) enum Values {
    /// What all parameters take.
    List(Vec<Arc<Node>>),
    /// What each of them takes, value by value.
    Zipped(Vec<Vec<Arc<Node>>>),
    Span(Span),
}

/// Values from one number to another.
#[derive(Debug, Clone)]
pub(crate) struct Span {
    numbers: Spacing,
    /// Unit behind every number; empty for plain numbers.
    unit: String,
    place: Place,
}

impl Axis {
    pub(crate) fn len(&self) -> usize {
        match &self.values {
            Values::List(list) => list.len(),
            Values::Zipped(rows) => rows.len(),
            Values::Span(span) => span.numbers.count,
        }
    }

    /// What is to be said of a span of the command line that could mean from, step and end as well: FROM:TO:COUNT where the step goes from
    /// FROM to COUNT in fewer steps than values are asked for.
    pub(crate) fn read_otherwise(&self) -> Option<Remark> {
        let Values::Span(span) = &self.values else { return None };
        if span.place.source.name != SWEEP_OPTION {
            return None;
        }
        let ends: Vec<i64> = span.place.text().split(':').map(|end| end.trim().parse().ok()).collect::<Option<_>>()?;
        let [from, step, end] = ends[..] else { return None };
        let distance = end.checked_sub(from)?;
        let steps = (step != 0 && distance % step == 0).then(|| distance / step)?;
        if !(1..end).contains(&steps) {
            return None;
        }
        let values = shown(self.len(), |k| self.label(k));
        let path = self.targets.first().map_or("", |target| target.written.as_str());
        let message = format!("{path}={} is {} values from {from} to {step}: {values}", span.place.text(), self.len());
        let number = |k: usize| (from + step * i64::try_from(k).unwrap_or(0)).to_string();
        let stepped = shown(usize::try_from(steps).unwrap_or(0) + 1, number);
        let help = format!("it is FROM:TO:COUNT[:log]; for {stepped} write {path}={from}:{end}:{}", steps + 1);
        Some(Remark::at(&span.place, message).help(help))
    }

    /// Value `k` of the parameter `at` as a node that carries `tag`.
    pub(crate) fn node(&self, k: usize, at: usize, tag: usize) -> Node {
        match &self.values {
            Values::List(list) => Node { tag: Some(tag), ..Node::clone(&list[k]) },
            Values::Zipped(rows) => Node { tag: Some(tag), ..Node::clone(&rows[k][at]) },
            Values::Span(span) => {
                let number = span.numbers.number(k);
                let value = if span.unit.is_empty() {
                    Value::Number { value: number, integer: whole(number) }
                } else {
                    Value::Text(format!("{} {}", shortest(number), span.unit))
                };
                Node { value, place: span.place.clone(), tag: Some(tag) }
            }
        }
    }

    /// Index of every name, and of every label of a list that the parameter `at` takes, for looking up many; names come first.
    pub(crate) fn labels(&self, at: usize) -> HashMap<String, usize> {
        let mut labels: HashMap<String, usize> = match &self.values {
            Values::List(list) => list.iter().enumerate().rev().map(|(k, node)| (node.label(), k)).collect(),
            Values::Zipped(rows) => rows.iter().enumerate().rev().map(|(k, row)| (row[at].label(), k)).collect(),
            Values::Span(_) => HashMap::new(),
        };
        labels.extend(self.names.iter().flatten().enumerate().map(|(k, name)| (name.clone(), k)));
        labels
    }

    /// Index of a number or quantity that is written like the ends of a span.
    pub(crate) fn index_in_span(&self, node: &Node) -> Option<usize> {
        let Values::Span(span) = &self.values else { return None };
        match &node.value {
            Value::Number { value, .. } if span.unit.is_empty() => span.numbers.index(*value),
            Value::Text(text) => {
                let (number, unit) = units::split_quantity(text)?;
                let number = units::parse_quantity(number, "", &|_| None).ok()?;
                (unit == span.unit).then(|| span.numbers.index(number)).flatten()
            }
            _ => None,
        }
    }

    /// Value `k` for a legend: its name, else as written; of parameters that take their own, all of them.
    pub(crate) fn label(&self, k: usize) -> String {
        if let Some(names) = &self.names {
            return names[k].clone();
        }
        match &self.values {
            Values::Zipped(rows) => rows[k].iter().map(|node| node.label()).collect::<Vec<_>>().join(", "),
            _ => self.label_of(k, 0),
        }
    }

    /// Value `k` of the parameter `at`, as written.
    pub(crate) fn label_of(&self, k: usize, at: usize) -> String {
        match &self.values {
            Values::List(list) => list[k].label(),
            Values::Zipped(rows) => rows[k][at].label(),
            Values::Span(span) if span.unit.is_empty() => shortest(span.numbers.number(k)),
            Values::Span(span) => format!("{} {}", shortest(span.numbers.number(k)), span.unit),
        }
    }
}

/// Values in a row; of many the first ones and the last.
fn shown(len: usize, value: impl Fn(usize) -> String) -> String {
    const SHOWN: usize = 8;
    let all = |range: std::ops::Range<usize>| range.map(&value).collect::<Vec<_>>().join(", ");
    if len <= SHOWN { all(0..len) } else { format!("{}, …, {}", all(0..3), value(len - 1)) }
}

/// Reads every `[[sweep]]`. The first block is the outer loop of the grid, the last runs fastest.
pub(crate) fn read(root: &Table<'_>) -> Read<Vec<Axis>> {
    let Some(field) = root.get("sweep") else { return Ok(Vec::new()) };
    let items = field.items("an array of tables: [[sweep]]")?;
    if items.len() > MAX_BLOCKS {
        let message = format!("holds {} blocks; at most {MAX_BLOCKS} are taken", items.len());
        return Err(field.refuse(RefusalKind::TooLarge, message, None));
    }
    let axes = all(items.iter().enumerate().map(|(i, item)| axis(root, item, i)))?;
    let targets: Vec<&Target> = axes.iter().flat_map(|axis| &axis.targets).collect();
    for (i, target) in targets.iter().enumerate() {
        if let Some(earlier) = targets[..i].iter().find(|earlier| earlier.overlaps(target)) {
            let message = format!(
                "{} is swept together with {} on line {}",
                target.written,
                earlier.written,
                earlier.place.position().0
            );
            let refusal = target.place.refuse(RefusalKind::Rule, message);
            return Err(root.ctx.refuse(refusal.help("a parameter is swept once")));
        }
    }
    let count = axes.iter().try_fold(1usize, |count, axis| count.checked_mul(axis.len()));
    if count.is_none_or(|count| count > MAX_CASES) {
        let exact = axes.iter().map(|axis| axis.len() as f64).product::<f64>();
        let shown = count.map_or_else(|| format!("{exact:.3e}"), |count| count.to_string());
        let message = format!("the sweeps make a grid of {shown} cases; at most {MAX_CASES} are run");
        let refusal = axes[axes.len() - 1].place.refuse(RefusalKind::TooLarge, message);
        return Err(root.ctx.refuse(refusal.label("grid too large").help("sweep fewer values")));
    }
    Ok(axes)
}

fn axis(root: &Table<'_>, item: &Field<'_>, i: usize) -> Read<Axis> {
    let direct = |key: &str| {
        SPAN.get(key).is_some().then(|| {
            let why = format!("`{key}` stands in the values: write values = {{ from = …, to = …, count = … }}");
            (RefusalKind::UnknownKey, why)
        })
    };
    let what = format!("[[sweep]] {}", i + 1);
    let table = Table::of_kind(item.ctx, item.node, what, (&SWEEP, ""), direct)?;
    let targets = table.require("parameter").and_then(|field| targets(&field, root.node));
    let values_field = table.require("values");
    let values = values_field.as_ref().map_err(|refused| *refused).and_then(values);
    let (targets, values) = (targets?, values?);
    let values = zipped(values, targets.len(), &values_field?)?;
    let mut axis = Axis { values, targets, names: None, place: item.node.place.clone() };
    axis.names = table.get("names").map(|field| names(&field, axis.len())).transpose()?;
    Ok(axis)
}

/// A name for each of `count` values.
fn names(field: &Field<'_>, count: usize) -> Read<Vec<String>> {
    let items = field.items("an array of texts, one for each value")?;
    if items.len() != count {
        let message = format!("holds {} names for {count} values", items.len());
        return Err(field.refuse(RefusalKind::Rule, message, Some("write one for each value".to_owned())));
    }
    let mut seen: HashMap<&str, usize> = HashMap::new();
    all(items.iter().enumerate().map(|(k, item)| {
        let name = item.text()?;
        let right = || Some("write a short text that tells the value from the others".to_owned());
        if name.trim() != name || name.is_empty() || name.chars().any(char::is_control) {
            let message = format!("holds {name:?}, which is no name: it is empty, or begins or ends with a blank");
            return Err(item.refuse(RefusalKind::BadName, message, right()));
        }
        if let Some(earlier) = seen.insert(name, k) {
            let message = format!("calls values {} and {} alike: {:?}", earlier + 1, k + 1, shorten(name));
            return Err(item.refuse(RefusalKind::BadName, message, right()));
        }
        Ok(name.to_owned())
    }))
}

fn targets(field: &Field<'_>, document: &Node) -> Read<Vec<Target>> {
    let fields = match &field.node.value {
        Value::Text(_) => vec![field.clone()],
        _ => field.items("a path or an array of paths")?,
    };
    if fields.is_empty() || fields.len() > MAX_TOGETHER {
        let message = format!("holds {} paths", fields.len());
        return Err(field.refuse(RefusalKind::OutOfRange, message, Some(format!("write 1 to {MAX_TOGETHER} paths"))));
    }
    all(fields.iter().map(|field| {
        let target = path::resolve(field.ctx, document, field.text()?, &field.node.place)?;
        match target.ends() {
            ("sweep" | "figure" | "output" | "title" | "parameter" | "sensitivity" | "design", _)
            | ("robot" | "element" | "metric", "name") => {
                let message = format!("is {:?}, which cannot be swept", shorten(&target.written));
                let help = "names, figures and outputs are the same in every case".to_owned();
                Err(field.refuse(RefusalKind::Rule, message, Some(help)))
            }
            ("constants", name) if path::get(document, &target).is_none() => {
                let known = document.get("constants").and_then(|constants| constants.entries()).unwrap_or_default();
                let message =
                    format!("is {:?}, but there is no constant `{}`", shorten(&target.written), shorten(name));
                let help = match known.is_empty() {
                    true => format!("write it into the file, [constants] {name} = …, and use it there"),
                    false => names::suggest(name, known.iter().map(|entry| entry.key.as_str())),
                };
                Err(field.refuse(RefusalKind::UnknownName, message, Some(help)))
            }
            _ => Ok(target),
        }
    }))
}

/// Arrays as long as there are parameters give each of them its own value.
fn zipped(values: Values, count: usize, field: &Field<'_>) -> Read<Values> {
    let Values::List(items) = &values else { return Ok(values) };
    let row = |item: &Arc<Node>| item.items().filter(|row| row.len() == count).map(<[_]>::to_vec);
    if count == 1 || !items.iter().any(|item| row(item).is_some()) {
        return Ok(values);
    }
    let rows = items.iter().map(|item| {
        row(item).ok_or_else(|| {
            let item = field.item(item);
            let message = format!("holds {} beside values for each of {count} parameters", item.node.written());
            item.refuse(RefusalKind::Rule, message, Some(format!("write {count} values in each pair of brackets")))
        })
    });
    all(rows.collect::<Vec<_>>()).map(Values::Zipped)
}

fn values(field: &Field<'_>) -> Read<Values> {
    if field.node.entries().is_some() {
        return span(field).map(Values::Span);
    }
    let Some(items) = field.node.items() else {
        return Err(field.wrong_type("an array or a table with from, to, count"));
    };
    if items.is_empty() {
        return Err(field.refuse(RefusalKind::Missing, "is empty", Some("write at least one value".to_owned())));
    }
    for item in items {
        if let Value::Number { value, .. } = item.value
            && !value.is_finite()
        {
            let field = field.item(item);
            let message = format!("holds {}, not a finite number", item.label());
            return Err(field.refuse(RefusalKind::OutOfRange, message, Some("write finite numbers".to_owned())));
        }
    }
    Ok(Values::List(items.to_vec()))
}

fn span(field: &Field<'_>) -> Read<Span> {
    let table = field.table(&SPAN)?;
    let end = |key| table.require(key).and_then(|field| end_of_span(&field));
    let ends = (|ends: [Read<(f64, String)>; 2]| {
        let [from, to] = ends;
        let ((from, unit), (to, to_unit)) = (from?, to?);
        if unit != to_unit {
            let message = format!("has a `from` in {} and a `to` in {}", unit_name(&unit), unit_name(&to_unit));
            return Err(field.refuse(RefusalKind::Rule, message, Some("write both ends in one unit".to_owned())));
        }
        Ok(([from, to], unit))
    })([end("from"), end("to")]);
    let (numbers, unit) = Spacing::read(field, &table, ends)?;
    Ok(Span { numbers, unit, place: field.node.place.clone() })
}

fn unit_name(unit: &str) -> &str {
    if unit.is_empty() { "plain numbers" } else { unit }
}

/// The number and the unit of an end.
fn end_of_span(field: &Field<'_>) -> Read<(f64, String)> {
    let (number, unit) = match &field.node.value {
        Value::Number { value, .. } => (*value, String::new()),
        Value::Text(text) => match units::split_quantity(text) {
            Some((number, unit)) => (units::parse_quantity(number, "", &|_| None).unwrap_or(f64::NAN), unit.to_owned()),
            None => return Err(field.wrong_type("a number or a quantity")),
        },
        _ => return Err(field.wrong_type("a number or a quantity")),
    };
    if number.is_finite() {
        return Ok((number, unit));
    }
    let message = format!("is {}, not a finite number", field.node.label());
    Err(field.refuse(RefusalKind::OutOfRange, message, Some("write finite ends".to_owned())))
}
