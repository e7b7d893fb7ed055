//! `[[parameter]]` and `[sensitivity]`: by what a run is differentiated, and what.

mod asked;
mod constants;
mod control;
mod extended;
mod gather;
mod judge;
mod mark;
pub(crate) mod plan;
mod rows;

pub(crate) use asked::{Asked, More, OPTION, read};
pub(crate) use judge::{judge, refuse_unknown};
pub(crate) use mark::mark;
