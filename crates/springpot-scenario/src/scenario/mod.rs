//! A whole scenario: as it is written, with what the command line says in its place.

mod inputs;
mod lone;
pub(crate) mod overrides;
mod portable;
pub(crate) mod put;
pub(crate) mod root;
mod schema;
pub(crate) mod written;

pub use lone::LoneElement;
pub use portable::Portable;
pub use schema::json_schema;
pub use written::Scenario;
