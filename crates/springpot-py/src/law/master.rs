//! Master curves.

use crate::array::column;
use crate::error::{guarded, run_error_at, value_error};
use crate::quantity::number;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyModule};
use springpot::law::Shift;
use springpot::law::master::{MasterError, Row, ShiftFit};

pub(super) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(master, module)?)
}

/// Shifts, rows and laws of a master curve.
#[pyfunction]
#[pyo3(signature = (frequency, storage, loss, temperature, reference, vertical=false))]
fn master<'py>(
    py: Python<'py>,
    frequency: &Bound<'py, PyAny>,
    storage: &Bound<'py, PyAny>,
    loss: &Bound<'py, PyAny>,
    temperature: &Bound<'py, PyAny>,
    reference: &Bound<'py, PyAny>,
    vertical: bool,
) -> PyResult<Bound<'py, PyDict>> {
    guarded(py, || {
        let frequency = column(frequency, "frequency")?;
        let columns = [(storage, "storage"), (loss, "loss"), (temperature, "T")].map(|(value, name)| {
            let found = column(value, name)?;
            match found.len() == frequency.len() {
                true => Ok(found),
                false => {
                    Err(value_error(format!("frequency has {} values, and {name} {}", frequency.len(), found.len())))
                }
            }
        });
        let [storage, loss, temperature] = columns;
        let (storage, loss, temperature) = (storage?, loss?, temperature?);
        let reference = number(reference, "K", "reference")?;
        let rows: Vec<Row> = (0..frequency.len())
            .map(|k| Row { frequency: frequency[k], storage: storage[k], loss: loss[k], temperature: temperature[k] })
            .collect();
        let found =
            py.detach(|| springpot::law::master::master(&rows, reference, vertical)).map_err(|error| match error {
                MasterError::NoOverlap { .. } | MasterError::Flat { .. } => run_error_at(py, &error, None),
                MasterError::Number { row, .. } => value_error(format!("row {row}: {error}")),
                _ => value_error(error),
            })?;
        let fit = |fit: &ShiftFit| -> PyResult<Bound<'py, PyDict>> {
            let words = PyDict::new(py);
            match fit.shift {
                Shift::Wlf { c1, c2, reference } => {
                    words.set_item("kind", "wlf")?;
                    words.set_item("C1", c1)?;
                    words.set_item("C2", c2)?;
                    words.set_item("T_ref", reference)?;
                    let sd = PyDict::new(py);
                    sd.set_item("C1", fit.sd[0])?;
                    sd.set_item("C2", fit.sd[1])?;
                    words.set_item("sd", sd)?;
                    words.set_item("correlation", fit.correlation)?;
                }
                Shift::Arrhenius { energy, reference } => {
                    words.set_item("kind", "arrhenius")?;
                    words.set_item("energy", energy)?;
                    words.set_item("T_ref", reference)?;
                    words.set_item("sd", fit.sd[0])?;
                }
            }
            words.set_item("rms", fit.rms)?;
            words.set_item("bic", fit.bic)?;
            Ok(words)
        };
        let told = PyDict::new(py);
        let shift = |name: &str, of: &dyn Fn(&springpot::law::master::Shifted) -> f64| {
            told.set_item(name, PyArray1::from_iter(py, found.shifts.iter().map(of)))
        };
        shift("T", &|one| one.temperature)?;
        shift("log10_a_T", &|one| one.log_a)?;
        shift("sd", &|one| one.sd)?;
        shift("log10_b_T", &|one| one.log_b)?;
        shift("sd_b", &|one| one.sd_b)?;
        let curve = PyDict::new(py);
        let row = |name: &str, of: &dyn Fn(&Row) -> f64| {
            curve.set_item(name, PyArray1::from_iter(py, found.rows.iter().map(of)))
        };
        row("frequency", &|row| row.frequency)?;
        row("storage", &|row| row.storage)?;
        row("loss", &|row| row.loss)?;
        row("T", &|row| row.temperature)?;
        told.set_item("curve", curve)?;
        told.set_item("wlf", found.wlf.as_ref().map(fit).transpose()?)?;
        told.set_item("arrhenius", fit(&found.arrhenius)?)?;
        told.set_item("chosen", fit(found.chosen())?)?;
        told.set_item("scatter", found.scatter)?;
        Ok(told)
    })
}
