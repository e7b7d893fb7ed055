//! How calls end.

/// How a call ended. What was wrong is told by `springpot_last_error`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Done.
    Ok = 0,
    /// A pointer is NULL or not aligned, an array has another length than is wanted, a number is no element.
    Argument = 1,
    /// The text of the elements is refused: syntax, units, names, ranges.
    Text = 2,
    /// A call out of order: no `springpot_bank_begin` before, no `springpot_bank_evaluate` before a commit, a step that does not start where the last one ended.
    Order = 3,
    /// A number is NaN or infinite, or a step is not longer than 0.
    Number = 4,
    /// An input is missing, outside its range, or breaks a rule of its law.
    Input = 5,
    /// No memory can be built for these steps, or no force fits these strokes.
    Unsolved = 6,
    /// The bytes are no state of a bank of the same elements.
    State = 7,
    /// A defect of the library; the bank is as it was or has to be begun anew.
    Defect = 8,
}

/// What was wrong.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct Problem {
    /// Of which kind it is.
    pub status: Status,
    /// In words.
    pub message: String,
}

impl Problem {
    /// A problem in these words.
    pub fn new(status: Status, message: impl Into<String>) -> Self {
        Self { status, message: message.into() }
    }
}
