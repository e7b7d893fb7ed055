//! Which columns are written, and which are kept in memory for the figures.

use super::curve::{MAX_CURVES_IN_ALL, most_points};
use crate::figures::FigureColumn;
use crate::table::matches;
use springpot::integrate::System;
use springpot::observe::Quantity;
use springpot::table::Column;
use springpot_scenario::units::Unit;
use springpot_scenario::{Cases, ColumnGlob, FigureKind, FigurePlan, RefusalKind, Refusals};

/// Most curves of one figure; a figure of more is left out with a word.
pub const MAX_CURVES: usize = 64;

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
    /// Curves of a case: indices into `kept` of x and y.
    curves: Vec<[usize; 2]>,
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
    /// For each ordinate, the index of its curve in [`super::CaseResult`].
    pub curves: Vec<usize>,
    /// Why it is not drawn; it has no cases then.
    pub left_out: Option<LeftOut>,
}

/// Why a figure is not drawn.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LeftOut {
    /// It has more than [`MAX_CURVES`]: choose columns or cases.
    #[error("it would hold {curves} curves; choose some with `where` (at most {MAX_CURVES})")]
    Curves {
        /// Curves that it would have.
        curves: usize,
    },
    /// With those before it, it has more than [`MAX_CURVES_IN_ALL`]: choose columns or cases here or there.
    #[error(
        "it and the figures before it would hold {curves} curves; choose some with `where` (at most {MAX_CURVES_IN_ALL})"
    )]
    InAll {
        /// Curves that they would have.
        curves: usize,
    },
}

impl Layout {
    /// Lays out the columns of a sweep whose first case is `system`.
    ///
    /// # Errors
    /// Globs that match no column, units that do not fit their column.
    pub fn new(cases: &Cases, system: &System) -> Result<Self, Refusals> {
        let observables = system.observables();
        let (columns, time) = (observables.columns(), observables.column(Quantity::Time));
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
        let (kept, curves, figures) = (Vec::new(), Vec::new(), Vec::new());
        let mut layout = Self { written, swept, columns, selected, kept, curves, figures };
        for figure in cases.figures() {
            let data = layout.figure(cases, figure, &time)?;
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

    /// The curves that figures draw of `case`: their indices, and where x and y stand among the kept columns.
    pub(super) fn drawn(&self, case: usize) -> impl Iterator<Item = (usize, [usize; 2])> {
        let figures = self.figures.iter().filter(move |figure| figure.cases.binary_search(&case).is_ok());
        figures.flat_map(|figure| &figure.curves).map(|&curve| (curve, self.curves[curve]))
    }

    /// Points that each curve keeps at most.
    pub fn most_points(&self) -> usize {
        let counts = || self.figures.iter().map(FigureData::count);
        most_points(counts().max().unwrap_or(0), counts().sum())
    }

    /// The data of the figures, in the order of the scenario; robots draw none.
    pub fn figures(&self) -> &[FigureData] {
        &self.figures
    }

    fn figure(&mut self, cases: &Cases, figure: &FigurePlan, time: &Column) -> Result<FigureData, Refusals> {
        let FigureKind::Curves { x, y } = &figure.kind else {
            let x = FigureColumn { column: time.clone(), unit: None };
            return Ok(FigureData { cases: Vec::new(), x, y: Vec::new(), curves: Vec::new(), left_out: None });
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
        let column = |k: usize| figure_column(figure, &self.columns[k]);
        let x = column(abscissa)?;
        let y = ordinates.iter().map(|&k| column(k)).collect::<Result<Vec<_>, _>>()?;
        let fixed = |axis: usize| figure.selection.iter().find(|s| s.axis == axis).map(|s| s.value);
        let counts = (0..cases.axis_count()).map(|axis| if fixed(axis).is_some() { 1 } else { cases.axis_len(axis) });
        let count = counts.product::<usize>().saturating_mul(y.len());
        let in_all = self.figures.iter().map(FigureData::count).sum::<usize>().saturating_add(count);
        let left_out = match count {
            curves if curves > MAX_CURVES => Some(LeftOut::Curves { curves }),
            _ if in_all > MAX_CURVES_IN_ALL => Some(LeftOut::InAll { curves: in_all }),
            _ => None,
        };
        if left_out.is_some() {
            return Ok(FigureData { cases: Vec::new(), x, y, curves: Vec::new(), left_out });
        }
        let x_kept = place(&mut self.kept, abscissa);
        let curves = ordinates.iter().map(|&k| [x_kept, place(&mut self.kept, k)]).collect::<Vec<_>>();
        let curves = curves.into_iter().map(|curve| place(&mut self.curves, curve)).collect();
        Ok(FigureData { cases: selected_cases(cases, &fixed), x, y, curves, left_out })
    }
}

impl FigureData {
    /// Curves that are kept for it.
    fn count(&self) -> usize {
        self.cases.len() * self.curves.len()
    }
}

/// A column with the unit that a figure draws it in.
fn figure_column(figure: &FigurePlan, column: &Column) -> Result<FigureColumn, Refusals> {
    let mut unit = None;
    for wanted in figure.units.iter().filter(|unit| matches(&unit.column.text, &column.name)) {
        let (own, parsed) = (si_unit(column), Unit::parse(&wanted.unit, &|_| None));
        let (Some(own), Ok(parsed)) = (own, parsed) else { continue };
        if own.dimension() != parsed.dimension() {
            let message = format!("{} is in {}, which does not convert to {}", column.name, column.unit, wanted.unit);
            return Err(wanted.column.place.refuse(RefusalKind::BadQuantity, message).into());
        }
        unit = Some((wanted.unit.clone(), parsed));
    }
    Ok(FigureColumn { column: column.clone(), unit })
}

/// Index of an item in a list, to which it is added where it is missing.
fn place<T: PartialEq>(list: &mut Vec<T>, item: T) -> usize {
    list.iter().position(|other| *other == item).unwrap_or_else(|| {
        list.push(item);
        list.len() - 1
    })
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
        let help = springpot_scenario::suggest(&glob.text, names);
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
