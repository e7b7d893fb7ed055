//! The scenario's figures from the columns that the run kept, figures of finished runs from their files, and figures of curves from elsewhere.
//!
//! A kind of figure is a file: what it wants of the rows, and how it is drawn.

mod curves;
mod later;
mod look;
mod panels;
mod robot;
mod source;
mod summary;

pub use later::{AskedFigure, LaterFigure, NotDrawn};
pub(crate) use look::DrawnLook;
pub(crate) use panels::{Curves, DrawnCase, FigureColumn, MeasuredPoints};

use crate::sweep::{FigureData, Layout, Outcome, Wanted};
use crate::table::folder::Folder;
use source::Source;
use springpot::system::System;
use springpot_report::Rendered;
use springpot_scenario::{Cases, FigureFormat, FigureKind, FigurePlan, Plan, Refusals};
use std::io;

/// What a figure wants of the rows.
pub(crate) fn data(cases: &Cases, figure: &FigurePlan, wanted: &mut Wanted) -> Result<FigureData, Refusals> {
    match &figure.kind {
        FigureKind::Curves { x, y } => curves::data(cases, figure, wanted, x, y),
        FigureKind::Summary { x, y } => summary::data(cases, figure, wanted, x, y),
        FigureKind::Robot => Ok(FigureData::default()),
    }
}

/// What a figure is called in a format.
pub(crate) fn file_name(figure: &str, format: FigureFormat) -> String {
    format!("{figure}.{}", format.name())
}

/// What a file of a figure holds.
pub fn bytes(rendered: &Rendered, format: FigureFormat) -> &[u8] {
    match format {
        FigureFormat::Svg => rendered.svg.as_bytes(),
        FigureFormat::Png => &rendered.png,
        FigureFormat::Pdf => &rendered.pdf,
    }
}

/// Draws every figure into the folder; returns what could not be drawn, or shown in one of them, and why. `system` and `plan` are those of the first case.
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
            FigureKind::Summary { .. } => summary::draw(&source),
            FigureKind::Robot => robot::draw(&source),
        };
        match rendered {
            Ok(rendered) => {
                warnings.extend(rendered.remarks.iter().map(|remark| format!("figure \"{}\": {remark}", figure.name)));
                for &format in &figure.look.formats {
                    folder.write_figure(&file_name(&figure.name, format), bytes(&rendered, format))?;
                }
            }
            Err(why) => warnings.push(format!("figure \"{}\" is not drawn: {why}", figure.name)),
        }
    }
    Ok(warnings)
}
