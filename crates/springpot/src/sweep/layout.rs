//! Which columns are written, and which are kept in memory for the figures.

use crate::scenario::units::Unit;
use crate::scenario::{Cases, ColumnGlob, FigureKind, FigurePlan, RefusalKind, Refusals};
use crate::simulate::System;
use crate::table::{Column, matches};

/// Most curves of one figure; a figure of more is left out with a word.
pub const MAX_CURVES: usize = 64;

/// Most values that a figure keeps in memory; a figure of more is left out with a word.
pub const MAX_POINTS: usize = 100_000_000;

/// The columns of a sweep.
#[derive(Debug, Clone)]
pub struct Layout {
    /// Swept parameters, then the run's columns that are asked for.
    written: Vec<Column>,
    swept: usize,
    /// All columns of a run.
    columns: Vec<Column>,
    /// Indices into `columns` of those that are written.
    selected: Vec<usize>,
    /// Indices into `columns` of those that figures need.
    kept: Vec<usize>,
    figures: Vec<FigureData>,
}

/// Which data a figure draws.
#[derive(Debug, Clone)]
pub struct FigureData {
    /// Cases, in order.
    pub cases: Vec<usize>,
    /// The abscissa.
    pub x: FigureColumn,
    /// The ordinates.
    pub y: Vec<FigureColumn>,
    /// Curves it would have; where that is more than [`MAX_CURVES`], it has no cases.
    pub curves: usize,
    /// Values that it would keep; where that is more than [`MAX_POINTS`], it has no cases.
    pub points: usize,
}

/// A column of a figure.
#[derive(Debug, Clone)]
pub struct FigureColumn {
    /// The column.
    pub column: Column,
    /// Index into the kept columns of [`super::CaseResult`].
    pub kept: usize,
    /// The unit it is drawn in and how SI values become numbers of it; `None`: SI.
    pub unit: Option<(String, Unit)>,
}

impl Layout {
    /// Lays out the columns of a sweep whose first case is `system`.
    ///
    /// # Errors
    /// Globs that match no column, units that do not fit their column.
    pub fn new(cases: &Cases, system: &System) -> Result<Self, Refusals> {
        let columns = system.columns();
        let swept = cases.parameters().len();
        let selected = match cases.columns() {
            None => (0..columns.len()).collect(),
            Some(globs) => {
                let mut selected: Vec<usize> = Vec::new();
                for glob in globs {
                    selected.extend(found(glob, &columns)?);
                }
                selected.sort_unstable();
                selected.dedup();
                selected
            }
        };
        let parameters = cases.parameters().iter().map(|name| Column::new(name.as_str(), "", "swept parameter"));
        let written = parameters.chain(selected.iter().map(|&k| columns[k].clone())).collect();
        let mut layout = Self { written, swept, columns, selected, kept: Vec::new(), figures: Vec::new() };
        for figure in cases.figures() {
            let data = layout.figure(cases, figure)?;
            layout.figures.push(data);
        }
        Ok(layout)
    }

    /// Columns of results.csv.
    pub fn written(&self) -> &[Column] {
        &self.written
    }

    /// How many of them, the first ones, are swept parameters.
    pub fn swept(&self) -> usize {
        self.swept
    }

    /// Columns of summary.csv.
    pub(super) fn summary_columns(&self) -> Vec<Column> {
        let plain = |name: &str| Column::new(name, "", "");
        let swept = self.written[..self.swept].iter().cloned();
        swept.chain(["column", "unit", "min", "max", "rms"].map(plain)).collect()
    }

    /// The run's columns that are written, with their indices in a row.
    pub(super) fn selected(&self) -> impl Iterator<Item = (usize, &Column)> {
        self.selected.iter().map(|&k| (k, &self.columns[k]))
    }

    /// Indices in a row of the columns that `case` keeps for figures; `None` where it draws none.
    pub(super) fn kept(&self, case: usize) -> Option<&[usize]> {
        self.figures.iter().any(|figure| figure.cases.binary_search(&case).is_ok()).then_some(&self.kept[..])
    }

    /// The data of the figures, in the order of the scenario; robots draw none.
    pub fn figures(&self) -> &[FigureData] {
        &self.figures
    }

