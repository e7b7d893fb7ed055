//! Who takes the rows of a run.

use super::state::Checkpoint;
use crate::observe::Table;
use crate::system::sensitivity::Lost;

/// Takes the rows of a run.
pub trait Rows {
    /// One complete row, in the order of [`crate::system::System::columns`]; NaN stands for an empty field.
    ///
    /// # Errors
    /// Whatever keeps the row from being kept; the run stops.
    fn row(&mut self, values: &[f64]) -> std::io::Result<()>;

    /// One complete row at the time of an event of [`crate::system::System::events`], by its number there, before what the event sets holds. Its
    /// derivatives are along the event, whose time moves: `later` has those of the time, by each parameter of [`crate::system::System::sensitivity`].
    ///
    /// # Errors
    /// As [`Self::row`].
    fn event(&mut self, _event: usize, _values: &[f64], _later: &[f64]) -> std::io::Result<()> {
        Ok(())
    }

    /// Before the first row, how often the signals of the run will switch ([`super::Report::switches`]).
    fn looked_ahead(&mut self, _switches: u64) {}

    /// The derivatives by a parameter end here: those of later rows mean nothing.
    fn lost(&mut self, _lost: Lost) {}

    /// Whether [`Self::checkpoint`] is to be called now, at time `t` between two steps; `last` where the run stops here because it
    /// was interrupted. Asking changes nothing about the steps.
    fn wants_checkpoint(&mut self, _t: f64, _last: bool) -> bool {
        false
    }

    /// The state from which [`super::resume`] goes on; all rows that belong to it were handed over.
    ///
    /// # Errors
    /// Whatever keeps it from being kept; the run stops.
    fn checkpoint(&mut self, _state: Checkpoint) -> std::io::Result<()> {
        Ok(())
    }
}

impl<F: FnMut(&[f64]) -> std::io::Result<()>> Rows for F {
    fn row(&mut self, values: &[f64]) -> std::io::Result<()> {
        self(values)
    }
}

/// Keeps every row.
impl Rows for Table {
    fn row(&mut self, values: &[f64]) -> std::io::Result<()> {
        self.push(values);
        Ok(())
    }
}
