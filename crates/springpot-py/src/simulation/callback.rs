//! Callables of Python that are asked at samples: controllers and inputs.

use super::Inner;
use crate::array::{Rows, numbers};
use crate::error::{run_error_at, value_error};
use numpy::{PyArray1, PyUntypedArrayMethods};
use pyo3::prelude::*;
use springpot::Simulation;
use springpot_scenario::suggest;

/// Times that differ by less than this share of them are one.
const ONE_TIME: f64 = 1e-12;

/// A callable and when it is asked.
pub(super) struct Callback {
    pub(super) what: What,
    pub(super) function: Py<PyAny>,
    /// Between two samples, s.
    pub(super) period: f64,
    /// How many were taken.
    pub(super) count: u64,
}

/// What a callable says.
#[derive(Debug, Clone)]
pub(super) enum What {
    /// The actuator forces (nv).
    Controller,
    /// An input of an element, SI.
    Input { element: usize, input: usize, name: String },
}

impl Callback {
    /// When the next sample is due, s: k/(1/period) where 1/period is whole, as rows are timed.
    pub(super) fn next(&self) -> f64 {
        let (k, per_second) = (self.count as f64, self.period.recip().round());
        if (per_second * self.period - 1.0).abs() < 1e-14 { k / per_second } else { k * self.period }
    }

    fn is_due(&self, t: f64) -> bool {
        self.next() <= t * (1.0 + ONE_TIME)
    }
}

/// An input by the names of its element and its own: their indices, and its unit.
pub(super) fn find_input(simulation: &Simulation, element: &str, input: &str) -> PyResult<(usize, usize, String)> {
    let elements = &simulation.system().elements;
    let Some(e) = elements.iter().position(|own| own.name == element) else {
        let help = suggest(element, elements.iter().map(|own| own.name.as_str()).collect::<Vec<_>>());
        return Err(value_error(format!("no element is called \"{element}\"; {help}")));
    };
    let inputs = &elements[e].entry.inputs;
    let Some(i) = inputs.iter().position(|own| own.name == input) else {
        let help = suggest(input, inputs.iter().map(|own| &*own.name).collect::<Vec<_>>());
        return Err(value_error(format!("element \"{element}\" has no input \"{input}\"; {help}")));
    };
    Ok((e, i, inputs[i].unit.to_string()))
}

impl Inner {
    /// When the next callable is asked, s.
    pub(super) fn next_sample(&self) -> f64 {
        self.callbacks.iter().map(Callback::next).fold(f64::INFINITY, f64::min)
    }

    /// Asks all callables that are due. All of one instant see what was before any of them acts; nothing is changed where one raises.
    pub(super) fn take_samples(&mut self, py: Python<'_>) -> PyResult<()> {
        let t = self.simulation.t();
        if self.callbacks.is_empty() || self.next_sample() > t * (1.0 + ONE_TIME) {
            return Ok(());
        }
        let (mut inputs, mut has_torque) = (Vec::new(), false);
        let mut torque = std::mem::take(&mut self.control);
        let before = torque.clone();
        let asked = self.callbacks.iter().filter(|callback| callback.is_due(t)).try_for_each(|callback| {
            let (q, v) = (self.simulation.q(), self.simulation.v());
            let state = (t, PyArray1::from_slice(py, q), PyArray1::from_slice(py, v));
            let said = callback.function.bind(py).call1(state)?;
            match &callback.what {
                What::Controller => {
                    has_torque = true;
                    read_torque(py, &said, t, &mut torque)
                }
                What::Input { element, input, name } => {
                    let value: f64 = said.extract()?;
                    if !value.is_finite() {
                        return Err(run_error_at(py, format!("t = {t} s: {name} became {value}"), Some(t)));
                    }
                    inputs.push((*element, *input, value));
                    Ok(())
                }
            }
        });
        self.control = if asked.is_ok() { torque } else { before };
        asked?;
        if has_torque {
            self.apply_torques(py)?;
        }
        for (element, input, value) in inputs {
            let set = self.simulation.set_input(element, input, Some(value));
            set.map_err(|error| super::failed(py, &error))?;
        }
        for callback in self.callbacks.iter_mut().filter(|callback| callback.is_due(t)) {
            callback.count += 1;
        }
        Ok(())
    }

    /// Holds the sum of the caller's and the controller's torques.
    pub(super) fn apply_torques(&mut self, py: Python<'_>) -> PyResult<()> {
        for &k in &self.driven {
            let torque = self.own[k] + self.control[k];
            self.simulation.set_torque(k, torque).map_err(|error| super::failed(py, &error))?;
        }
        Ok(())
    }
}

/// What a controller says: nv numbers, or one where nv is 1.
fn read_torque(py: Python<'_>, said: &Bound<'_, PyAny>, t: f64, torque: &mut [f64]) -> PyResult<()> {
    let array = numbers(said, "the controller's tau")?;
    match (array.shape(), &mut *torque) {
        ([], [only]) => *only = said.extract()?,
        ([n], torque) if *n == torque.len() => Rows::new(&array, "tau", *n)?.read(0, torque),
        (shape, torque) => {
            let (shape, n) = (crate::array::written(shape), torque.len());
            return Err(value_error(format!("the controller's tau has shape {shape}; it must have shape ({n},)")));
        }
    }
    match torque.iter().find(|torque| !torque.is_finite()) {
        None => Ok(()),
        Some(bad) => Err(run_error_at(py, format!("t = {t} s: the controller's tau holds {bad}"), Some(t))),
    }
}
