//! Designs: parameters moved until a metric is as small as constraints let it be.

use crate::error::{guarded, run_error_at, scenario_error};
use crate::interrupt::watched;
use crate::scenario::{CATALOG, asked};
use pyo3::prelude::*;
use springpot::system::Stop;
use springpot_run::design::design;

/// design.json, steps.csv, and the text of the scenario with the values that were found.
#[pyfunction]
#[pyo3(signature = (scenario, set = None, starts = None, jobs = 0))]
pub(crate) fn designed(
    py: Python<'_>,
    scenario: &Bound<'_, PyAny>,
    set: Option<&Bound<'_, PyAny>>,
    starts: Option<usize>,
    jobs: usize,
) -> PyResult<(String, String, String)> {
    guarded(py, || {
        let refused = |refusals| scenario_error(py, &refusals);
        let scenario = asked(scenario, set)?.scenario().map_err(refused)?;
        let stop = Stop::new(false);
        let jobs = if jobs > 0 { jobs } else { std::thread::available_parallelism().map_or(1, usize::from) };
        let (found, told) = watched(py, &stop, |_| Ok(()), || design(&scenario, &CATALOG, (starts, jobs), &stop));
        told?;
        let found = found.map_err(refused)?;
        match found.status {
            "failed" => {
                Err(run_error_at(py, "no start could be run, or a metric has no value or no gradient there", None))
            }
            _ => Ok((found.json(), found.steps(), found.text.clone())),
        }
    })
}
