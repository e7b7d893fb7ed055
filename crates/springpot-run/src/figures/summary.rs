//! Statistics of columns, and metrics, over a swept parameter.

use super::panels::{Curves, DrawnCase, FigureColumn};
use super::source::{FreeSweeps, Source};
use crate::labels;
use crate::sweep::{Abscissa, CaseResult, FigureData, Summed, Total, Wanted};
use springpot::table::Column;
use springpot_report::Rendered;
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

/// Cases that differ in the abscissa alone: values of the other sweeps, and of each statistic the points.
struct Drawn {
    values: Vec<(String, String)>,
    points: Vec<Vec<[f64; 2]>>,
}

pub(super) fn draw(source: &Source<'_>) -> Result<Rendered, String> {
    let data = source.drawn()?;
    let over = data.over.as_ref().ok_or("it has no abscissa")?;
    let sweeps = FreeSweeps::of(source, Some(over.axis));
    let mut curves: Vec<Drawn> = Vec::new();
    for &index in &data.cases {
        let values = sweeps.values(source.cases, index);
        let at = curves.iter().position(|other| other.values == values).unwrap_or_else(|| {
            curves.push(Drawn { values, points: vec![Vec::new(); data.totals.len()] });
            curves.len() - 1
        });
        let x = over.values[source.cases.position(index)[over.axis]];
        let ended = source.ended(index);
        for (total, points) in data.totals.iter().zip(&mut curves[at].points) {
            points.push([x, ended.and_then(|case| value(total.what, case)).unwrap_or(f64::NAN)]);
        }
    }
    for points in curves.iter_mut().flat_map(|curve| &mut curve.points) {
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    }
    let y: Vec<FigureColumn> = data.totals.iter().map(|total| total.y.clone()).collect();
    let title = source.figure.title.as_deref();
    let drawn = curves.iter().map(|Drawn { values, points }| DrawnCase {
        source: None,
        values: values.clone(),
        points: points.iter().map(Vec::as_slice).collect(),
    });
    let what = Curves { title, x: &over.column, y: &y, look: &data.look, is_marked: true, measured: &[] };
    what.plot(drawn).render().map_err(|error| error.to_string())
}

fn value(what: Total, case: &CaseResult) -> Option<f64> {
    let (index, statistic) = match what {
        Total::Metric(k) => return case.metrics.values.get(k).copied(),
        Total::Statistic { index, statistic } => (index, statistic),
    };
    let totals = case.curves.as_ref()?.totals.get(&index)?;
    Some(totals.value(statistic))
}
