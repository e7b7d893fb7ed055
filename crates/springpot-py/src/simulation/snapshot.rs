//! All that is known at one time, by column.

use crate::error::value_error;
use crate::pickle::{self, Reduced, reduced};
use numpy::PyArray1;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyIterator, PyList};
use serde::{Deserialize, Serialize};
use springpot::observe::{Observables, Quantity, Snapshot};
use springpot_scenario::suggest;
use std::collections::HashMap;
use std::sync::Arc;

/// What the bytes of a snapshot begin with.
const TAG: &str = "springpot snapshot 1\n";

/// What a snapshot tells: names and units.
#[derive(Debug)]
pub(super) struct Columns {
    all: Vec<(String, String)>,
    places: HashMap<String, usize>,
}

impl Columns {
    fn of(all: Vec<(String, String)>) -> Self {
        let places = all.iter().enumerate().map(|(k, (name, _))| (name.clone(), k)).collect();
        Self { all, places }
    }

    /// Those of a system, and how their values are found.
    pub(super) fn new(observables: &Observables) -> (Self, Vec<Quantity>) {
        let quantities = observables.quantities();
        let columns = quantities.iter().map(|quantity| observables.column(*quantity));
        (Self::of(columns.map(|column| (column.name, column.unit)).collect()), quantities)
    }

    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.all.iter().map(|(name, _)| name.as_str())
    }

    pub(super) fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let units = PyDict::new(py);
        self.all.iter().try_for_each(|(name, unit)| units.set_item(name, unit))?;
        Ok(units)
    }
}

/// All that is known at one time: a mapping from columns, as results have them, to SI numbers (NaN where unknown).
#[pyclass(frozen, mapping, name = "Snapshot", module = "springpot._springpot")]
#[derive(Debug)]
pub(super) struct PySnapshot {
    told: Told,
    columns: Arc<Columns>,
}

#[derive(Debug, Serialize, Deserialize)]
struct Told {
    t: f64,
    q: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
    /// In the order of the columns.
    values: Vec<f64>,
}

impl PySnapshot {
    pub(super) fn new(snapshot: &Snapshot, columns: Arc<Columns>, quantities: &[Quantity]) -> Self {
        let values = quantities.iter().map(|quantity| snapshot.value(*quantity)).collect();
        let [q, v, a] = [snapshot.q(), snapshot.v(), snapshot.a()].map(<[f64]>::to_vec);
        Self { told: Told { t: snapshot.t(), q, v, a, values }, columns }
    }

    fn value(&self, name: &str) -> Option<f64> {
        self.columns.places.get(name).map(|place| self.told.values[*place])
    }
}

#[pymethods]
impl PySnapshot {
    /// Time, s.
    #[getter]
    fn t(&self) -> f64 {
        self.told.t
    }

    /// Coordinates, shape ``(nq,)``.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.told.q)
    }

    /// Velocities, shape ``(nv,)``.
    #[getter]
    fn v<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.told.v)
    }

    /// Accelerations, shape ``(nv,)``; NaN at a singular start.
    #[getter]
    fn a<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.told.a)
    }

    /// SI units by column.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.columns.units(py)
    }

    fn __getitem__(&self, name: &str) -> PyResult<f64> {
        self.value(name).ok_or_else(|| {
            let help = suggest(name, self.columns.names().collect::<Vec<_>>());
            PyKeyError::new_err(format!("no column is called \"{name}\"; {help}"))
        })
    }

    fn __contains__(&self, name: &Bound<'_, PyAny>) -> bool {
        name.extract::<String>().is_ok_and(|name| self.columns.places.contains_key(&name))
    }

    fn __len__(&self) -> usize {
        self.columns.all.len()
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        PyList::new(py, self.columns.names())?.try_iter()
    }

    /// The value of a column, or ``default``.
    #[pyo3(signature = (name, default=None, /))]
    fn get<'py>(&self, py: Python<'py>, name: &str, default: Option<Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
        match self.value(name) {
            Some(value) => Ok(value.into_pyobject(py)?.into_any()),
            None => Ok(default.unwrap_or_else(|| py.None().into_bound(py))),
        }
    }

    /// Names of the columns.
    fn keys(&self) -> Vec<String> {
        self.columns.names().map(str::to_owned).collect()
    }

    /// Values in their order.
    fn values(&self) -> Vec<f64> {
        self.told.values.clone()
    }

    /// Names and values.
    fn items(&self) -> Vec<(String, f64)> {
        self.columns.names().map(str::to_owned).zip(self.told.values.iter().copied()).collect()
    }

    fn _ipython_key_completions_(&self) -> Vec<String> {
        self.keys()
    }

    /// What ``__reduce__`` made.
    #[staticmethod]
    fn _from_bytes(bytes: &[u8]) -> PyResult<Self> {
        let (told, columns): (Told, Vec<(String, String)>) = pickle::of_bytes(TAG, "snapshot", bytes)?;
        if told.values.len() != columns.len() {
            return Err(value_error("the bytes are no snapshot: values and columns are not as many"));
        }
        Ok(Self { told, columns: Arc::new(Columns::of(columns)) })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced::<Self>(py, "_from_bytes", pickle::to_bytes(py, TAG, &(&self.told, &self.columns.all))?)
    }

    fn __repr__(&self) -> String {
        format!("Snapshot(t={}, {} columns)", self.told.t, self.columns.all.len())
    }
}
