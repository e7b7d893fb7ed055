//! Results in a folder, read back: what a study tells of its cases, of a run that has ended.

use super::case::Case;
use crate::error::{guarded, springpot_error, value_error};
use crate::pickle::{self, Reduced, reduced};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyList};
use springpot_run::table::disk::Disk;
use springpot_run::{Results, Told, of_other_version};
use springpot_scenario::SweptValue;
use std::path::PathBuf;

/// What the bytes of it begin with.
const TAG: &str = "springpot results 1\n";

/// What a run that has ended says of itself: the questions that a `Study` answers, without the scenario.
#[pyclass(frozen, module = "springpot._springpot")]
pub(crate) struct Stored(Told);

#[pymethods]
impl Stored {
    /// The results in a folder, with their cases; and what deserves a warning.
    #[staticmethod]
    fn read(py: Python<'_>, folder: PathBuf) -> PyResult<(Self, Vec<Case>, Option<String>)> {
        guarded(py, || {
            let read = py.detach(|| {
                let results = Results::read(&Disk::default(), &folder)?;
                let warning = of_other_version(&folder, results.version());
                results.whole().map(|whole| (whole, warning))
            });
            let ((told, parcels), warning) = read.map_err(|error| springpot_error(py, error))?;
            Ok((Self(told), parcels.into_iter().map(Case).collect(), warning.map(|warning| warning.to_string())))
        })
    }

    /// What `to_bytes` made.
    #[staticmethod]
    fn from_bytes(bytes: &[u8]) -> PyResult<Self> {
        pickle::of_bytes(TAG, "results", bytes).map(Self)
    }

    /// All but the rows.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        pickle::to_bytes(py, TAG, &self.0)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced::<Self>(py, "from_bytes", self.to_bytes(py)?)
    }

    /// The folder that was read.
    #[getter]
    fn folder(&self) -> PathBuf {
        self.0.folder.clone()
    }

    /// The format of its rows.
    #[getter]
    fn format(&self) -> &str {
        &self.0.format
    }

    /// Writes the rows as CSV into a file, whatever their format is.
    fn write_rows(&self, py: Python<'_>, file: PathBuf) -> PyResult<()> {
        guarded(py, || {
            let written = py.detach(|| {
                let mut out = std::io::BufWriter::new(std::fs::File::create(&file).map_err(|error| error.to_string())?);
                let results = Results::read(&Disk::default(), &self.0.folder).map_err(|error| error.to_string())?;
                results.write_csv(&mut out).map_err(|error| error.to_string())
            });
            written.map_err(|error| springpot_error(py, error))
        })
    }

    /// Number of cases.
    fn __len__(&self) -> usize {
        self.0.cases.len()
    }

    /// The title of the scenario.
    #[getter]
    fn title(&self) -> Option<&str> {
        self.0.title.as_deref()
    }

    /// Name and text of the scenario, and what was set and swept beside it.
    #[getter]
    fn scenario(&self) -> (String, String, Vec<String>, Vec<String>) {
        self.0.scenario.clone()
    }

    /// Paths of the swept parameters.
    #[getter]
    fn parameters(&self) -> Vec<String> {
        self.0.parameters.clone()
    }

    /// By sweep the paths that move together, the number of its values, and what they are called where they have names.
    #[getter]
    fn axes(&self) -> Vec<(Vec<String>, usize, Option<Vec<String>>)> {
        self.0.axes.clone()
    }

    /// Name, paths, value and unit of what the first case is differentiated by.
    #[getter]
    fn differentiated(&self) -> Vec<(String, Vec<String>, f64, String)> {
        self.0.differentiated.clone()
    }

    /// Name, unit and meaning of every column, those of swept parameters first.
    #[getter]
    fn columns(&self) -> Vec<(String, String, String)> {
        self.0.columns.iter().cloned().map(<(String, String, String)>::from).collect()
    }

    /// What stands at an axis that shows a column.
    fn axis(&self, column: usize) -> PyResult<String> {
        self.0.axis(column).ok_or_else(|| value_error(format!("column {column} of {}", self.0.columns.len())))
    }

    /// Names and columns of events.csv behind the swept parameters.
    #[getter]
    fn event_columns(&self) -> Vec<String> {
        self.0.event_columns.clone()
    }

    /// Name, column and unit of every metric.
    #[getter]
    fn metrics(&self) -> Vec<(String, String, String)> {
        self.0.metrics.iter().cloned().map(<(String, String, String)>::from).collect()
    }

    /// The swept values of a case: numbers in SI units, or texts.
    fn values<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyList>> {
        let values = PyList::empty(py);
        for value in &self.known(index)?.0 {
            match value {
                SweptValue::Number(number) => values.append(number)?,
                SweptValue::Text(text) => values.append(text)?,
            }
        }
        Ok(values)
    }

    /// What a case is called.
    fn name(&self, index: usize) -> PyResult<&str> {
        Ok(&self.known(index)?.1)
    }
}

impl Stored {
    fn known(&self, index: usize) -> PyResult<&(Vec<SweptValue>, String)> {
        self.0.cases.get(&index).ok_or_else(|| pyo3::exceptions::PyIndexError::new_err(format!("no case {index}")))
    }
}
