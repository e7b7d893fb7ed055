//! `springpot plot`: columns of a finished run as a figure.

use crate::arguments::PlotOptions;
use crate::{Ending, diagnostic, output, printed, terminal};
use springpot_report::Plot;
use springpot_run::figures::{AskedFigure, NotDrawn, bytes};
use springpot_run::{Warn, Warning};
use springpot_scenario::FigureFormat;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

pub(crate) fn plot(options: &PlotOptions) -> Ending {
    let mut warn = |Warning { message, help }| diagnostic::warning(message, help);
    let (plot, files) = match figure(options, &mut warn) {
        Ok(figure) => figure,
        Err(NotDrawn { message, help }) => {
            match help {
                Some(help) => diagnostic::error_with_help(message, help),
                None => diagnostic::error(message),
            }
            return Ending::Refused;
        }
    };
    let rendered = match plot.render() {
        Ok(rendered) => rendered,
        Err(error) => {
            diagnostic::error(format!("the figure is not drawn: {error}"));
            return Ending::Failed;
        }
    };
    rendered.remarks.iter().for_each(|remark| diagnostic::warning(format!("figure: {remark}"), None));
    let mut lines = String::new();
    for (file, format) in &files {
        match output::written(file, write(file, bytes(&rendered, *format))) {
            Ending::Done => {}
            ending => return ending,
        }
        lines.push_str(&format!("{}\n", file.display()));
    }
    printed(terminal::try_print(&lines))
}

fn write(file: &Path, bytes: &[u8]) -> io::Result<()> {
    if let Some(folder) = file.parent() {
        fs::create_dir_all(folder)?;
    }
    output::write(file, bytes)
}

/// The figure, and its files.
fn figure(options: &PlotOptions, warn: Warn<'_>) -> Result<(Plot, Vec<(PathBuf, FigureFormat)>), NotDrawn> {
    let out = options.out.as_ref().map(|out| Ok((out.clone(), format(out)?))).transpose()?;
    let mut formats: Vec<FigureFormat> = Vec::with_capacity(options.formats.len());
    for word in &options.formats {
        let format = format_named(word)?;
        if !formats.contains(&format) {
            formats.push(format);
        }
    }
    let (results, columns) = results_and_columns(options);
    let asked = AskedFigure {
        results,
        columns,
        x: options.x.clone(),
        selection: options.selection.clone(),
        units: options.units.clone(),
        title: options.title.clone(),
        look: options.look.0.clone(),
    };
    let figure = asked.figure(warn)?;
    let files = match out {
        Some(out) => vec![out],
        None => {
            let file =
                |format: FigureFormat| figure.folder.join("figures").join(format!("{}.{}", figure.name, format.name()));
            let formats = if formats.is_empty() { FigureFormat::DEFAULT.to_vec() } else { formats };
            formats.into_iter().map(|format| (file(format), format)).collect()
        }
    };
    Ok((figure.plot, files))
}

/// Of the words on the command line: the first and those after it that are there as folders or CSV files are results, the others columns.
fn results_and_columns(options: &PlotOptions) -> (Vec<PathBuf>, Vec<String>) {
    let is_results = |word: &&String| {
        let path = Path::new(word.as_str());
        path.is_dir() || (has_ending(path, "csv") && path.is_file())
    };
    let further = options.y.iter().take_while(is_results).count();
    let (folders, columns) = options.y.split_at(further);
    let folders = std::iter::once(options.results.clone()).chain(folders.iter().map(PathBuf::from));
    (folders.collect(), columns.to_vec())
}

/// The format of that name.
fn format_named(word: &str) -> Result<FigureFormat, NotDrawn> {
    let found = FigureFormat::ALL.into_iter().find(|format| word.trim().eq_ignore_ascii_case(format.name()));
    found.ok_or_else(|| NotDrawn {
        message: format!("--formats {word}: there is no such format of figures"),
        help: Some("write some of svg, png and pdf: --formats svg,pdf".to_owned()),
    })
}

/// The format that the name of a file says.
fn format(out: &Path) -> Result<FigureFormat, NotDrawn> {
    FigureFormat::ALL.into_iter().find(|format| has_ending(out, format.name())).ok_or_else(|| NotDrawn {
        message: format!("--out {} is none of .svg, .png and .pdf", out.display()),
        help: Some("write a name that ends in .svg, .png or .pdf".to_owned()),
    })
}

fn has_ending(file: &Path, wanted: &str) -> bool {
    file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case(wanted))
}
