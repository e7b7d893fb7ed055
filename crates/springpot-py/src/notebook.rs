//! What notebooks show.

use pyo3::prelude::*;

/// The HTML that `springpot._html` makes of an object.
pub(crate) fn html<'py, T: pyo3::PyTypeInfo>(of: &str, object: &Bound<'py, T>) -> PyResult<Bound<'py, PyAny>> {
    object.py().import("springpot._html")?.getattr(of)?.call1((object,))
}
