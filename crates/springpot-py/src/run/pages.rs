//! Pages, figures and files of results in a folder, as the command makes them.

use crate::error::{springpot_error, value_error};
use pyo3::prelude::*;
use springpot_report::{Map, MapAxis, Scale};
use springpot_run::figures::{AskedFigure, NotDrawn};
use springpot_run::table::disk::Disk;
use springpot_run::{ExportError, ExportFormat, Results};
use springpot_scenario::LOOK_OPTIONS;
use std::path::{Path, PathBuf};

fn open(py: Python<'_>, folder: &Path) -> PyResult<Results> {
    Results::open(&Disk::default(), folder).map_err(|error| springpot_error(py, error))
}

/// The page that shows results in motion.
#[pyfunction]
fn view_page(py: Python<'_>, folder: PathBuf, cases: Vec<usize>) -> PyResult<String> {
    let results = open(py, &folder)?;
    if let Some(missing) = cases.iter().find(|case| !results.has_rows(**case)) {
        return Err(value_error(format!("case {missing} has no row")));
    }
    let html = py.detach(|| springpot_run::view(&results, &cases).map(|view| view.html()));
    html.map_err(|error| springpot_error(py, error))
}

/// The report of results, or of how those of another run differ from them.
#[pyfunction]
fn report_page(py: Python<'_>, folder: PathBuf, other: Option<PathBuf>) -> PyResult<String> {
    let results = open(py, &folder)?;
    let other = other.map(|other| open(py, &other)).transpose()?;
    let report = py.detach(|| {
        let report = match &other {
            None => springpot_run::report(&results),
            Some(other) => springpot_run::comparison(&results, other),
        };
        report.map(|report| report.html())
    });
    report.map_err(|error| springpot_error(py, error))
}

/// The bytes of a file for other programs, which the ending of its name tells, and what is to be known of it.
#[pyfunction]
fn export_bytes(py: Python<'_>, folder: PathBuf, case: usize, file: PathBuf) -> PyResult<(Vec<u8>, Vec<String>)> {
    let Some(format) = ExportFormat::of(&file) else {
        let endings = ExportFormat::ENDINGS.map(|ending| format!(".{ending}")).join(", ");
        return Err(value_error(format!("the ending of {} names no format; there are {endings}", file.display())));
    };
    let results = open(py, &folder)?;
    let mut bytes = Vec::new();
    let notes = py.detach(|| springpot_run::export(&results, case, format, &mut bytes));
    match notes {
        Ok(notes) => Ok((bytes, notes)),
        Err(ExportError::Results(error)) => Err(springpot_error(py, error)),
        Err(ExportError::Write(error)) => Err(error.into()),
    }
}

/// SVG, PNG and PDF of a figure, and what it does not show.
type Drawn = (String, Vec<u8>, Vec<u8>, Vec<String>);

/// Names of the options of a figure's look, and what they say.
#[pyfunction]
fn look_options() -> Vec<(&'static str, &'static str)> {
    LOOK_OPTIONS.iter().filter_map(|option| Some((option.name(), option.spelt?.help))).collect()
}

/// The figure of columns of the results in a folder; `where` and `units` as `PATH=VALUE`, the look by names of options.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "each is a part of the figure")]
fn plot_figure(
    py: Python<'_>,
    folder: PathBuf,
    columns: Vec<String>,
    x: String,
    selection: Vec<String>,
    units: Vec<String>,
    title: Option<String>,
    look: Vec<(String, Option<String>)>,
) -> PyResult<Drawn> {
    let asked = AskedFigure { results: vec![folder], columns, x, selection, units, title, look };
    let draw = || {
        // What a run warns of was said when it was run.
        let figure = asked.figure(&mut |_| {});
        let figure = figure.map_err(|NotDrawn { message, help }| match help {
            Some(help) => format!("{message} ({help})"),
            None => message,
        })?;
        figure.plot.render().map_err(|error| format!("the figure is not drawn: {error}"))
    };
    let drawn = py.detach(draw).map_err(value_error)?;
    Ok((drawn.svg, drawn.png, drawn.pdf, drawn.remarks))
}

/// Label, values, what they are called, whether the scale is logarithmic.
type Side = (String, Vec<f64>, Vec<String>, bool);

/// The figure of cells over two axes, the first row first; `size` in mm.
#[pyfunction]
#[pyo3(signature = (title, x, y, z, cells, size = None))]
fn map_figure(
    py: Python<'_>,
    title: Option<String>,
    x: Side,
    y: Side,
    z: String,
    cells: Vec<f64>,
    size: Option<[f64; 2]>,
) -> PyResult<Drawn> {
    let side = |(label, values, names, is_log): Side| MapAxis {
        label,
        values,
        names,
        scale: if is_log { Scale::Log } else { Scale::Linear },
    };
    let map = Map { title, x: side(x), y: side(y), z, cells, size };
    let drawn = py.detach(|| map.render()).map_err(value_error)?;
    Ok((drawn.svg, drawn.png, drawn.pdf, drawn.remarks))
}

pub(super) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(view_page, module)?)?;
    module.add_function(wrap_pyfunction!(report_page, module)?)?;
    module.add_function(wrap_pyfunction!(export_bytes, module)?)?;
    module.add_function(wrap_pyfunction!(look_options, module)?)?;
    module.add_function(wrap_pyfunction!(map_figure, module)?)?;
    module.add_function(wrap_pyfunction!(plot_figure, module)?)
}
