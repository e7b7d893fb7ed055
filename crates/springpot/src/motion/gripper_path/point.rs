//! Where the gripper should be, and nothing about joints.

use super::{PathError, Wanted};
use crate::model::Model;
use crate::motion::Source;
use crate::signal::Signal;

/// A point that the gripper should be at, world x, y and z, m: what impedance control follows, within reach or not. All coordinates are 0.
#[derive(Debug, Clone)]
pub struct GripperPoint(pub [Signal; 3]);

impl Source for GripperPoint {
    fn at(&self, _: &Model, t: f64, q: &mut [f64], v: &mut [f64], a: &mut [f64]) -> Result<Option<Wanted>, PathError> {
        [q, v, a].into_iter().for_each(|values| values.fill(0.0));
        let jets = self.0.each_ref().map(|signal| signal.at(t));
        Ok(Some(Wanted { position: jets.map(|jet| jet.value), velocity: jets.map(|jet| jet.first) }))
    }

    fn signals(&self) -> Vec<&Signal> {
        self.0.iter().collect()
    }

    fn named_signals(&self, _: &Model) -> Vec<(String, &Signal)> {
        self.0.iter().map(|signal| ("the gripper's path".to_owned(), signal)).collect()
    }
}
