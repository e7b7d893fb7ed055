//! Errors of the engine as the exceptions of `springpot._errors`.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple};
use springpot::model::description::DescriptionError;
use springpot::system::RunError;
use springpot_run::Trouble;
use springpot_scenario::Refusals;
use std::any::Any;
use std::fmt::Display;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

static EXCEPTIONS: PyOnceLock<Py<PyModule>> = PyOnceLock::new();

/// An exception of the package, built with these keyword arguments.
fn raise(py: Python<'_>, class: &str, message: &str, words: &Bound<'_, PyDict>) -> PyErr {
    let build = || {
        let module = EXCEPTIONS.get_or_try_init(py, || py.import("springpot._errors").map(Bound::unbind))?;
        module.bind(py).getattr(class)?.call((message,), Some(words))
    };
    build().map_or_else(|error| error, PyErr::from_value)
}

/// `ValueError`: a value of the right type that cannot be.
pub(crate) fn value_error(message: impl Display) -> PyErr {
    PyValueError::new_err(message.to_string())
}

/// `TypeError`.
pub(crate) fn type_error(message: impl Display) -> PyErr {
    PyTypeError::new_err(message.to_string())
}

/// `SpringpotError`.
pub(crate) fn springpot_error(py: Python<'_>, message: impl Display) -> PyErr {
    raise(py, "SpringpotError", &message.to_string(), &PyDict::new(py))
}

/// `ModelError`.
pub(crate) fn model_error(py: Python<'_>, message: impl Display) -> PyErr {
    raise(py, "ModelError", &message.to_string(), &PyDict::new(py))
}

/// `ModelError` of a URDF file.
pub(crate) fn description_error(py: Python<'_>, error: &DescriptionError) -> PyErr {
    model_error(py, error)
}

/// `RunError` with its time where it has one.
pub(crate) fn run_error(py: Python<'_>, error: &RunError) -> PyErr {
    run_error_at(py, error, error.time())
}

/// `RunError` with this time.
pub(crate) fn run_error_at(py: Python<'_>, message: impl Display, t: Option<f64>) -> PyErr {
    let words = PyDict::new(py);
    match words.set_item("t", t) {
        Ok(()) => raise(py, "RunError", &message.to_string(), &words),
        Err(error) => error,
    }
}

/// `RunError` of a case: why, where the cause stands, and what can be done.
pub(crate) fn case_error(py: Python<'_>, trouble: &Trouble) -> PyErr {
    let more = [&trouble.place, &trouble.help].into_iter().flatten().map(|words| format!("\n  {words}"));
    run_error_at(py, format!("{}{}", trouble.message, more.collect::<String>()), trouble.t)
}

/// `ModelError` of a file that is not there, which is a `FileNotFoundError` too.
pub(crate) fn missing_model(py: Python<'_>, error: &DescriptionError, path: &Path) -> PyErr {
    let words = PyDict::new(py);
    match words.set_item("filename", path.as_os_str()) {
        Ok(()) => raise(py, "MissingModelError", &error.to_string(), &words),
        Err(error) => error,
    }
}

/// `ScenarioError` with the place of the first refusal, and all of them as its `refusals`.
pub(crate) fn scenario_error(py: Python<'_>, refusals: &Refusals) -> PyErr {
    refused(py, refusals, "ScenarioError", None)
}

/// `ScenarioError` of a file that is not there, which is a `FileNotFoundError` too.
pub(crate) fn missing_scenario(py: Python<'_>, refusals: &Refusals, path: &Path) -> PyErr {
    refused(py, refusals, "MissingScenarioError", Some(path))
}

fn refused(py: Python<'_>, refusals: &Refusals, class: &str, missing: Option<&Path>) -> PyErr {
    let words = PyDict::new(py);
    let fill = || -> PyResult<()> {
        if let Some(first) = refusals.first() {
            words.set_item("path", &first.file)?;
            words.set_item("line", first.line)?;
            words.set_item("column", first.column)?;
            words.set_item("help", first.help.as_deref())?;
        }
        if let Some(path) = missing {
            words.set_item("filename", path.as_os_str())?;
        }
        let all = refusals.iter().map(|refusal| {
            (&refusal.file, refusal.line, refusal.column, &refusal.message, refusal.help.as_deref()).into_pyobject(py)
        });
        words.set_item("refusals", PyTuple::new(py, all.collect::<PyResult<Vec<_>>>()?)?)
    };
    match fill() {
        Ok(()) => raise(py, class, &refusals.to_string(), &words),
        Err(error) => error,
    }
}

/// Does the work of a call; a panic becomes a `SpringpotError`, which `except Exception` catches.
pub(crate) fn guarded<T>(py: Python<'_>, work: impl FnOnce() -> PyResult<T>) -> PyResult<T> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| Err(panicked(py, panic.as_ref())))
}

fn panicked(py: Python<'_>, panic: &(dyn Any + Send)) -> PyErr {
    let said = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
    springpot_error(py, format!("a mistake of Springpot itself, please report it: {}", said.unwrap_or("unknown")))
}
