//! The scenario's figures from the columns that the run kept, figures of finished runs from their files, and figures of curves from elsewhere.
//!
//! A kind of figure is a file: how it is drawn. What it wants of the rows is laid out with the columns.

mod curves;
mod later;
mod map;
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
use std::num::NonZero;
use std::panic::resume_unwind;
use std::thread::{self, available_parallelism};

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
    let figures = cases.figures().iter().zip(layout.figures());
    let sources: Vec<Source> =
        figures.map(|(figure, data)| Source { figure, cases, system, plan, data, outcome }).collect();
    let mut warnings = Vec::new();
    for together in sources.chunks(available_parallelism().map_or(1, NonZero::get)) {
        for (figure, rendered) in together.iter().map(|source| source.figure).zip(rendered(together)) {
            match rendered {
                Ok(Files { remarks, files }) => {
                    warnings.extend(remarks.iter().map(|remark| format!("figure \"{}\": {remark}", figure.name)));
                    for (format, bytes) in files {
                        folder.write_figure(&file_name(&figure.name, format), &bytes)?;
                    }
                }
                Err(why) => warnings.push(format!("figure \"{}\" is not drawn: {why}", figure.name)),
            }
        }
    }
    Ok(warnings)
}

/// A figure in the formats that are wanted.
struct Files {
    /// What it does not show.
    remarks: Vec<String>,
    files: Vec<(FigureFormat, Vec<u8>)>,
}

fn files(source: &Source<'_>) -> Result<Files, String> {
    let drawn = match source.figure.kind {
        FigureKind::Curves { .. } => curves::draw(source),
        FigureKind::Summary { .. } => summary::draw(source),
        FigureKind::Map { .. } => map::draw(source),
        FigureKind::Robot => robot::draw(source),
    }?;
    let written = |format: &FigureFormat| {
        let bytes = match format {
            FigureFormat::Svg => drawn.svg().into_bytes(),
            FigureFormat::Png => drawn.png().map_err(|error| error.to_string())?,
            FigureFormat::Pdf => drawn.pdf(),
        };
        Ok((*format, bytes))
    };
    let files = source.figure.look.formats.iter().map(written).collect::<Result<_, String>>()?;
    Ok(Files { remarks: drawn.remarks().to_vec(), files })
}

/// Draws each figure on a thread of its own; where the system gives none, on this one.
fn rendered(sources: &[Source<'_>]) -> Vec<Result<Files, String>> {
    let Some((first, others)) = sources.split_first() else { return Vec::new() };
    thread::scope(|scope| {
        let spawn = |source| thread::Builder::new().spawn_scoped(scope, move || files(source)).map_err(|_| source);
        let others: Vec<_> = others.iter().map(spawn).collect();
        let mut all = vec![files(first)];
        all.extend(others.into_iter().map(|other| match other {
            Ok(drawn) => drawn.join().unwrap_or_else(|panic| resume_unwind(panic)),
            Err(source) => files(source),
        }));
        all
    })
}
