//! Ranges, scales, size and words of a figure of curves, in the units that it is drawn in.

use super::panels::{FigureColumn, groups};
use springpot_scenario::units::{self, Unit};
use springpot_scenario::{FigurePlan, RangeEnd, RefusalKind, Refusals};

/// What is asked of the look of a figure.
#[derive(Debug, Clone, Default)]
pub struct AskedLook {
    /// Along x.
    pub x: AskedAxis,
    /// Along y.
    pub y: AskedAxis,
    /// Lengths along x and y have one scale.
    pub is_equal: bool,
    /// Width and height, m.
    pub size: Option<[f64; 2]>,
    /// What stands above the legend.
    pub legend: Option<String>,
    /// There is no legend.
    pub hides_legend: bool,
}

/// What is asked of an axis.
#[derive(Debug, Clone, Default)]
pub struct AskedAxis {
    /// From where to where it runs.
    pub range: Option<[RangeEnd; 2]>,
    /// It is logarithmic.
    pub is_log: bool,
    /// What stands at it.
    pub label: Option<String>,
}

/// How a figure looks.
#[derive(Debug, Clone, Default)]
pub struct Look {
    /// What was asked.
    pub asked: AskedLook,
    /// From where to where x runs, as drawn.
    pub x_range: Option<[f64; 2]>,
    /// The same of y, and which of the units it is for.
    pub y_range: Option<(usize, [f64; 2])>,
}

/// Which part of a look does not fit the columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// The range of x.
    X,
    /// The range of y.
    Y,
    /// Equal lengths.
    Aspect,
}

/// Why a look does not fit the columns: which part, what is wrong, and what would be right.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Misfit {
    /// The part.
    pub part: Part,
    /// What is wrong with it.
    pub message: String,
    /// What would be right.
    pub help: String,
}

impl Look {
    /// The look of a figure with these columns.
    ///
    /// # Errors
    /// Ranges that do not rise, or are in units of something else; equal lengths of different units.
    pub fn new(asked: AskedLook, x: &FigureColumn, y: &[FigureColumn]) -> Result<Self, Misfit> {
        let misfit = |part| move |(message, help)| Misfit { part, message, help };
        let x_range =
            asked.x.range.as_ref().map(|ends| range(ends, x, asked.x.is_log)).transpose().map_err(misfit(Part::X))?;
        let groups = groups(y);
        let y_range = match &asked.y.range {
            None => None,
            Some(ends) => {
                // Quantities find their axis, numbers are of the first.
                let firsts = groups.iter().map(|group| &y[group[0]]).enumerate();
                let mut tried = firsts.map(|(at, column)| range(ends, column, asked.y.is_log).map(|range| (at, range)));
                let first = tried.next().transpose().map_err(misfit(Part::Y));
                match first {
                    Ok(range) => range,
                    Err(error) => Some(tried.find_map(Result::ok).ok_or(error)?),
                }
            }
        };
        if asked.is_equal && (groups.len() > 1 || y.iter().any(|y| y.unit_name() != x.unit_name())) {
            let units: Vec<String> = std::iter::once(x).chain(y).map(FigureColumn::axis).collect();
            let message = format!("x and y have different units: {}", units.join("; "));
            return Err(Misfit {
                part: Part::Aspect,
                message,
                help: "give both one unit with `units`, or leave it out".into(),
            });
        }
        Ok(Self { asked, x_range, y_range })
    }

    /// That of a scenario's figure.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub(crate) fn of(figure: &FigurePlan, x: &FigureColumn, y: &[FigureColumn]) -> Result<Self, Refusals> {
        let look = &figure.look;
        let axis = |axis: &springpot_scenario::AxisLook| AskedAxis {
            range: axis.range.as_ref().map(|range| range.ends.clone()),
            is_log: axis.is_log,
            label: axis.label.clone(),
        };
        let asked = AskedLook {
            x: axis(&look.x),
            y: axis(&look.y),
            is_equal: look.equal.is_some(),
            size: look.size,
            legend: look.legend.clone(),
            hides_legend: look.hides_legend,
        };
        Self::new(asked, x, y).map_err(|Misfit { part, message, help }| {
            let range = |axis: &springpot_scenario::AxisLook| {
                axis.range.as_ref().map(|range| (range.what.clone(), range.place.clone()))
            };
            let found = match part {
                Part::X => range(&look.x),
                Part::Y => range(&look.y),
                Part::Aspect => look.equal.clone().map(|place| ("aspect = \"equal\":".to_owned(), place)),
            };
            let (what, place) = found.unwrap_or_else(|| (String::new(), figure.place.clone()));
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
