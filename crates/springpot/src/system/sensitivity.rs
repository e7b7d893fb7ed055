//! What a run is differentiated by: numbers of its system, and what each of them moves.

use super::System;
use crate::control::{Controlled, ControllerNumber, ErrorTerm, FeedbackSlope, TermChange};
use crate::elements::Element;
use crate::law::Network;
use crate::model::Model;
use crate::observe::Quantity;
use crate::signal::Signal;
use crate::table::Column;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// By what a run is differentiated.
#[derive(Debug, Clone, Default)]
pub struct Sensitivity {
    /// The numbers, in the order of their columns.
    pub parameters: Vec<Parameter>,
    /// The system with the geometry that parameters move as locked joints of its robot, at 0, without mass; all else is that of the run, under the
    /// same names. `None`: no parameter moves any.
    pub extended: Option<Arc<System>>,
    /// Whether derivatives share in the choice of steps.
    pub control: bool,
    /// The derivatives that rows tell, in their order.
    pub columns: Vec<DerivativeColumn>,
    /// Go back through the run in place of beside it: quantities of which rows are kept, so that a number that is made of them can be differentiated at
    /// its end ([`crate::driver::Tape::gradients`]). Nothing shares in the choice of steps then, and rows tell no derivatives.
    pub adjoint: Option<Vec<Quantity>>,
}

impl Sensitivity {
    /// The numbers of the controller among them.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = &ControllerNumber> {
        self.parameters.iter().flat_map(|parameter| &parameter.seeds).filter_map(|seed| match seed {
            Seed::Controller { number, .. } => Some(number),
            _ => None,
        })
    }

    /// Adds the terms of a controller whose gain is 0 and moves.
    pub(crate) fn add_terms(&self, controlled: &Controlled, terms: &mut Vec<ErrorTerm>) {
        let Some(variation) = controlled.variation() else { return };
        for TermChange { term, .. } in self.numbers().flat_map(|number| variation.terms_by_number(number)) {
            let is_same = |own: &ErrorTerm| own.velocity == term.velocity && (own.order < 0.0) == (term.order < 0.0);
            if !terms.iter().any(is_same) {
                terms.push(term);
            }
        }
    }
}

/// How much a quantity at a row counts in a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// Which row, from 0.
    pub row: usize,
    /// Which of [`Sensitivity::adjoint`].
    pub quantity: usize,
    /// ∂(number)/∂(its value there).
    pub slope: f64,
}

/// A derivative that rows tell.
#[derive(Debug, Clone)]
pub struct DerivativeColumn {
    /// Of what.
    pub of: Quantity,
    /// By which of [`Sensitivity::parameters`].
    pub by: usize,
    /// Its name, unit and meaning.
    pub column: Column,
}

/// A number that a run is differentiated by.
#[derive(Debug, Clone)]
pub struct Parameter {
    /// What it is called.
    pub name: String,
    /// Its value, SI.
    pub value: f64,
    /// Its size where that may be 0: what a change of it is measured by.
    pub typical: f64,
    /// What it moves; several add up.
    pub seeds: Vec<Seed>,
}

