//! What figures want of the rows: their curves, and the columns that those are made of.

use super::curve::MAX_CURVES_IN_ALL;
use crate::metrics::is_within;
use crate::panels::{DrawnLook, FigureColumn, MeasuredPoints};
use crate::table::matches;
use springpot::table::Column;
use springpot_scenario::units::Unit;
use springpot_scenario::{
    Cases, ColumnGlob, FigureNumbers, FigurePlan, FigurePoints, Metric, MetricPlan, Place, RefusalKind, Refusals,
    Statistic,
};

/// Most curves of one figure; a figure of more is left out with a word.
pub const MAX_CURVES: usize = 64;

/// Most cases that the figures of statistics draw.
const MAX_SUMMED: usize = 100_000;

/// Which data a figure draws.
#[derive(Debug, Clone, Default)]
pub struct FigureData {
    /// Cases, in order.
    pub cases: Vec<usize>,
    /// The curves of each of them.
    pub curves: Vec<FigureCurve>,
    /// The statistics of each of them.
    pub totals: Vec<FigureTotal>,
    /// The abscissa of the statistics.
    pub over: Option<Abscissa>,
    /// The second axis of a map.
    pub across: Option<Abscissa>,
    /// Measured points beside them.
    pub measured: Vec<MeasuredPoints>,
    /// How it looks.
    pub look: DrawnLook,
    /// Why it is not drawn; it has no cases and no curves then.
    pub left_out: Option<LeftOut>,
}

/// One curve of every case that a figure draws.
#[derive(Debug, Clone)]
pub struct FigureCurve {
    /// Its index in [`crate::sweep::CaseResult`].
    pub index: usize,
    /// The abscissa.
    pub x: FigureColumn,
    /// The ordinate.
    pub y: FigureColumn,
}

/// A number of every case that a figure draws.
#[derive(Debug, Clone)]
pub struct FigureTotal {
    /// What it is.
    pub what: Total,
    /// Its column.
    pub y: FigureColumn,
}

/// A number of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Total {
    /// A statistic of a column.
    Statistic {
        /// Its index in [`crate::sweep::CaseCurves`].
        index: usize,
        /// Which it is.
        statistic: Statistic,
    },
    /// A metric, by its place in the scenario.
    Metric(usize),
}

/// What a figure sums a case up by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Summed {
    /// A statistic of the column with this index.
    Column(Statistic, usize),
    /// A metric, by its place in the scenario.
    Metric(usize),
}

/// A swept parameter as an abscissa.
#[derive(Debug, Clone)]
pub struct Abscissa {
    /// Its sweep.
    pub axis: usize,
    /// What stands there.
    pub column: FigureColumn,
    /// Its values, as `column` takes them.
    pub values: Vec<f64>,
    /// What they are called, where they are no numbers or have names: `values` are their places then.
    pub names: Vec<String>,
}

/// Rows with t in between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::sweep) struct Window {
    /// Where t stands among the kept columns.
    pub(in crate::sweep) t: usize,
    from: f64,
    to: f64,
}

impl Window {
    /// Whether a row belongs to it, the rounding of its time aside.
    pub(in crate::sweep) fn holds(&self, t: f64) -> bool {
        is_within([self.from, self.to], t)
    }
}

/// A curve of a case: places of x and y among the kept columns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::sweep) struct WantedCurve {
    pub(in crate::sweep) places: [usize; 2],
    pub(in crate::sweep) window: Option<Window>,
    /// Whether the axes are logarithmic.
    pub(in crate::sweep) is_log: [bool; 2],
}

/// Statistics of a column, by its place among the kept ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::sweep) struct WantedTotal {
    pub(in crate::sweep) place: usize,
    pub(in crate::sweep) window: Option<Window>,
}

/// A metric, where t and its column stand among the kept ones, and what the column is.
#[derive(Debug, Clone)]
pub(in crate::sweep) struct WantedMetric {
    /// Of the first case.
    pub(in crate::sweep) first: Metric,
    pub(in crate::sweep) t: usize,
    pub(in crate::sweep) place: usize,
    pub(in crate::sweep) column: Column,
    /// Where the derivatives of its column by each parameter are kept, where they are known.
    pub(in crate::sweep) changes: Option<Vec<usize>>,
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
    /// It takes statistics of too many cases.
    #[error("it would draw {cases} cases; choose some with `where` (at most {MAX_SUMMED})")]
    Cases {
        /// Cases that it would draw.
        cases: usize,
    },
}

/// The columns of a run, and those of them that figures want.
#[derive(Debug, Clone)]
pub(crate) struct Wanted {
    /// All columns of a run.
    columns: Vec<Column>,
    /// Indices into `columns` of those that are kept.
    kept: Vec<usize>,
    /// Curves and statistics of a case.
    curves: Vec<WantedCurve>,
    totals: Vec<WantedTotal>,
    /// Curves of all cases and figures so far.
    count: usize,
}

