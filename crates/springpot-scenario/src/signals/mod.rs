//! What a value may be where a function of time stands: a signal, or feedback in its place.

pub(crate) mod feedback;
pub(crate) mod of_time;
pub(crate) mod plan;
