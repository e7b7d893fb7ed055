//! Feedback by an expression.

use super::sense::Sense;
use crate::signal::{ColumnExpression, Jet, Signal, SlopeError};

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

/// By how much a feedback changes with a number that constants of its expression follow from.
#[derive(Debug, Clone)]
pub struct FeedbackSlope {
    /// The expression with these constants as columns behind what it sees.
    open: ColumnExpression,
    /// Value and slope of each of them.
    constants: Vec<[f64; 2]>,
    scale: f64,
}

impl FeedbackSlope {
    /// Of the expression `source` of a feedback of `scale`, read with `columns`, with each of whose `constants` (name, value, slope) changes by its
    /// slope.
    ///
    /// # Errors
    /// [`SlopeError::Expression`]; [`SlopeError::Switch`] where the number moves a bend or a jump that hangs on t alone, or on nothing.
    pub fn new(
        source: &str,
        constants: &[(String, f64, f64)],
        columns: &[&str],
        scale: f64,
    ) -> Result<Self, SlopeError> {
        let (moved, still): (Vec<_>, Vec<_>) = constants.iter().partition(|(.., slope)| *slope != 0.0);
        let values = |all: &[&(String, f64, f64)]| -> Vec<(String, f64)> {
            all.iter().map(|(name, value, _)| (name.clone(), *value)).collect()
        };
        let names: Vec<&str> = moved.iter().map(|(name, ..)| name.as_str()).collect();
        let open = ColumnExpression::parse_open(source, &values(&still), columns, &names)?;
        let all: Vec<(String, f64)> = constants.iter().map(|(name, value, _)| (name.clone(), *value)).collect();
        let closed = ColumnExpression::parse(source, &all, columns)?;
        let seen = closed.columns().len();
        if let Some(function) = open.kink_by_none_of(seen) {
            return Err(SlopeError::Switch { function });
        }
        if open.kinks() != closed.kinks() || open.kinks_of_time() != closed.kinks_of_time() {
            return Err(SlopeError::Switch { function: "a function" });
        }
        Ok(Self { open, constants: moved.iter().map(|(_, value, slope)| [*value, *slope]).collect(), scale })
    }

    /// ∂(feedback)/∂number on a branch, of what is seen.
    pub(crate) fn value_on(&self, branch: u64, t: f64, seen: &[f64]) -> f64 {
        let (mut values, mut moved) = (seen.to_vec(), vec![0.0; seen.len()]);
        for [value, slope] in &self.constants {
            values.push(*value);
            moved.push(*slope);
        }
        self.scale * self.open.change_on(branch, t, &values, &moved)
    }

    /// ∂/∂number of the argument of kink `bit`.
    pub(crate) fn guard_on(&self, branch: u64, bit: u32, t: f64, seen: &[f64]) -> f64 {
        let jet = |value: f64, first: f64| Jet { value, first, second: 0.0 };
        let mut values: Vec<Jet> = seen.iter().map(|value| jet(*value, 0.0)).collect();
        values.extend(self.constants.iter().map(|[value, slope]| jet(*value, *slope)));
        self.open.guard_jet(branch, bit, Jet::constant(t), &values).map_or(0.0, |jet| jet.first)
    }
}
