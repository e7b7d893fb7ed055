//! Whole runs of scenarios: what every face of a run shares.

pub mod sweep;
pub mod table;
