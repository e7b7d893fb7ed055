//! All that is known at one time, by column.

use numpy::PyArray1;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyIterator, PyList};
use springpot::observe::{Observables, Quantity, Snapshot};
use springpot_scenario::suggest;
use std::collections::HashMap;
use std::sync::Arc;

/// What can be observed of a system.
#[derive(Debug)]
pub(super) struct Columns {
    all: Vec<(Quantity, String, String)>,
    places: HashMap<String, usize>,
}

impl Columns {
    pub(super) fn new(observables: &Observables) -> Self {
        let named = |quantity| {
            let column = observables.column(quantity);
            (quantity, column.name, column.unit)
        };
        let all: Vec<_> = observables.quantities().into_iter().map(named).collect();
        let places = all.iter().enumerate().map(|(k, (_, name, _))| (name.clone(), k)).collect();
        Self { all, places }
    }

    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.all.iter().map(|(_, name, _)| name.as_str())
    }

    pub(super) fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let units = PyDict::new(py);
        self.all.iter().try_for_each(|(_, name, unit)| units.set_item(name, unit))?;
        Ok(units)
    }
}

/// All that is known at one time: a mapping from columns, as results have them, to SI numbers (NaN where unknown).
#[pyclass(frozen, mapping, name = "Snapshot", module = "springpot._springpot")]
#[derive(Debug)]
pub(super) struct PySnapshot {
    snapshot: Snapshot,
    columns: Arc<Columns>,
}

impl PySnapshot {
    pub(super) fn new(snapshot: Snapshot, columns: Arc<Columns>) -> Self {
        Self { snapshot, columns }
    }

    fn value(&self, name: &str) -> Option<f64> {
        let place = *self.columns.places.get(name)?;
        Some(self.snapshot.value(self.columns.all[place].0))
    }

    fn values_in_order(&self) -> impl Iterator<Item = f64> + '_ {
        self.columns.all.iter().map(|(quantity, ..)| self.snapshot.value(*quantity))
    }
}

#[pymethods]
impl PySnapshot {
    /// Time, s.
    #[getter]
    fn t(&self) -> f64 {
        self.snapshot.t()
    }

    /// Coordinates, shape ``(nq,)``.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.snapshot.q())
    }

    /// Velocities, shape ``(nv,)``.
    #[getter]
    fn v<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.snapshot.v())
    }

    /// Accelerations, shape ``(nv,)``; NaN at a singular start.
    #[getter]
    fn a<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.snapshot.a())
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
        self.values_in_order().collect()
    }

    /// Names and values.
    fn items(&self) -> Vec<(String, f64)> {
        self.columns.names().map(str::to_owned).zip(self.values_in_order()).collect()
    }

    fn __repr__(&self) -> String {
        format!("Snapshot(t={}, {} columns)", self.snapshot.t(), self.columns.all.len())
    }
}
