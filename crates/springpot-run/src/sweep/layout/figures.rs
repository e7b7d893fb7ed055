//! What the figures of a scenario want of the rows, by their kinds.

use super::wanted::{Abscissa, FigureData, Summed, Wanted};
use crate::panels::swept_numbers;
use springpot_scenario::{Cases, ColumnGlob, FigureKind, FigurePlan, RefusalKind, Refusals, Summarised, SweptAxis};

/// What a figure wants of the rows.
pub(super) fn data(cases: &Cases, figure: &FigurePlan, wanted: &mut Wanted) -> Result<FigureData, Refusals> {
    match &figure.kind {
        FigureKind::Curves { x, y } => curves(cases, figure, wanted, x, y),
        FigureKind::Summary { x, y } => summary(cases, figure, wanted, x, y),
        FigureKind::Robot => Ok(FigureData::default()),
    }
}

/// A curve for each column that `y` matches, over the one that `x` does.
fn curves(
    cases: &Cases,
    figure: &FigurePlan,
    wanted: &mut Wanted,
    x: &ColumnGlob,
    y: &[ColumnGlob],
) -> Result<FigureData, Refusals> {
    let [x] = wanted.found(x)?[..] else {
        return Err(x.place.refuse(RefusalKind::Rule, "x matches several columns; it takes one").into());
    };
    let mut curves = Vec::new();
    for glob in y {
        for y in wanted.found(glob)? {
            if !curves.contains(&[x, y]) {
                curves.push([x, y]);
            }
        }
    }
    wanted.curves(cases, figure, &curves)
}

/// A curve for each statistic and each value of the other sweeps.
fn summary(
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
