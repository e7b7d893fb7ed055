//! Ranges, scales, size and words of a figure of curves, in the units that it is drawn in.

use super::column::{FigureColumn, groups};
use springpot_scenario::units::{self, Unit};
use springpot_scenario::{FigurePlan, Look, RangeEnd, RefusalKind, Refusals};

/// How a figure looks with the columns that it shows.
#[derive(Debug, Clone, Default)]
pub struct DrawnLook {
    /// What was asked.
    pub asked: Look,
    /// From where to where x runs, as drawn.
    pub x_range: Option<[f64; 2]>,
    /// The same of y, and which of the units it is for.
    pub y_range: Option<(usize, [f64; 2])>,
}

/// Why a look does not fit the columns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Misfit {
    /// The option.
    pub(crate) option: &'static str,
    /// What is wrong with it.
    pub(crate) message: String,
    /// What would be right.
    pub(crate) help: String,
}

impl DrawnLook {
    /// The look of a figure with these columns.
    ///
    /// # Errors
    /// Ranges that do not rise, or are in units of something else; equal lengths of different units.
    pub(crate) fn new(asked: Look, x: &FigureColumn, y: &[FigureColumn]) -> Result<Self, Misfit> {
        let misfit = |option| move |(message, help)| Misfit { option, message, help };
        let x_range =
            asked.x.range.as_ref().map(|ends| range(ends, x, asked.x.is_log)).transpose().map_err(misfit("x_range"))?;
        let groups = groups(y);
        let y_range = match &asked.y.range {
            None => None,
            Some(ends) => {
                // Quantities find their axis, numbers are of the first.
                let firsts = groups.iter().map(|group| &y[group[0]]).enumerate();
                let mut tried = firsts.map(|(at, column)| range(ends, column, asked.y.is_log).map(|range| (at, range)));
                let first = tried.next().transpose().map_err(misfit("y_range"));
                match first {
                    Ok(range) => range,
                    Err(error) => Some(tried.find_map(Result::ok).ok_or(error)?),
                }
            }
        };
        if asked.is_equal && (groups.len() > 1 || y.iter().any(|y| y.unit_name() != x.unit_name())) {
            let units: Vec<String> = std::iter::once(x).chain(y).map(FigureColumn::axis).collect();
            let message = format!("x and y have different units: {}", units.join("; "));
            return Err(misfit("aspect")((message, "give both one unit with `units`, or leave it out".into())));
        }
        Ok(Self { asked, x_range, y_range })
    }

    /// That of a scenario's figure.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub(crate) fn of(figure: &FigurePlan, x: &FigureColumn, y: &[FigureColumn]) -> Result<Self, Refusals> {
        Self::new(figure.look.clone(), x, y).map_err(|Misfit { option, message, help }| {
            let said = figure.look.said(option);
            let what = said.map_or("", |said| &said.what);
            let place = said.and_then(|said| said.place.as_ref()).unwrap_or(&figure.place);
            place.refuse(RefusalKind::OutOfRange, format!("{what} {message}")).help(help).into()
        })
    }

    /// Width and height, mm.
    pub(crate) fn size(&self) -> Option<[f64; 2]> {
        self.asked.size.map(millimetres)
    }
}

/// Lengths in mm.
pub(crate) fn millimetres(size: [f64; 2]) -> [f64; 2] {
    size.map(|side| 1e3 * side)
}

/// A range in the unit that a column is drawn in; else what is wrong, and what would be right.
fn range(ends: &[RangeEnd; 2], column: &FigureColumn, is_log: bool) -> Result<[f64; 2], (String, String)> {
    let end = |end: &RangeEnd| -> Result<f64, (String, String)> {
        let Some(unit) = &end.unit else { return Ok(end.number) };
        let expected = if column.column.unit.is_empty() { "1" } else { &column.column.unit };
        let fits = match (Unit::parse(expected, &|_| None), Unit::parse(unit, &|_| None)) {
            (Ok(own), Ok(unit)) => own.dimension() == unit.dimension(),
            _ => false,
        };
        let value = units::parse_quantity(&end.written(), &column.column.unit, &|_| None);
        match value {
            Ok(value) if fits => Ok(column.number(value)),
            _ => {
                let message = format!("holds {}, but {} is in {}", end.written(), column.name(), column.unit_name());
                Err((message, format!("write a number, or a quantity in {}", column.unit_name())))
            }
        }
    };
    let [from, to] = [end(&ends[0])?, end(&ends[1])?];
    let shown = format!("runs from {} to {}", ends[0].written(), ends[1].written());
    if from >= to {
        let help = if from > to { "write the smaller end first" } else { "write two different ends" };
        return Err((shown, help.into()));
    }
    if is_log && from <= 0.0 {
        return Err((format!("{shown} on a logarithmic scale"), "both ends must be above zero".into()));
    }
    Ok([from, to])
}
