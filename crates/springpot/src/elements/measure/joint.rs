//! The coordinate of a joint.

use super::forces::JointForce;
use super::forces::{Forces, Pull};
use super::{Direction, Measure, Reading};
use crate::dynamics::Kinematics;
use crate::model::{Dimension, JointKind, Model};

/// The coordinate of a joint of one degree of freedom, rad or m: y = ratio·q + offset with the q of the joint that it
/// follows, or y = q of its own.
///
/// A force F > 0 (N·m or N) drives the coordinate down. Angles are not wrapped: a continuous joint winds up. It belongs to
/// the [`Model`] that it was made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    joint: usize,
    /// Which velocity moves it.
    velocity: usize,
    /// ∂y/∂q of that velocity.
    ratio: f64,
    offset: f64,
    is_rotation: bool,
}

/// A joint has no coordinate that an element could act on.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum JointMeasureError {
    /// There is no joint of this name.
    #[error("the robot has no joint \"{0}\"")]
    Unknown(String),
    /// There is no moving joint of this index.
    #[error("there is no joint {joint}: the robot has {count} moving joints")]
    NoSuchJoint {
        /// The index.
        joint: usize,
        /// Number of moving joints.
        count: usize,
    },
    /// The joint has several coordinates that are numbers, and the name says none of them.
    #[error("joint \"{joint}\" is {} and has {} coordinates: name one of {}", kind.name(), coordinates.len(), coordinates.join(", "))]
    Several {
        /// The joint.
        joint: String,
        /// What it is.
        kind: JointKind,
        /// Names of its coordinates.
        coordinates: Vec<String>,
    },
    /// The joint has no coordinate that is a number.
    #[error(
        "joint \"{joint}\" is {}: an element acts on the coordinate of a joint of one degree of freedom ({})", kind.name(), of_one_degree()
    )]
    Kind {
        /// The joint.
        joint: String,
        /// What it is.
        kind: JointKind,
    },
}

/// `revolute, continuous or prismatic`.
fn of_one_degree() -> String {
    let kinds = JointKind::ALL.into_iter().filter(|kind| kind.dimension().is_some());
    let names: Vec<&str> = kinds.map(JointKind::name).collect();
    let (others, last) = names.split_at(names.len() - 1);
    format!("{} or {}", others.join(", "), last.concat())
}

impl Joint {
    /// The coordinate of moving joint `joint`.
    ///
    /// # Errors
    /// [`JointMeasureError::NoSuchJoint`]; [`JointMeasureError::Kind`] for a spherical or floating joint.
    pub fn new(model: &Model, joint: usize) -> Result<Self, JointMeasureError> {
        let count = model.joint_count();
        if joint >= count {
            return Err(JointMeasureError::NoSuchJoint { joint, count });
        }
        let Some(dimension) = model.joint_space(joint).dimension() else {
            let kind = model.described_joint(joint).kind;
            return Err(JointMeasureError::Kind { joint: model.joint_names()[joint].clone(), kind });
        };
        let (_, ratio, offset) = model.followed(joint).unwrap_or((joint, 1.0, 0.0));
        let velocity = model.v_range(joint).start;
        Ok(Self { joint, velocity, ratio, offset, is_rotation: dimension == Dimension::Angle })
    }

    /// The coordinate of the joint called `name`; of a joint of several, that called "joint.coordinate".
    ///
    /// # Errors
    /// [`JointMeasureError::Unknown`]; [`JointMeasureError::Several`] where the name says no coordinate;
    /// [`JointMeasureError::Kind`] for a spherical, floating or fixed joint.
    pub fn named(model: &Model, name: &str) -> Result<Self, JointMeasureError> {
        match model.joint_index(name) {
            Some(joint) => Self::new(model, joint),
            None if model.has_fixed_joint(name) => {
                Err(JointMeasureError::Kind { joint: name.into(), kind: JointKind::Fixed })
            }
            None => Err(match model.described_joints().iter().find(|joint| joint.name == name) {
                Some(joint) => JointMeasureError::Several {
                    joint: name.into(),
                    kind: joint.kind,
                    coordinates: model.joint_names()[joint.joints.clone()].to_vec(),
                },
                None => JointMeasureError::Unknown(name.into()),
            }),
        }
    }

    /// Index of the moving joint.
    pub fn joint(&self) -> usize {
        self.joint
    }

    pub(super) fn is_rotation(&self) -> bool {
        self.is_rotation
    }

    pub(super) fn offset(&self) -> f64 {
        self.offset.abs()
    }

    #[inline]
    pub(super) fn read_into(
        &self,
        model: &Model,
        kinematics: &Kinematics,
        gradient: &mut [f64],
        reading: &mut Reading,
    ) {
        let gradient = &mut gradient[..model.nv()];
        gradient.fill(0.0);
        gradient[self.velocity] = self.ratio;
        *reading = Reading {
            coordinate: kinematics.joint_coordinate(self.joint),
            rate: self.ratio * kinematics.joint_velocities()[self.velocity],
            direction: Direction::Fixed,
        };
    }

    #[inline]
    pub(super) fn push(&self, pull: Pull, forces: &mut Forces) {
        forces.joints.push(JointForce { velocity: self.velocity, slope: self.ratio, pull });
    }
}

impl From<Joint> for Measure {
    fn from(joint: Joint) -> Self {
        Self::Joint(joint)
    }
}
