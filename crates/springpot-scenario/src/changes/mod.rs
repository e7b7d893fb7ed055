//! What takes the place of a value: where a path leads in the document, and what sweeps put there.

pub(crate) mod more;
pub(crate) mod path;
pub(crate) mod sweep;
