//! What a run goes on in spite of.

use springpot_scenario::Cases;
use std::fmt;

/// Something that a run goes on in spite of.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Warning {
    /// What it is.
    pub message: String,
    /// What to do about it, where that is known.
    pub help: Option<String>,
}

/// Takes warnings as they come.
pub type Warn<'a> = &'a mut dyn FnMut(Warning);

impl From<String> for Warning {
    fn from(message: String) -> Self {
        Self { message, help: None }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

/// What the robot's files hold that is not used, or lack and is assumed; the last one says how to accept all of them.
pub fn robot_warnings(cases: &Cases) -> Vec<Warning> {
    let with_cure = |message: String| Warning { help: missing_package(&message), message };
    let mut warnings: Vec<Warning> = cases.warnings().into_iter().map(with_cure).collect();
    if let Some(last) = warnings.last_mut() {
        let accept = format!("once they are read: accept = {:?} in [robot]", cases.warning_kinds());
        last.help = Some(last.help.take().map_or(accept.clone(), |cure| format!("{cure}; {accept}")));
    }
    warnings
}

/// What finds the meshes of a robot that is away from its package.
fn missing_package(message: &str) -> Option<String> {
    let (_, found) = message.split_once("mesh files not found")?;
    let name = found.split_once("package://")?.1.split(['/', '"']).next().filter(|name| !name.is_empty())?;
    Some(format!("package_path = \"FOLDER\" in [robot], the folder {name} or the one that holds it, finds them"))
}
