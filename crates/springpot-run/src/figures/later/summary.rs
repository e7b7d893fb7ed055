//! Statistics of columns, and metrics, over a swept parameter: what `kind = "summary"` of a figure draws, from the files of results.

use super::super::{Curves, DrawnCase, FigureColumn, swept_numbers};
use super::curves::{Sweeps, Units, chosen, fitting, found, found_labels, label, named, source, units};
use super::table::{Sweep, Table};
use super::{AskedFigure, NotDrawn, look};
use crate::sweep::is_within;
use crate::table::{Totals, matches};
use springpot::table::Column;
use springpot_report::Plot;
use springpot_scenario::{Look, Statistic, suggest};
use std::collections::HashMap;

/// What stands before the parenthesis of a metric.
const METRIC: &str = "metric";

/// What is asked for: a statistic of the columns that a glob matches, or a metric.
#[derive(Debug, PartialEq)]
pub(super) enum Asked {
    Statistic(Statistic, String),
    Metric(String),
}

/// What the words ask for; nothing where none of them is a statistic.
pub(super) fn asked(words: &[String]) -> Result<Option<Vec<Asked>>, NotDrawn> {
    let read: Vec<Option<Asked>> = words.iter().map(|word| one(word)).collect();
    if read.iter().all(Option::is_none) {
        return Ok(None);
    }
    if let Some((word, _)) = words.iter().zip(&read).find(|(_, read)| read.is_none()) {
        let message = format!("{word:?} is no statistic, and others are: a figure draws one or the other");
        return Err(NotDrawn::new(message, format!("write max({word}), or draw it in a figure of its own")));
    }
    Ok(Some(read.into_iter().flatten().collect()))
}

fn one(word: &str) -> Option<Asked> {
    let (name, of) = word.trim().strip_suffix(')')?.split_once('(')?;
    if name == METRIC {
        return Some(Asked::Metric(of.trim().to_owned()));
    }
    let statistic = Statistic::ALL.into_iter().find(|statistic| statistic.name() == name)?;
    Some(Asked::Statistic(statistic, of.trim().to_owned()))
}

/// An ordinate: what it is of each case.
enum What {
    /// Index of the column.
    Statistic(Statistic, usize),
    Metric(String),
}

/// Cases that differ in the abscissa alone, as they are drawn.
struct Drawn {
    source: Option<String>,
    values: Vec<(String, String)>,
    points: Vec<Vec<[f64; 2]>>,
}

/// A case under way: index of the value of each sweep, the first field of the abscissa, statistics, metrics.
struct Case {
    position: Vec<usize>,
    field: f64,
    totals: Vec<Totals>,
    metrics: Vec<f64>,
}

/// The figure: the swept path at `--x`, or the only one, as the abscissa.
pub(super) fn plot(tables: &[Table], figure: &AskedFigure, look: &Look, asked: &[Asked]) -> Result<Plot, NotDrawn> {
    let path = path(&tables[0], &figure.x)?;
    found_labels(&tables[0], look)?;
    let chosen = chosen(tables, &figure.selection)?;
    let units = units(&tables[0], &figure.units)?;
    let (mut x, mut y) = (None, None);
    let mut drawn: Vec<Drawn> = Vec::new();
    for (at, (table, chosen)) in tables.iter().zip(&chosen).enumerate() {
        let axis = axis(table, &path)?;
        let what = what(table, asked)?;
        let (cases, sweeps) = cases(table, (&path, axis), &what, chosen, look.window)?;
        let sweep = &table.sweeps[axis];
        // Beyond the values that run.json lists, the rows have the numbers.
        let (column, values) = swept_numbers(&path, &sweep.written(&path))
            .map_err(|(message, help)| NotDrawn::new(message, help.to_owned()))?;
        x.get_or_insert(column);
        if y.is_none() {
            y = Some(ordinates(table, &what, look, &units)?);
        }
        let own = source(tables, at);
        let named = named(sweeps);
        for case in cases {
            let values_of = free(&named, &case.position, axis, chosen);
            let place =
                drawn.iter().position(|other| other.source == own && other.values == values_of).unwrap_or_else(|| {
                    drawn.push(Drawn { source: own.clone(), values: values_of, points: vec![Vec::new(); what.len()] });
                    drawn.len() - 1
                });
            let x = values.get(case.position[axis]).copied().unwrap_or(case.field);
            let (mut totals, mut metrics) = (case.totals.iter(), case.metrics.iter());
            for (what, points) in what.iter().zip(&mut drawn[place].points) {
                let value = match what {
                    What::Statistic(statistic, _) => totals.next().map_or(f64::NAN, |totals| totals.value(*statistic)),
                    What::Metric(_) => metrics.next().copied().unwrap_or(f64::NAN),
                };
                points.push([x, value]);
            }
        }
    }
    if drawn.is_empty() {
        return Err(NotDrawn::new("there are no rows to draw", None));
    }
    for points in drawn.iter_mut().flat_map(|drawn| &mut drawn.points) {
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    }
    let (Some(x), Some(y)) = (x, y) else { return Err(NotDrawn::new("there are no rows to draw", None)) };
    let look = look::drawn(look, &x, &y)?;
    let cases = drawn.iter().map(|Drawn { source, values, points }| DrawnCase {
        source: source.clone(),
        values: values.clone(),
        points: points.iter().map(Vec::as_slice).collect(),
    });
    Ok(Curves { title: figure.title.as_deref(), x: &x, y: &y, look: &look, is_marked: true, measured: &[] }.plot(cases))
}

