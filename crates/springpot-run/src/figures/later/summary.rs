//! Statistics of columns, and metrics, over a swept parameter: what `kind = "summary"` of a figure draws, from the files of results.

use super::curves::{Sweeps, Units, chosen, drawn as column, found, found_labels, label, named, source, units};
use super::table::{self, Reading, Sweep, Table};
use super::{AskedFigure, NotDrawn, look};
use crate::panels::{CasesOver, FigureColumn, swept_numbers};
use crate::table::Totals;
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

/// A case: the first field of the abscissa, and statistics.
type Case = table::Case<(f64, Vec<Totals>)>;

/// The figure: the swept path at `--x`, or the only one, as the abscissa.
pub(super) fn plot(tables: &[Table], figure: &AskedFigure, look: &Look, asked: &[Asked]) -> Result<Plot, NotDrawn> {
    let path = path(&tables[0], &figure.x)?;
    found_labels(&tables[0], look)?;
    let chosen = chosen(tables, &figure.selection)?;
    let units = units(&tables[0], &figure.units)?;
    let (mut x, mut y) = (None, None);
    let mut drawn = CasesOver::default();
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
        let metrics = metrics(table, &what, &sweeps)?;
        let (own, named) = (source(tables, at), named(sweeps));
        for Case { position, kept: (field, totals) } in &cases {
            let mut totals = totals.iter();
            let number = |what: &What| match what {
                What::Statistic(statistic, _) => totals.next().map_or(f64::NAN, |totals| totals.value(*statistic)),
                What::Metric(name) => metrics.get(&(position.clone(), name.clone())).copied().unwrap_or(f64::NAN),
            };
            let numbers: Vec<f64> = what.iter().map(number).collect();
            let x = values.get(position[axis]).copied().unwrap_or(*field);
            drawn.take(own.clone(), free(&named, position, axis, chosen), x, &numbers);
        }
    }
    let (Some(x), Some(y), false) = (x, y, drawn.is_empty()) else {
        return Err(NotDrawn::new("there are no rows to draw", None));
    };
    let look = look::drawn(look, &x, &y)?;
    Ok(drawn.plot(figure.title.as_deref(), &x, &y, &look))
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
        What::Statistic(statistic, at) => Ok(column(&table.columns[*at], units, look)?.summed(*statistic)),
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
    let column = |what: &What| if let What::Statistic(_, at) = what { Some(*at) } else { None };
    let columns: Vec<usize> = what.iter().filter_map(column).collect();
    let at_x = table.columns.iter().position(|column| column.name == path);
    let listed = table.sweeps[axis].written(path).len();
    let begin = |record: &_, line, position: &[usize]| {
        // The field may be a text where it is not needed.
        let needed = at_x.filter(|_| position[axis] >= listed);
        let field = needed.map_or(Ok(f64::NAN), |at| table.number(record, at, line))?;
        Ok((field, vec![Totals::default(); columns.len()]))
    };
    let add = |kept: &mut (f64, Vec<Totals>), numbers: &[f64]| {
        kept.1.iter_mut().zip(numbers).for_each(|(totals, number)| totals.add(*number));
    };
    table.cases(Reading { columns: &columns, chosen, window }, begin, add)
}

/// Values of the metrics that are drawn, by the position of their case and their name.
fn metrics(table: &Table, what: &[What], sweeps: &[Sweep]) -> Result<HashMap<(Vec<usize>, String), f64>, NotDrawn> {
    let name = |what: &What| if let What::Metric(name) = what { Some(name.clone()) } else { None };
    let named: Vec<String> = what.iter().filter_map(name).collect();
    if named.is_empty() {
        return Ok(HashMap::new());
    }
    let (mut sweeps, metrics) = (sweeps.to_vec(), table.metrics()?);
    if let Some(name) = named.iter().find(|name| metrics.iter().all(|metric| metric.name != **name)) {
        let message = format!("{} has no metric {name:?}", table.name());
        return Err(NotDrawn::new(message, suggest(name, metrics.iter().map(|metric| metric.name.as_str()))));
    }
    let drawn = metrics.into_iter().filter(|metric| named.contains(&metric.name));
    Ok(drawn.map(|metric| ((table.position(&mut sweeps, &metric.swept), metric.name), metric.value)).collect())
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