    fn figure(&mut self, cases: &Cases, figure: &FigurePlan) -> Result<FigureData, Refusals> {
        let FigureKind::Curves { x, y } = &figure.kind else {
            let x = FigureColumn { column: self.columns[0].clone(), kept: 0, unit: None };
            return Ok(FigureData { cases: Vec::new(), x, y: Vec::new(), curves: 0, points: 0 });
        };
        let abscissa = match found(x, &self.columns)?[..] {
            [only] => only,
            _ => return Err(x.place.refuse(RefusalKind::Rule, "x matches several columns; it takes one").into()),
        };
        let mut ordinates = Vec::new();
        for glob in y {
            for k in found(glob, &self.columns)? {
                if !ordinates.contains(&k) {
                    ordinates.push(k);
                }
            }
        }
        for unit in &figure.units {
            found(&unit.column, &self.columns)?;
        }
        let x = self.figure_column(figure, abscissa)?;
        let y = ordinates.into_iter().map(|k| self.figure_column(figure, k)).collect::<Result<Vec<_>, _>>()?;
        let fixed = |axis: usize| figure.selection.iter().find(|s| s.axis == axis).map(|s| s.value);
        let counts = (0..cases.axis_count()).map(|axis| if fixed(axis).is_some() { 1 } else { cases.axis_len(axis) });
        let curves = counts.product::<usize>() * y.len();
        let rows = cases.plan(0)?.time.rows.count();
        let points = curves.saturating_add(curves / y.len().max(1)).saturating_mul(rows);
        let too_large = curves > MAX_CURVES || points > MAX_POINTS;
        let drawn = if too_large { Vec::new() } else { selected_cases(cases, &fixed) };
        Ok(FigureData { cases: drawn, x, y, curves, points })
    }

    fn figure_column(&mut self, figure: &FigurePlan, index: usize) -> Result<FigureColumn, Refusals> {
        let column = self.columns[index].clone();
        let kept = self.kept.iter().position(|k| *k == index).unwrap_or_else(|| {
            self.kept.push(index);
            self.kept.len() - 1
        });
        let mut unit = None;
        for wanted in figure.units.iter().filter(|unit| matches(&unit.column.text, &column.name)) {
            let (own, parsed) = (si_unit(&column), Unit::parse(&wanted.unit, &|_| None));
            let (Some(own), Ok(parsed)) = (own, parsed) else { continue };
            if own.dimension() != parsed.dimension() {
                let message =
                    format!("{} is in {}, which does not convert to {}", column.name, column.unit, wanted.unit);
                return Err(wanted.column.place.refuse(RefusalKind::BadQuantity, message).into());
            }
            unit = Some((wanted.unit.clone(), parsed));
        }
        Ok(FigureColumn { column, kept, unit })
    }
}

/// The unit of a column, where it has a fixed one.
fn si_unit(column: &Column) -> Option<Unit> {
    Unit::parse(if column.unit.is_empty() { "1" } else { &column.unit }, &|_| None).ok()
}

/// Indices of the columns that a glob matches; at least one.
fn found(glob: &ColumnGlob, columns: &[Column]) -> Result<Vec<usize>, Refusals> {
    let found: Vec<usize> = (0..columns.len()).filter(|&k| matches(&glob.text, &columns[k].name)).collect();
    if found.is_empty() {
        let names = columns.iter().map(|column| column.name.as_str());
        let help = crate::scenario::suggest(&glob.text, names);
        let message = format!("{:?} matches no column", glob.text);
        return Err(glob.place.refuse(RefusalKind::UnknownName, message).help(help).into());
    }
    Ok(found)
}

fn selected_cases(cases: &Cases, fixed: &dyn Fn(usize) -> Option<usize>) -> Vec<usize> {
    let mut selected = vec![0];
    for axis in 0..cases.axis_count() {
        let (len, fixed) = (cases.axis_len(axis), fixed(axis));
        let values = || fixed.map_or(0..len, |value| value..value + 1);
        selected = selected.iter().flat_map(|case| values().map(move |k| case * len + k)).collect();
    }
    selected
}