/// The swept path that is the abscissa; `t` stands for the only one.
fn path(table: &Table, x: &str) -> Result<String, NotDrawn> {
    let mut swept = table.sweeps.iter().flat_map(|sweep| &sweep.parameters);
    match (x, swept.next(), swept.next()) {
        (_, None, _) => Err(NotDrawn::new(
            format!("{} has no sweep, over which a statistic is drawn", table.name()),
            "draw the column itself, or run the scenario with --sweep PATH=v1,v2,...".to_owned(),
        )),
        ("t", Some(only), None) => Ok(only.clone()),
        ("t", ..) => {
            let all: Vec<&str> = table.sweeps.iter().flat_map(|sweep| &sweep.parameters).map(String::as_str).collect();
            Err(NotDrawn::new(
                "a statistic is drawn over a swept parameter",
                format!("choose one with --x: {}", all.join(", ")),
            ))
        }
        (x, ..) => Ok(x.to_owned()),
    }
}

fn axis(table: &Table, path: &str) -> Result<usize, NotDrawn> {
    let found = table.sweeps.iter().position(|sweep| sweep.parameters.iter().any(|own| own == path));
    found.ok_or_else(|| {
        let swept = table.sweeps.iter().flat_map(|sweep| &sweep.parameters).map(String::as_str);
        NotDrawn::new(format!("--x {path}: it is not swept in {}", table.name()), suggest(path, swept))
    })
}

fn what(table: &Table, asked: &[Asked]) -> Result<Vec<What>, NotDrawn> {
    let mut what = Vec::new();
    for asked in asked {
        match asked {
            Asked::Statistic(statistic, glob) => {
                what.extend(found(table, glob)?.into_iter().map(|at| What::Statistic(*statistic, at)));
            }
            Asked::Metric(name) => what.push(What::Metric(name.clone())),
        }
    }
    Ok(what)
}

/// The ordinates as they are drawn.
fn ordinates(table: &Table, what: &[What], look: &Look, units: &Units) -> Result<Vec<FigureColumn>, NotDrawn> {
    let one = |what: &What| match what {
        What::Statistic(statistic, at) => {
            let column = table.columns[*at].clone();
            let unit = units.iter().rev().find(|(glob, ..)| matches(glob, &column.name));
            let unit = unit.map(|(_, text, unit)| fitting(&column, text, unit)).transpose()?;
            let label = label(look, &column);
            let plain = FigureColumn { column, unit, label: None };
            let label = label.unwrap_or_else(|| format!("{} of {}", statistic.name(), plain.name()));
            Ok(FigureColumn { label: Some(label), ..plain })
        }
        What::Metric(name) => {
            let unit = table.metrics()?.iter().find(|metric| metric.name == *name).map(|metric| metric.unit.clone());
            let column = Column::new(format!("{METRIC}({name})"), unit.unwrap_or_default(), "");
            let label = label(look, &column).unwrap_or_else(|| name.clone());
            Ok(FigureColumn { column, unit: None, label: Some(label) })
        }
    };
    what.iter().map(one).collect()
}

