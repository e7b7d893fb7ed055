//! More numbers that a run is differentiated by, as the command line asks for them.

use crate::text::refusal::Place;

/// What the option is called that asks for them.
pub(crate) const OPTION: &str = "--sensitivity";

/// A path, or the name of a parameter, that the command line asks for.
#[derive(Debug, Clone)]
pub(crate) struct More {
    pub(crate) written: String,
    pub(crate) place: Place,
}
