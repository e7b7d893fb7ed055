//! The program as a user types it.

mod failures;
mod results;
mod support;
