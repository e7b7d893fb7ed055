//! `springpot.fractional`: derivatives of samples, Mittag-Leffler functions.

use crate::array::{Rows, flat, numbers, written};
use crate::error::{guarded, value_error};
use crate::interrupt::left_behind;

use numpy::{Complex64, PyArray1, PyArrayMethods, PyReadonlyArray1, PyUntypedArrayMethods};
use pyo3::prelude::*;
use springpot::fractional::mittag_leffler::MittagLeffler;
use springpot::fractional::scheme::Samples;
use springpot::fractional::{Definition, Method, derivative, derivative_with_error};
use springpot::system::Stop;
use std::sync::atomic::Ordering;

/// So many samples take longer than a thread of their own does to start.
const WORTH_A_THREAD: usize = 4096;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(differentiate, module)?)?;
    module.add_function(wrap_pyfunction!(mittag_leffler_real, module)?)?;
    module.add_function(wrap_pyfunction!(mittag_leffler_complex, module)?)
}

/// D^order of the columns of `x` (one where it has one dimension), and estimates of the errors where they are wanted; in C order.
#[pyfunction]
#[pyo3(signature = (t, x, order, definition, method, rates, with_error))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
fn differentiate<'py>(
    py: Python<'py>,
    t: &Bound<'py, PyAny>,
    x: &Bound<'py, PyAny>,
    order: f64,
    definition: &str,
    method: &str,
    rates: Option<&Bound<'py, PyAny>>,
    with_error: bool,
) -> PyResult<(Bound<'py, PyAny>, Option<Bound<'py, PyAny>>)> {
    guarded(py, || {
        let definition: Definition = definition.parse().map_err(value_error)?;
        let method: Method = method.parse().map_err(value_error)?;
        let times = numbers(t, "t")?;
        let [rows] = *times.shape() else {
            return Err(value_error(format!("t has shape {}; it must have shape (N,)", written(times.shape()))));
        };
        let times = flat(&times)?;
        let x = columns(x, "x", rows)?;
        let rates = rates.map(|rates| columns(rates, "rates", rows)).transpose()?;
        if rates.as_ref().is_some_and(|rates| rates.columns.len() != x.columns.len() || rates.is_flat != x.is_flat) {
            return Err(value_error("rates must have the shape of x"));
        }
        let first = times.first().copied().unwrap_or(0.0);
        let times: Vec<f64> = times.iter().map(|t| t - first).collect();
        let (is_flat, wanted) = (x.is_flat, x.columns.len() * rows);
        let work = move |stop: &Stop| {
            let each = x.columns.iter().enumerate().take_while(|_| !stop.load(Ordering::Relaxed)).map(|(k, x)| {
                let rate = rates.as_ref().map(|rates| rates.columns[k].as_slice());
                let samples = Samples { t: &times, x, rate };
                if with_error {
                    let found = derivative_with_error(&samples, order, definition, method)?;
                    return Ok((found.values, found.error));
                }
                Ok((derivative(&samples, order, definition, method)?, Vec::new()))
            });
            each.collect::<Result<Vec<_>, springpot::fractional::DerivativeError>>()
        };
        let found =
            if wanted < WORTH_A_THREAD { py.detach(|| work(&Stop::new(false))) } else { left_behind(py, work)? };
        let found = found.map_err(value_error)?;
        let (values, errors): (Vec<_>, Vec<_>) = found.into_iter().unzip();
        let values = shaped(py, &values, rows, is_flat)?;
        let errors = if with_error { Some(shaped(py, &errors, rows, is_flat)?) } else { None };
        Ok((values, errors))
    })
}

/// Columns of samples.
struct Columns {
    columns: Vec<Vec<f64>>,
    /// Whether they came as one dimension.
    is_flat: bool,
}

fn columns(value: &Bound<'_, PyAny>, name: &str, rows: usize) -> PyResult<Columns> {
    let array = numbers(value, name)?;
    match *array.shape() {
        [found] if found == rows => Ok(Columns { columns: vec![flat(&array)?], is_flat: true }),
        [found, count] if found == rows => {
            let all = Rows::new(&array, name, count)?;
            let (mut columns, mut row) = (vec![Vec::with_capacity(rows); count], vec![0.0; count]);
            for k in 0..rows {
                all.read(k, &mut row);
                columns.iter_mut().zip(&row).for_each(|(column, value)| column.push(*value));
            }
            Ok(Columns { columns, is_flat: false })
        }
        _ => {
            let shape = written(array.shape());
            Err(value_error(format!(
                "{name} has shape {shape}; with {rows} times it must have shape ({rows},) or ({rows}, K)"
            )))
        }
    }
}

/// Results of every column in the shape that they came in.
fn shaped<'py>(py: Python<'py>, columns: &[Vec<f64>], rows: usize, is_flat: bool) -> PyResult<Bound<'py, PyAny>> {
    if is_flat {
        return Ok(PyArray1::from_slice(py, &columns[0]).into_any());
    }
    let all = (0..rows).flat_map(|row| columns.iter().map(move |column| column[row]));
    Ok(PyArray1::from_vec(py, all.collect()).reshape([rows, columns.len()])?.into_any())
}

/// dⁿE_{a,b}/dzⁿ of real arguments.
#[pyfunction]
fn mittag_leffler_real<'py>(
    py: Python<'py>,
    z: PyReadonlyArray1<'py, f64>,
    a: f64,
    b: f64,
    n: usize,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    guarded(py, || {
        let function = MittagLeffler::derivative(a, b, n).map_err(value_error)?;
        let z = z.as_slice()?.to_vec();
        let mut values = vec![0.0; z.len()];
        py.detach(|| function.real_into(&z, &mut values));
        Ok(PyArray1::from_vec(py, values))
    })
}

/// The same of complex arguments.
#[pyfunction]
fn mittag_leffler_complex<'py>(
    py: Python<'py>,
    z: PyReadonlyArray1<'py, Complex64>,
    a: f64,
    b: f64,
    n: usize,
) -> PyResult<Bound<'py, PyArray1<Complex64>>> {
    guarded(py, || {
        let function = MittagLeffler::derivative(a, b, n).map_err(value_error)?;
        let z = z.as_slice()?.to_vec();
        let mut values = vec![Complex64::new(0.0, 0.0); z.len()];
        py.detach(|| function.complex_into(&z, &mut values));
        Ok(PyArray1::from_vec(py, values))
    })
}
