//! Laws from data sheets and from measurements over the frequency.

use super::PyLaw;
use super::prony::angular;
use super::read::described;
use crate::array::column;
use crate::error::{guarded, value_error};
use crate::quantity::number;
use crate::scenario::CATALOG;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use springpot::law::Entry;
use springpot::law::datasheet::{Datum, Measured, Model, Quantity, can_fit, fit, fit_network, identify};
use springpot_scenario::suggest;
use springpot_scenario::units::parse_quantity;
use std::f64::consts::FRAC_PI_2;
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

/// A law with its parameters, as any other.
fn law(py: Python<'_>, entry: &Entry, value: impl Fn(&str) -> f64) -> PyResult<PyLaw> {
    let (words, parameters) = (PyDict::new(py), PyDict::new(py));
    for param in &entry.params {
        parameters.set_item(&*param.name, value(&param.name))?;
    }
    words.set_item("law", &*entry.name)?;
    words.set_item("parameters", parameters)?;
    described(&words)?.build()
}

/// A/L of a sample, m: its stiffness is E·A/L; `None` where none is given.
fn sample(area: Option<&Bound<'_, PyAny>>, length: Option<&Bound<'_, PyAny>>) -> PyResult<Option<f64>> {
    let size = |value: &Bound<'_, PyAny>, unit: &str, name: &str| {
        let found = number(value, unit, name)?;
        if found > 0.0 { Ok(found) } else { Err(value_error(format!("{name} is {found} {unit}; it must be positive"))) }
    };
    match (area, length) {
        (Some(area), Some(length)) => Ok(Some(size(area, "m^2", "area")? / size(length, "m", "length")?)),
        (None, None) => Ok(None),
        _ => Err(value_error("a sample has an area and a length: give both")),
    }
}

/// The value of a quantity, tan δ as an angle too, and whether it is a modulus in Pa, of which it is the stiffness of the sample.
fn value(told: &Bound<'_, PyAny>, quantity: Quantity, sample: Option<f64>) -> PyResult<(f64, bool)> {
    let (name, unit) = (quantity.name(), quantity.unit());
    let read = number(told, unit, name);
    let Ok(text) = told.cast::<PyString>() else { return Ok((read?, false)) };
    let text = text.to_cow()?;
    if unit.is_empty() && ["rad", "deg"].iter().any(|angle| text.contains(angle)) {
        let angle = number(told, "rad", name)?;
        let is_right = (0.0..FRAC_PI_2).contains(&angle);
        return if is_right {
            Ok((angle.tan(), false))
        } else {
            Err(value_error(format!("{name}: δ lies between 0 and 90 deg")))
        };
    }
    match read {
        Ok(value) => Ok((value, false)),
        Err(error) => {
            let modulus = match unit {
                "N/m" => "Pa",
                "N*s/m" => "Pa*s",
                _ => return Err(error),
            };
            let Ok(modulus) = parse_quantity(&text, modulus, &|_| None) else { return Err(error) };
            let sized = sample.map(|sample| (modulus * sample, true));
            sized.ok_or_else(|| value_error(format!("{name} is a modulus: give the area and the length of the sample")))
        }
    }
}

/// The law, and the largest relative deviation of what it has in the place of the data.
#[pyfunction]
#[pyo3(signature = (data, law=None, *, area=None, length=None))]
fn datasheet(
    py: Python<'_>,
    data: Vec<(String, Bound<'_, PyAny>, Bound<'_, PyAny>)>,
    law: Option<String>,
    area: Option<&Bound<'_, PyAny>>,
    length: Option<&Bound<'_, PyAny>>,
) -> PyResult<(PyLaw, f64)> {
    guarded(py, || {
        let sample = sample(area, length)?;
        let (mut read, mut is_sized) = (Vec::with_capacity(data.len()), sample.is_none());
        for (name, told, frequency) in &data {
            let Some(quantity) = Quantity::ALL.into_iter().find(|quantity| quantity.name() == name) else {
                let help = suggest(name, Quantity::ALL.map(Quantity::name));
                return Err(value_error(format!("a data sheet has no \"{name}\"; {help}")));
            };
            let (value, is_modulus) = value(told, quantity, sample)?;
            is_sized |= is_modulus;
            read.push(Datum { quantity, value, omega: angular(frequency, "the frequency")? });
        }
        if !is_sized {
            return Err(value_error("a sample, but no modulus in Pa: what is a stiffness already has no sample"));
        }
        let entry = match &law {
            Some(name) => entry(name)?,
            None => Model::for_data(&read).law(&CATALOG).ok_or_else(|| value_error("no law is of that form"))?,
        };
        let found = identify(entry, &read).map_err(value_error)?;
        let law = self::law(py, entry, |name| found.parameter(name).unwrap_or(0.0))?;
        Ok((law, found.deviation(&read)))
    })
}

/// The law, √ of the mean square of its relative deviations, and one standard deviation of each of its parameters.
#[pyfunction]
#[pyo3(signature = (omega, modulus_real, modulus_imag, law, area=None, length=None))]
fn fit_modulus<'py>(
    py: Python<'py>,
    omega: &Bound<'py, PyAny>,
    modulus_real: &Bound<'py, PyAny>,
    modulus_imag: &Bound<'py, PyAny>,
    law: &str,
    area: Option<&Bound<'py, PyAny>>,
    length: Option<&Bound<'py, PyAny>>,
) -> PyResult<(PyLaw, f64, Bound<'py, PyDict>)> {
    guarded(py, || {
        let omega = column(omega, "omega")?;
        let (storage, loss) = (column(modulus_real, "modulus")?, column(modulus_imag, "modulus")?);
        if storage.len() != omega.len() {
            return Err(value_error(format!("omega has {} values, and modulus {}", omega.len(), storage.len())));
        }
        let by = sample(area, length)?.unwrap_or(1.0);
        let rows = omega.iter().zip(storage.iter().zip(&loss));
        let rows: Vec<Measured> = rows
            .map(|(omega, (storage, loss))| Measured { omega: *omega, storage: by * storage, loss: by * loss })
            .collect();
        let entry = entry(law)?;
        let spread = PyDict::new(py);
        let (law, rms) = if Model::of(entry).is_none() && can_fit(entry) {
            let fitted = py.detach(|| fit_network(entry, &rows)).map_err(value_error)?;
            let place = |name: &str| entry.params.iter().position(|param| &*param.name == name);
            entry.params.iter().zip(&fitted.spreads).try_for_each(|(param, one)| spread.set_item(&*param.name, one))?;
            (self::law(py, entry, |name| place(name).map_or(f64::NAN, |at| fitted.values[at]))?, fitted.rms)
        } else {
            let fitted = fit(entry, &rows).map_err(value_error)?;
            entry.params.iter().try_for_each(|param| spread.set_item(&*param.name, fitted.spread(&param.name)))?;
            (self::law(py, entry, |name| fitted.law.parameter(name).unwrap_or(0.0))?, fitted.rms)
        };
        Ok((law, rms, spread))
    })
}
