//! What is written, and where: the ground under everything that reads a scenario.

pub(crate) mod document;
pub(crate) mod glob;
pub(crate) mod mistaken;
pub(crate) mod names;
pub(crate) mod quoted;
pub(crate) mod refusal;
