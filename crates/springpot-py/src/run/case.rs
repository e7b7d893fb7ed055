//! A case that was run, and its columns without a copy.

use crate::error::{case_error, value_error};
use crate::pickle::{Reduced, reduced};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use springpot_run::sweep::Parcel;
use std::sync::Arc;

/// A case that came to its end, or failed on the way; it can be sent to other processes of the same build.
#[pyclass(frozen, module = "springpot._springpot")]
pub(crate) struct Case(pub(crate) Arc<Parcel>);

#[pymethods]
impl Case {
    /// What `to_bytes` made.
    #[staticmethod]
    fn from_bytes(bytes: &[u8]) -> PyResult<Self> {
        Parcel::from_bytes(bytes).map(|parcel| Self(Arc::new(parcel))).map_err(value_error)
    }

    /// Bytes that hold every number to the bit.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &py.detach(|| self.0.to_bytes())?))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced::<Self>(py, "from_bytes", self.to_bytes(py)?)
    }

    /// Index in the grid of the sweeps.
    #[getter]
    fn index(&self) -> usize {
        self.0.index()
    }

    /// Number of rows.
    #[getter]
    fn rows(&self) -> usize {
        self.0.report().rows as usize
    }

    /// The column number `k`, behind those of swept parameters.
    fn column(&self, k: usize) -> PyResult<Column> {
        let count = self.0.columns().map_or(0, <[Vec<f64>]>::len);
        if k < count {
            Ok(Column { of: self.0.clone(), k })
        } else {
            Err(value_error(format!("column {k} of {count}")))
        }
    }

    /// The same with these of its columns alone.
    fn with_columns(&self, kept: Vec<usize>) -> Self {
        Self(Arc::new(self.0.with_columns(&kept)))
    }

    /// Whether it has all of its columns.
    #[getter]
    fn is_whole(&self) -> bool {
        self.0.is_whole()
    }

    /// Whether it has the column number `k`.
    fn has_column(&self, k: usize) -> bool {
        let column = self.0.columns().and_then(|columns| columns.get(k));
        column.is_some_and(|column| column.len() as u64 == self.0.report().rows)
    }

    /// Why it failed, as a `RunError`; `None` where it did not.
    #[getter]
    fn error<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.0.error().map(|trouble| case_error(py, trouble).value(py).clone().into_any())
    }

    /// Whether it failed.
    #[getter]
    fn has_failed(&self) -> bool {
        self.0.error().is_some()
    }

    /// Steps, rows, energies: as in run.json.
    #[getter]
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (report, words) = (self.0.report(), PyDict::new(py));
        words.set_item("steps", report.steps)?;
        words.set_item("rejected_steps", report.rejected_steps)?;
        words.set_item("newton_iterations", report.newton_iterations)?;
        words.set_item("explicit_steps", report.explicit_steps)?;
        words.set_item("evaluations", report.evaluations)?;
        words.set_item("method_switches", report.method_switches)?;
        words.set_item("rows", report.rows)?;
        words.set_item("t_reached", report.t_reached)?;
        words.set_item("energy_residual", report.energy_residual)?;
        words.set_item("energy_turned_over", report.energy_turned_over)?;
        words.set_item("ledger", self.0.no_ledger().map(|why| format!("unknown: {why}")))?;
        words.set_item("wall_time", self.0.wall().as_secs_f64())?;
        Ok(words)
    }

    /// The limits of joints that it passes, in words.
    #[getter]
    fn limits(&self) -> Vec<String> {
        self.0.limits().iter().map(ToString::to_string).collect()
    }

    /// The values of its metrics in the order of the scenario; NaN where one has none, empty where no row was written.
    #[getter]
    fn metrics(&self) -> Vec<f64> {
        self.0.metrics().values.clone()
    }

    /// The derivatives of its metrics, by metric and parameter, in their order; empty where it is not differentiated.
    #[getter]
    fn gradients(&self) -> Vec<Vec<f64>> {
        self.0.metrics().derivatives.gradients.clone()
    }

    /// Where derivatives end before the run does: parameter, t in s, why.
    #[getter]
    fn lost(&self) -> Vec<(usize, f64, String)> {
        let lost = self.0.metrics().derivatives.lost.iter();
        lost.map(|lost| (lost.parameter, lost.t, lost.why.clone())).collect()
    }

    /// Its lines in events.csv.
    #[getter]
    fn events(&self) -> &str {
        self.0.events().0
    }

    /// Smallest, largest and root-mean-square value of every column.
    #[getter]
    fn statistics(&self) -> Vec<(f64, f64, f64)> {
        let count = self.0.columns().map_or(0, <[Vec<f64>]>::len);
        self.0.statistics().iter().take(count).map(|column| (column.min, column.max, column.rms())).collect()
    }
}

/// A column of a case; NumPy takes its numbers where they are.
#[pyclass(frozen, module = "springpot._springpot")]
pub(crate) struct Column {
    of: Arc<Parcel>,
    k: usize,
}

#[pymethods]
impl Column {
    /// Where its numbers are, which nobody may write to.
    #[getter]
    fn __array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let values = &self.of.columns().unwrap_or_default()[self.k];
        let words = PyDict::new(py);
        words.set_item("version", 3)?;
        words.set_item("shape", (values.len(),))?;
        words.set_item("typestr", if cfg!(target_endian = "little") { "<f8" } else { ">f8" })?;
        // NumPy keeps this object, which keeps the numbers.
        words.set_item("data", (values.as_ptr().addr(), true))?;
        Ok(words)
    }
}
