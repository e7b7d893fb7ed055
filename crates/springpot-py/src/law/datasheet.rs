//! Laws from data sheets and from measurements over the frequency.

use super::PyLaw;
use super::prony::angular;
use super::read::described;
use crate::array::{numbers, written};
use crate::error::{guarded, value_error};
use crate::quantity::number;
use crate::scenario::CATALOG;
use numpy::PyUntypedArrayMethods;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use springpot::law::Entry;
use springpot::law::datasheet::{Datum, Identified, Measured, Model, Quantity, fit, identify};
use springpot_scenario::suggest;
use std::sync::Arc;

pub(super) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(datasheet, module)?)?;
    module.add_function(wrap_pyfunction!(fit_modulus, module)?)
}

/// The law of that name.
fn entry(name: &str) -> PyResult<&'static Arc<Entry>> {
    CATALOG.get(name).ok_or_else(|| {
        let help = suggest(name, CATALOG.entries().iter().map(|entry| &*entry.name).collect::<Vec<_>>());
        value_error(format!("there is no law \"{name}\"; {help}"))
    })
}

/// The law that was found, as any other.
fn law(py: Python<'_>, entry: &Entry, found: &Identified) -> PyResult<PyLaw> {
    let (words, parameters) = (PyDict::new(py), PyDict::new(py));
    for param in &entry.params {
        parameters.set_item(&*param.name, found.parameter(&param.name).unwrap_or(0.0))?;
    }
    words.set_item("law", &*entry.name)?;
    words.set_item("parameters", parameters)?;
    described(&words)?.build()
}

/// The law, and the largest relative deviation of what it has in the place of the data.
#[pyfunction]
#[pyo3(signature = (data, law=None))]
fn datasheet(
    py: Python<'_>,
    data: Vec<(String, Bound<'_, PyAny>, Bound<'_, PyAny>)>,
    law: Option<String>,
) -> PyResult<(PyLaw, f64)> {
    guarded(py, || {
        let mut read = Vec::with_capacity(data.len());
        for (name, value, frequency) in &data {
            let Some(quantity) = Quantity::ALL.into_iter().find(|quantity| quantity.name() == name) else {
                let help = suggest(name, Quantity::ALL.map(Quantity::name));
                return Err(value_error(format!("a data sheet has no \"{name}\"; {help}")));
            };
            let value = number(value, quantity.unit(), name)?;
            read.push(Datum { quantity, value, omega: angular(frequency, "the frequency")? });
        }
        let entry = match &law {
            Some(name) => entry(name)?,
            None => Model::for_data(&read).law(&CATALOG).ok_or_else(|| value_error("no law is of that form"))?,
        };
        let found = identify(entry, &read).map_err(value_error)?;
        Ok((self::law(py, entry, &found)?, found.deviation(&read)))
    })
}

/// The law, √ of the mean square of its relative deviations, and one standard deviation of each of its parameters.
#[pyfunction]
#[pyo3(signature = (omega, modulus_real, modulus_imag, law))]
fn fit_modulus<'py>(
    py: Python<'py>,
    omega: &Bound<'py, PyAny>,
    modulus_real: &Bound<'py, PyAny>,
    modulus_imag: &Bound<'py, PyAny>,
    law: &str,
) -> PyResult<(PyLaw, f64, Bound<'py, PyDict>)> {
    guarded(py, || {
        let column = |value: &Bound<'py, PyAny>, name: &str| {
            let array = numbers(value, name)?;
            match array.shape() {
                [_] => super::flat(&array),
                shape => Err(value_error(format!("{name} has shape {}; it must have shape (N,)", written(shape)))),
            }
        };
        let omega = column(omega, "omega")?;
        let (storage, loss) = (column(modulus_real, "modulus")?, column(modulus_imag, "modulus")?);
        if storage.len() != omega.len() {
            return Err(value_error(format!("omega has {} values, and modulus {}", omega.len(), storage.len())));
        }
        let rows = omega.iter().zip(storage.iter().zip(&loss));
        let rows: Vec<Measured> =
            rows.map(|(omega, (storage, loss))| Measured { omega: *omega, storage: *storage, loss: *loss }).collect();
        let entry = entry(law)?;
        let fitted = fit(entry, &rows).map_err(value_error)?;
        let spread = PyDict::new(py);
        for param in &entry.params {
            spread.set_item(&*param.name, fitted.spread(&param.name))?;
        }
        Ok((self::law(py, entry, &fitted.law)?, fitted.rms, spread))
    })
}
