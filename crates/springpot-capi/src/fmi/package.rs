//! An FMU as files: from a scenario to the bytes of the archive.

use super::description::{self, Head};
use super::instance::Instance;
use super::library::{LIBRARY, PLATFORM};
use super::resources::{self, FILES, Resources, SCENARIO, SET, VARIABLES};
use super::variables::{self, Variable};
use super::{guid, zip};
use springpot::Simulation;
use springpot::law::{Catalog, Entry};
use springpot::system::{Action, RowTimes, RunError};
use springpot_scenario::{Plan, Portable, Refusals, Scenario};
use std::fs;
use std::path::Path;
use std::sync::Arc;

/// Why there is no FMU.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PackageError {
    /// The scenario itself is refused.
    #[error(transparent)]
    Scenario(#[from] Refusals),
    /// It has several cases.
    #[error(
        "the scenario has {cases} cases, and an FMU is one: take its [[sweep]] out, and write the value with --set"
    )]
    Cases {
        /// How many.
        cases: usize,
    },
    /// It has an element with a named scheme.
    #[error("element {element:?} has a named scheme, which needs the whole motion in advance: leave its `scheme` out")]
    Scheme {
        /// Its name.
        element: String,
    },
    /// It cannot start.
    #[error("the scenario cannot start: {0}")]
    Start(#[from] RunError),
    /// Two variables have one name.
    #[error("two variables are called {name}: rename a joint or an element")]
    Name {
        /// The name.
        name: String,
    },
    /// There is no name for this platform.
    #[error("FMUs have no name for this platform")]
    Platform,
    /// A file cannot be read.
    #[error("{file} cannot be read: {error}")]
    File {
        /// The file.
        file: String,
        /// What the system says.
        error: std::io::Error,
    },
    /// It does not stand in another folder as it does in its own.
    #[error("the scenario is another one beside the files that it names: {0}")]
    Moved(String),
    /// The archive is too large.
    #[error("{0}")]
    Archive(String),
}

/// An FMU of a scenario, but for the library.
#[derive(Debug, Clone)]
pub struct Package {
    identifier: String,
    description: String,
    /// By name, in the folder of resources.
    resources: Vec<(String, Vec<u8>)>,
    variables: Vec<Variable>,
    guid: String,
    events: Vec<String>,
    catalog: Catalog,
    own_laws: Vec<String>,
}

impl Package {
    /// The FMU of a scenario with what is set in it, whose file is called `name` and whose elements have laws of `catalog`.
    ///
    /// # Errors
    /// [`PackageError`]: several cases, named schemes, what keeps a run from starting, files that cannot be read.
    pub fn new(scenario: &Scenario, name: &str, catalog: &Catalog) -> Result<Self, PackageError> {
        let cases = scenario.cases(catalog)?;
        if cases.len() > 1 {
            return Err(PackageError::Cases { cases: cases.len() });
        }
        // An FMU tells no derivatives.
        let plan = Plan { sensitivity: None, ..cases.plan(0)? };
        if let Some(planned) = plan.elements.iter().find(|planned| planned.element.scheme.is_some()) {
            return Err(PackageError::Scheme { element: planned.element.name.clone() });
        }
        let recorded = plan.events.iter().filter(|event| event.event.action == Action::Record);
        let events = recorded.map(|event| event.event.name.clone()).collect();
        let variables = variables_of(scenario, catalog, &plan)?;
        let own_laws = own_laws(catalog, &plan);
        let Portable { text, set, files } = scenario.portable();
        let mut resources = vec![
            (SCENARIO.to_owned(), text.into_bytes()),
            (SET.to_owned(), json(&set)),
            (VARIABLES.to_owned(), json(&variables)),
        ];
        for (name, file) in files {
            let bytes = fs::read(&file);
            let bytes = bytes.map_err(|error| PackageError::File { file: file.display().to_string(), error })?;
            resources.push((name, bytes));
        }
        let guid = guid::of(resources.iter().map(|(name, bytes)| (name.as_str(), &bytes[..])));
        let identifier = identifier(name);
        let head = Head {
            title: plan.title.as_deref().filter(|title| !title.trim().is_empty()).unwrap_or(name),
            identifier: &identifier,
            guid: &guid,
            end: plan.settings.end,
            step: match plan.settings.rows {
                RowTimes::Step { step, .. } => Some(step),
                RowTimes::Times(_) => None,
            },
            tolerance: plan.settings.fixed_step.is_none().then_some(plan.settings.rtol),
        };
        let description = description::xml(&head, &variables);
        let catalog = catalog.clone();
        Ok(Self { identifier, description, resources, variables, guid, events, catalog, own_laws })
    }

