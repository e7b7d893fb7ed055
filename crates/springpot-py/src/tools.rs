//! What the commands `check`, `modulus` and `fmu` do, as functions.

use crate::error::{case_error, guarded, run_error_at, scenario_error, value_error};
use crate::interrupt::interruptible;
use crate::scenario::{CATALOG, asked};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use springpot_capi::fmi::{LIBRARY, Package, PackageError, is_this_library, without_python};
use springpot_run::modulus::{Modulus, USUAL_AMPLITUDE, moduli, units};
use springpot_scenario::suggest;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(check, module)?)?;
    module.add_function(wrap_pyfunction!(modulus, module)?)?;
    module.add_function(wrap_pyfunction!(fmu, module)?)
}

/// Message, help, and where it stands: file, line and column, from 1.
type Finding = (String, Option<String>, Option<(String, usize, usize)>);

/// What deserves a warning in a scenario; raises what keeps it from being run.
#[pyfunction]
#[pyo3(signature = (scenario, set = None))]
fn check(py: Python<'_>, scenario: &Bound<'_, PyAny>, set: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<Finding>> {
    guarded(py, || {
        let refused = |refusals| scenario_error(py, &refusals);
        let scenario = asked(scenario, set)?.scenario().map_err(refused)?;
        let found = interruptible(py, |_| springpot_cli::findings(&scenario, &CATALOG))?;
        let (remarks, failures) = found.map_err(refused)?;
        if let Some((_, first)) = failures.first() {
            return Err(case_error(py, first));
        }
        let finding = |remark: springpot_scenario::Remark| {
            let place = remark.place.filter(|place| !place.source.text.is_empty());
            let place = place.map(|place| {
                let (line, column) = place.position();
                (place.source.name.clone(), line, column)
            });
            (remark.message, remark.help, place)
        };
        Ok(remarks.into_iter().map(finding).collect())
    })
}

/// Units of stroke and K*, whether the law is linear, and frequency, amplitude, storage, loss and lost energy of every row, amplitudes outermost.
type Moduli = ([&'static str; 2], bool, Vec<[f64; 5]>);

/// K* of an element at frequencies, Hz, and amplitudes, m or rad, of which a law that is linear needs none.
#[pyfunction]
#[pyo3(signature = (scenario, element, hertz, amplitudes = None, set = None))]
fn modulus(
    py: Python<'_>,
    scenario: &Bound<'_, PyAny>,
    element: &str,
    hertz: Vec<f64>,
    amplitudes: Option<Vec<f64>>,
    set: Option<&Bound<'_, PyAny>>,
) -> PyResult<Moduli> {
    guarded(py, || {
        let refused = |refusals| scenario_error(py, &refusals);
        let scenario = asked(scenario, set)?.scenario().map_err(refused)?;
        let plan = interruptible(py, |_| scenario.cases(&CATALOG).and_then(|cases| cases.plan(0)))?.map_err(refused)?;
        if plan.absent.iter().any(|(_, absent)| absent.element.name == element) {
            return Err(value_error(format!("element {element:?} is not enabled, and has no modulus here")));
        }
        let Some(planned) = plan.elements.iter().find(|planned| planned.element.name == element) else {
            let help = suggest(element, plan.elements.iter().map(|planned| &*planned.element.name));
            return Err(value_error(format!("there is no element {element:?}; {help}")));
        };
        let is_linear = planned.element.law.is_linear();
        let amplitudes = match amplitudes {
            Some(amplitudes) => amplitudes,
            None if is_linear => vec![USUAL_AMPLITUDE],
            None => {
                let why = format!("the law of element {element:?} is not linear: its modulus depends on the amplitude");
                return Err(value_error(format!("{why}; give amplitude=\"1 mm\", or several")));
            }
        };
        let found = interruptible(py, |_| moduli(planned, &hertz, &amplitudes))?;
        let found = found.map_err(|(message, help)| run_error_at(py, format!("{message}\n  {help}"), None))?;
        let row = |row: Modulus| [row.hertz, row.amplitude, row.storage, row.loss, row.cycle];
        Ok((units(planned), is_linear, found.into_iter().map(row).collect()))
    })
}

/// The bytes of an FMU, and the events that it does not tell. `folder` is an empty one to try it in, `library` a file that takes the place of our own.
#[pyfunction]
#[pyo3(signature = (scenario, name, folder, set = None, library = None))]
fn fmu<'py>(
    py: Python<'py>,
    scenario: &Bound<'_, PyAny>,
    name: &str,
    folder: PathBuf,
    set: Option<&Bound<'_, PyAny>>,
    library: Option<PathBuf>,
) -> PyResult<(Bound<'py, PyBytes>, Vec<String>)> {
    guarded(py, || {
        let scenario = asked(scenario, set)?.scenario().map_err(|refusals| scenario_error(py, &refusals))?;
        let bytes = match library {
            Some(file) => Some(fs::read(&file)?).filter(|bytes| is_this_library(bytes)).ok_or_else(|| {
                value_error(format!("{} is not the library of this version of Springpot", file.display()))
            }),
            None => {
                find_own(py)?;
                own_library().ok_or_else(|| {
                    value_error(format!(
                        "this package has no {LIBRARY} that runs without Python: name one that `cargo build --release -p springpot-capi` made by library="
                    ))
                })
            }
        }?;
        let made = interruptible(py, |_| {
            let package = Package::new(&scenario, name, &CATALOG)?;
            package.verify(&folder)?;
            Ok((package.archive(bytes)?, package.silent_events().to_vec()))
        })?;
        let (archive, silent) = made.map_err(|error: PackageError| match error {
            PackageError::Scenario(refusals) => scenario_error(py, &refusals),
            PackageError::Start(error) => run_error_at(py, error, None),
            error => value_error(error),
        })?;
        Ok((PyBytes::new(py, &archive), silent))
    })
}

/// The file of this extension.
static EXTENSION: OnceLock<PathBuf> = OnceLock::new();

/// Finds the file of this extension, from which [`own_library`] sets out.
pub(crate) fn find_own(py: Python<'_>) -> PyResult<()> {
    if EXTENSION.get().is_none() {
        let file: PathBuf = py.import("springpot._springpot")?.getattr("__file__")?.extract()?;
        EXTENSION.get_or_init(|| file);
    }
    Ok(())
}

/// The library of FMUs that this package has: a file of its own beside this extension, or the extension itself, which has the same functions.
pub(crate) fn own_library() -> Option<Vec<u8>> {
    let extension = EXTENSION.get()?;
    let beside = fs::read(extension.parent().unwrap_or(Path::new("")).join(LIBRARY)).ok();
    let own = || fs::read(extension).ok().and_then(without_python);
    beside.filter(|bytes| is_this_library(bytes)).or_else(own).filter(|bytes| is_this_library(bytes))
}
