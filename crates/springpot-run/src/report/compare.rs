//! How two results differ.

use super::curves::{self, Asked, Read};
use super::{facts, standard, warnings, written};
use crate::labels;
use crate::numbers::{brief, rough, short};
use crate::panels::DrawnCase;
use crate::record::Listed;
use crate::results::{Results, ResultsError};
use crate::sweep::KeptCurve;
use serde_json::Value;
use springpot_report::page::{Block, Figure, Report, Section, Table};
use std::collections::{BTreeMap, HashMap};

/// Numbers of a case that are held in memory.
const MOST_NUMBERS: usize = 20_000_000;
/// Metrics that are listed.
const MOST_METRICS: usize = 300;
/// Differences of the scenarios that are listed.
const MOST_LISTED: usize = 300;

/// A case of each result that are set side by side: their places among the cases with rows.
struct Pair {
    places: [usize; 2],
    name: String,
}

/// The report of how `b` differs from `a`.
///
/// Rows are those of the first case that both have with the same swept values, or else of the first of each; of rows at different times, those of `b` are taken as straight lines
/// between them.
///
/// # Errors
/// The results cannot be read.
pub fn comparison(a: &Results, b: &Results) -> Result<Report, ResultsError> {
    let names = names(a, b);
    let pair = pair(a, b);
    let mut sections =
        vec![Section { title: "In short".to_owned(), blocks: vec![Block::Table(in_short([a, b], &names))] }];
    let mut add = |title: &str, blocks: Vec<Block>| {
        if !blocks.is_empty() {
            sections.push(Section { title: title.to_owned(), blocks });
        }
    };
    let [of_a, of_b] = [a, b].map(warnings);
    let both = of_a.iter().filter(|one| of_b.contains(one)).map(|one| format!("both: {one}"));
    let only_a = of_a.iter().filter(|one| !of_b.contains(one)).map(|one| format!("{}: {one}", names[0]));
    let only_b = of_b.iter().filter(|one| !of_a.contains(one)).map(|one| format!("{}: {one}", names[1]));
    let told: Vec<String> = both.chain(only_a).chain(only_b).collect();
    add("Warnings", if told.is_empty() { Vec::new() } else { vec![Block::Warnings(told)] });
    add("What was run otherwise", otherwise([a, b], &names));
    add("Metrics", metrics([a, b], &names).map(Block::Table).into_iter().collect());
    add("Figures", figures([a, b], &names, &pair)?);
    add("Columns", columns([a, b], &names, &pair)?);
    Ok(Report {
        title: format!("{} and {}", names[0], names[1]),
        subject: "two results compared".to_owned(),
        status: String::new(),
        version: b.record.version().to_owned(),
        sections,
    })
}

/// What the two are called: their folders, whole where the last names are one.
fn names(a: &Results, b: &Results) -> [String; 2] {
    let (short, whole) = ([a.name(), b.name()], [a, b].map(|results| results.folder.display().to_string()));
    if short[0] == short[1] { whole } else { short }
}

fn pair(a: &Results, b: &Results) -> Pair {
    let (of_a, of_b) = (a.record.with_rows(), b.record.with_rows());
    let same = |case: &Listed, other: &Listed| case.parameters == other.parameters;
    let found = of_a.iter().enumerate().find_map(|(at, case)| {
        let other = of_b.iter().position(|other| same(case, other))?;
        Some((at, other, a.record.case_name(case)))
    });
    match found {
        Some((at, other, name)) => Pair { places: [at, other], name },
        None => {
            let name = |results: &Results, cases: &[&Listed]| {
                cases.first().map_or(String::new(), |case| results.record.case_name(case))
            };
            let names = [name(a, &of_a), name(b, &of_b)];
            Pair {
                places: [0, 0],
                name: names.iter().filter(|name| !name.is_empty()).cloned().collect::<Vec<_>>().join(" beside "),
            }
        }
    }
}

fn in_short(results: [&Results; 2], names: &[String; 2]) -> Table {
    let mut table = Table::new("", &["", &names[0], &names[1]]);
    let [of_a, of_b] = results.map(facts);
    let title = results.map(|results| results.record.title.clone().unwrap_or_default());
    table.rows.push([vec!["title".to_owned()], title.to_vec()].concat());
    table.rows.push(vec!["status".to_owned(), results[0].record.status.clone(), results[1].record.status.clone()]);
    table.rows.push(vec![
        "Springpot".to_owned(),
        results[0].record.version().to_owned(),
        results[1].record.version().to_owned(),
    ]);
    for (name, value) in of_a {
        let other = of_b.iter().find(|(other, _)| *other == name).map_or("–", |(_, value)| value);
        table.rows.push(vec![name.to_owned(), value, other.to_owned()]);
    }
    table
}

