//! Which columns and cases are drawn, and the curves that they make.

use super::Refused;
use super::table::Table;
use crate::arguments::PlotOptions;
use springpot::table::Column;
use springpot_report::Plot;
use springpot_run::figures::{Curves, FigureColumn};
use springpot_run::labels;
use springpot_run::sweep::{KeptCurve, MAX_CURVES, most_points};
use springpot_run::table::matches;
use springpot_scenario::suggest;
use springpot_scenario::units::Unit;

/// Values of a sweep that are listed.
const LISTED: usize = 12;

/// What is asked for.
pub(super) struct Wanted {
    x: FigureColumn,
    y: Vec<FigureColumn>,
    /// Where these columns stand in the rows.
    x_at: usize,
    y_at: Vec<usize>,
    /// For each sweep the value that is chosen.
    chosen: Vec<Option<String>>,
}

impl Wanted {
    pub(super) fn new(table: &Table, options: &PlotOptions) -> Result<Self, Refused> {
        let units = units(table, &options.units)?;
        let drawn = |at: usize| {
            let column = table.columns[at].clone();
            let unit = units.iter().rev().find(|(glob, ..)| matches(glob, &column.name));
            let unit = match unit {
                None => None,
                Some((_, text, unit)) => Some(fitting(&column, text, unit)?),
            };
            Ok(FigureColumn { column, unit })
        };
        let x_at = match found(table, &options.x)?[..] {
            [only] => only,
            _ => return Err(Refused::new(format!("--x {:?} matches several columns; it takes one", options.x), None)),
        };
        let x = drawn(x_at)?;
        let mut ordinates = Vec::new();
        for glob in &options.y {
            for at in found(table, glob)? {
                if !ordinates.contains(&at) {
                    ordinates.push(at);
                }
            }
        }
        let y = ordinates.iter().copied().map(drawn).collect::<Result<_, _>>()?;
        Ok(Self { x, y, x_at, y_at: ordinates, chosen: chosen(table, &options.selection)? })
    }
}

/// Columns that a glob matches; at least one.
fn found(table: &Table, glob: &str) -> Result<Vec<usize>, Refused> {
    let found: Vec<usize> = (0..table.columns.len()).filter(|&k| matches(glob, &table.columns[k].name)).collect();
    if found.is_empty() {
        let help = suggest(glob, table.columns.iter().map(|column| column.name.as_str()));
        return Err(Refused::new(format!("{glob:?} matches no column"), help));
    }
    Ok(found)
}

type Units = Vec<(String, String, Unit)>;

/// Reads `COLUMN=UNIT`.
fn units(table: &Table, assignments: &[String]) -> Result<Units, Refused> {
    let read = assignments.iter().map(|assignment| {
        let Some((glob, unit)) = assignment.split_once('=') else {
            return Err(Refused::new(format!("--unit {assignment:?} has no `=`"), "write COLUMN=UNIT".to_owned()));
        };
        found(table, glob)?;
        match Unit::parse(unit, &|_| None) {
            Ok(parsed) => Ok((glob.to_owned(), unit.to_owned(), parsed)),
            Err(error) => Err(Refused::new(format!("--unit {assignment}: {error}"), None)),
        }
    });
    read.collect()
}

fn fitting(column: &Column, text: &str, unit: &Unit) -> Result<(String, Unit), Refused> {
    let own = Unit::parse(if column.unit.is_empty() { "1" } else { &column.unit }, &|_| None);
    match own {
        Ok(own) if own.dimension() == unit.dimension() => Ok((text.to_owned(), unit.clone())),
        _ => {
            let own = if column.unit.is_empty() { "a pure number" } else { &column.unit };
            Err(Refused::new(format!("{} is in {own}, which does not convert to {text}", column.name), None))
        }
    }
}

