//! What figures want of the rows: their curves, and the columns that those are made of.

use super::curve::MAX_CURVES_IN_ALL;
use crate::figures::FigureColumn;
use crate::table::matches;
use springpot::table::Column;
use springpot_scenario::units::Unit;
use springpot_scenario::{Cases, ColumnGlob, FigurePlan, RefusalKind, Refusals};

/// Most curves of one figure; a figure of more is left out with a word.
pub const MAX_CURVES: usize = 64;

/// Which data a figure draws.
#[derive(Debug, Clone, Default)]
pub struct FigureData {
    /// Cases, in order.
    pub cases: Vec<usize>,
    /// The curves of each of them.
    pub curves: Vec<FigureCurve>,
    /// Why it is not drawn; it has no cases and no curves then.
    pub left_out: Option<LeftOut>,
}

/// One curve of every case that a figure draws.
#[derive(Debug, Clone)]
pub struct FigureCurve {
    /// Its index in [`super::CaseResult`].
    pub index: usize,
    /// The abscissa.
    pub x: FigureColumn,
    /// The ordinate.
    pub y: FigureColumn,
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

/// The columns of a run, and those of them that figures want.
#[derive(Debug, Clone)]
pub(crate) struct Wanted {
    /// All columns of a run.
    columns: Vec<Column>,
    /// Indices into `columns` of those that are kept.
    kept: Vec<usize>,
    /// Curves of a case: indices into `kept` of x and y.
    curves: Vec<[usize; 2]>,
    /// Curves of all cases and figures so far.
    count: usize,
}

impl Wanted {
    /// Of a run with these columns: nothing yet.
    pub(super) fn new(columns: Vec<Column>) -> Self {
        Self { columns, kept: Vec::new(), curves: Vec::new(), count: 0 }
    }

    /// All columns of a run.
    pub(crate) fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// Indices in a row of the columns that are kept.
    pub(super) fn kept(&self) -> &[usize] {
        &self.kept
    }

    /// Where x and y of a curve stand among the kept columns.
    pub(super) fn places(&self, curve: usize) -> [usize; 2] {
        self.curves[curve]
    }

    /// Indices of the columns that a glob matches; at least one.
    ///
    /// # Errors
    /// It matches none.
    pub(crate) fn found(&self, glob: &ColumnGlob) -> Result<Vec<usize>, Refusals> {
        let columns = &self.columns;
        let found: Vec<usize> = (0..columns.len()).filter(|&k| matches(&glob.text, &columns[k].name)).collect();
        if found.is_empty() {
            let names = columns.iter().map(|column| column.name.as_str());
            let help = springpot_scenario::suggest(&glob.text, names);
            let message = format!("{:?} matches no column", glob.text);
            return Err(glob.place.refuse(RefusalKind::UnknownName, message).help(help).into());
        }
        Ok(found)
    }

    /// Keeps, of every case that `figure` selects, the curves with these columns as x and y.
    ///
    /// # Errors
    /// Units of the figure that match no column, or do not fit theirs.
    pub(crate) fn curves(
        &mut self,
        cases: &Cases,
        figure: &FigurePlan,
        curves: &[[usize; 2]],
    ) -> Result<FigureData, Refusals> {
        for unit in &figure.units {
            self.found(&unit.column)?;
        }
        let column = |k: usize| figure_column(figure, &self.columns[k]);
        let columns =
            curves.iter().map(|[x, y]| Ok((column(*x)?, column(*y)?))).collect::<Result<Vec<_>, Refusals>>()?;
        let fixed = |axis: usize| figure.selection.iter().find(|s| s.axis == axis).map(|s| s.value);
        let counts = (0..cases.axis_count()).map(|axis| if fixed(axis).is_some() { 1 } else { cases.axis_len(axis) });
        let count = counts.product::<usize>().saturating_mul(curves.len());
        let in_all = self.count.saturating_add(count);
        let left_out = match count {
            curves if curves > MAX_CURVES => Some(LeftOut::Curves { curves }),
            _ if in_all > MAX_CURVES_IN_ALL => Some(LeftOut::InAll { curves: in_all }),
            _ => None,
        };
        if left_out.is_some() {
            return Ok(FigureData { left_out, ..FigureData::default() });
        }
        self.count = in_all;
        let kept = curves.iter().map(|curve| curve.map(|k| place(&mut self.kept, k))).collect::<Vec<_>>();
        let curves = kept.into_iter().zip(columns).map(|(kept, (x, y))| FigureCurve {
            index: place(&mut self.curves, kept),
            x,
            y,
        });
        Ok(FigureData { curves: curves.collect(), cases: selected_cases(cases, &fixed), left_out })
    }
}

impl FigureData {
    /// Curves that are kept for it.
    pub(super) fn count(&self) -> usize {
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

fn selected_cases(cases: &Cases, fixed: &dyn Fn(usize) -> Option<usize>) -> Vec<usize> {
    let mut selected = vec![0];
    for axis in 0..cases.axis_count() {
        let (len, fixed) = (cases.axis_len(axis), fixed(axis));
        let values = || fixed.map_or(0..len, |value| value..value + 1);
        selected = selected.iter().flat_map(|case| values().map(move |k| case * len + k)).collect();
    }
    selected
}