/// What one unit of a parameter moves.
#[derive(Debug, Clone)]
pub enum Seed {
    /// Where the run starts: the coordinate of a velocity.
    Position {
        /// Which velocity.
        velocity: usize,
        /// By how much.
        by: f64,
    },
    /// How fast it starts.
    Velocity {
        /// Which velocity.
        velocity: usize,
        /// By how much.
        by: f64,
    },
    /// Numbers of a law.
    Law {
        /// Which element.
        element: usize,
        /// The law, built of numbers that carry their derivatives by the parameter ([`crate::law::Build`]).
        law: Network,
    },
    /// The coordinate at which the stroke of an element is 0.
    Rest {
        /// Which element.
        element: usize,
        /// By how much.
        by: f64,
    },
    /// For how long an element was held before t = 0 ([`crate::law::Past::Held`]).
    Age {
        /// Which element.
        element: usize,
        /// By how much, s.
        by: f64,
    },
    /// An input of an element.
    Input {
        /// Which element.
        element: usize,
        /// Which of its inputs.
        input: usize,
        /// By how much, as a function of time.
        by: Signal,
    },
    /// The force of an actuator.
    Drive {
        /// On which velocity.
        velocity: usize,
        /// By how much, as a function of time.
        by: Signal,
    },
    /// When a function of time jumps.
    Switch {
        /// Which.
        of: Switched,
        /// A function that passes zero where it jumps.
        argument: Signal,
        /// By how much that.
        by: Signal,
    },
    /// The function of an event.
    When {
        /// Which of [`System::events`].
        event: usize,
        /// By how much.
        by: FeedbackSlope,
    },
    /// The function of an event that hangs on t alone.
    WhenOfTime {
        /// Which of [`System::events`].
        event: usize,
        /// By how much.
        by: Signal,
    },
    /// What an event sets.
    Set {
        /// Which of [`System::events`].
        event: usize,
        /// Which of its settings.
        setting: usize,
        /// By how much.
        by: f64,
    },
    /// The damping of a joint.
    Damping {
        /// Which joint, of the robot of [`Sensitivity::extended`] where there is one.
        joint: usize,
        /// By how much.
        by: f64,
    },
    /// The friction of a joint.
    Friction {
        /// Which joint, of the robot of [`Sensitivity::extended`] where there is one.
        joint: usize,
        /// By how much.
        by: f64,
    },
    /// Inertias: those of this model are by how much, of the robot of [`Sensitivity::extended`] where there is one.
    Inertia(Arc<Model>),
    /// The field of gravity: that of this model is by how much.
    Gravity(Arc<Model>),
    /// A number of the controller.
    Controller {
        /// Which.
        number: ControllerNumber,
        /// By how much.
        by: f64,
    },
    /// Where its reference wants the coordinate of a velocity.
    Reference {
        /// Which velocity.
        velocity: usize,
        /// By how much, as a function of time.
        by: Signal,
    },
    /// Where it wants the gripper, where it says that itself.
    ReferencePoint {
        /// Which coordinate: 0, 1, 2.
        axis: usize,
        /// By how much, as a function of time.
        by: Signal,
    },
    /// The largest force of the controller on a velocity.
    Limit {
        /// Which velocity.
        velocity: usize,
        /// By how much.
        by: f64,
    },
    /// How fast that force may change.
    RateLimit {
        /// Which velocity.
        velocity: usize,
        /// By how much.
        by: f64,
    },
    /// An actuator force by feedback.
    TorqueFeedback {
        /// Which velocity.
        velocity: usize,
        /// By how much.
        by: FeedbackSlope,
    },
    /// An input by feedback.
    InputFeedback {
        /// Which element.
        element: usize,
        /// Which of its inputs.
        input: usize,
        /// By how much.
        by: FeedbackSlope,
    },
    /// A locked joint of [`Sensitivity::extended`].
    Place {
        /// Which of its velocities.
        velocity: usize,
        /// By how much its coordinate.
        by: f64,
    },
}

/// A function of time of a system.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Switched {
    /// The force of an actuator, by its velocity.
    Drive(usize),
    /// An input of an element.
    Input {
        /// Which element.
        element: usize,
        /// Which of its inputs.
        input: usize,
    },
}

/// Where the derivatives by a parameter end: the solution has none there, or has another one on each side.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Lost {
    /// Which of [`Sensitivity::parameters`].
    pub parameter: usize,
    /// From when on there are none, s.
    pub t: f64,
    /// Why.
    pub why: String,
}

/// Why a run cannot be differentiated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SensitivityError {
    /// No derivative is known of something that the run is made of.
    #[error("no derivative by a parameter is known of {what}")]
    Unknown {
        /// What it is.
        what: String,
    },
    /// Derivatives are known of it, but not by going back through the run.
    #[error("the adjoint does not go back through {what}: method = \"forward\" does")]
    Backwards {
        /// What it is.
        what: String,
    },
    /// What the parameter would move is not there.
    #[error("\"{parameter}\" moves {what}, which there is not")]
    Missing {
        /// The parameter.
        parameter: String,
        /// What it moves.
        what: String,
    },
}

/// Whether derivatives of a quantity are known, of a system of these elements.
pub fn has_derivative<'a>(quantity: Quantity, element: impl FnOnce(usize) -> Option<&'a Element>) -> bool {
    use crate::observe::ElementQuantity::{
        Derivative, Dissipated, Force, GeneralizedForce, Input, InputValue, Leaf, Length, Rate, Stored, Stroke, Told,
    };
    use crate::observe::EnergyQuantity::{Actuators, Joints, Kinetic, Potential, Residual};
    match quantity {
        Quantity::Time
        | Quantity::Coordinate(_)
        | Quantity::Velocity(_)
        | Quantity::Acceleration(_)
        | Quantity::Torque(_)
        | Quantity::Gripper(_)
        | Quantity::GripperError
        | Quantity::Energy(Kinetic | Potential | Actuators | Joints) => true,
        Quantity::Element(e, of) => match of {
            Length | Stroke | Rate | GeneralizedForce(_) | InputValue(_) | Told(_) => true,
            Force | Derivative | Stored | Dissipated | Input => true,
            Leaf(..) => element(e).is_some_and(Element::tells_changes_of_leaves),
        },
        Quantity::Energy(Residual) | Quantity::Derivative(_) => false,
    }
}
