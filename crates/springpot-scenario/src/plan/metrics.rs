//! `[[metric]]`: numbers that say how good a run is.

use crate::keys::METRIC;
use crate::keys::MetricKind;
use crate::plan::Plan;
use crate::reader::constants;
use crate::reader::files::CsvCache;
use crate::reader::files::DescriptionCache;
use crate::reader::named::{checked_name, unique};
use crate::reader::{Context, Field, Read, Refused, Table, all};
use crate::text::document::{Entry, Node, Value, shorten};
use crate::text::names;
use crate::text::refusal::{Place, Refusal, RefusalKind, Refusals, Source};
use crate::units::Unit;
use serde::{Deserialize, Serialize};
use springpot::law::Catalog;
use springpot::system::RowTimes;
use springpot::table::Column;
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// Most of them.
const MAX_METRICS: usize = 1_000;

/// What stands behind the commas of one that is a line.
const BEHIND_COMMAS: [&str; 4] = ["window", "band", "target", "levels"];

/// How far a column may stay from its target, or how large a swing must be to count.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Band {
    /// In the unit of the column.
    Width(f64),
    /// As a share of the way from the first row to the target.
    Share(f64),
}

/// A metric.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Metric {
    /// Its name.
    pub name: String,
    /// The column that it is taken from.
    pub of: String,
    /// What of it.
    pub kind: MetricKind,
    /// Rows with t in between, s; `None`: all of them.
    pub window: Option<[f64; 2]>,
    /// Of kinds that take one; `None`: [`Metric::band`] says what stands for it.
    pub band: Option<Band>,
    /// Where the column is to go; `None`: the last row.
    pub target: Option<f64>,
    /// Of the rise time, between which shares of the way it is; `None`: 0.1 and 0.9.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub levels: Option<[f64; 2]>,
}

/// A metric of a scenario.
#[derive(Debug, Clone, PartialEq)]
pub struct MetricPlan {
    /// The metric.
    pub metric: Metric,
    /// Where it stands.
    pub place: Place,
    /// Where its column stands.
    pub of: Place,
}

/// Reads the metrics of a plan that has all else.
pub(crate) fn read(root: &Table<'_>, plan: &Plan) -> Read<Vec<MetricPlan>> {
    let Some(field) = root.get("metric") else { return Ok(Vec::new()) };
    let items = field.items("an array of tables: [[metric]]")?;
    if items.len() > MAX_METRICS {
        let message = format!("has {} metrics; at most {MAX_METRICS} are taken", items.len());
        return Err(field.refuse(RefusalKind::TooLarge, message, None));
    }
    // What is lost in joints is a column where some case loses it.
    let columns = plan.observables().with_joint_losses().columns();
    let mut seen = HashMap::new();
    all(items.iter().enumerate().map(|(k, item)| {
        let name = item.node.get("name").and_then(|node| node.text());
        let what = name.map_or_else(|| format!("metric {}", k + 1), |name| format!("metric {:?}", shorten(name)));
        let table = Table::of(item.ctx, item.node, what, &METRIC)?;
        let name = table.require("name").and_then(|field| {
            let name = checked_name(&field)?;
            unique(&mut seen, &field, name).map(|()| name.to_owned())
        });
        one(&table, name, &columns, Some(&plan.settings.rows))
    }))
}

/// Reads all but the name of a metric of a run with these columns and, where they are known, rows.
fn one(table: &Table<'_>, name: Read<String>, columns: &[Column], rows: Option<&RowTimes>) -> Read<MetricPlan> {
    let of = table.require("of").and_then(|field| Ok((column(&field, columns)?, field.node.place.clone())));
    let kind = table.require("kind").and_then(|field| field.word("kind of metric"));
    let window = table.get("window").map(|field| window(&field, rows)).transpose();
    let kind = kind.map(|word| MetricKind::named(word).unwrap_or(MetricKind::Final));
    let (kind, (column, of)) = (kind?, of?);
    let takes = [
        ("band", kind.takes_band()),
        ("target", kind.takes_target()),
        ("levels", matches!(kind, MetricKind::RiseTime)),
    ];
    let needless = takes.into_iter().filter(|(_, takes)| !takes).filter_map(|(key, _)| table.get(key));
    let refused: Vec<_> = needless.map(|field| has_no_meaning(&field, kind)).collect();
    if let Some(refused) = refused.into_iter().next() {
        return Err(refused);
    }
    let levels = table.get("levels").map(|field| levels(&field)).transpose()?;
    let band = table.get("band").map(|field| band(&field, column)).transpose();
    let target = table.get("target").map(|field| Ok((in_unit(&field, column)?, field))).transpose();
    let (name, window, band, target) = (name?, window?, band?, target?);
    if let Some((_, field)) = &target
        && !kind.has_target()
        && !matches!(band, Some(Band::Share(_)))
    {
        let message = format!("has no meaning where kind = {:?} and the band is not in %", kind.name());
        return Err(field.refuse(RefusalKind::Rule, message, Some("leave `target` out".to_owned())));
    }
    let target = target.map(|(target, _)| target);
    let metric = Metric { name, of: column.name.clone(), kind, window, band, target, levels };
    Ok(MetricPlan { metric, place: table.node.place.clone(), of })
}

