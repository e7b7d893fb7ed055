//! A function of time, whatever it is made of.

use super::expression::{Branch, Expression};
use super::jet::Jet;
use super::sampled::{SampleError, Samples};
use std::sync::Arc;

/// A function of time; cheap to clone.
#[derive(Debug, Clone)]
pub struct Signal {
    pub(super) kind: Kind,
    pub(super) scale: f64,
    pub(super) offset: f64,
}

#[derive(Debug, Clone)]
pub(super) enum Kind {
    Constant(f64),
    Expression(Arc<Expression>),
    Samples(Arc<Samples>),
}

impl Signal {
    /// Whether it has the bits of another one everywhere.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        let numbers = |signal: &Self| [signal.scale, signal.offset].map(f64::to_bits);
        let kinds = match (&self.kind, &other.kind) {
            (Kind::Constant(own), Kind::Constant(other)) => own.to_bits() == other.to_bits(),
            (Kind::Expression(own), Kind::Expression(other)) => Arc::ptr_eq(own, other) || own.is_same(other),
            (Kind::Samples(own), Kind::Samples(other)) => Arc::ptr_eq(own, other) || own.is_same(other),
            _ => false,
        };
        kinds && numbers(self) == numbers(other)
    }

    fn new(kind: Kind) -> Self {
        Self { kind, scale: 1.0, offset: 0.0 }
    }

    /// f(t) = value.
    pub fn constant(value: f64) -> Self {
        Self::new(Kind::Constant(value))
    }

    /// An expression of t.
    pub fn expression(expression: Expression) -> Self {
        Self::new(Kind::Expression(Arc::new(expression)))
    }

    /// Straight lines through (times_i, values_i): continuous, with a break at every sample inside.
    ///
    /// At least two samples, times strictly increasing, all finite. Outside the domain the first and last line go on.
    pub fn linear(times: &[f64], values: &[f64]) -> Result<Self, SampleError> {
        Ok(Self::new(Kind::Samples(Arc::new(Samples::linear(times, values)?))))
    }

    /// The C² cubic spline through (times_i, values_i) with not-a-knot ends: the third derivative is continuous at the
    /// second and the last but one sample, so cubics are reproduced and the error is O(h⁴) up to the ends.
    ///
    /// At least two samples, times strictly increasing, all finite; three give the parabola and two the line. Outside the
    /// domain the first and last polynomial go on.
    pub fn spline(times: &[f64], values: &[f64]) -> Result<Self, SampleError> {
        Ok(Self::new(Kind::Samples(Arc::new(Samples::spline(times, values)?))))
    }

    /// A sampled signal whose first value holds before its samples and whose last one behind them; others as they are.
    #[must_use]
    pub fn held(self) -> Self {
        match &self.kind {
            Kind::Samples(samples) => Self { kind: Kind::Samples(Arc::new(samples.held())), ..self },
            Kind::Constant(_) | Kind::Expression(_) => self,
        }
    }

    /// scale·signal + offset.
    pub fn scaled(signal: Self, scale: f64, offset: f64) -> Self {
        match signal.kind {
            Kind::Constant(_) => Self::constant(scale * signal.value(0.0) + offset),
            kind => Self { kind, scale: scale * signal.scale, offset: scale * signal.offset + offset },
        }
    }

    /// Value and derivatives at `t`, in s. What is not finite is returned as it is.
    pub fn at(&self, t: f64) -> Jet {
        let jet = match &self.kind {
            Kind::Constant(value) => return Jet::constant(*value),
            Kind::Expression(expression) => expression.at(t),
            Kind::Samples(samples) => samples.at(t),
        };
        Jet {
            value: self.scale * jet.value + self.offset,
            first: self.scale * jet.first,
            second: self.scale * jet.second,
        }
    }

    /// Value at `t`, in s: the same bits as `at(t).value`.
    pub fn value(&self, t: f64) -> f64 {
        let value = match &self.kind {
            Kind::Constant(value) => return *value,
            Kind::Expression(expression) => expression.value(t),
            Kind::Samples(samples) => samples.at(t).value,
        };
        self.scale * value + self.offset
    }

    /// A bound of what rounding has made of the value at `t`, which loses more than its own last digits where large numbers cancel; of samples
    /// that of the numbers beside `t`.
    pub(crate) fn rounding(&self, t: f64) -> f64 {
        let error = match &self.kind {
            Kind::Constant(_) => return 0.0,
            Kind::Expression(expression) => expression.rounding(t),
            Kind::Samples(samples) => samples.rounding(t),
        };
        self.scale.abs() * error + f64::EPSILON * self.offset.abs()
    }

    /// What changes where the expression has a kink or jump ([`Expression::branch`]); always the same for other signals.
    pub fn branch(&self, t: f64) -> Branch {
        match &self.kind {
            Kind::Expression(expression) => expression.branch(t),
            Kind::Constant(_) | Kind::Samples(_) => Branch::default(),
        }
    }

    /// Whether its value at `t` is that of this instant alone ([`Expression::turns_at`]).
    pub fn turns_at(&self, t: f64) -> bool {
        matches!(&self.kind, Kind::Expression(expression) if expression.turns_at(t))
    }

    /// Whether [`branch`](Self::branch) can change.
    pub fn has_kinks(&self) -> bool {
        matches!(&self.kind, Kind::Expression(expression) if expression.has_kinks())
    }

    /// Times inside the domain, increasing, where a derivative up to the third of sampled data jumps; none for others.
    pub fn break_points(&self) -> &[f64] {
        match &self.kind {
            Kind::Samples(samples) => samples.break_points(),
            Kind::Constant(_) | Kind::Expression(_) => &[],
        }
    }

    /// First and last time of sampled data that is not held; `None`: defined everywhere.
    pub fn domain(&self) -> Option<(f64, f64)> {
        match &self.kind {
            Kind::Samples(samples) => samples.domain(),
            Kind::Constant(_) | Kind::Expression(_) => None,
        }
    }

    /// The value, if it is a number or an expression without t.
    pub fn is_constant(&self) -> Option<f64> {
        match &self.kind {
            Kind::Constant(value) => Some(*value),
            Kind::Expression(expression) => Some(self.scale * expression.is_constant()? + self.offset),
            Kind::Samples(_) => None,
        }
    }
}

impl From<f64> for Signal {
    fn from(value: f64) -> Self {
        Self::constant(value)
    }
}

impl From<Expression> for Signal {
    fn from(expression: Expression) -> Self {
        Self::expression(expression)
    }
}
