//! What it takes to go on, to the bit.

use super::{Inner, failed};
use crate::error::value_error;
use crate::pickle::{self, Reduced, reduced};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde::{Deserialize, Serialize};
use springpot::driver::SimulationState;
use std::sync::LazyLock;

/// What the bytes of a state begin with: they hold what one build of the engine keeps.
static TAG: LazyLock<String> =
    LazyLock::new(|| format!("springpot {} state 1, build {}\n", env!("CARGO_PKG_VERSION"), springpot_run::BUILD));

/// Where a simulation was between two steps; belongs to the scenario, values and callables that it was taken from.
#[pyclass(frozen, name = "SimulationState", module = "springpot._springpot")]
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct PyState {
    engine: SimulationState,
    own: Vec<f64>,
    control: Vec<f64>,
    /// Samples taken of every callable.
    counts: Vec<u64>,
}

#[pymethods]
impl PyState {
    /// The time at which it was taken, s.
    #[getter]
    fn t(&self) -> f64 {
        self.engine.t()
    }

    /// As bytes, for files and other processes of the same build.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        pickle::to_bytes(py, &TAG, self)
    }

    /// What :meth:`to_bytes` wrote; ``ValueError`` where the bytes are damaged or of another build.
    #[staticmethod]
    fn from_bytes(bytes: &[u8]) -> PyResult<Self> {
        pickle::of_bytes(&TAG, "state of a simulation", bytes)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced::<Self>(py, "from_bytes", self.to_bytes(py)?)
    }

    fn __repr__(&self) -> String {
        format!("SimulationState(t={})", self.engine.t())
    }
}

impl Inner {
    pub(super) fn state(&mut self, py: Python<'_>) -> PyResult<PyState> {
        let engine = self.simulation.state().map_err(|error| failed(py, &error))?;
        let counts = self.callbacks.iter().map(|callback| callback.count).collect();
        Ok(PyState { engine, own: self.own.clone(), control: self.control.clone(), counts })
    }

    pub(super) fn set_state(&mut self, py: Python<'_>, state: &PyState) -> PyResult<()> {
        let fits = state.counts.len() == self.callbacks.len() && state.own.len() == self.own.len();
        if !fits || state.control.len() != self.control.len() {
            return Err(value_error("the state is one of another simulation: its callables or joints are not these"));
        }
        self.simulation.set_state(&state.engine).map_err(|error| failed(py, &error))?;
        self.own.clone_from(&state.own);
        self.control.clone_from(&state.control);
        for (callback, count) in self.callbacks.iter_mut().zip(&state.counts) {
            callback.count = *count;
        }
        Ok(())
    }
}