fn has_no_meaning(field: &Field<'_>, kind: MetricKind) -> Refused {
    let message = format!("has no meaning where kind = {:?}", kind.name());
    field.refuse(RefusalKind::Rule, message, Some(format!("leave `{}` out", field.key)))
}

fn column<'c>(field: &Field<'_>, columns: &'c [Column]) -> Read<&'c Column> {
    let text = field.text()?;
    columns.iter().find(|column| column.name == text).ok_or_else(|| {
        let help = names::suggest(text, columns.iter().map(|column| column.name.as_str()));
        field.refuse(RefusalKind::UnknownName, format!("is {:?}, which is no column", shorten(text)), Some(help))
    })
}

fn window(field: &Field<'_>, rows: Option<&RowTimes>) -> Read<[f64; 2]> {
    let items = field.items("an array of two times, [from, to]")?;
    let [from, to] = &items[..] else {
        let message = format!("has {} entries, but must be an array of two times, [from, to]", items.len());
        let help = "write window = [\"2 s\", \"5 s\"]".to_owned();
        return Err(field.refuse(RefusalKind::WrongType, message, Some(help)));
    };
    let times = [from.number("s"), to.number("s")];
    let [from, to] = [times[0]?, times[1]?];
    let runs = format!("runs from {from} s to {to} s");
    if from >= to {
        let message = format!("{runs}, which is no stretch of time");
        return Err(field.refuse(RefusalKind::OutOfRange, message, Some("write the earlier time first".to_owned())));
    }
    match rows {
        Some(rows) if !has_row(rows, [from, to]) => {
            let last = rows.at(rows.count().saturating_sub(1));
            let help = format!("the rows go from {} s to {last} s; choose a window that holds some", rows.at(0));
            Err(field.refuse(RefusalKind::OutOfRange, format!("{runs}, where there is no row"), Some(help)))
        }
        _ => Ok([from, to]),
    }
}

/// Whether a row of a whole run is in a window.
fn has_row(rows: &RowTimes, [from, to]: [f64; 2]) -> bool {
    let slack = 1e-9 * (to - from);
    let (mut low, mut high) = (0, rows.count());
    while low < high {
        let middle = low + (high - low) / 2;
        if rows.at(middle) < from - slack { low = middle + 1 } else { high = middle }
    }
    low < rows.count() && rows.at(low) <= to + slack
}

/// A quantity of the column, or a number in its unit.
fn in_unit(field: &Field<'_>, column: &Column) -> Read<f64> {
    let has_fixed_unit = Unit::parse(&column.unit, &|_| None).is_ok();
    if has_fixed_unit || matches!(field.node.value, Value::Number { .. }) {
        return field.number(&column.unit);
    }
    let help = format!("write a number: it is in {}", column.unit);
    Err(field.refuse(RefusalKind::BadQuantity, format!("is {}, and the unit varies", field.node.written()), Some(help)))
}

/// Two shares of a way, the lower one first.
fn levels(field: &Field<'_>) -> Read<[f64; 2]> {
    let items = field.items("an array of two shares, [from, to]")?;
    let shares = all(items.iter().map(|item| item.number("")))?;
    match shares[..] {
        [from, to] if 0.0 <= from && from < to && to <= 1.0 => Ok([from, to]),
        _ => {
            let message = "must be two shares from 0 to 1 of the way to the target, the lower one first";
            Err(field.refuse(RefusalKind::OutOfRange, message, Some("write levels = [0.1, 0.9]".to_owned())))
        }
    }
}

fn band(field: &Field<'_>, column: &Column) -> Read<Band> {
    field.refuse_affine()?;
    let band = match &field.node.value {
        Value::Text(text) if text.trim_end().ends_with('%') => Band::Share(field.number("")?),
        Value::Table(_) if constants::is_expression(field.node) => match constants::written_expression(field)? {
            (number, Some(unit)) if unit.node.text().is_some_and(|unit| unit.trim() == "%") => {
                Band::Share(number / 100.0)
            }
            _ => Band::Width(in_unit(field, column)?),
        },
        _ => Band::Width(in_unit(field, column)?),
    };
    let (Band::Width(value) | Band::Share(value)) = band;
    if value > 0.0 {
        return Ok(band);
    }
    let help = "write a quantity of the column, or a share such as \"2 %\"".to_owned();
    Err(field.refuse(RefusalKind::OutOfRange, format!("is {}, but must be positive", field.node.label()), Some(help)))
}

