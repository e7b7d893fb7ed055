//! Springpot for other engines: the element bank in C ([`c`], `include/springpot.h`), and scenarios as FMI 2.0 co-simulation FMUs
//! ([`fmi`]).
//!
//! The only place beside the dispatch of instruction sets that holds `unsafe`: pointers of other languages become slices in `border`, for [`c`] and
//! [`fmi::functions`], and loggers of FMUs are called. No panic crosses the border; every function answers with a status, and with a text that says what
//! was wrong.
//!
//! | module | holds |
//! |---|---|
//! | [`bank`] | elements from a text, driven on slices |
//! | [`c`] | the same for C |
//! | [`fmi`] | a scenario as an FMU: package, description, instances, functions |
//!
//! Rust hands the laws over with each call; C and FMUs know those that come with Springpot, or others by [`set_catalog`].

pub mod bank;
#[allow(unsafe_code)]
mod border;
#[allow(unsafe_code)]
pub mod c;
pub mod fmi;
mod hash;
mod laws;
mod sealed;
mod status;

pub use laws::set_catalog;
pub use status::{Problem, Status};
