//! The program as a user types it.

mod check;
mod documents;
mod dynamics;
mod dynamics_refusals;
mod equation;
mod failures;
mod figures;
mod help;
mod info;
#[cfg(unix)]
mod interrupted;
mod prony;
mod results;
#[cfg(unix)]
mod resume;
mod robots;
mod support;
#[cfg(target_os = "linux")]
mod terminal;
