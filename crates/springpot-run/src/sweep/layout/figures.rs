//! What the figures of a scenario want of the rows, by their kinds.

use super::wanted::{Abscissa, FigureData, Summed, Wanted};
use crate::labels;
use crate::panels::{FigureColumn, swept_numbers};
use springpot::table::Column;
use springpot_scenario::{Cases, ColumnGlob, FigureKind, FigurePlan, RefusalKind, Refusals, Summarised, SweptAxis};

/// What a figure wants of the rows.
pub(super) fn data(cases: &Cases, figure: &FigurePlan, wanted: &mut Wanted) -> Result<FigureData, Refusals> {
    match &figure.kind {
        FigureKind::Curves { x, y } => curves(cases, figure, wanted, x, y),
        FigureKind::Summary { x, y } => summary(cases, figure, wanted, x, y),
        FigureKind::Map { x, y, z } => map(cases, figure, wanted, (x, y, z)),
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
        for one in summed(cases, wanted, summarised)? {
            if !totals.contains(&one) {
                totals.push(one);
            }
        }
    }
    wanted.totals(cases, figure, (abscissa(cases, figure, x)?, None), &totals)
}

/// What a case is summed up by.
fn summed(cases: &Cases, wanted: &Wanted, summarised: &Summarised) -> Result<Vec<Summed>, Refusals> {
    Ok(match summarised {
        Summarised::Columns { statistic, columns } => {
            wanted.found(columns)?.into_iter().map(|column| Summed::Column(*statistic, column)).collect()
        }
        // The scenario was refused where there is none.
        Summarised::Metric(name) => {
            let place = cases.metrics().iter().position(|plan| plan.metric.name == *name);
            place.into_iter().map(Summed::Metric).collect()
        }
    })
}

/// A cell for each value of two sweeps.
fn map(
    cases: &Cases,
    figure: &FigurePlan,
    wanted: &mut Wanted,
    (x, y, z): (&SweptAxis, &SweptAxis, &Summarised),
) -> Result<FigureData, Refusals> {
    let totals = summed(cases, wanted, z)?;
    if let (Summarised::Columns { columns, .. }, [_, _, ..]) = (z, &totals[..]) {
        let message = format!("{:?} matches several columns; a map takes one", columns.text);
        return Err(columns.place.refuse(RefusalKind::Rule, message).into());
    }
    wanted.totals(cases, figure, (side(cases, figure, x)?, Some(side(cases, figure, y)?)), &totals)
}

/// A side of a map: numbers as an abscissa has them, and what has names or is no number in its order.
fn side(cases: &Cases, figure: &FigurePlan, x: &SweptAxis) -> Result<Abscissa, Refusals> {
    let written: Vec<String> = (0..cases.axis_len(x.axis)).map(|k| cases.axis_label_of(x.axis, &x.path, k)).collect();
    if let (None, Ok((column, values))) = (cases.axis_names(x.axis), swept_numbers(&x.path, &written)) {
        return Ok(Abscissa { axis: x.axis, column, values, names: Vec::new() });
    }
    let is_log = [(&figure.look.x, "x_scale"), (&figure.look.y, "y_scale")].into_iter().find(|(look, _)| look.is_log);
    let is_x = matches!(&figure.kind, FigureKind::Map { x: own, .. } if own == x);
    if let Some((_, option)) = is_log.filter(|(_, option)| (*option == "x_scale") == is_x) {
        let place = figure.look.said(option).and_then(|said| said.place.as_ref()).unwrap_or(&figure.place);
        let message = format!("{option} = \"log\": the values of {} are no numbers, or have names", x.path);
        return Err(place.refuse(RefusalKind::Rule, message).help("leave it out").into());
    }
    let names = match cases.axis_names(x.axis) {
        Some(names) => names.to_vec(),
        None => written,
    };
    let column = Column::new(&*x.path, "", "swept parameter");
    let column = FigureColumn { column, unit: None, label: Some(labels::parameter(&x.path)) };
    Ok(Abscissa { axis: x.axis, column, values: (0..names.len()).map(|k| k as f64).collect(), names })
}

/// The swept values as numbers in the unit that the first is written in.
fn abscissa(cases: &Cases, figure: &FigurePlan, x: &SweptAxis) -> Result<Abscissa, Refusals> {
    let written: Vec<String> = (0..cases.axis_len(x.axis)).map(|k| cases.axis_label_of(x.axis, &x.path, k)).collect();
    match swept_numbers(&x.path, &written) {
        Ok((column, values)) => Ok(Abscissa { axis: x.axis, column, values, names: Vec::new() }),
        Err((message, help)) => Err(figure.place.refuse(RefusalKind::Rule, message).help(help).into()),
    }
}
