//! The scenario's figures from the columns that the run kept, and figures of curves from elsewhere.

mod panels;
mod robot;

pub use panels::{Curves, FigureColumn};

use crate::labels;
use crate::sweep::{FigureData, KeptCurve, Layout, Outcome};
use crate::table::folder::Folder;
use springpot::integrate::System;
use springpot_report::{Plot, Rendered, ReportError};
use springpot_scenario::{Cases, FigureKind, FigurePlan, Plan};
use std::io;

/// Draws every figure into the folder; returns what could not be drawn and why. `system` and `plan` are those of the first case.
///
/// # Errors
/// The file system's.
pub fn draw(
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
    let drawn = data.cases.iter().filter_map(|&index| {
        let found = outcome.cases.binary_search_by_key(&index, |case| case.index).ok()?;
        let kept = outcome.cases[found].curves.as_ref();
        let points = |curve: &usize| kept.and_then(|curves| curves.get(curve)).map_or(&[][..], KeptCurve::points);
        Some((cases.position(index), data.curves.iter().map(points).collect()))
    });
    let what = Curves {
        title: figure.title.as_deref(),
        x: &data.x,
        y: &data.y,
        free: &free,
        sweep: &|axis| cases.axis_parameters(axis).map(labels::parameter).collect::<Vec<_>>().join(", "),
        value: &|axis, k| cases.axis_label(axis, k),
    };
    Ok(what.plot(drawn))
}
