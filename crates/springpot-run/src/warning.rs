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
    let mut warnings: Vec<Warning> = cases.warnings().into_iter().map(Warning::from).collect();
    if let Some(last) = warnings.last_mut() {
        last.help = Some(format!("once they are read: accept = {:?} in [robot]", cases.warning_kinds()));
    }
    warnings
}
