//! What the numbers of q and v are called.

use super::dimension::Dimension;
use super::robot::Model;
use super::spec::Space;

/// One number of q or v: the joint's name, with a component where the joint has several.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Label {
    /// `q1`, `floating_base.x`, `floating_base.wz`, …
    pub name: String,
    /// What it measures.
    pub dimension: Dimension,
}

const COORDINATES: [(&str, Dimension); 7] = [
    ("x", Dimension::Length),
    ("y", Dimension::Length),
    ("z", Dimension::Length),
    ("qx", Dimension::Quaternion),
    ("qy", Dimension::Quaternion),
    ("qz", Dimension::Quaternion),
    ("qw", Dimension::Quaternion),
];
const VELOCITIES: [(&str, Dimension); 6] = [
    ("vx", Dimension::Length),
    ("vy", Dimension::Length),
    ("vz", Dimension::Length),
    ("wx", Dimension::Angle),
    ("wy", Dimension::Angle),
    ("wz", Dimension::Angle),
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

    fn labels(&self, of_pose: &[(&str, Dimension)]) -> Vec<Label> {
        let own = (0..self.joint_count()).filter(|&j| self.followed(j).is_none());
        own.flat_map(|j| {
            let joint = &self.joint_names()[j];
            let one = |dimension| vec![Label { name: joint.clone(), dimension }];
            match self.joint_kind(j).space() {
                Space::Point => Vec::new(),
                Space::Line(dimension) => one(dimension),
                Space::Circle => one(Dimension::Angle),
                Space::Pose => of_pose
                    .iter()
                    .map(|&(part, dimension)| Label { name: format!("{joint}.{part}"), dimension })
                    .collect(),
            }
        })
        .collect()
    }
}