impl Wanted {
    /// Of a run with these columns: nothing yet.
    pub(in crate::sweep) fn new(columns: Vec<Column>) -> Self {
        Self { columns, kept: Vec::new(), curves: Vec::new(), totals: Vec::new(), count: 0 }
    }

    /// All columns of a run.
    pub(crate) fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// Indices in a row of the columns that are kept.
    pub(in crate::sweep) fn kept(&self) -> &[usize] {
        &self.kept
    }

    /// A curve.
    pub(in crate::sweep) fn curve(&self, index: usize) -> WantedCurve {
        self.curves[index]
    }

    /// Statistics of a column.
    pub(in crate::sweep) fn total(&self, index: usize) -> WantedTotal {
        self.totals[index]
    }

    /// The window of a figure; keeps the times for it.
    fn window(&mut self, figure: &FigurePlan) -> Option<Window> {
        let [from, to] = figure.look.window?;
        let t = self.columns.iter().position(|column| column.name == "t")?;
        Some(Window { t: place(&mut self.kept, t), from, to })
    }

    /// Keeps the column of a metric, and the times.
    ///
    /// # Errors
    /// There is no such column.
    pub(in crate::sweep) fn metric(&mut self, plan: &MetricPlan) -> Result<WantedMetric, Refusals> {
        let found = |name: &str| self.columns.iter().position(|column| column.name == name);
        let (Some(t), Some(at)) = (found("t"), found(&plan.metric.of)) else {
            let message = format!("metric {:?}: this run has no column {:?}", plan.metric.name, plan.metric.of);
            let names = self.columns.iter().map(|column| column.name.as_str());
            let help = springpot_scenario::suggest(&plan.metric.of, names);
            return Err(plan.of.refuse(RefusalKind::UnknownName, message).help(help).into());
        };
        let column = self.columns[at].clone();
        let (t, place) = (place(&mut self.kept, t), place(&mut self.kept, at));
        Ok(WantedMetric { first: plan.metric.clone(), t, place, column, changes: None })
    }

    /// Keeps a place in a row, whether or not a column of the run stands there.
    pub(in crate::sweep) fn keep(&mut self, at: usize) -> usize {
        place(&mut self.kept, at)
    }

    /// A column as a figure draws it.
    ///
    /// # Errors
    /// Units of the figure that do not fit it.
    pub(crate) fn drawn(&self, figure: &FigurePlan, column: usize) -> Result<FigureColumn, Refusals> {
        figure_column(figure, &self.columns[column])
    }

    /// Refuses units and labels that match no column, `others` included.
    fn check_names(&self, figure: &FigurePlan, others: &[Column]) -> Result<(), Refusals> {
        let labels = figure.look.labels.iter().map(|label| &label.column);
        let names = figure.units.iter().map(|unit| &unit.column).chain(labels);
        let mut names = names.filter(|glob| !others.iter().any(|column| matches(&glob.text, &column.name)));
        names.try_for_each(|glob| self.found(glob).map(drop))
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
        self.check_names(figure, &[])?;
        let column = |k: usize| self.drawn(figure, k);
        let columns =
            curves.iter().map(|[x, y]| Ok((column(*x)?, column(*y)?))).collect::<Result<Vec<_>, Refusals>>()?;
        let look = match columns.first() {
            Some((x, _)) => {
                let y: Vec<FigureColumn> = columns.iter().map(|(_, y)| y.clone()).collect();
                DrawnLook::of(figure, x, &y)?
            }
            None => DrawnLook::default(),
        };
        let measured = figure.data.iter().map(|data| measured(data, &columns)).collect::<Result<_, _>>()?;
        let fixed = |axis: usize| figure.selection.iter().find(|s| s.axis == axis).map(|s| s.value);
        let counts = (0..cases.axis_count()).map(|axis| if fixed(axis).is_some() { 1 } else { cases.axis_len(axis) });
        let count = counts.product::<usize>().saturating_mul(curves.len());
        if let Some(left_out) = self.count_in(count) {
            return Ok(FigureData { left_out: Some(left_out), ..FigureData::default() });
        }
        let (window, is_log) = (self.window(figure), [figure.look.x.is_log, figure.look.y.is_log]);
        let kept = curves.iter().map(|curve| curve.map(|k| place(&mut self.kept, k))).collect::<Vec<_>>();
        let curves = kept.into_iter().zip(columns).map(|(places, (x, y))| FigureCurve {
            index: place(&mut self.curves, WantedCurve { places, window, is_log }),
            x,
            y,
        });
        let (curves, cases) = (curves.collect(), selected_cases(cases, &fixed));
        Ok(FigureData { curves, cases, measured, look, ..FigureData::default() })
    }