/// Keys of the first cases, as resolved, whose values differ, and what is swept.
fn otherwise(results: [&Results; 2], names: &[String; 2]) -> Vec<Block> {
    let [a, b] = results.map(|results| {
        let mut keys = BTreeMap::new();
        written::visit(&results.record.plan, &mut String::new(), &mut |path, value| {
            // Figures and titles change no number.
            if !path.starts_with("figures.") && path != "title" {
                keys.insert(path.to_owned(), value.clone());
            }
        });
        for sweep in &results.record.sweeps {
            keys.insert(format!("sweep of {}", sweep.parameters.join(", ")), Value::String(sweep.labels.join("; ")));
        }
        keys
    });
    let mut paths: Vec<&String> = a.keys().chain(b.keys()).collect();
    paths.sort_unstable();
    paths.dedup();
    let differing: Vec<&String> = paths.into_iter().filter(|path| a.get(*path) != b.get(*path)).collect();
    if differing.is_empty() {
        return vec![Block::Text("Nothing: both were run from the same values.".to_owned())];
    }
    let mut table = Table::new("", &["key", &names[0], &names[1]]);
    let shown = |value: Option<&Value>| value.map_or_else(|| "–".to_owned(), written::plain);
    for path in differing.iter().take(MOST_LISTED) {
        table.rows.push(vec![(*path).clone(), shown(a.get(*path)), shown(b.get(*path))]);
    }
    if differing.len() > MOST_LISTED {
        table.note = Some(format!("The first {MOST_LISTED} of {}.", differing.len()));
    }
    vec![Block::Table(table)]
}

/// Metrics that both have, of the same column and the same swept values.
fn metrics(results: [&Results; 2], names: &[String; 2]) -> Option<Table> {
    if !results[0].record.parameters().eq(results[1].record.parameters()) {
        return None;
    }
    let [a, b] = results.map(|results| results.texts("metrics.csv"));
    let others: HashMap<(&str, &[String]), &[String]> = b
        .iter()
        .filter(|(_, fields)| fields.len() == 4)
        .map(|(lead, fields)| ((&**lead, &fields[..2]), &fields[..]))
        .collect();
    let cases = results[0].record.names_by_lead();
    let difference = format!("#{} − {}", names[1], names[0]);
    let [first, second] = [0, 1].map(|k| format!("#{}", names[k]));
    let mut table = Table::new("", &["case", "metric", &first, &second, &difference, "#relative", "unit"]);
    for (lead, fields) in &a {
        let [name, _, value, unit] = &fields[..] else { continue };
        let Some([_, _, other, other_unit]) = others.get(&(&**lead, &fields[..2])) else { continue };
        if unit != other_unit {
            continue;
        }
        if table.rows.len() == MOST_METRICS {
            table.note = Some("The first ones; metrics.csv of both has all.".to_owned());
            break;
        }
        let (x, y) = (value.parse::<f64>().ok(), other.parse::<f64>().ok());
        let shown = |value: Option<f64>| value.map_or_else(|| "none".to_owned(), short);
        let (change, share) = match (x, y) {
            (Some(0.0), Some(y)) => (brief(y), "–".to_owned()),
            (Some(x), Some(y)) => (brief(y - x), format!("{} %", brief(100.0 * (y - x) / x.abs()))),
            _ => ("–".to_owned(), "–".to_owned()),
        };
        let case = cases.of(lead);
        let unit = labels::written_unit(unit);
        table.rows.push(vec![case, written::cut(name.clone()), shown(x), shown(y), change, share, unit]);
    }
    (!table.rows.is_empty()).then_some(table)
}

/// What both are drawn with, one over the other.
fn figures(results: [&Results; 2], names: &[String; 2], pair: &Pair) -> Result<Vec<Block>, ResultsError> {
    let asked: Vec<Asked> = standard(results[0])
        .into_iter()
        .filter(|asked| {
            asked
                .y
                .iter()
                .chain([&asked.x])
                .all(|name| results.iter().all(|one| one.names().any(|other| other == name)))
        })
        .collect();
    let read =
        [Read::of(results[0], &asked, Some(pair.places[0]))?, Read::of(results[1], &asked, Some(pair.places[1]))?];
    let figures: Vec<Figure> = asked
        .iter()
        .enumerate()
        .filter_map(|(at, asked)| {
            let cases = read.iter().zip(names).filter_map(|(read, name)| {
                let points = read.curves.first()?[at].iter().map(KeptCurve::points).collect();
                Some(DrawnCase { source: Some(name.clone()), values: Vec::new(), points })
            });
            Some(curves::figure(asked.title.clone(), curves::picture(results[0], asked, cases)?))
        })
        .collect();
    let mut blocks = of_case(pair);
    if !figures.is_empty() {
        blocks.push(Block::Figures(figures));
    }
    Ok(blocks)
}

/// Which case it is, where there are several.
fn of_case(pair: &Pair) -> Vec<Block> {
    if pair.name.is_empty() { Vec::new() } else { vec![Block::Text(format!("Case: {}.", pair.name))] }
}

/// The rows of a case, column by column.
struct Rows {
    columns: Vec<Vec<f64>>,
    /// Every so many rows are held.
    stride: usize,
}

