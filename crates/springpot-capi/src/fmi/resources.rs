//! What an FMU knows: the scenario, what is set in it, its files, and its variables.

use super::guid;
use super::variables::Variable;
use springpot::law::Catalog;
use springpot_scenario::{Plan, Scenario};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The files of a folder of resources.
pub(super) const SCENARIO: &str = "scenario.toml";
pub(super) const SET: &str = "set.json";
pub(super) const VARIABLES: &str = "variables.json";
pub(super) const FILES: &str = "files";

/// A scenario as an FMU holds it.
#[derive(Debug, Clone)]
pub struct Resources {
    scenario: Scenario,
    catalog: Catalog,
    variables: Vec<Variable>,
    guid: String,
}

impl Resources {
    /// Reads a folder of resources, whose elements have laws of `catalog`.
    ///
    /// # Errors
    /// In words, where a file cannot be read or is none of an FMU of this version.
    pub fn read(folder: &Path, catalog: &Catalog) -> Result<Self, String> {
        let files = gather(folder).map_err(|error| format!("{} cannot be read: {error}", folder.display()))?;
        let text = |name: &str| {
            let found = files.iter().find(|(file, _)| file == name);
            let (_, bytes) = found.ok_or_else(|| format!("{name} is missing among the resources"))?;
            String::from_utf8(bytes.clone()).map_err(|_| format!("{name} is not UTF-8"))
        };
        let unread = |name: &str, error: serde_json::Error| format!("{name} is none of this version: {error}");
        let mut scenario = Scenario::parse(&text(SCENARIO)?, SCENARIO, folder).map_err(|error| error.to_string())?;
        let set: Vec<String> = serde_json::from_str(&text(SET)?).map_err(|error| unread(SET, error))?;
        for assignment in &set {
            scenario.set(assignment).map_err(|error| error.to_string())?;
        }
        let variables = serde_json::from_str(&text(VARIABLES)?).map_err(|error| unread(VARIABLES, error))?;
        let guid = guid::of(files.iter().map(|(name, bytes)| (name.as_str(), &bytes[..])));
        Ok(Self { scenario, catalog: catalog.clone(), variables, guid })
    }

    /// The variables, by value reference.
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// The identity of all of it.
    pub fn guid(&self) -> &str {
        &self.guid
    }

    /// The scenario with other numbers at these paths, to be simulated up to `end`, s, where that is not its own.
    ///
    /// # Errors
    /// In words, where the scenario does not take a number.
    pub fn plan(&self, changes: &[(&str, f64)], end: Option<f64>) -> Result<Plan, String> {
        plan(&self.scenario, &self.catalog, changes, end)
    }
}

/// The only case of a scenario under changes.
pub(super) fn plan(
    scenario: &Scenario,
    catalog: &Catalog,
    changes: &[(&str, f64)],
    end: Option<f64>,
) -> Result<Plan, String> {
    let mut scenario = scenario.clone();
    for (path, value) in changes {
        scenario.set_anew(&format!("{path}={value:?}")).map_err(|error| error.to_string())?;
    }
    let read = scenario.cases(catalog).and_then(|cases| cases.plan(0));
    let mut plan = read.map_err(|error| error.to_string())?;
    plan.sensitivity = None;
    if let Some(end) = end {
        plan.settings.end = end;
    }
    Ok(plan)
}

/// The files of a folder and of the files beside it, by name.
fn gather(folder: &Path) -> io::Result<Vec<(String, Vec<u8>)>> {
    let mut files = Vec::new();
    for name in [SCENARIO, SET, VARIABLES] {
        let path = folder.join(name);
        if path.is_file() {
            files.push((name.to_owned(), fs::read(path)?));
        }
    }
    let beside = folder.join(FILES);
    if beside.is_dir() {
        let mut paths: Vec<PathBuf> =
            fs::read_dir(beside)?.map(|entry| Ok(entry?.path())).collect::<io::Result<_>>()?;
        paths.sort();
        for path in paths.into_iter().filter(|path| path.is_file()) {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            files.push((format!("{FILES}/{name}"), fs::read(&path)?));
        }
    }
    Ok(files)
}