impl Metric {
    /// A refusal of the line that [`Self::parse`] reads.
    pub fn refuse(text: &str, option: &str, kind: RefusalKind, message: &str) -> Refusal {
        let source = Arc::new(Source { name: option.to_owned(), text: text.into() });
        Place { source, span: 0..text.len() }.refuse(kind, message)
    }

    /// Reads a metric from one line: `KIND(COLUMN)` or `NAME = KIND(COLUMN)`, and behind commas other keys as a scenario has them:
    /// `settling-time(gripper.error), band = "1 mm", window = ["2 s", "5 s"]`. `option` is what the line is called in refusals, `columns` are
    /// those that there are.
    ///
    /// ```
    /// use springpot::table::Column;
    /// use springpot_scenario::{Metric, MetricKind};
    /// let columns = [Column::new("t", "s", ""), Column::new("gripper.error", "m", "")];
    /// let metric = Metric::parse("settle = settling-time(gripper.error), band = \"1 mm\"", "--metric", &columns)?;
    /// assert_eq!((&*metric.name, metric.kind, &*metric.of), ("settle", MetricKind::SettlingTime, "gripper.error"));
    /// # Ok::<(), springpot_scenario::Refusals>(())
    /// ```
    ///
    /// # Errors
    /// As `[[metric]]` in a scenario.
    pub fn parse(text: &str, option: &str, columns: &[Column]) -> Result<Self, Refusals> {
        let source = Arc::new(Source { name: option.to_owned(), text: text.into() });
        let place = |span| Place { source: source.clone(), span };
        let whole = place(0..text.len());
        let right = "write KIND(COLUMN), as in 'rms(strut.force)' or 'settling-time(gripper.error), band = \"1 mm\"'";
        let misread = |message: &str| -> Refusals { whole.refuse(RefusalKind::Syntax, message).help(right).into() };
        let open = text.find('(').ok_or_else(|| misread("there is no parenthesis"))?;
        let close = open + text[open..].find(')').ok_or_else(|| misread("the parenthesis is never closed"))?;
        let (named, kind_start) = match text[..open].find('=') {
            Some(equals) => (Some(0..equals), equals + 1),
            None => (None, 0),
        };
        let rest = text[close + 1..].trim_start();
        let rest_start = text.len() - rest.len();
        let mut entries = match rest.strip_prefix(',') {
            None if rest.is_empty() => Vec::new(),
            None => return Err(misread("there is something behind the parenthesis")),
            Some(_) => pairs(&source, rest_start)?
                .ok_or_else(|| misread("what stands behind the parenthesis is not KEY = VALUE, …"))?,
        };
        let trimmed = |span: std::ops::Range<usize>| {
            let part = &text[span.clone()];
            let start = span.start + part.len() - part.trim_start().len();
            start..start + part.trim().len()
        };
        let (catalog, tables, robots) = (Catalog::standard(), CsvCache::default(), DescriptionCache::default());
        let ctx = Context::new(&catalog, Path::new(""), &tables, &robots);
        // What else a metric has stands in front of the commas.
        let tail = Node { value: Value::Table(entries.clone()), place: whole.clone(), tag: None };
        let opened = Table::open(&ctx, &tail, option, &BEHIND_COMMAS).map(|_| ());
        let ctx = ctx.going_on(opened)?;
        let called = trimmed(kind_start..close + 1);
        for (key, span) in [
            ("name", trimmed(named.clone().unwrap_or(called.clone()))),
            ("of", trimmed(open + 1..close)),
            ("kind", trimmed(kind_start..open)),
        ] {
            let node =
                Node { value: Value::Text(text[span.clone()].to_owned()), place: place(span.clone()), tag: None };
            entries.insert(0, Entry { key: key.to_owned(), key_place: place(span), node: Arc::new(node) });
        }
        let node = Node { value: Value::Table(entries), place: whole.clone(), tag: None };
        let read = Table::of(&ctx, &node, option, &METRIC).and_then(|table| {
            let name = table.require("name").and_then(|field| match named {
                Some(_) => checked_name(&field).map(str::to_owned),
                None => field.text().map(str::to_owned),
            });
            one(&table, name, columns, None)
        });
        Ok(ctx.finish(read)?.metric)
    }
}

/// The keys and values behind the comma at a byte; `None` where they are no TOML.
fn pairs(source: &Arc<Source>, comma: usize) -> Result<Option<Vec<Entry>>, Refusals> {
    // The comma becomes a brace, so that all places stay.
    let braced = format!("{}{{{}}}", &source.text[..comma], &source.text[comma + 1..]);
    let range = comma..braced.len();
    let node = Node::value(&Arc::new(Source { name: source.name.clone(), text: braced.into() }), range);
    let as_written = |refusal: Refusal| Refusal { text: source.text.clone(), ..refusal };
    let node = node.map_err(|refusals| Refusals::of(refusals.into_iter().map(as_written).collect()))?;
    Ok(node.and_then(|node| match node.moved_to(source).value {
        Value::Table(entries) => Some(entries),
        _ => None,
    }))
}
