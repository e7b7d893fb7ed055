//! What the numbers of q and v are called.

use super::robot::Model;
use super::spec::JointKind;

/// What a coordinate or a velocity measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// An angle, rad.
    Angle,
    /// A length, m.
    Length,
    /// A component of a quaternion, without unit.
    Quaternion,
}

/// One number of q or v: the joint's name, with a component where the joint has several.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Label {
    /// `q1`, `floating_base.x`, `floating_base.wz`, …
    pub name: String,
    /// What it measures.
    pub measure: Measure,
}

const COORDINATES: [(&str, Measure); 7] = [
    ("x", Measure::Length),
    ("y", Measure::Length),
    ("z", Measure::Length),
    ("qx", Measure::Quaternion),
    ("qy", Measure::Quaternion),
    ("qz", Measure::Quaternion),
    ("qw", Measure::Quaternion),
];
const VELOCITIES: [(&str, Measure); 6] = [
    ("vx", Measure::Length),
    ("vy", Measure::Length),
    ("vz", Measure::Length),
    ("wx", Measure::Angle),
    ("wy", Measure::Angle),
    ("wz", Measure::Angle),
];

impl Model {
    /// Names of the coordinates, in the order of q.
    pub fn q_labels(&self) -> Vec<Label> {
        self.labels(&COORDINATES)
    }

    /// Names of the velocities, in the order of v; accelerations and generalized forces have the same.
    pub fn v_labels(&self) -> Vec<Label> {
        self.labels(&VELOCITIES)
    }

    fn labels(&self, of_floating: &[(&str, Measure)]) -> Vec<Label> {
        let own = (0..self.joint_count()).filter(|&j| self.followed(j).is_none());
        own.flat_map(|j| {
            let joint = &self.joint_names()[j];
            let one = |measure| vec![Label { name: joint.clone(), measure }];
            match self.joint_kind(j) {
                JointKind::Fixed => Vec::new(),
                JointKind::Revolute | JointKind::Continuous => one(Measure::Angle),
                JointKind::Prismatic => one(Measure::Length),
                JointKind::Floating => of_floating
                    .iter()
                    .map(|&(part, measure)| Label { name: format!("{joint}.{part}"), measure })
                    .collect(),
            }
        })
        .collect()
    }
}
