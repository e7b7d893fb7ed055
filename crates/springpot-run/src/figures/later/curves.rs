//! Which columns and cases are drawn, and the curves that they make.

use super::table::{self, Reading, Sweep, Table};
use super::{AskedFigure, NotDrawn, look};
use crate::labels;
use crate::panels::{Curves, DrawnCase, DrawnLook, FigureColumn, MeasuredPoints};
use crate::sweep::{KeptCurve, MAX_CURVES, most_points};
use crate::table::matches;
use springpot::table::Column;
use springpot_report::Plot;
use springpot_scenario::units::Unit;
use springpot_scenario::{FigureLabel, Look, equals_sign, suggest};

/// Values of a sweep that are listed.
const LISTED: usize = 12;

/// What is asked for.
pub(super) struct Wanted {
    x: FigureColumn,
    y: Vec<FigureColumn>,
    look: DrawnLook,
    /// By result.
    places: Vec<Places>,
}

/// Where what is asked for stands in a result.
struct Places {
    x: usize,
    y: Vec<usize>,
    /// For each sweep the value that is chosen.
    chosen: Vec<Option<String>>,
}

impl Wanted {
    pub(super) fn new(tables: &[Table], asked: &AskedFigure, look: &Look) -> Result<Self, NotDrawn> {
        let table = &tables[0];
        let units = units(table, &asked.units)?;
        found_labels(table, look)?;
        let drawn = |at: usize| drawn(&table.columns[at], &units, look);
        let mut places = Places::all(tables, &asked.x, &asked.columns)?;
        let names = |table: &Table, places: &Places| -> Vec<String> {
            places.y.iter().map(|&at| table.columns[at].name.clone()).collect()
        };
        let first = names(table, &places[0]);
        for (other, places) in tables.iter().zip(&places).skip(1) {
            if !other.is_measured && names(other, places) != first {
                let message = format!("{} and {} have other columns of these names", table.name(), other.name());
                return Err(NotDrawn::new(message, "name columns that all results have".to_owned()));
            }
        }
        for (places, chosen) in places.iter_mut().zip(chosen(tables, &asked.selection)?) {
            places.chosen = chosen;
        }
        let has_time = |table: &&Table| table.columns.iter().any(|column| column.name == "t");
        if let Some(table) = tables.iter().find(|table| look.window.is_some() && !has_time(table)) {
            return Err(NotDrawn::new(format!("--window: {} has no column t", table.name()), None));
        }
        let x = drawn(places[0].x)?;
        let y = places[0].y.iter().copied().map(drawn).collect::<Result<Vec<_>, _>>()?;
        let look = look::drawn(look, &x, &y)?;
        Ok(Self { x, y, look, places })
    }
}

impl Places {
    /// Those of all tables: a column that only measured ones have is drawn of these.
    fn all(tables: &[Table], x: &str, columns: &[String]) -> Result<Vec<Self>, NotDrawn> {
        let is_in = |table: &&Table, glob: &String| found(table, glob).is_ok();
        let one = |table: &Table| {
            let measured = || tables.iter().filter(|table| table.is_measured);
            let own = columns.iter().filter(|glob| match table.is_measured {
                true => is_in(&table, glob),
                false => is_in(&table, glob) || !measured().any(|other| is_in(&other, glob)),
            });
            let own: Vec<String> = own.cloned().collect();
            if own.is_empty() {
                let help = "name a column of its own too".to_owned();
                return Err(NotDrawn::new(format!("{} has none of these columns", table.name()), help));
            }
            Self::of(table, x, &own)
        };
        tables.iter().map(one).collect()
    }

    fn of(table: &Table, x: &str, columns: &[String]) -> Result<Self, NotDrawn> {
        let x = match found(table, x).map_err(|refused| refused.of_abscissa(table))?[..] {
            [only] => only,
            _ => return Err(NotDrawn::new(format!("--x {x:?} matches several columns; it takes one"), None)),
        };
        let mut y = Vec::new();
        for glob in columns {
            for at in found(table, glob)?.into_iter().filter(|at| *at != x || !table.is_measured) {
                if !y.contains(&at) {
                    y.push(at);
                }
            }
        }
        Ok(Self { x, y, chosen: Vec::new() })
    }
}

/// Columns that a glob matches; at least one.
pub(super) fn found(table: &Table, glob: &str) -> Result<Vec<usize>, NotDrawn> {
    let found: Vec<usize> = (0..table.columns.len()).filter(|&k| table.is_called(k, glob)).collect();
    if found.is_empty() {
        let help = suggest(glob, table.columns.iter().map(|column| column.name.as_str()));
        return Err(NotDrawn::new(format!("{glob:?} matches no column of {}", table.name()), help));
    }
    Ok(found)
}

pub(super) type Units = Vec<(String, String, Unit)>;