impl Rows {
    fn of(results: &Results, place: usize) -> Result<Self, ResultsError> {
        let rows = results.record.with_rows().get(place).map_or(0, |case| case.rows as usize);
        let stride = rows.saturating_mul(results.columns.len()).div_ceil(MOST_NUMBERS).max(1);
        let mut columns = vec![Vec::new(); results.columns.len()];
        let mut seen = 0;
        results.visit(&mut |_, case, values| {
            if case == place {
                if seen % stride == 0 {
                    columns.iter_mut().zip(values).for_each(|(column, value)| column.push(*value));
                }
                seen += 1;
            }
            Ok(())
        })?;
        Ok(Self { columns, stride })
    }

    fn column(&self, results: &Results, name: &str) -> Option<&[f64]> {
        results.names().position(|other| other == name).map(|at| &self.columns[at][..])
    }
}

/// The largest difference of every column that both have.
fn columns(results: [&Results; 2], names: &[String; 2], pair: &Pair) -> Result<Vec<Block>, ResultsError> {
    let rows = [Rows::of(results[0], pair.places[0])?, Rows::of(results[1], pair.places[1])?];
    let times = [0, 1].map(|k| rows[k].column(results[k], "t"));
    let mut blocks = of_case(pair);
    if let [Some(t), Some(other)] = times
        && !t.is_empty()
        && !other.is_empty()
    {
        let rms = [0, 1].map(|k| format!("#root mean square of {}", names[k]));
        let mut table = Table::new("", &["column", &rms[0], &rms[1], "#largest difference", "#at t, s", "unit"]);
        for column in results[0].columns.iter().filter(|column| column.name != "t") {
            let (Some(a), Some(b)) =
                (rows[0].column(results[0], &column.name), rows[1].column(results[1], &column.name))
            else {
                continue;
            };
            let (mut largest, mut at, mut from) = (f64::NAN, f64::NAN, 0);
            for (time, value) in t.iter().zip(a) {
                let Some(there) = between(other, b, *time, &mut from) else { continue };
                let difference = (there - value).abs();
                if difference > largest || largest.is_nan() {
                    (largest, at) = (difference, *time);
                }
            }
            let shown = |value: f64| if value.is_nan() { "–".to_owned() } else { brief(value) };
            let (difference, at) = (if largest.is_nan() { "–".to_owned() } else { rough(largest) }, shown(at));
            let unit = labels::written_unit(&column.unit);
            table.rows.push(vec![
                column.name.clone(),
                shown(root_mean_square(a)),
                shown(root_mean_square(b)),
                difference,
                at,
                unit,
            ]);
        }
        let mut notes = Vec::new();
        if t != other {
            notes.push("The rows are at different times: straight lines stand between those of the second.".to_owned());
        }
        if let Some(rows) = rows.iter().find(|rows| rows.stride > 1) {
            notes.push(format!("One of {} rows is compared.", rows.stride));
        }
        table.note = (!notes.is_empty()).then(|| notes.join(" "));
        if !table.rows.is_empty() {
            blocks.push(Block::Table(table));
        }
    }
    for (one, (own, than)) in [(&names[0], (results[0], results[1])), (&names[1], (results[1], results[0]))] {
        let alone: Vec<&str> = own.names().filter(|name| !than.names().any(|other| other == *name)).collect();
        if !alone.is_empty() {
            blocks.push(Block::Text(format!("Only {one} has {}.", alone.join(", "))));
        }
    }
    Ok(blocks)
}

fn root_mean_square(values: &[f64]) -> f64 {
    let finite = values.iter().filter(|value| value.is_finite());
    let (sum, count) = finite.fold((0.0, 0.0), |(sum, count), value| (sum + value * value, count + 1.0));
    (sum / count).sqrt()
}

/// The value at `t` on straight lines through the points, whose times rise; `from` goes on from call to call. Nothing outside of them, or beside
/// an empty field.
fn between(times: &[f64], values: &[f64], t: f64, from: &mut usize) -> Option<f64> {
    while times.get(*from + 1).is_some_and(|next| *next <= t) {
        *from += 1;
    }
    let (t0, y0) = (*times.get(*from)?, *values.get(*from)?);
    if t0 == t {
        return y0.is_finite().then_some(y0);
    }
    let (t1, y1) = (*times.get(*from + 1)?, *values.get(*from + 1)?);
    let value = y0 + (y1 - y0) * ((t - t0) / (t1 - t0));
    (t0 < t && value.is_finite()).then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_between_points() {
        let (times, values) = ([0.0, 1.0, 3.0, 4.0], [1.0, 3.0, -1.0, f64::NAN]);
        let mut from = 0;
        let found: Vec<Option<f64>> = [-0.5, 0.0, 0.5, 1.0, 2.0, 3.0, 3.5, 4.0, 5.0]
            .iter()
            .map(|t| between(&times, &values, *t, &mut from))
            .collect();
        assert_eq!(found, [None, Some(1.0), Some(2.0), Some(3.0), Some(1.0), Some(-1.0), None, None, None]);
        assert_eq!(between(&[], &[], 0.0, &mut 0), None);
    }

    #[test]
    fn means_leave_empty_fields_out() {
        assert_eq!(root_mean_square(&[3.0, f64::NAN, -4.0]), 12.5_f64.sqrt());
        assert!(root_mean_square(&[]).is_nan());
    }
}