/// The value of each sweep that `--where` chooses.
fn chosen(table: &Table, selection: &[String]) -> Result<Vec<Option<String>>, Refused> {
    let mut chosen = vec![None; table.sweeps.len()];
    for assignment in selection {
        let Some((path, value)) = assignment.rsplit_once('=') else {
            return Err(Refused::new(format!("--where {assignment:?} has no `=`"), "write PATH=VALUE".to_owned()));
        };
        let (path, value) = (path.trim(), value.trim().trim_matches('"'));
        let names = || table.sweeps.iter().flat_map(|sweep| &sweep.parameters).map(String::as_str);
        let sweep = table.sweeps.iter().position(|sweep| sweep.parameters.iter().any(|name| name == path));
        let Some(at) = sweep else {
            let help = if table.sweeps.is_empty() { "nothing is".to_owned() } else { suggest(path, names()) };
            return Err(Refused::new(format!("--where {assignment}: {path} is not swept"), help));
        };
        let labels = &table.sweeps[at].labels;
        let same = |label: &&String| {
            let equal = |label: f64| value.parse::<f64>().is_ok_and(|value| value == label);
            label.as_str() == value || label.parse().is_ok_and(equal)
        };
        let Some(label) = labels.iter().find(same) else {
            let mut help = format!("values: {}", labels.iter().take(LISTED).cloned().collect::<Vec<_>>().join(", "));
            if labels.len() > LISTED {
                help.push_str(", …");
            }
            return Err(Refused::new(format!("--where {assignment}: no case has this value"), help));
        };
        chosen[at] = Some(label.clone());
    }
    Ok(chosen)
}

/// One curve under way: which case, and one run of points for each ordinate.
struct Case {
    position: Vec<usize>,
    curves: Vec<KeptCurve>,
}

/// Reads the rows and makes the figure: the first sweep that is not fixed makes curves, the others panels.
pub(super) fn plot(table: &Table, wanted: &Wanted, title: Option<String>) -> Result<Plot, Refused> {
    let (cases, sweeps) = cases(table, wanted)?;
    let free: Vec<usize> = (0..sweeps.len()).filter(|&k| wanted.chosen[k].is_none()).collect();
    let what = Curves {
        title: title.as_deref(),
        x: &wanted.x,
        y: &wanted.y,
        free: &free,
        sweep: &|axis| sweeps[axis].0.clone(),
        value: &|axis, k| sweeps[axis].1[k].clone(),
    };
    Ok(what.plot(cases.iter().map(|case| (case.position.clone(), case.curves.iter().map(KeptCurve::points).collect()))))
}

/// Title and labels of every sweep.
type Sweeps = Vec<(String, Vec<String>)>;

/// The points of every case that is drawn, in the order of the rows.
fn cases(table: &Table, wanted: &Wanted) -> Result<(Vec<Case>, Sweeps), Refused> {
    let mut cases: Vec<Case> = Vec::new();
    let mut last: Option<(Vec<usize>, Option<usize>)> = None;
    // As many curves as run.json says; a run draws them from as many points.
    let values = wanted.chosen.iter().zip(&table.sweeps);
    let counts = values.map(|(chosen, sweep)| if chosen.is_some() { 1 } else { sweep.labels.len().max(1) });
    let count = counts.fold(wanted.y.len(), usize::saturating_mul);
    let most = most_points(count, count);
    let names: Vec<Vec<String>> = table.sweeps.iter().map(|sweep| sweep.labels.clone()).collect();
    let sweeps = table.visit(&mut |record, line, position| {
        let case = match &last {
            Some((other, case)) if other == position => *case,
            _ => {
                let drawn =
                    wanted.chosen.iter().zip(position).zip(&names).all(|((chosen, &at), labels)| {
                        chosen.as_ref().is_none_or(|chosen| labels.get(at) == Some(chosen))
                    });
                let case = drawn.then(|| {
                    let curves = vec![KeptCurve::new(most); wanted.y.len()];
                    cases.push(Case { position: position.to_vec(), curves });
                    cases.len() - 1
                });
                last = Some((position.to_vec(), case));
                case
            }
        };
        let Some(case) = case else { return Ok(()) };
        if cases.len() * wanted.y.len() > MAX_CURVES {
            let message = format!("the figure would hold more than {MAX_CURVES} curves");
            let help = "choose fewer columns, or some of the cases with --where PATH=VALUE".to_owned();
            return Err(Refused::new(message, help));
        }
        let number = |at: usize| {
            let field = record.get(at).unwrap_or_default();
            let text = std::str::from_utf8(field).unwrap_or("?");
            let value = if text.is_empty() { Some(f64::NAN) } else { text.parse::<f64>().ok() };
            value.ok_or_else(|| table.no_number(at, line, field))
        };
        let x = number(wanted.x_at)?;
        for (&at, points) in wanted.y_at.iter().zip(&mut cases[case].curves) {
            points.push(x, number(at)?);
        }
        Ok(())
    })?;
    if cases.is_empty() {
        return Err(Refused::new("there are no rows to draw", None));
    }
    let sweeps = sweeps.into_iter().map(|sweep| {
        let names: Vec<String> = sweep.parameters.iter().map(|path| labels::parameter(path)).collect();
        (names.join(", "), sweep.labels)
    });
    Ok((cases, sweeps.collect()))
}
