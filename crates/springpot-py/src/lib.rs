//! The Python module `springpot._springpot`: the engine on NumPy arrays.
//!
//! What users see stands in `python/springpot`; signatures with shapes and units in `python/springpot/_springpot.pyi`.

mod array;
mod bank;
mod command;
mod error;
mod fit;
mod fractional;
mod interrupt;
mod law;
mod linear;
mod model;
mod notebook;
mod pickle;
mod quantity;
mod run;
mod scenario;
mod simulation;
mod tools;

use pyo3::prelude::*;

/// One line for each module.
#[pymodule]
fn _springpot(module: &Bound<'_, PyModule>) -> PyResult<()> {
    bank::register(module)?;
    command::register(module)?;
    fit::register(module)?;
    fractional::register(module)?;
    law::register(module)?;
    linear::register(module)?;
    model::register(module)?;
    quantity::register(module)?;
    run::register(module)?;
    simulation::register(module)?;
    tools::register(module)?;
    Ok(())
}
