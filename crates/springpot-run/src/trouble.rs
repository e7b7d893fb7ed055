//! Why a case has no complete run, for those who read it.

use serde::{Deserialize, Serialize};
use springpot::system::RunError;
use springpot_scenario::{Cure, Place, Plan};

/// Why a case has no complete run, where the cause stands, and what can be done.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Trouble {
    /// Why.
    pub message: String,
    /// File, line and column of the cause, where it is known.
    pub place: Option<String>,
    /// What can be done, where the message does not say it.
    pub help: Option<String>,
    /// When it happened, s; `None` where no time is to blame.
    pub t: Option<f64>,
    /// Where the cause stands in what was read; not known of runs that others made.
    #[serde(skip)]
    pub at: Option<Place>,
}

impl Trouble {
    /// What an error means for the scenario that was planned.
    pub fn of(error: &RunError, plan: &Plan) -> Self {
        let Cure { place, help } = plan.cure(error);
        let written = place.as_ref().map(|place| {
            let (line, column) = place.position();
            format!("{}:{line}:{column}", place.source.name)
        });
        Self { message: error.to_string(), place: written, help, t: error.time(), at: place }
    }
}
