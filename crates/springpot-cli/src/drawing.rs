//! Figures of commands other than `run` and `plot`.

use crate::{Ending, diagnostic, output};
use springpot_report::{Plot, Rendered};
use std::path::Path;

/// Endings of files that hold figures.
pub(crate) const ENDINGS: [&str; 3] = ["svg", "png", "pdf"];

/// The ending of a file, in lower case.
pub(crate) fn ending(file: &Path) -> String {
    file.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_lowercase()
}

/// Draws a figure, and writes it as the ending of `file` says.
pub(crate) fn write(file: &Path, plot: &Plot) -> Ending {
    let Rendered { svg, png, pdf, remarks } = match plot.render() {
        Ok(rendered) => rendered,
        Err(error) => {
            diagnostic::error(format!("the figure is not drawn: {error}"));
            return Ending::Failed;
        }
    };
    remarks.iter().for_each(|remark| diagnostic::warning(format!("figure: {remark}"), None));
    let bytes = match &*ending(file) {
        "png" => &png[..],
        "pdf" => &pdf[..],
        _ => svg.as_bytes(),
    };
    output::written(file, output::write(file, bytes))
}
