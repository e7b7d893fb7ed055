//! An expression as a function of the columns of a row.

use super::error::ExpressionError;
use super::parse::program_of;
use super::program::{MAX_KINKS, Op, Trace, run_on};
use std::fmt;

/// A function of t and of named columns, such as `gripper.z - 0.1`; otherwise as [`super::Expression`].
///
/// ```
/// use springpot::signal::ColumnExpression;
/// let height = ColumnExpression::parse("gripper.z-h*t", &[("h".to_owned(), 0.5)], &["t", "q.q1", "gripper.z"])?;
/// assert_eq!(height.columns(), [2]);
/// assert_eq!(height.value(0.5, &[1.0]), 0.75);
/// # Ok::<(), springpot::signal::ExpressionError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnExpression {
    source: String,
    program: Vec<Op>,
    columns: Vec<usize>,
}

impl ColumnExpression {
    /// Reads an expression that may name `constants` and `columns`. Of two columns the longer name counts, since names may hold dots and signs; a
    /// name without a dot is none of a column.
    ///
    /// # Errors
    /// As [`super::Expression::parse`].
    pub fn parse(source: &str, constants: &[(String, f64)], columns: &[&str]) -> Result<Self, ExpressionError> {
        let (program, columns) = program_of(source, constants, columns)?;
        let kinks = program.iter().filter(|op| op.has_kink()).count();
        if kinks > MAX_KINKS {
            return Err(ExpressionError::TooManyKinks { given: kinks, limit: MAX_KINKS });
        }
        Ok(Self { source: source.to_owned(), program, columns })
    }

    /// The columns that it names, by their places in those that it was read with.
    pub fn columns(&self) -> &[usize] {
        &self.columns
    }

    /// The value at t, s, `values` being those of [`Self::columns`]. NaN and infinities are returned as they are.
    ///
    /// # Panics
    /// Where there are fewer values than columns.
    pub fn value(&self, t: f64, values: &[f64]) -> f64 {
        run_on(&self.program, t, values, &mut Trace::default())
    }

    /// The value, if neither t nor a column occurs.
    pub fn is_constant(&self) -> Option<f64> {
        match self.program[..] {
            [Op::Number(value)] => Some(value),
            _ => None,
        }
    }
}

/// The text it was read from.
impl fmt::Display for ColumnExpression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.source)
    }
}