    /// Keeps, of every case that `figure` selects, these numbers, over a swept parameter.
    ///
    /// # Errors
    /// As [`Self::curves`].
    pub(crate) fn totals(
        &mut self,
        cases: &Cases,
        figure: &FigurePlan,
        (over, across): (Abscissa, Option<Abscissa>),
        totals: &[Summed],
    ) -> Result<FigureData, Refusals> {
        let metrics = totals.iter().filter_map(|total| match total {
            Summed::Column(..) => None,
            Summed::Metric(k) => Some(self.metric_column(&cases.metrics()[*k].metric)),
        });
        self.check_names(figure, &metrics.collect::<Vec<_>>())?;
        let column = |total: &Summed| match *total {
            Summed::Column(statistic, k) => Ok(self.drawn(figure, k)?.summed(statistic)),
            Summed::Metric(k) => {
                let metric = &cases.metrics()[k].metric;
                let column = figure_column(figure, &self.metric_column(metric))?;
                Ok(FigureColumn { label: column.label.or_else(|| Some(metric.name.clone())), ..column })
            }
        };
        let columns = totals.iter().map(column).collect::<Result<Vec<_>, Refusals>>()?;
        let look = DrawnLook::of(figure, &over.column, &columns)?;
        let fixed = |axis: usize| figure.selection.iter().find(|s| s.axis == axis).map(|s| s.value);
        let len = |axis: usize| if fixed(axis).is_some() { 1 } else { cases.axis_len(axis) };
        let is_other = |axis: &usize| *axis != over.axis && across.as_ref().is_none_or(|across| *axis != across.axis);
        let others = (0..cases.axis_count()).filter(is_other).map(len).product::<usize>();
        let summed = (0..cases.axis_count()).map(len).fold(1, usize::saturating_mul);
        let too_many = (summed > MAX_SUMMED).then_some(LeftOut::Cases { cases: summed });
        if let Some(left_out) = too_many.or_else(|| self.count_in(others.saturating_mul(totals.len()))) {
            return Ok(FigureData { left_out: Some(left_out), ..FigureData::default() });
        }
        let window = self.window(figure);
        let totals = totals.iter().zip(columns).map(|(total, y)| {
            let what = match *total {
                Summed::Column(statistic, k) => {
                    let wanted = WantedTotal { place: place(&mut self.kept, k), window };
                    Total::Statistic { index: place(&mut self.totals, wanted), statistic }
                }
                Summed::Metric(k) => Total::Metric(k),
            };
            FigureTotal { what, y }
        });
        let (totals, cases) = (totals.collect(), selected_cases(cases, &fixed));
        Ok(FigureData { totals, cases, look, over: Some(over), across, ..FigureData::default() })
    }

    /// A metric as a figure draws it.
    fn metric_column(&self, metric: &Metric) -> Column {
        let of = self.columns.iter().find(|column| column.name == metric.of);
        let unit = metric.kind.unit(of.map_or("", |column| &column.unit));
        Column::new(format!("metric({})", metric.name), unit, "")
    }

    /// Counts the curves of one more figure, or says why there are too many.
    fn count_in(&mut self, count: usize) -> Option<LeftOut> {
        let in_all = self.count.saturating_add(count);
        if count > MAX_CURVES {
            return Some(LeftOut::Curves { curves: count });
        }
        if in_all > MAX_CURVES_IN_ALL {
            return Some(LeftOut::InAll { curves: in_all });
        }
        self.count = in_all;
        None
    }
}

impl FigureData {
    /// Curves that are kept for it.
    pub(in crate::sweep) fn count(&self) -> usize {
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
    let labels = figure.look.labels.iter().rev();
    let label =
        labels.into_iter().find(|label| matches(&label.column.text, &column.name)).map(|label| label.text.clone());
    Ok(FigureColumn { column: column.clone(), unit, label })
}

/// Measured points in the units of the columns that are drawn: along y that of the first column that they fit.
fn measured(data: &FigurePoints, columns: &[(FigureColumn, FigureColumn)]) -> Result<MeasuredPoints, Refusals> {
    let fits = |unit: &Option<Unit>, column: &FigureColumn| match (unit, si_unit(&column.column)) {
        (Some(unit), Some(own)) => unit.dimension() == own.dimension(),
        (Some(_), None) => false,
        (None, _) => true,
    };
    let refuse = |place: &Place, column: &FigureColumn| -> Refusals {
        let unit = if column.column.unit.is_empty() { "pure numbers" } else { &column.column.unit };
        let message = format!("measured points are drawn beside {}, which is in {unit}", column.column.name);
        place.refuse(RefusalKind::BadQuantity, message).help("write a unit of the same dimension").into()
    };
    let Some((x, first)) = columns.first() else {
        return Ok(MeasuredPoints { label: data.label.clone(), of: 0, x: Vec::new(), y: Vec::new() });
    };
    if !fits(&data.x.unit, x) {
        return Err(refuse(&data.x.place, x));
    }
    let of = columns.iter().position(|(_, y)| fits(&data.y.unit, y)).ok_or_else(|| refuse(&data.y.place, first))?;
    let drawn = |values: &FigureNumbers, column: &FigureColumn| {
        let si = |value: &f64| values.unit.as_ref().map_or(*value, |unit| unit.to_si(*value));
        values.numbers.iter().map(|value| column.number(si(value))).collect()
    };
    Ok(MeasuredPoints { label: data.label.clone(), of, x: drawn(&data.x, x), y: drawn(&data.y, &columns[of].1) })
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