/// Reads the rows; returns the cases that are drawn, and the sweeps.
fn cases(
    table: &Table,
    (path, axis): (&str, usize),
    what: &[What],
    chosen: &[Option<String>],
    window: Option<[f64; 2]>,
) -> Result<(Vec<Case>, Vec<Sweep>), NotDrawn> {
    let columns: Vec<usize> = what
        .iter()
        .filter_map(|what| match what {
            What::Statistic(_, at) => Some(*at),
            What::Metric(_) => None,
        })
        .collect();
    let named: Vec<&String> = what
        .iter()
        .filter_map(|what| match what {
            What::Metric(name) => Some(name),
            What::Statistic(..) => None,
        })
        .collect();
    let time = table.columns.iter().position(|column| column.name == "t");
    let at_x = table.columns.iter().position(|column| column.name == path);
    let labels: Vec<Vec<String>> = table.sweeps.iter().map(|sweep| sweep.labels.clone()).collect();
    let is_drawn = |position: &[usize]| {
        chosen
            .iter()
            .zip(position)
            .zip(&labels)
            .all(|((chosen, at), labels)| chosen.as_ref().is_none_or(|chosen| labels.get(*at) == Some(chosen)))
    };
    let mut cases: Vec<Case> = Vec::new();
    let listed = table.sweeps[axis].written(path).len();
    let sweeps = table.visit(&mut |record, line, position| {
        let number = |at: usize| table.number(record, at, line);
        if cases.last().is_none_or(|case| case.position != position) {
            if !is_drawn(position) {
                return Ok(());
            }
            // The field may be a text where it is not needed.
            let is_listed = position[axis] < listed;
            let field = if is_listed { f64::NAN } else { at_x.map_or(Ok(f64::NAN), number)? };
            let (totals, metrics) = (vec![Totals::default(); columns.len()], vec![f64::NAN; named.len()]);
            cases.push(Case { position: position.to_vec(), field, totals, metrics });
        }
        if let (Some(window), Some(t)) = (window, time)
            && !is_within(window, number(t)?)
        {
            return Ok(());
        }
        if let Some(case) = cases.last_mut() {
            for (at, totals) in columns.iter().zip(&mut case.totals) {
                totals.add(number(*at)?);
            }
        }
        Ok(())
    })?;
    if !named.is_empty() {
        let (mut sweeps, metrics) = (sweeps.clone(), table.metrics()?);
        let places: HashMap<Vec<usize>, usize> =
            cases.iter().enumerate().map(|(at, case)| (case.position.clone(), at)).collect();
        for metric in &metrics {
            let position = table.position(&mut sweeps, &metric.swept);
            let place = named.iter().position(|name| **name == metric.name);
            if let (Some(case), Some(place)) = (places.get(&position), place) {
                cases[*case].metrics[place] = metric.value;
            }
        }
        if let Some(name) = named.iter().find(|name| metrics.iter().all(|metric| metric.name != ***name)) {
            let message = format!("{} has no metric {name:?}", table.name());
            return Err(NotDrawn::new(message, suggest(name, metrics.iter().map(|metric| metric.name.as_str()))));
        }
    }
    Ok((cases, sweeps))
}

/// Names and values of the sweeps that are neither the abscissa nor chosen.
fn free(sweeps: &Sweeps, position: &[usize], axis: usize, chosen: &[Option<String>]) -> Vec<(String, String)> {
    let is_free = |k: &usize| *k != axis && chosen.get(*k).is_none_or(Option::is_none);
    let value = |k: usize| (sweeps[k].0.clone(), sweeps[k].1[position[k]].clone());
    (0..sweeps.len()).filter(is_free).map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_are_told_from_columns() {
        let read = |words: &[&str]| asked(&words.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>());
        assert!(matches!(read(&["strut.force", "odd(x)"]), Ok(None)));
        let Ok(Some(found)) = read(&["max(strut.force)", "metric( settle )"]) else { panic!() };
        let expected = [Asked::Statistic(Statistic::Max, "strut.force".into()), Asked::Metric("settle".into())];
        assert_eq!(found, expected);
        assert!(read(&["max(strut.force)", "strut.force"]).is_err());
    }
}
