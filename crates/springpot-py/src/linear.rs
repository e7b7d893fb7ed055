//! Small motions of scenarios: eigenvalues, answers to sines, linear models.

use crate::error::{guarded, scenario_error, springpot_error, value_error};
use crate::scenario::{CATALOG, asked};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springpot_run::linear::{About, Stopped, Where, about, linearise, modes_json, response_json};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(linear_model, module)?)?;
    module.add_function(wrap_pyfunction!(linear_modes, module)?)?;
    module.add_function(wrap_pyfunction!(linear_response, module)?)
}

/// The small motions of the first case. `place`: a time, s, or none; whether it goes to the equilibrium; whether control is left out.
fn small_motions(
    scenario: &Bound<'_, PyAny>,
    set: Option<&Bound<'_, PyAny>>,
    (at, equilibrium, open): (Option<f64>, bool, bool),
) -> PyResult<About> {
    let py = scenario.py();
    let refused = |refusals| scenario_error(py, &refusals);
    let cases = asked(scenario, set)?.scenario().map_err(refused)?.cases(&CATALOG);
    let cases = cases.map_err(|refusals| scenario_error(py, &refusals))?;
    let plan = cases.plan(0).map_err(|refusals| scenario_error(py, &refusals))?;
    let at = at.map(|t| t.to_string());
    py.detach(|| about(&plan, Where { at: at.as_deref(), equilibrium, open })).map_err(|why| stopped(py, why))
}

fn stopped(py: Python<'_>, why: Stopped) -> PyErr {
    match why {
        Stopped::Refused(message, help) => value_error(format!("{message}; {help}")),
        Stopped::Failed(message) => springpot_error(py, message),
    }
}

/// A linear model as JSON text.
#[pyfunction]
#[pyo3(signature = (scenario, channels, place, band, tolerance, set=None))]
fn linear_model(
    py: Python<'_>,
    scenario: &Bound<'_, PyAny>,
    channels: (Vec<String>, Vec<String>),
    place: (Option<f64>, bool, bool),
    band: [f64; 2],
    tolerance: f64,
    set: Option<&Bound<'_, PyDict>>,
) -> PyResult<String> {
    guarded(py, || {
        let about = small_motions(scenario, set.map(|set| set.as_any()), place)?;
        let found = py.detach(|| linearise(&about, [&channels.0, &channels.1], band, tolerance));
        found.map(|modelled| modelled.json().to_string()).map_err(|why| stopped(py, why))
    })
}

/// Eigenvalues as JSON text.
#[pyfunction]
#[pyo3(signature = (scenario, place, set=None))]
fn linear_modes(
    py: Python<'_>,
    scenario: &Bound<'_, PyAny>,
    place: (Option<f64>, bool, bool),
    set: Option<&Bound<'_, PyDict>>,
) -> PyResult<String> {
    guarded(py, || {
        let about = small_motions(scenario, set.map(|set| set.as_any()), place)?;
        let modes = py.detach(|| about.linear.modes()).map_err(value_error)?;
        Ok(modes_json(&about, &modes).to_string())
    })
}

/// The answers of a column to sines of an input at frequencies, Hz, as JSON text.
#[pyfunction]
#[pyo3(signature = (scenario, names, frequencies, place, set=None))]
fn linear_response(
    py: Python<'_>,
    scenario: &Bound<'_, PyAny>,
    names: (String, String),
    frequencies: Vec<f64>,
    place: (Option<f64>, bool, bool),
    set: Option<&Bound<'_, PyDict>>,
) -> PyResult<String> {
    guarded(py, || {
        let about = small_motions(scenario, set.map(|set| set.as_any()), place)?;
        let found = py.detach(|| response_json(&about, [&names.0, &names.1], &frequencies));
        found.map(|value| value.to_string()).map_err(|why| stopped(py, why))
    })
}
