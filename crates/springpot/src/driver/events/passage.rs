//! Where a function of an event passes zero.

/// A function has passed zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Passage {
    pub(crate) event: usize,
    pub(crate) t: f64,
    pub(crate) rises: bool,
}