/// Reads `COLUMN=UNIT`.
pub(super) fn units(table: &Table, assignments: &[String]) -> Result<Units, NotDrawn> {
    let read = assignments.iter().map(|assignment| {
        let Some((glob, unit)) = assignment.split_once('=') else {
            return Err(NotDrawn::new(format!("--unit {assignment:?} has no `=`"), "write COLUMN=UNIT".to_owned()));
        };
        found(table, glob)?;
        match Unit::parse(unit, &|_| None) {
            Ok(parsed) => Ok((glob.to_owned(), unit.to_owned(), parsed)),
            Err(error) => Err(NotDrawn::new(format!("--unit {assignment}: {error}"), None)),
        }
    });
    read.collect()
}

/// Whether every label is that of a column.
pub(super) fn found_labels(table: &Table, look: &Look) -> Result<(), NotDrawn> {
    look.labels.iter().try_for_each(|label| found(table, &label.column.text).map(|_| ()))
}

/// What a column is called; nothing where nobody says it.
pub(super) fn label(look: &Look, column: &Column) -> Option<String> {
    let is_meant = |label: &&FigureLabel| matches(&label.column.text, &column.name);
    look.labels.iter().rev().find(is_meant).map(|label| label.text.clone())
}

/// A column as it is drawn.
pub(super) fn drawn(column: &Column, units: &Units, look: &Look) -> Result<FigureColumn, NotDrawn> {
    let unit = units.iter().rev().find(|(glob, ..)| matches(glob, &column.name));
    let unit = unit.map(|(_, text, unit)| fitting(column, text, unit)).transpose()?;
    Ok(FigureColumn { column: column.clone(), unit, label: label(look, column) })
}

fn fitting(column: &Column, text: &str, unit: &Unit) -> Result<(String, Unit), NotDrawn> {
    let own = Unit::parse(if column.unit.is_empty() { "1" } else { &column.unit }, &|_| None);
    match own {
        Ok(own) if own.dimension() == unit.dimension() => Ok((text.to_owned(), unit.clone())),
        _ => {
            let own = if column.unit.is_empty() { "a pure number" } else { &column.unit };
            Err(NotDrawn::new(format!("{} is in {own}, which does not convert to {text}", column.name), None))
        }
    }
}

/// By result, the value of each sweep that `--where` chooses; a path need not be swept in all of them.
pub(super) fn chosen(tables: &[Table], selection: &[String]) -> Result<Vec<Vec<Option<String>>>, NotDrawn> {
    let mut chosen: Vec<Vec<Option<String>>> = tables.iter().map(|table| vec![None; table.sweeps.len()]).collect();
    for assignment in selection {
        let Some(equals) = equals_sign(assignment) else {
            return Err(NotDrawn::new(format!("--where {assignment:?} has no `=`"), "write PATH=VALUE".to_owned()));
        };
        let (path, value) = (assignment[..equals].trim(), assignment[equals + 1..].trim().trim_matches('"'));
        let mut is_swept = false;
        for (table, chosen) in tables.iter().zip(&mut chosen) {
            let sweep = table.sweeps.iter().position(|sweep| sweep.parameters.iter().any(|name| name == path));
            let Some(at) = sweep else { continue };
            is_swept = true;
            let Some(label) = table.sweeps[at].find(value) else {
                let labels = &table.sweeps[at].labels;
                let mut help =
                    format!("values: {}", labels.iter().take(LISTED).cloned().collect::<Vec<_>>().join(", "));
                if labels.len() > LISTED {
                    help.push_str(", …");
                }
                return Err(NotDrawn::new(format!("--where {assignment}: no case has this value"), help));
            };
            chosen[at] = Some(label.clone());
        }
        if !is_swept {
            let names = || tables.iter().flat_map(|table| &table.sweeps).flat_map(|sweep| &sweep.parameters);
            let help = match names().next() {
                None => "nothing is".to_owned(),
                Some(_) => suggest(path, names().map(String::as_str)),
            };
            return Err(NotDrawn::new(format!("--where {assignment}: {path} is not swept"), help));
        }
    }
    Ok(chosen)
}

/// A case with a curve for each ordinate.
type Case = table::Case<Vec<KeptCurve>>;

