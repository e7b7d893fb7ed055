//! The Python module `springpot._springpot`: the engine on NumPy arrays.
//!
//! What users see stands in `python/springpot`; signatures with shapes and units in `python/springpot/_springpot.pyi`.

mod array;
mod command;
mod error;
mod model;
mod scenario;

use pyo3::prelude::*;

/// One line for each module.
#[pymodule]
fn _springpot(module: &Bound<'_, PyModule>) -> PyResult<()> {
    command::register(module)?;
    model::register(module)?;
    Ok(())
}
