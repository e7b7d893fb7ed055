//! The command line in process.

use crate::error::guarded;
use crate::scenario::CATALOG;
use crate::tools::{find_own, own_library};
use pyo3::prelude::*;
use std::ffi::OsString;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(command_line, module)?)?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))
}

/// Runs the command `springpot` with these arguments, the program's name first; gives its exit code.
#[pyfunction]
fn command_line(py: Python<'_>, arguments: Vec<OsString>) -> PyResult<u8> {
    find_own(py)?;
    springpot_cli::offer_library(own_library);
    guarded(py, || Ok(py.detach(|| springpot_cli::exit_code_from(&CATALOG, arguments))))
}
