//! The scenario's figures from the columns that the run kept.

mod robot;

use crate::labels;
use springpot::simulate::System;
use springpot_report::{Curve, Panel, Plot, Rendered, ReportError};
use springpot_run::sweep::{FigureColumn, FigureData, KeptCurve, Layout, Outcome};
use springpot_run::table::folder::Folder;
use springpot_scenario::units::Unit;
use springpot_scenario::{Cases, FigureKind, FigurePlan, Plan};
use std::io;

/// Draws every figure into the folder; returns what could not be drawn and why.
pub(crate) fn draw(
    cases: &Cases,
    system: &System,
    plan: &Plan,
    layout: &Layout,
    outcome: &Outcome,
    folder: &mut Folder,
) -> io::Result<Vec<String>> {
    let mut warnings = Vec::new();
    for (figure, data) in cases.figures().iter().zip(layout.figures()) {
        let rendered = match figure.kind {
            FigureKind::Robot => robot::drawing(figure, system, plan).and_then(|drawing| render(drawing.render())),
            FigureKind::Curves { .. } => curves(cases, figure, data, outcome).and_then(|plot| render(plot.render())),
        };
        match rendered {
            Ok(Rendered { svg, png }) => {
                folder.write_figure(&format!("{}.svg", figure.name), svg.as_bytes())?;
                folder.write_figure(&format!("{}.png", figure.name), &png)?;
            }
            Err(why) => warnings.push(format!("figure \"{}\" is not drawn: {why}", figure.name)),
        }
    }
    Ok(warnings)
}

fn render(result: Result<Rendered, ReportError>) -> Result<Rendered, String> {
    result.map_err(|error| error.to_string())
}

/// One curve per swept value and column; a second sweep makes one panel per value.
fn curves(cases: &Cases, figure: &FigurePlan, data: &FigureData, outcome: &Outcome) -> Result<Plot, String> {
    if let Some(why) = &data.left_out {
        return Err(why.to_string());
    }
    // Sweeps that the figure does not fix: the first makes the curves, the others the panels.
    let free: Vec<usize> =
        (0..cases.axis_count()).filter(|axis| figure.selection.iter().all(|s| s.axis != *axis)).collect();
    let alike = common_unit(&data.y).is_some();
    let mut panels: Vec<(Vec<usize>, Panel)> = Vec::new();
    for &index in &data.cases {
        let Ok(found) = outcome.cases.binary_search_by_key(&index, |case| case.index) else { continue };
        let case = &outcome.cases[found];
        let position = cases.position(index);
        let key: Vec<usize> = free.iter().skip(1).map(|axis| position[*axis]).collect();
        let at = panels.iter().position(|(other, _)| *other == key).unwrap_or_else(|| {
            let named = free.iter().skip(1).map(|axis| axis_label(cases, *axis, position[*axis], true));
            let title = named.collect::<Vec<_>>().join(", ");
            panels.push((key, Panel { title: (!title.is_empty()).then_some(title), curves: Vec::new() }));
            panels.len() - 1
        });
        // Beside a column's name the value alone would not say what it is of.
        let several = data.y.len() > 1;
        let swept = free.first().map(|axis| axis_label(cases, *axis, position[*axis], several));
        for (column, index) in data.y.iter().zip(&data.curves) {
            let own = several.then(|| if alike { labels::quantity(&column.column.name) } else { axis(column) });
            let label = own.into_iter().chain(swept.clone()).collect::<Vec<_>>().join(", ");
            let kept = case.curves.as_ref().and_then(|curves| curves.get(index));
            panels[at].1.curves.push(curve(label, &data.x, column, kept.map_or(&[], KeptCurve::points)));
        }
    }
    let mut panels: Vec<Panel> = panels.into_iter().map(|(_, panel)| panel).collect();
    if let [only] = &mut panels[..]
        && let [curve] = &mut only.curves[..]
    {
        // The ordinate's label says all about a single curve.
        curve.label.clear();
    }
    let legend_title = free.first().filter(|_| data.y.len() == 1).map(|axis| axis_title(cases, *axis));
    Ok(Plot { title: figure.title.clone(), x_label: axis(&data.x), y_label: ordinate(&data.y), legend_title, panels })
}

fn curve(label: String, x: &FigureColumn, y: &FigureColumn, points: &[[f64; 2]]) -> Curve {
    let (in_x, in_y) = (x.unit.as_ref(), y.unit.as_ref());
    let number = |value: f64, unit: Option<&(String, Unit)>| unit.map_or(value, |(_, unit)| unit.from_si(value));
    let (x, y) = points.iter().map(|[x, y]| (number(*x, in_x), number(*y, in_y))).unzip();
    Curve { label, x, y }
}

fn axis(column: &FigureColumn) -> String {
    labels::axis(&column.column, column.unit.as_ref().map(|(text, _)| text.as_str()))
}

/// One label for all ordinates: the column's own, or the unit that several have in common.
fn ordinate(columns: &[FigureColumn]) -> String {
    match columns {
        [only] => axis(only),
        several => common_unit(several).map_or(String::new(), |unit| labels::written_unit(&unit)),
    }
}

/// The unit that all columns are drawn in; `None` where they differ.
fn common_unit(columns: &[FigureColumn]) -> Option<String> {
    let unit = |column: &FigureColumn| {
        column.unit.as_ref().map_or_else(|| column.column.unit.clone(), |(text, _)| text.clone())
    };
    let first = unit(columns.first()?);
    columns.iter().all(|column| unit(column) == first).then_some(first)
}

/// The swept value as written; with the parameter's name where nothing else says it.
fn axis_label(cases: &Cases, axis: usize, k: usize, named: bool) -> String {
    let value = labels::written_unit(&cases.axis_label(axis, k));
    if named { format!("{} = {value}", axis_title(cases, axis)) } else { value }
}

fn axis_title(cases: &Cases, axis: usize) -> String {
    cases.axis_parameters(axis).map(labels::parameter).collect::<Vec<_>>().join(", ")
}
