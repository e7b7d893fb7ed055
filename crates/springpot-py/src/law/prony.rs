//! Prony series of laws.

use super::{PyLaw, each};
use crate::error::{guarded, value_error};
use crate::notebook;
use crate::pickle::{self, Reduced, reduced};
use crate::quantity::number;
use numpy::{Complex64, PyArray1, PyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::{PyAny, PyString};
use springpot::fractional::prony::{Bulk, PronySeries, Relaxation as _, Slowest, Window};
use std::f64::consts::TAU;

pub(super) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyProny>()?;
    module.add_function(wrap_pyfunction!(prony, module)?)
}

/// What the bytes of a series begin with.
const TAG: &str = "springpot prony 1\n";

/// G(t) ≈ G_e + Σ g_k e^{−t/tau_k}, all g_k > 0: a spring beside Maxwell branches. :func:`springpot.prony` makes them.
#[pyclass(frozen, eq, name = "Prony", module = "springpot._springpot")]
#[derive(Debug, PartialEq)]
struct PyProny {
    series: PronySeries,
}

/// Angular frequency, rad/s: a number is one, a text with Hz counts turns.
pub(super) fn angular(value: &Bound<'_, PyAny>, name: &str) -> PyResult<f64> {
    let found = number(value, "Hz", name)?;
    let turns = match value.cast::<PyString>() {
        Ok(text) => text.to_cow()?.trim_end().ends_with("Hz"),
        Err(_) => false,
    };
    Ok(if turns { TAU * found } else { found })
}

#[pyfunction]
#[pyo3(signature = (law, times=None, *, band=None, rtol=1e-4, slowest="relaxes"))]
fn prony(
    py: Python<'_>,
    law: &PyLaw,
    times: Option<(Bound<'_, PyAny>, Bound<'_, PyAny>)>,
    band: Option<(Bound<'_, PyAny>, Bound<'_, PyAny>)>,
    rtol: f64,
    slowest: &str,
) -> PyResult<PyProny> {
    guarded(py, || {
        let window = match (times, band) {
            (Some((from, to)), None) => {
                Window::Times { from: number(&from, "s", "times[0]")?, to: number(&to, "s", "times[1]")? }
            }
            (None, Some((from, to))) => {
                Window::Frequencies { from: angular(&from, "band[0]")?, to: angular(&to, "band[1]")? }
            }
            _ => return Err(value_error("a Prony series needs either times=(from, to), s, or band=(from, to), rad/s")),
        };
        let slowest = match slowest {
            "relaxes" => Slowest::Relaxes,
            "stays" => Slowest::Stays,
            other => return Err(value_error(format!("slowest is \"{other}\"; write \"relaxes\" or \"stays\""))),
        };
        let tangent = law.tangent()?;
        if !tangent.is_smooth() || tangent.spectrum(1.0) <= 0.0 {
            let why = "the parts of the law are not springs and springpots alone: a chain of springs and dashpots needs no series";
            return Err(value_error(why));
        }
        let series = py.detach(|| PronySeries::new(&tangent, window, rtol, slowest)).map_err(value_error)?;
        Ok(PyProny { series })
    })
}

fn bulk(name: &str) -> PyResult<Bulk> {
    match name {
        "elastic" => Ok(Bulk::Elastic),
        "relaxes" => Ok(Bulk::Relaxes),
        other => Err(value_error(format!("bulk is \"{other}\"; write \"elastic\" or \"relaxes\""))),
    }
}

#[pymethods]
impl PyProny {
    /// G_e.
    #[getter]
    fn equilibrium(&self) -> f64 {
        self.series.equilibrium
    }

    /// g_k, shape ``(branches,)``, fastest first.
    #[getter]
    fn moduli<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.series.terms.iter().map(|term| term.modulus))
    }

    /// tau_k, s, shape ``(branches,)``.
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.series.terms.iter().map(|term| term.relaxation_time))
    }

    /// Largest relative error found on the window.
    #[getter]
    fn error(&self) -> f64 {
        self.series.error
    }

    /// The bound that was asked for.
    #[getter]
    fn rtol(&self) -> f64 {
        self.series.tolerance
    }

    /// G(t) in the shape of ``t``, s.
    fn relaxation<'py>(&self, py: Python<'py>, t: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        each(py, t, "t", |t| self.series.relaxation(t))
    }

    /// G*(ω) in the shape of ``omega``, rad/s; complex.
    fn modulus<'py>(&self, py: Python<'py>, omega: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<Complex64>>> {
        each(py, omega, "omega", |omega| {
            let modulus = self.series.complex_modulus(omega);
            Complex64::new(modulus.re, modulus.im)
        })
    }

    /// As CSV.
    fn csv(&self) -> String {
        self.series.csv()
    }

    /// As lines for Abaqus; ``bulk`` is "elastic" or "relaxes".
    #[pyo3(signature = (bulk="elastic"))]
    #[pyo3(name = "abaqus")]
    fn for_abaqus(&self, bulk: &str) -> PyResult<String> {
        self.series.abaqus(self::bulk(bulk)?).map_err(value_error)
    }

    /// As lines for Ansys.
    #[pyo3(signature = (bulk="elastic"))]
    #[pyo3(name = "ansys")]
    fn for_ansys(&self, bulk: &str) -> PyResult<String> {
        self.series.ansys(self::bulk(bulk)?).map_err(value_error)
    }

    fn __len__(&self) -> usize {
        self.series.terms.len()
    }

    /// What ``__reduce__`` made.
    #[staticmethod]
    fn _from_bytes(bytes: &[u8]) -> PyResult<Self> {
        pickle::of_bytes(TAG, "Prony series", bytes).map(|series| Self { series })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced::<Self>(py, "_from_bytes", pickle::to_bytes(py, TAG, &self.series)?)
    }

    fn __hash__(&self) -> u64 {
        let PronySeries { equilibrium, terms, error, .. } = &self.series;
        equilibrium.to_bits() ^ error.to_bits().rotate_left(17) ^ terms.len() as u64
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        notebook::html("prony", slf)
    }

    fn __repr__(&self) -> String {
        let (count, error) = (self.series.terms.len(), self.series.error);
        format!("Prony({count} branches, equilibrium={}, error={error:.1e})", self.series.equilibrium)
    }
}
