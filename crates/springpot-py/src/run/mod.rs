//! Runs of scenarios: a study that knows its cases, cases that were run, and results written as the command writes them, with their pages.

mod case;
mod design;
mod pages;
mod source;
mod stored;
mod study;

use pyo3::prelude::*;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<case::Case>()?;
    module.add_class::<case::Column>()?;
    module.add_class::<stored::Stored>()?;
    module.add_class::<study::Study>()?;
    module.add_function(wrap_pyfunction!(design::designed, module)?)?;
    pages::register(module)
}
