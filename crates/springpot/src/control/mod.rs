//! Feedback: actuator forces and inputs of elements that follow from the state of the robot, by expressions or by laws of control.
//!
//! [`Feedback`] is an expression of what is seen of the state, a [`Controller`] a law with a [`Reference`]. Both are functions at one time, besides
//! the integrals and fractional derivatives of errors that a controller asks for; whoever takes steps keeps those, evaluates continuous laws at
//! the nodes of its steps, and sampled ones where they are due.

mod computed_torque;
mod controller;
mod feedback;
mod impedance;
mod limits;
mod pd_gravity;
mod pid;
mod reference;
mod sense;
mod shaping;
mod variation;

pub use computed_torque::ComputedTorque;
pub use controller::{Aim, At, Controller, ErrorTerm, Scratch, TorqueSlopes};
pub use feedback::{Feedback, FeedbackSlope};
pub use impedance::Impedance;
pub use limits::{AntiWindup, Limit};
pub use pd_gravity::PdGravity;
pub use pid::Pid;
pub use reference::{Profile, Reference};
pub use sense::Sense;
pub use shaping::{Measurement, Shaping};
pub use variation::{ControllerNumber, ControllerVariation, RobotChange, TermChange};

use crate::signal::Signal;
use std::sync::Arc;

/// All that controls a system; the default controls nothing.
#[derive(Debug, Clone, Default)]
pub struct Control {
    /// Actuator forces by feedback.
    pub torques: Vec<TorqueFeedback>,
    /// Inputs of elements by feedback.
    pub inputs: Vec<InputFeedback>,
    /// A controller.
    pub controller: Option<Controlled>,
}

/// An actuator force that follows from the state.
#[derive(Debug, Clone)]
pub struct TorqueFeedback {
    /// The velocity that it acts on, which no other signal drives.
    pub velocity: usize,
    /// The force, N·m or N.
    pub law: Feedback,
    /// When it is taken; `None`: at every time.
    pub sampling: Option<Sampling>,
}

/// An input of an element that follows from the state, in place of its signal.
#[derive(Debug, Clone)]
pub struct InputFeedback {
    /// The element.
    pub element: usize,
    /// Which of its inputs.
    pub input: usize,
    /// The input, SI.
    pub law: Feedback,
    /// When it is taken; `None`: at every time.
    pub sampling: Option<Sampling>,
}

/// A controller of the robot.
#[derive(Debug, Clone)]
pub struct Controlled {
    /// The law.
    pub law: Arc<dyn Controller>,
    /// What it aims at.
    pub reference: Reference,
    /// Bounds of its actuator forces, for each velocity; those left out have none.
    pub limits: Vec<Limit>,
    /// What integrals do while a force is at its bound.
    pub anti_windup: AntiWindup,
    /// When it acts; `None`: at every time.
    pub sampling: Option<Sampling>,
    /// How the parts of the law see its error.
    pub shaping: Shaping,
    /// Forces that are added to those of the law, before all limits: velocities and functions of time, N·m or N.
    pub feed_forward: Vec<(usize, Signal)>,
    /// How it sees coordinates, where it is sampled; `None`: as they are.
    pub measurement: Option<Measurement>,
}

impl Controlled {
    /// A law that acts at every time on the error as it is, without limits.
    pub fn new(law: Arc<dyn Controller>, reference: Reference) -> Self {
        Self {
            law,
            reference,
            limits: Vec::new(),
            anti_windup: AntiWindup::default(),
            sampling: None,
            shaping: Shaping::default(),
            feed_forward: Vec::new(),
            measurement: None,
        }
    }

    /// τ (nv) without its error terms and before all limits.
    pub(crate) fn torque(&self, at: &At, scratch: &mut Scratch, tau: &mut [f64]) {
        self.law.torque(at, scratch, tau);
        self.feed_forward.iter().for_each(|(k, signal)| tau[*k] += signal.value(at.t));
    }

    /// The terms of its forces that hang on the past of an error.
    pub(crate) fn error_terms(&self) -> Vec<ErrorTerm> {
        let mut terms = self.law.error_terms();
        if self.shaping.filter.is_some() {
            terms.extend(self.law.rate_terms());
        }
        terms
    }

    /// What it says where its run is differentiated; `None` where nothing is known of that.
    pub fn variation(&self) -> Option<&dyn ControllerVariation> {
        self.law.variation().filter(|_| self.shaping.is_plain() && self.measurement.is_none())
    }
}

/// When a sampled law is evaluated: at k·period, k = 0, 1, …, from the state just before. Its value holds from `delay` periods later on; before the first one it is 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    /// Between two samples, s.
    pub period: f64,
    /// Periods from a sample to when it acts.
    pub delay: usize,
}

impl Control {
    /// Whether it controls nothing.
    pub fn is_empty(&self) -> bool {
        self.torques.is_empty() && self.inputs.is_empty() && self.controller.is_none()
    }

    /// All expressions with their sampling.
    pub(crate) fn laws(&self) -> impl Iterator<Item = (&Feedback, Option<Sampling>)> {
        let torques = self.torques.iter().map(|torque| (&torque.law, torque.sampling));
        torques.chain(self.inputs.iter().map(|input| (&input.law, input.sampling)))
    }
}
