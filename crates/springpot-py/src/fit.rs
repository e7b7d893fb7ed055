//! Fits of scenarios to measurements.

use crate::array::column;
use crate::error::{guarded, run_error_at, scenario_error, springpot_error, value_error};
use crate::interrupt::interruptible;
use crate::scenario::{CATALOG, asked};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyModule};
use springpot_run::fit::{FitError, Outcome, Problem, fit as find, json, save, told};
use springpot_scenario::Fitting;
use std::path::PathBuf;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Fitted>()?;
    module.add_class::<Residuals>()?;
    module.add_function(wrap_pyfunction!(fit_scenario, module)?)
}

fn read(scenario: &Bound<'_, PyAny>, set: Option<&Bound<'_, PyAny>>) -> PyResult<Fitting> {
    let py = scenario.py();
    let asked = asked(scenario, set)?;
    let refused = |refusals| scenario_error(py, &refusals);
    asked.scenario().map_err(refused)?.fit(&CATALOG).map_err(|refusals| scenario_error(py, &refusals))
}

/// Fits a scenario; Ctrl-C raises, and nothing is kept.
#[pyfunction]
#[pyo3(signature = (scenario, set=None))]
fn fit_scenario(py: Python<'_>, scenario: &Bound<'_, PyAny>, set: Option<&Bound<'_, PyAny>>) -> PyResult<Fitted> {
    guarded(py, || {
        let fitting = read(scenario, set)?;
        let jobs = std::thread::available_parallelism().map_or(1, usize::from);
        let found = interruptible(py, |stop| find(fitting, jobs, stop))?;
        found.map(|outcome| Fitted { outcome }).map_err(|error| match error {
            FitError::Refused(refusals) => scenario_error(py, &refusals),
            FitError::Unfit(why) => springpot_error(py, why),
            error @ FitError::Unstartable(_) => run_error_at(py, &error, None),
        })
    })
}

/// What a fit found.
#[pyclass(module = "springpot._springpot", frozen)]
struct Fitted {
    outcome: Outcome,
}

#[pymethods]
impl Fitted {
    /// The record of the fit, as fit.json has it.
    fn json(&self) -> String {
        json(&self.outcome).to_string()
    }

    /// What the command prints.
    fn told(&self) -> String {
        told(&self.outcome)
    }

    /// The scenario with the values put in.
    fn scenario(&self) -> String {
        self.outcome.fitting.fitted(&self.outcome.fit.values)
    }

    /// Covariance of the parameters, row by row, shape (P·P,).
    fn covariance<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.outcome.fit.covariance)
    }

    /// By record and column: `at`, `measured`, `model`, `residual`.
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let all = PyDict::new(py);
        for (data, score) in self.outcome.fitting.plan().data.iter().zip(&self.outcome.records) {
            let own = PyDict::new(py);
            for (column, found) in data.columns.iter().zip(&score.columns) {
                let told = PyDict::new(py);
                told.set_item("at", PyArray1::from_iter(py, score.rows.iter().map(|row| data.at[*row])))?;
                told.set_item("measured", PyArray1::from_slice(py, &found.measured))?;
                told.set_item("model", PyArray1::from_slice(py, &found.model))?;
                told.set_item("residual", PyArray1::from_slice(py, &found.residuals))?;
                told.set_item("unit", &column.unit)?;
                own.set_item(&column.name, told)?;
            }
            all.set_item(&data.name, own)?;
        }
        Ok(all)
    }

    /// Writes the files of the command into a folder.
    fn save(&self, py: Python<'_>, folder: PathBuf) -> PyResult<Vec<String>> {
        Ok(py.detach(|| save(&self.outcome, &folder))?)
    }
}

/// The residuals of a fit, for other minimisers.
#[pyclass(module = "springpot._springpot", frozen)]
struct Residuals {
    fitting: Fitting,
}

#[pymethods]
impl Residuals {
    #[new]
    #[pyo3(signature = (scenario, set=None))]
    fn new(py: Python<'_>, scenario: &Bound<'_, PyAny>, set: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        guarded(py, || {
            let fitting = read(scenario, set)?;
            Problem::new(&fitting).map_err(|why| springpot_error(py, why))?;
            Ok(Self { fitting })
        })
    }

    /// Names of the parameters.
    #[getter]
    fn names(&self) -> Vec<String> {
        self.fitting.plan().parameters.iter().map(|one| one.sought.name.clone()).collect()
    }

    /// Their units, SI.
    #[getter]
    fn units(&self) -> Vec<String> {
        self.fitting.plan().parameters.iter().map(|one| one.unit.clone()).collect()
    }

    /// Where they begin, shape (P,).
    #[getter]
    fn start<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.fitting.plan().parameters.iter().map(|one| one.sought.start[0]))
    }

    /// Their least and their largest values, two arrays of shape (P,).
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> [Bound<'py, PyArray1<f64>>; 2] {
        let each = |k: usize| self.fitting.plan().parameters.iter().map(move |one| one.sought.bounds[k]);
        [PyArray1::from_iter(py, each(0)), PyArray1::from_iter(py, each(1))]
    }

    /// The residuals at p, shape (N,).
    fn residuals<'py>(&self, py: Python<'py>, p: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(PyArray1::from_vec(py, self.at(py, p, false)?.0))
    }

    /// Their derivatives by p, row by row, shape (N·P,).
    fn jacobian<'py>(&self, py: Python<'py>, p: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(PyArray1::from_vec(py, self.at(py, p, true)?.1))
    }
}

impl Residuals {
    fn at(&self, py: Python<'_>, p: &Bound<'_, PyAny>, is_differentiated: bool) -> PyResult<(Vec<f64>, Vec<f64>)> {
        guarded(py, || {
            let values = column(p, "p")?;
            let count = self.fitting.plan().parameters.len();
            if values.len() != count {
                return Err(value_error(format!("p has {} values, and there are {count} parameters", values.len())));
            }
            let problem = Problem::new(&self.fitting).map_err(|why| springpot_error(py, why))?;
            let found = py.detach(|| problem.residuals(&values, is_differentiated));
            found.map_err(|error| run_error_at(py, &error, None))
        })
    }
}