/// Reads the rows and makes the figure: the first sweep that is not fixed makes curves, the others panels.
pub(super) fn plot(tables: &[Table], wanted: &Wanted, title: Option<&str>) -> Result<Plot, NotDrawn> {
    let mut read = Vec::with_capacity(tables.len());
    let mut count = 0;
    for (table, places) in tables.iter().zip(&wanted.places) {
        let (cases, sweeps) = cases(table, places, wanted, &mut count)?;
        read.push((cases, sweeps));
    }
    let Wanted { x, y, look, .. } = wanted;
    let mut measured = Vec::new();
    for ((table, places), (cases, _)) in tables.iter().zip(&wanted.places).zip(&read) {
        if table.is_measured {
            measured.extend(points(table, places, cases, (x, y)));
        }
    }
    let of_runs = read.iter().enumerate().filter(|(at, _)| !tables[*at].is_measured);
    let drawn = of_runs.flat_map(|(at, (cases, sweeps))| {
        let chosen = &wanted.places[at].chosen;
        let free: Vec<usize> = (0..sweeps.len()).filter(|&k| chosen[k].is_none()).collect();
        let source = source(tables, at);
        cases.iter().map(move |case| {
            let value = |&k: &usize| (sweeps[k].0.clone(), sweeps[k].1[case.position[k]].clone());
            let points = case.kept.iter().map(KeptCurve::points).collect();
            DrawnCase { source: source.clone(), values: free.iter().map(value).collect(), points }
        })
    });
    Ok(Curves { title, x, y, look, is_marked: false, measured: &measured }.plot(drawn))
}

/// The points of a measured table, each column at the axis of the first ordinate in its unit.
fn points(
    table: &Table,
    places: &Places,
    cases: &[Case],
    (x, y): (&FigureColumn, &[FigureColumn]),
) -> Vec<MeasuredPoints> {
    let Some(case) = cases.first() else { return Vec::new() };
    let series = places.y.iter().zip(&case.kept).map(|(&at, curve)| {
        let column = &table.columns[at];
        let has_unit = !column.unit.is_empty();
        let of =
            y.iter().position(|y| if has_unit { y.column.unit == column.unit } else { y.column.name == column.name });
        let of = of.unwrap_or(0);
        let drawn = curve.points().iter().map(|[along, up]| (x.number(*along), y[of].number(*up)));
        let label = if places.y.len() > 1 { format!("{}: {}", table.name(), column.name) } else { table.name() };
        let (x, y) = drawn.unzip();
        MeasuredPoints { label, of, x, y }
    });
    series.collect()
}

/// What the results at this place are called, where there are several.
pub(super) fn source(tables: &[Table], at: usize) -> Option<String> {
    let is_alone = tables.iter().filter(|table| table.name() == tables[at].name()).count() == 1;
    let name = if is_alone { tables[at].name() } else { tables[at].folder.display().to_string() };
    let runs = tables.iter().filter(|table| !table.is_measured).count();
    (runs > 1).then_some(name)
}

/// Title and labels of every sweep.
pub(super) type Sweeps = Vec<(String, Vec<String>)>;

/// The points of every case that is drawn, in the order of the rows; `count` are the curves of all results so far.
fn cases(table: &Table, places: &Places, wanted: &Wanted, count: &mut usize) -> Result<(Vec<Case>, Sweeps), NotDrawn> {
    // As many curves as run.json says; a run draws them from as many points.
    let values = places.chosen.iter().zip(&table.sweeps);
    let counts = values.map(|(chosen, sweep)| if chosen.is_some() { 1 } else { sweep.labels.len().max(1) });
    let share = counts.fold(places.y.len(), usize::saturating_mul);
    let most = most_points(share, share);
    let look = &wanted.look.asked;
    let is_log = [look.x.is_log, look.y.is_log];
    let begin = |_: &_, _, _: &[usize]| {
        *count += places.y.len();
        if *count > MAX_CURVES {
            let message = format!("the figure would hold more than {MAX_CURVES} curves");
            let help = "choose fewer columns, or some of the cases with --where PATH=VALUE".to_owned();
            return Err(NotDrawn::new(message, help));
        }
        Ok(vec![KeptCurve::on_axes(most, is_log); places.y.len()])
    };
    let add = |curves: &mut Vec<KeptCurve>, numbers: &[f64]| {
        curves.iter_mut().zip(&numbers[1..]).for_each(|(curve, y)| curve.push(numbers[0], *y));
    };
    let columns: Vec<usize> = [places.x].into_iter().chain(places.y.iter().copied()).collect();
    let reading = Reading { columns: &columns, chosen: &places.chosen, window: look.window };
    let (cases, sweeps) = table.cases(reading, begin, add)?;
    if cases.is_empty() {
        return Err(NotDrawn::new("there are no rows to draw", None));
    }
    if look.window.is_some() && cases.iter().all(|case| case.kept.iter().all(|curve| curve.points().is_empty())) {
        return Err(NotDrawn::new("--window: no row lies in it", "choose times that the run has".to_owned()));
    }
    Ok((cases, named(sweeps)))
}

/// Sweeps with names and values as legends show them.
pub(super) fn named(sweeps: Vec<Sweep>) -> Sweeps {
    let sweeps = sweeps
        .into_iter()
        .map(|sweep| labels::sweep(sweep.parameters.iter().map(String::as_str), &sweep.labels, sweep.are_names));
    sweeps.collect()
}
