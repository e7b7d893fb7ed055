//! The program as a user types it.

mod check;
mod failures;
mod figures;
mod help;
#[cfg(unix)]
mod interrupted;
mod results;
mod robots;
mod support;
#[cfg(target_os = "linux")]
mod terminal;
