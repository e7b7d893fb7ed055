//! `[[parameter]]` and `[sensitivity]`: by what a run is differentiated, and what.

mod asked;
mod constants;
mod control;
mod extended;
mod gather;
mod judge;
mod mark;
mod rows;

pub(crate) use asked::{Asked, By, apart, blocks, read};
pub(crate) use constants::{followers, slopes};
pub(crate) use gather::Slope;
pub(crate) use judge::{block_of, judge, refuse_unknown};
pub(crate) use mark::{leave_ends, mark};
