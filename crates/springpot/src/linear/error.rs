//! Why a system is not linearised.

use crate::elements::NoDirection;

/// Why a system cannot be linearised, or has no equilibrium.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LinearError {
    /// An element has no direction to act in.
    #[error("element \"{element}\": {why}")]
    NoDirection {
        /// The element.
        element: String,
        /// Why.
        why: NoDirection,
    },
    /// An input, a torque or a coordinate is no number, or breaks a rule of its law.
    #[error("{what}: {problem}")]
    Value {
        /// The column or the element.
        what: String,
        /// What is wrong.
        problem: String,
    },
    /// Parts in series come to no common force at rest.
    #[error("the parts in series of element \"{element}\" come to no common force at a stroke of {stroke} m")]
    NoRest {
        /// The element.
        element: String,
        /// Its stroke.
        stroke: f64,
    },
    /// The actuators of kinematics that are given hold every configuration.
    #[error("the motion is given in advance: there are no torques that an equilibrium would balance")]
    Given,
    /// Nothing holds a joint.
    #[error("there is no equilibrium: nothing holds {joint}, on which {torque} {unit} are left over")]
    NothingHolds {
        /// The velocity's name.
        joint: String,
        /// What is left over where the search ended.
        torque: f64,
        /// N·m or N.
        unit: &'static str,
    },
}
