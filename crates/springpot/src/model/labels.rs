//! What the numbers of q and v are called.

use super::dimension::Dimension;
use super::kind::{Component, Space};
use super::robot::Model;

/// One number of q or v: the joint's name, with a component where the joint has several.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Label {
    /// `q1`, `floating_base.x`, `floating_base.wz`, …
    pub name: String,
    /// What it measures.
    pub dimension: Dimension,
}

impl Model {
    /// Names of the coordinates, in the order of q.
    pub fn q_labels(&self) -> Vec<Label> {
        self.labels(&self.names.joints, Space::coordinates)
    }

    /// Names of the velocities, in the order of v; accelerations and generalized forces have the same.
    pub fn v_labels(&self) -> Vec<Label> {
        self.labels(&self.names.velocities, Space::velocities)
    }

    fn labels(&self, names: &[String], parts: fn(Space) -> &'static [Component]) -> Vec<Label> {
        let label = |(j, space): (usize, Space)| match space.dimension() {
            Some(dimension) => vec![Label { name: names[j].clone(), dimension }],
            None => {
                let named = |&(part, dimension): &Component| Label { name: format!("{}.{part}", names[j]), dimension };
                parts(space).iter().map(named).collect()
            }
        };
        self.own_joints_and_spaces().flat_map(label).collect()
    }
}
