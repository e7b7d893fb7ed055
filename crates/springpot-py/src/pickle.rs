//! Objects as bytes that are sealed, and back: for pickles, files and other processes.

use crate::error::value_error;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde::Serialize;
use serde::de::DeserializeOwned;
use springpot_run::{open, seal};

/// What `__reduce__` gives: who makes the object again, and of what.
pub(crate) type Reduced<'py> = (Bound<'py, PyAny>, (Bound<'py, PyBytes>,));

/// The bytes of a value behind the line `tag`.
pub(crate) fn to_bytes<'py>(py: Python<'py>, tag: &str, value: &impl Serialize) -> PyResult<Bound<'py, PyBytes>> {
    Ok(PyBytes::new(py, &seal(tag, value)?))
}

/// The value of such bytes; `what` is what they should be.
///
/// # Errors
/// `ValueError` where they are damaged, or of another kind or version.
pub(crate) fn of_bytes<T: DeserializeOwned>(tag: &str, what: &str, bytes: &[u8]) -> PyResult<T> {
    open(tag, bytes).map_err(|error| value_error(format!("the bytes are no {what}: {error}")))
}

/// An object that the static method `maker` of its class makes of these bytes.
pub(crate) fn reduced<'py, C: pyo3::PyTypeInfo>(
    py: Python<'py>,
    maker: &str,
    bytes: Bound<'py, PyBytes>,
) -> PyResult<Reduced<'py>> {
    Ok((py.get_type::<C>().getattr(maker)?, (bytes,)))
}
