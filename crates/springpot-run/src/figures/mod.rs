//! The scenario's figures from the columns that the run kept, and figures of curves from elsewhere.
//!
//! A kind of figure is a file: what it wants of the rows, and how it is drawn.

mod curves;
mod panels;
mod robot;
mod source;

pub use panels::{Curves, FigureColumn};

use crate::sweep::{FigureData, Layout, Outcome, Wanted};
use crate::table::folder::Folder;
use source::Source;
use springpot::integrate::System;
use springpot_report::Rendered;
use springpot_scenario::{Cases, FigureKind, FigurePlan, Plan, Refusals};
use std::io;

/// What a figure wants of the rows.
pub(crate) fn data(cases: &Cases, figure: &FigurePlan, wanted: &mut Wanted) -> Result<FigureData, Refusals> {
    match &figure.kind {
        FigureKind::Curves { x, y } => curves::data(cases, figure, wanted, x, y),
        FigureKind::Robot => Ok(FigureData::default()),
    }
}

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
        let source = Source { figure, cases, system, plan, data, outcome };
        let rendered = match figure.kind {
            FigureKind::Curves { .. } => curves::draw(&source),
            FigureKind::Robot => robot::draw(&source),
        };
        match rendered {
            Ok(Rendered { svg, png, .. }) => {
                folder.write_figure(&format!("{}.svg", figure.name), svg.as_bytes())?;
                folder.write_figure(&format!("{}.png", figure.name), &png)?;
            }
            Err(why) => warnings.push(format!("figure \"{}\" is not drawn: {why}", figure.name)),
        }
    }
    Ok(warnings)
}
