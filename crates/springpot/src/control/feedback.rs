//! Feedback by an expression.

use super::sense::Sense;
use crate::signal::{ColumnExpression, Jet, Signal};

/// scale·f(t, s) + offset of what is seen of the state.
#[derive(Debug, Clone)]
pub struct Feedback {
    expression: ColumnExpression,
    senses: Vec<Sense>,
    scale: f64,
    offset: f64,
    /// What of it hangs on t alone.
    parts: Vec<Signal>,
}

impl Feedback {
    /// An expression whose columns ([`ColumnExpression::columns`]) are `senses`, in their order.
    ///
    /// # Panics
    /// Where there are not as many senses as columns.
    pub fn new(expression: ColumnExpression, senses: Vec<Sense>) -> Self {
        assert_eq!(expression.columns().len(), senses.len(), "a sense for each column");
        let parts = expression.parts_of_time().into_iter().map(Signal::expression).collect();
        Self { expression, senses, scale: 1.0, offset: 0.0, parts }
    }

    /// scale·feedback + offset: a unit.
    #[must_use]
    pub fn scaled(self, scale: f64, offset: f64) -> Self {
        Self { scale: scale * self.scale, offset: scale * self.offset + offset, ..self }
    }

    /// What it sees.
    pub fn senses(&self) -> &[Sense] {
        &self.senses
    }

    /// Its largest parts that hang on t alone: steps must see what they do.
    pub(crate) fn parts_of_time(&self) -> &[Signal] {
        &self.parts
    }

    /// The expression.
    pub fn expression(&self) -> &ColumnExpression {
        &self.expression
    }

    /// Whether it has kinks.
    pub(crate) fn has_kinks(&self) -> bool {
        self.expression.has_kinks()
    }

    /// Its value, each kink on the side where its argument is.
    pub fn value(&self, t: f64, seen: &[f64]) -> f64 {
        self.scale * self.expression.value(t, seen) + self.offset
    }

    /// Its value on a branch ([`ColumnExpression::value_on`]).
    pub(crate) fn value_on(&self, branch: u64, t: f64, seen: &[f64]) -> f64 {
        self.scale * self.expression.value_on(branch, t, seen) + self.offset
    }

    /// A bound of what rounding makes of its value on a branch.
    pub(crate) fn rounding_on(&self, branch: u64, t: f64, seen: &[f64]) -> f64 {
        self.scale.abs() * self.expression.rounding_on(branch, t, seen) + f64::EPSILON * self.offset.abs()
    }

    /// Its value and time derivative on a branch.
    pub(crate) fn jet_on(&self, branch: u64, t: f64, seen: &[Jet]) -> Jet {
        let jet = self.expression.jet_on(branch, t, seen);
        Jet {
            value: self.scale * jet.value + self.offset,
            first: self.scale * jet.first,
            second: self.scale * jet.second,
        }
    }

    /// Its derivative by each of its senses.
    pub(crate) fn slopes_on(&self, branch: u64, t: f64, seen: &[f64], slopes: &mut Vec<f64>) {
        self.expression.slopes_on(branch, t, seen, slopes);
        slopes.iter_mut().for_each(|slope| *slope *= self.scale);
    }
}
