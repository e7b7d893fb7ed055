//! What names and units of quantities follow from.

use crate::law::Entry;
use crate::model::{Label, Measure};
use std::sync::Arc;

/// Units of generalized forces, by [`Measure`]: of an angle, a length, a quaternion.
pub(super) const FORCES: [&str; 3] = ["N*m", "N", ""];

/// What names and units of an element's quantities follow from.
#[derive(Debug, Clone)]
pub(super) struct ObservedElement {
    pub(super) name: String,
    /// Whether it acts on the coordinate of a joint.
    pub(super) on_joint: bool,
    pub(super) is_rotation: bool,
    pub(super) derivative_unit: &'static str,
    pub(super) entry: Arc<Entry>,
}

/// The unit of a number, from those for angles, lengths and quaternions.
pub(super) fn of_measure(label: &Label, [angle, length, quaternion]: [&'static str; 3]) -> &'static str {
    match label.measure {
        Measure::Angle => angle,
        Measure::Length => length,
        Measure::Quaternion => quaternion,
    }
}
