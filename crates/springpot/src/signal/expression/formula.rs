//! An expression as a function of time.

use super::branch::Branch;
use super::error::ExpressionError;
use super::parse;
use super::program::{Op, Trace, run};
use crate::signal::jet::Jet;
use crate::signal::rounding::Rounded;
use std::fmt;
use std::str::FromStr;

/// A function of t, kept as a flat program in postfix order; evaluation neither recurses nor allocates.
///
/// ```
/// use springpot::signal::Expression;
/// let x: Expression = "0.7*t^2".parse()?;
/// let jet = x.at(0.0);
/// assert_eq!((jet.value, jet.first, jet.second), (0.0, 0.0, 1.4));
/// # Ok::<(), springpot::signal::ExpressionError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Expression {
    pub(super) source: String,
    pub(super) program: Vec<Op>,
    pub(super) kinks: usize,
}

impl Expression {
    /// Reads an expression.
    ///
    /// # Errors
    /// What stands there in place of an expression, and what is too long or too deep.
    pub fn parse(source: &str) -> Result<Self, ExpressionError> {
        Self::parse_with(source, &[])
    }

    /// Reads an expression that may name these constants besides what all expressions know; where both have a name, it is not the constant's.
    ///
    /// ```
    /// use springpot::signal::Expression;
    /// let x = Expression::parse_with("A*sin(2*pi*f*t)", &[("A".to_owned(), 0.005), ("f".to_owned(), 2.0)])?;
    /// assert!((x.value(0.125) - 0.005).abs() < 1e-17);
    /// # Ok::<(), springpot::signal::ExpressionError>(())
    /// ```
    ///
    /// # Errors
    /// As [`Expression::parse`].
    pub fn parse_with(source: &str, constants: &[(String, f64)]) -> Result<Self, ExpressionError> {
        let program = parse::program(source, constants)?;
        let kinks = program.iter().filter(|op| op.has_kink()).count();
        Ok(Self { source: source.to_owned(), program, kinks })
    }

    /// Whether it has the same operations on the same bits.
    pub(in crate::signal) fn is_same(&self, other: &Self) -> bool {
        let is_same = |(own, other): (&Op, &Op)| match (own, other) {
            (Op::Number(own), Op::Number(other)) => own.to_bits() == other.to_bits(),
            (own, other) => own == other,
        };
        self.program.len() == other.program.len() && self.program.iter().zip(&other.program).all(is_same)
    }

    /// Its sign, as an expression with a kink wherever it passes zero.
    pub(in crate::signal) fn sign(&self) -> Self {
        let mut program = self.program.clone();
        program.push(Op::Sign);
        Self { source: self.source.clone(), program, kinks: self.kinks + 1 }
    }

    /// The text it was read from.
    pub fn source(&self) -> &str {
        &self.source
    }

    /// The value at `t`: the same number as `at(t).value`. NaN and infinities are returned as they are.
    pub fn value(&self, t: f64) -> f64 {
        run(&self.program, t, &mut Trace::default())
    }

    /// A bound of what rounding has made of the value at `t`.
    pub(in crate::signal) fn rounding(&self, t: f64) -> f64 {
        run(&self.program, Rounded::read(t), &mut Trace::default()).error
    }

    /// Value and exact first two derivatives at `t`; at a kink or jump the derivatives are those from the right.
    pub fn at(&self, t: f64) -> Jet {
        run(&self.program, Jet::time(t), &mut Trace::default())
    }

    /// The side of each abs, sign, step (below: the argument is below zero), min, max (the first argument is below the second), atan2 (below
    /// the cut along the negative x axis), sqrt, asin, acos (the argument falls) and triangle wave (falls), just after `t`:
    /// between two times with the same sides none of them has switched an odd number of times; kinks and jumps lie where they change.
    pub fn branch(&self, t: f64) -> Branch {
        let mut rest = Vec::new();
        let first = self.trace(t, Some(&mut rest)).branch;
        Branch { first, rest }
    }

    /// Whether a sign, a step or an atan2 jumps at `t` itself, so that its value there is not that just after `t`.
    pub fn turns_at(&self, t: f64) -> bool {
        self.trace(t, None).turns
    }

    fn trace<'b>(&self, t: f64, beyond: Option<&'b mut Vec<u64>>) -> Trace<'b> {
        let mut trace = Trace { beyond, ..Trace::default() };
        if self.has_kinks() {
            run(&self.program, Jet::time(t), &mut trace);
        }
        trace
    }

    /// Whether [`branch`](Self::branch) can change.
    pub fn has_kinks(&self) -> bool {
        self.kinks > 0
    }

    /// How many functions it has that may have a kink.
    pub(in crate::signal) fn kink_count(&self) -> usize {
        self.kinks
    }

    /// The value, if `t` does not occur.
    pub fn is_constant(&self) -> Option<f64> {
        match self.program[..] {
            [Op::Number(value)] => Some(value),
            _ => None,
        }
    }
}

impl FromStr for Expression {
    type Err = ExpressionError;

    fn from_str(source: &str) -> Result<Self, ExpressionError> {
        Self::parse(source)
    }
}

/// The text it was read from.
impl fmt::Display for Expression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.source)
    }
}
