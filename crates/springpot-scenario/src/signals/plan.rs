//! A signal, or feedback in its place, as it is read.

use crate::text::document::Node;
use crate::text::refusal::Place;
use springpot::signal::Signal;
use std::sync::Arc;

/// A signal and the text it was read from.
#[derive(Debug, Clone)]
pub struct SignalPlan {
    /// The function of time, SI.
    pub signal: Signal,
    /// Its value where it is a plain number or a quantity, SI.
    pub constant: Option<f64>,
    /// As written in the scenario.
    pub written: String,
    /// Where it stands.
    pub place: Place,
    /// Where it is none, but an expression of the state: the function counts for nothing then.
    pub(crate) feedback: Option<Arc<FeedbackText>>,
}

/// Feedback as it is written.
#[derive(Debug, Clone)]
pub(crate) struct FeedbackText {
    /// The text of the expression.
    pub(crate) node: Node,
    /// What it is, for messages.
    pub(crate) owner: String,
    /// What makes it SI.
    pub(crate) scale: f64,
    pub(crate) offset: f64,
    /// Time between two samples, s.
    pub(crate) sample: Option<f64>,
}

/// The torques of a motion that are feedback, by velocity.
pub(crate) type TorqueTexts = Vec<(usize, Arc<FeedbackText>)>;
