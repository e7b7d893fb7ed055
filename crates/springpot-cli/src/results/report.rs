//! `springpot report`: what a run was and what came of it, or how two runs differ, as a page or a LaTeX document.

use crate::arguments::ReportOptions;
use crate::results::{self, refused, write_page};
use crate::{Ending, diagnostic, output, printed, terminal};
use springpot_report::page::Report;
use springpot_run::table::disk::Disk;
use springpot_run::{COMPARISON_LATEX, COMPARISON_PAGE, REPORT_LATEX, REPORT_PAGE, latex_figures};
use std::fs;
use std::path::Path;

pub(crate) fn report(options: &ReportOptions, disk: &Disk) -> Ending {
    let name = match (options.other.is_some(), options.tex) {
        (false, false) => REPORT_PAGE,
        (true, false) => COMPARISON_PAGE,
        (false, true) => REPORT_LATEX,
        (true, true) => COMPARISON_LATEX,
    };
    let out = options.out.clone().unwrap_or_else(|| options.results.join(name));
    let written = page(options, disk).and_then(|report| match options.tex {
        true => write_latex(&out, &report),
        false => write_page(&out, &report.html()),
    });
    written.err().unwrap_or_else(|| printed(terminal::try_print(&format!("{}\n", out.display()))))
}

fn page(options: &ReportOptions, disk: &Disk) -> Result<Report, Ending> {
    let results = results::open(&options.results, &[], disk)?;
    let report = match &options.other {
        None => springpot_run::report(&results),
        Some(other) => springpot_run::comparison(&results, &results::open(other, &[], disk)?),
    };
    report.map_err(|error| refused(&error))
}

/// The pictures, then the document that includes them.
fn write_latex(out: &Path, report: &Report) -> Result<(), Ending> {
    let stem = out.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    if stem.is_empty() || !stem.chars().all(is_plain) {
        let message = format!("--out {}: LaTeX finds pictures in folders of plain names only", out.display());
        diagnostic::error_with_help(message, "use letters, digits, - and _ for the file's name".to_owned());
        return Err(Ending::Refused);
    }
    let folder = latex_figures(&stem);
    let document = report.latex(&folder);
    let beside = out.parent().unwrap_or(Path::new(""));
    let ended = |path: &Path, written| match output::written(path, written) {
        Ending::Done => Ok(()),
        ending => Err(ending),
    };
    if !document.files.is_empty() {
        let figures = beside.join(&folder);
        ended(&figures, fs::create_dir_all(&figures))?;
    }
    for (name, bytes) in &document.files {
        let file = beside.join(name);
        ended(&file, output::write(&file, bytes))?;
    }
    write_page(out, &document.text)
}
