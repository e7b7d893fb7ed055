//! Numbers with units: a float is SI, a text has its unit.

use crate::error::{type_error, value_error};
use pyo3::prelude::*;
use pyo3::types::PyString;
use springpot_scenario::units::{Exponents, Unit, parse_quantity};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(parse_unit, module)?)?;
    module.add_function(wrap_pyfunction!(parse, module)?)
}

/// A finite number, or a text such as "25 degC" of the dimension of `unit` (empty: a pure number), in SI; `name` is what messages call it.
pub(crate) fn number(value: &Bound<'_, PyAny>, unit: &str, name: &str) -> PyResult<f64> {
    number_with(value, unit, name, &|_| None)
}

/// [`number`] of a unit whose exponents may have names.
pub(crate) fn number_with(value: &Bound<'_, PyAny>, unit: &str, name: &str, exponents: Exponents<'_>) -> PyResult<f64> {
    if let Ok(text) = value.cast::<PyString>() {
        let text = text.to_cow()?;
        return parse_quantity(&text, unit, exponents).map_err(|error| value_error(format!("{name}: {error}")));
    }
    let found: f64 = value.extract().map_err(|_| {
        let kind = value.get_type().name().map_or_else(|_| "that".to_owned(), |name| name.to_string());
        type_error(format!("{name} must be a number or a text with a unit, not {kind}"))
    })?;
    if found.is_finite() { Ok(found) } else { Err(value_error(format!("{name} is {found}; it must be finite"))) }
}

/// The SI value of a quantity of the dimension of `expected`.
#[pyfunction]
fn parse(text: &Bound<'_, PyAny>, expected: &str) -> PyResult<f64> {
    number(text, expected, "the quantity")
}

/// Factor and shift of a unit, SI = factor·number + shift, and its exponents of kg, m, s, A, K and mol.
#[pyfunction]
fn parse_unit(text: &str) -> PyResult<(f64, f64, [f64; 6])> {
    let unit = Unit::parse(text, &|_| None).map_err(value_error)?;
    Ok((unit.scale(), unit.shift(), unit.dimension().exponents()))
}
