//! The scenario's figures from the columns that the run kept, figures of finished runs from their files, and figures of curves from elsewhere.
//!
//! A kind of figure is a file: how it is drawn. What it wants of the rows is laid out with the columns.

mod curves;
mod later;
mod robot;
mod source;
mod summary;

pub use later::{AskedFigure, LaterFigure, NotDrawn};

use crate::sweep::{Layout, Outcome};
use crate::table::folder::Folder;
use source::Source;
use springpot::system::System;
use springpot_report::Rendered;
use springpot_scenario::{Cases, FigureFormat, FigureKind, Plan};
use std::io;

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