    /// modelDescription.xml.
    pub fn description(&self) -> &str {
        &self.description
    }

    /// The variables, by value reference.
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// Events of the scenario that are only recorded, and not by an FMU.
    pub fn silent_events(&self) -> &[String] {
        &self.events
    }

    /// Laws of its elements that do not come with Springpot: only a library that was handed them runs the FMU.
    pub fn own_laws(&self) -> &[String] {
        &self.own_laws
    }

    /// The identity of the FMU.
    pub fn guid(&self) -> &str {
        &self.guid
    }

    /// Writes the folder of resources, as it is where an FMU is unpacked.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn write_resources(&self, folder: &Path) -> std::io::Result<()> {
        fs::create_dir_all(folder.join(FILES))?;
        self.resources.iter().try_for_each(|(name, bytes)| fs::write(folder.join(name), bytes))
    }

    /// Whether the scenario is the same in an empty folder, where its resources are written, as in its own.
    ///
    /// # Errors
    /// [`PackageError::Moved`].
    pub fn verify(&self, folder: &Path) -> Result<(), PackageError> {
        self.write_resources(folder).map_err(|error| PackageError::Moved(error.to_string()))?;
        let resources = Resources::read(folder, &self.catalog).map_err(PackageError::Moved)?;
        if resources.guid() != self.guid {
            return Err(PackageError::Moved("its files are not those that were written".to_owned()));
        }
        let mut instance = Instance::new(resources.into());
        let started = instance.enter_initialization().and_then(|()| instance.exit_initialization());
        started.map_err(|fault| PackageError::Moved(fault.to_string()))
    }

    /// The archive, with the library of this platform.
    ///
    /// # Errors
    /// [`PackageError::Platform`], [`PackageError::Archive`].
    pub fn archive(&self, library: Vec<u8>) -> Result<Vec<u8>, PackageError> {
        let platform = PLATFORM.ok_or(PackageError::Platform)?;
        let ending = LIBRARY.rsplit_once('.').map_or("", |(_, ending)| ending);
        let described = ("modelDescription.xml".to_owned(), self.description.clone().into_bytes());
        let library = (format!("binaries/{platform}/{}.{ending}", self.identifier), library);
        let resources = self.resources.iter().map(|(name, bytes)| (format!("resources/{name}"), bytes.clone()));
        let files: Vec<_> = [described, library].into_iter().chain(resources).collect();
        zip::archive(&files).map_err(PackageError::Archive)
    }
}

fn json(value: &impl serde::Serialize) -> Vec<u8> {
    serde_json::to_vec_pretty(value).expect("texts and finite numbers")
}

/// Names of the laws of a plan that are not those of this name that come with Springpot.
fn own_laws(catalog: &Catalog, plan: &Plan) -> Vec<String> {
    let standard = Catalog::standard();
    let is_own = |law: &&Arc<Entry>| standard.get(&law.name).is_none_or(|other| other.equation != law.equation);
    let elements = plan.all_elements();
    let is_asked = |law: &&Arc<Entry>| {
        elements.iter().any(|planned| !planned.is_network && planned.element.entry.name == law.name)
    };
    catalog.entries().iter().filter(is_own).filter(is_asked).map(|law| law.name.to_string()).collect()
}

fn variables_of(scenario: &Scenario, catalog: &Catalog, plan: &Plan) -> Result<Vec<Variable>, PackageError> {
    let mut simulation = Simulation::new(plan.system(), plan.settings.clone())?;
    let inputs = variables::inputs(plan, &mut simulation);
    let mut all = variables::outputs(simulation.system(), &inputs);
    let candidates = variables::candidates(plan, simulation.system());
    // What the scenario takes as it stands there, and nothing else.
    let is_taken = |candidate: &variables::Candidate| {
        let Some((path, start)) = candidate.variable.place() else { return false };
        let changed = resources::plan(scenario, catalog, &[(path, start)], None);
        changed.is_ok_and(|plan| (candidate.read)(&plan) == Some(start))
    };
    let parameters = candidates.into_iter().filter(is_taken).map(|candidate| candidate.variable);
    all.splice(0..0, inputs.into_iter().chain(parameters));
    let mut names: Vec<&str> = all.iter().map(|variable| variable.name.as_str()).collect();
    names.sort_unstable();
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(PackageError::Name { name: pair[0].to_owned() }),
        None => Ok(all),
    }
}

/// A name of C that a file's name makes.
fn identifier(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let name: String = name.chars().map(plain).collect();
    let starts = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    if starts { name } else { format!("fmu_{name}") }
}
