//! Scenarios from a path, a text or a dict.

use crate::error::{missing_scenario, scenario_error};
use pyo3::prelude::*;
use springpot::law::Catalog;
use springpot_run::Asked;
use std::path::PathBuf;
use std::sync::LazyLock;

/// The laws that scenarios may name.
pub(crate) static CATALOG: LazyLock<Catalog> = LazyLock::new(Catalog::standard);

/// What `springpot._scenario.described` makes of a scenario and its overrides.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Described {
    /// Where it is to be read, unless `text` is given.
    path: PathBuf,
    text: Option<String>,
    /// `PATH=VALUE`.
    assignments: Vec<String>,
}

/// The scenario with the values of `set`, a dict of dotted paths; a text or a dict names files from the current folder.
///
/// # Errors
/// `ScenarioError`, and `TypeError` for what is no scenario.
pub(crate) fn asked(scenario: &Bound<'_, PyAny>, set: Option<&Bound<'_, PyAny>>) -> PyResult<Asked> {
    let py = scenario.py();
    let described = py.import("springpot._scenario")?.getattr("described")?.call1((scenario, set))?;
    let Described { path, text, assignments } = described.extract()?;
    let asked = match text {
        Some(text) => Asked::text(text, path.display().to_string(), std::env::current_dir()?),
        None => Asked::read(&path).map_err(|refusals| match path.try_exists() {
            Ok(false) => missing_scenario(py, &refusals, &path),
            _ => scenario_error(py, &refusals),
        })?,
    };
    Ok(Asked { overrides: assignments, ..asked })
}
