//! Statistics of columns, and metrics, over a swept parameter.

use super::look::DrawnLook;
use super::panels::{Curves, DrawnCase, FigureColumn};
use super::source::{FreeSweeps, Source};
use crate::labels;
use crate::sweep::{Abscissa, CaseResult, FigureData, FigureTotal, Summed, Total, Wanted};
use springpot::table::Column;
use springpot_report::{Plot, Rendered};
use springpot_scenario::units::Unit;
use springpot_scenario::{Cases, FigurePlan, RangeEnd, RefusalKind, Refusals, Summarised, SweptAxis};

/// A curve for each statistic and each value of the other sweeps.
pub(super) fn data(
    cases: &Cases,
    figure: &FigurePlan,
    wanted: &mut Wanted,
    x: &SweptAxis,
    y: &[Summarised],
) -> Result<FigureData, Refusals> {
    let mut totals = Vec::new();
    for summarised in y {
        let found: Vec<Summed> = match summarised {
            Summarised::Columns { statistic, columns } => {
                wanted.found(columns)?.into_iter().map(|column| Summed::Column(*statistic, column)).collect()
            }
            // The scenario was refused where there is none.
            Summarised::Metric(name) => {
                let place = cases.metrics().iter().position(|plan| plan.metric.name == *name);
                place.into_iter().map(Summed::Metric).collect()
            }
        };
        for one in found {
            if !totals.contains(&one) {
                totals.push(one);
            }
        }
    }
    wanted.totals(cases, figure, abscissa(cases, figure, x)?, &totals)
}

/// The swept values as numbers in the unit that the first is written in.
fn abscissa(cases: &Cases, figure: &FigurePlan, x: &SweptAxis) -> Result<Abscissa, Refusals> {
    let written: Vec<String> = (0..cases.axis_len(x.axis)).map(|k| cases.axis_label_of(x.axis, &x.path, k)).collect();
    match swept_numbers(&x.path, &written) {
        Ok((column, values)) => Ok(Abscissa { axis: x.axis, column, values }),
        Err((message, help)) => Err(figure.place.refuse(RefusalKind::Rule, message).help(help).into()),
    }
}

/// Values of a sweep, as they were written, as an abscissa: the column in the unit of the first, and SI numbers.
///
/// # Errors
/// What is wrong with them, and what would be right: texts, values in several units.
pub(super) fn swept_numbers(
    path: &str,
    written: &[String],
) -> Result<(FigureColumn, Vec<f64>), (String, &'static str)> {
    let mut unit: Option<Option<(String, Unit)>> = None;
    let mut values = Vec::with_capacity(written.len());
    for written in written {
        let Ok(end) = RangeEnd::parse(written) else {
            let message = format!("a summary over {path} needs numbers, and {written} is none");
            return Err((message, "draw it over a parameter that is swept over numbers or quantities"));
        };
        let own = end.unit.as_ref().and_then(|text| Some((text.clone(), Unit::parse(text, &|_| None).ok()?)));
        let first = unit.get_or_insert_with(|| own.clone());
        let value = match (first, &own) {
            (None, None) => end.number,
            (Some((_, first)), Some((_, own))) if first.dimension() == own.dimension() => own.to_si(end.number),
            _ => {
                let message = format!("a summary over {path} needs values in one unit, and {written} has another");
                return Err((message, "write all values of the sweep with one unit, or all without"));
            }
        };
        values.push(value);
    }
    let unit = unit.flatten();
    let column = Column::new(path, unit.as_ref().map_or("", |(text, _)| text), "swept parameter");
    Ok((FigureColumn { column, unit, label: Some(labels::parameter(path)) }, values))
}

/// Numbers of cases over a swept parameter: those that differ in it alone make a curve of each number.
#[derive(Default)]
pub(super) struct CasesOver(Vec<CaseGroup>);

/// Cases that differ in the abscissa alone: whose they are, values of the other sweeps, and of each number the points.
struct CaseGroup {
    source: Option<String>,
    values: Vec<(String, String)>,
    points: Vec<Vec<[f64; 2]>>,
}

impl CasesOver {
    /// Takes the numbers of a case.
    pub(super) fn take(&mut self, source: Option<String>, values: Vec<(String, String)>, x: f64, numbers: &[f64]) {
        let known = self.0.iter().position(|other| other.source == source && other.values == values);
        let at = known.unwrap_or_else(|| {
            self.0.push(CaseGroup { source, values, points: vec![Vec::new(); numbers.len()] });
            self.0.len() - 1
        });
        self.0[at].points.iter_mut().zip(numbers).for_each(|(points, number)| points.push([x, *number]));
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The figure of them.
    pub(super) fn plot(mut self, title: Option<&str>, x: &FigureColumn, y: &[FigureColumn], look: &DrawnLook) -> Plot {
        for points in self.0.iter_mut().flat_map(|group| &mut group.points) {
            points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        }
        let drawn = self.0.iter().map(|CaseGroup { source, values, points }| DrawnCase {
            source: source.clone(),
            values: values.clone(),
            points: points.iter().map(Vec::as_slice).collect(),
        });
        Curves { title, x, y, look, is_marked: true, measured: &[] }.plot(drawn)
    }
}

pub(super) fn draw(source: &Source<'_>) -> Result<Rendered, String> {
    let data = source.drawn()?;
    let over = data.over.as_ref().ok_or("it has no abscissa")?;
    let sweeps = FreeSweeps::of(source, Some(over.axis));
    let mut cases = CasesOver::default();
    for &index in &data.cases {
        let x = over.values[source.cases.position(index)[over.axis]];
        let ended = source.ended(index);
        let number = |total: &FigureTotal| ended.and_then(|case| value(total.what, case)).unwrap_or(f64::NAN);
        let numbers: Vec<f64> = data.totals.iter().map(number).collect();
        cases.take(None, sweeps.values(source.cases, index), x, &numbers);
    }
    let y: Vec<FigureColumn> = data.totals.iter().map(|total| total.y.clone()).collect();
    let plot = cases.plot(source.figure.title.as_deref(), &over.column, &y, &data.look);
    plot.render().map_err(|error| error.to_string())
}

fn value(what: Total, case: &CaseResult) -> Option<f64> {
    let (index, statistic) = match what {
        Total::Metric(k) => return case.metrics.values.get(k).copied(),
        Total::Statistic { index, statistic } => (index, statistic),
    };
    let totals = case.curves.as_ref()?.totals.get(&index)?;
    Some(totals.value(statistic))
}
