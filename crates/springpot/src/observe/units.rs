//! What names and units of quantities follow from.

use crate::elements::MeasureKind;
use crate::law::{Entry, Told};
use std::sync::Arc;

/// What names and units of an element's quantities follow from.
#[derive(Debug, Clone)]
pub(super) struct ObservedElement {
    pub(super) name: String,
    pub(super) shown: bool,
    pub(super) kind: MeasureKind,
    pub(super) is_rotation: bool,
    pub(super) derivative_unit: &'static str,
    /// Whether its law has one derivative to tell.
    pub(super) tells_derivative: bool,
    /// What its law tells of itself.
    pub(super) tells: Vec<Told>,
    /// Names of its leaves, and units of their derivatives.
    pub(super) leaves: Vec<(String, &'static str)>,
    pub(super) entry: Arc<Entry>,
}
