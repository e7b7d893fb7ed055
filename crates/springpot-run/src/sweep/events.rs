//! The events of a case: their rows, and how often each happened.

use crate::table::{push_fields, push_text};
use serde::{Deserialize, Serialize};
use springpot::system::{Action, System};

/// The events of a case so far. They are few, and wait in memory for the end of their case.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct CaseEvents {
    /// Their lines in events.csv.
    pub(super) lines: String,
    pub(super) happened: Happened,
}

/// How often each event happened, in the order of the scenario.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Happened {
    /// One for each event; none where nothing happened.
    pub counts: Vec<u64>,
    /// The event that ended the case.
    pub stopped_by: Option<usize>,
}

impl CaseEvents {
    /// Takes the row of an event; `lead` are the swept values, each with its comma.
    pub(super) fn take(&mut self, system: &System, lead: &str, event: usize, row: &[f64]) {
        let Happened { counts, stopped_by } = &mut self.happened;
        counts.resize(system.events.len(), 0);
        counts[event] += 1;
        if system.events[event].action == Action::Stop {
            *stopped_by = stopped_by.or(Some(event));
        }
        self.lines.push_str(lead);
        push_text(&mut self.lines, &system.events[event].name);
        push_fields(&mut self.lines, row.iter().copied());
        self.lines.push('\n');
    }
}

impl Happened {
    /// Adds those of another case.
    pub(super) fn add(&mut self, other: &Self) {
        self.counts.resize(self.counts.len().max(other.counts.len()), 0);
        self.counts.iter_mut().zip(&other.counts).for_each(|(sum, count)| *sum += count);
    }
}
