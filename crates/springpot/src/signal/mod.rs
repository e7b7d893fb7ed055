//! Functions of time: numbers, [expressions](Expression) of t, and samples (piecewise linear or C² cubic spline).
//!
//! Every signal gives its value and its exact first two time derivatives as a [`Jet`]. Signals know no units: everything is
//! SI, and [`Signal::scaled`] is how a unit is applied. At a kink or jump the value is the function's own and the
//! derivatives are those from the right, so that a step may start there; [`Signal::branch`] tells when one is crossed and
//! [`Signal::break_points`] where samples have theirs.

pub mod agenda;
pub mod expression;
mod function;
mod gradient;
mod interval;
mod jet;
mod passages;
mod rounding;
mod sampled;
mod scan;
mod series;
pub mod watched;

pub use agenda::{Agenda, Stop};
pub(crate) use expression::BoundExpression;
pub use expression::{
    Branch, ColumnExpression, Expression, ExpressionError, MovedJump, Slope, SlopeError, StrokeExpression,
};
pub use function::Signal;
pub use jet::Jet;
pub(crate) use passages::{Passages, passages};
pub use sampled::SampleError;
pub use watched::{AgendaError, Watched};
