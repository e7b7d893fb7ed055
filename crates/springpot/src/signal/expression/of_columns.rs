//! An expression as a function of the columns of a row.

use super::error::ExpressionError;
use super::formula::Expression;
use super::parse::{program_of, program_of_columns_and_open};
use super::program::{MAX_KINKS, MAX_STACK, Op, Trace, argument, carry_out, operands_from, run_on};
use crate::signal::jet::{Jet, Value};
use crate::signal::rounding::Rounded;
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
    /// A bit for each of its kinks: whether it hangs on t alone.
    of_time: u64,
}

impl ColumnExpression {
    /// Reads an expression that may name `constants` and `columns`. Of two columns the longer name counts, since names may hold dots and signs; a
    /// name without a dot is none of a column.
    ///
    /// # Errors
    /// As [`super::Expression::parse`].
    pub fn parse(source: &str, constants: &[(String, f64)], columns: &[&str]) -> Result<Self, ExpressionError> {
        Self::of(source, program_of(source, constants, columns)?)
    }

    /// The same where constants of the names `open` are columns behind those that it names ([`Self::columns`]), all of them.
    ///
    /// # Errors
    /// As [`Self::parse`].
    pub(crate) fn parse_open(
        source: &str,
        constants: &[(String, f64)],
        columns: &[&str],
        open: &[&str],
    ) -> Result<Self, ExpressionError> {
        Self::of(source, program_of_columns_and_open(source, constants, columns, open)?)
    }

    fn of(source: &str, (program, columns): (Vec<Op>, Vec<usize>)) -> Result<Self, ExpressionError> {
        let kinks = program.iter().filter(|op| op.has_kink()).count();
        if kinks > MAX_KINKS {
            return Err(ExpressionError::TooManyKinks { given: kinks, limit: MAX_KINKS });
        }
        let mut own = Self { source: source.to_owned(), program, columns, of_time: 0 };
        let at = (0..own.program.len()).filter(|&at| own.program[at].has_kink());
        own.of_time =
            at.zip(0..).filter(|(at, _)| !own.depends_on_columns(*at)).fold(0, |bits, (_, own)| bits | 1 << own);
        Ok(own)
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
        run_on(&self.program, t, &|k| values[k], &mut Trace::default())
    }

    /// A bound of what rounding makes of the value, where columns are as exact as their last digits.
    pub(crate) fn rounding_on(&self, branch: u64, t: f64, values: &[f64]) -> f64 {
        run_on(&self.program, Rounded::read(t), &|k| Rounded::read(values[k]), &mut Trace::held(branch)).error
    }

    /// As [`Self::value`], its kinks on the sides that `branch` says ([`Self::branch`]), whatever their arguments are: beyond a kink it goes on
    /// as before it.
    pub(crate) fn value_on(&self, branch: u64, t: f64, values: &[f64]) -> f64 {
        run_on(&self.program, t, &|k| values[k], &mut Trace::held(branch))
    }

    /// Value and time derivatives where time and columns have these, on a branch.
    pub(crate) fn jet_on(&self, branch: u64, t: f64, values: &[Jet]) -> Jet {
        run_on(&self.program, Jet::time(t), &|k| values[k], &mut Trace::held(branch))
    }

    /// Its derivative by each of its columns, on a branch.
    pub(crate) fn slopes_on(&self, branch: u64, t: f64, values: &[f64], slopes: &mut Vec<f64>) {
        slopes.clear();
        slopes.extend((0..self.columns.len()).map(|column| {
            let moved = |k: usize| Jet { value: values[k], first: if k == column { 1.0 } else { 0.0 }, second: 0.0 };
            run_on(&self.program, Jet::constant(t), &moved, &mut Trace::held(branch)).first
        }));
    }

    /// Its change where columns change by `moved`, on a branch.
    pub(crate) fn change_on(&self, branch: u64, t: f64, values: &[f64], moved: &[f64]) -> f64 {
        let jet = |k: usize| Jet { value: values[k], first: moved[k], second: 0.0 };
        run_on(&self.program, Jet::constant(t), &jet, &mut Trace::held(branch)).first
    }

    /// The argument of kink `bit` ([`Self::guards`]) with time derivatives where time and columns have these.
    pub(crate) fn guard_jet(&self, branch: u64, bit: u32, time: Jet, values: &[Jet]) -> Option<Jet> {
        let columns = |k: usize| values[k];
        let (mut stack, mut top, mut trace) = ([time; MAX_STACK], 0, Trace::held(branch));
        let mut kinks = 0..;
        for &op in &self.program {
            if op.has_kink() && kinks.next() == Some(bit) {
                if op == Op::Atan2 && !is_beside_cut(stack[top - 1].value) {
                    return None;
                }
                let argument = argument(op, &stack[..top])?;
                return Some(if branch >> bit & 1 == 1 { argument.neg() } else { argument });
            }
            carry_out(op, &mut stack, &mut top, time, &columns, &mut trace);
        }
        None
    }

    /// Whether its value may jump at kink `bit`.
    pub(crate) fn jumps_at(&self, bit: u32) -> bool {
        let mut kinks = self.program.iter().filter(|op| op.has_kink());
        kinks.nth(bit as usize).is_some_and(|op| op.may_jump())
    }

    /// The first function that bends or jumps by columns, but by none of the first `count`.
    pub(crate) fn kink_by_none_of(&self, count: usize) -> Option<&'static str> {
        let kinks = (0..self.program.len()).filter(|at| self.program[*at].has_kink());
        let mut alone = kinks.filter(|&at| {
            let own = &self.program[self.first_of(at)..at];
            let is_seen = |op: &Op| matches!(op, Op::Column(k) if *k < count);
            own.iter().any(|op| matches!(op, Op::Column(_))) && !own.iter().any(is_seen)
        });
        alone.next().map(|at| match self.program[at] {
            Op::Abs => "abs",
            Op::Sign => "sign",
            Op::Step => "step",
            Op::Min => "min",
            Op::Max => "max",
            Op::Atan2 => "atan2",
            Op::AsinSin => "asin",
            Op::AcosCos => "acos",
            _ => "a function",
        })
    }

    /// How many kinks it has.
    pub(crate) fn kinks(&self) -> usize {
        self.program.iter().filter(|op| op.has_kink()).count()
    }

    /// A bit for each of its kinks: on which side it is just after t, where columns have these values and derivatives.
    pub(crate) fn branch(&self, t: f64, values: &[Jet]) -> u64 {
        let mut trace = Trace::default();
        run_on(&self.program, Jet::time(t), &|k| values[k], &mut trace);
        trace.branch
    }

    /// Whether it has kinks.
    pub(crate) fn has_kinks(&self) -> bool {
        self.program.iter().any(|op| op.has_kink())
    }

    /// The bits of its kinks that hang on t alone: they switch at times that are known before a run ([`Self::parts_of_time`]).
    pub(crate) fn kinks_of_time(&self) -> u64 {
        self.of_time
    }

    /// Hands over the bit and the argument of each kink: it is positive on the side of `branch` and passes zero at the kink.
    pub(crate) fn guards(&self, branch: u64, t: f64, values: &[f64], take: &mut dyn FnMut(u32, f64)) {
        let columns = |k: usize| values[k];
        let (mut stack, mut top, mut trace) = ([t; MAX_STACK], 0, Trace::held(branch));
        let mut kinks = 0..;
        for &op in &self.program {
            if let Some(own) = op.has_kink().then(|| kinks.next()).flatten() {
                // The angle of a point that is not beside the cut has none.
                let is_off = op == Op::Atan2 && !is_beside_cut(stack[top - 1]);
                let argument = argument(op, &stack[..top]).filter(|_| !is_off);
                if let Some(argument) = argument {
                    take(own, if branch >> own & 1 == 1 { -argument } else { argument });
                }
            }
            carry_out(op, &mut stack, &mut top, t, &columns, &mut trace);
        }
    }

    /// Whether a column occurs in the operands of instruction `at`.
    fn depends_on_columns(&self, at: usize) -> bool {
        self.program[self.first_of(at)..at].iter().any(|op| matches!(op, Op::Column(_)))
    }

    /// Where the operands of instruction `at` begin.
    fn first_of(&self, at: usize) -> usize {
        operands_from(&self.program, at, self.program[at].operands())
    }

    /// Its largest parts that hang on t alone, as functions of it: steps must see what they do.
    pub(crate) fn parts_of_time(&self) -> Vec<Expression> {
        let mut parts = Vec::new();
        let mut end = self.program.len();
        while end > 0 {
            let at = end - 1;
            let first = self.first_of(at);
            let part = &self.program[first..end];
            let has = |wanted: fn(&Op) -> bool| part.iter().any(wanted);
            if has(|op| matches!(op, Op::Column(_))) {
                // Its operands come before it.
                end = at;
                continue;
            }
            if part.len() > 1 && has(|op| *op == Op::Time) {
                let kinks = part.iter().filter(|op| op.has_kink()).count();
                parts.push(Expression { source: self.source.clone(), program: part.to_vec(), kinks });
            }
            end = first;
        }
        parts
    }

    /// Itself as a function of t, where it names no column.
    pub(crate) fn of_time_alone(&self) -> Option<Expression> {
        let kinks = self.program.iter().filter(|op| op.has_kink()).count();
        let expression = || Expression { source: self.source.clone(), program: self.program.clone(), kinks };
        self.columns.is_empty().then(expression)
    }

    /// The value, if neither t nor a column occurs.
    pub fn is_constant(&self) -> Option<f64> {
        match self.program[..] {
            [Op::Number(value)] => Some(value),
            _ => None,
        }
    }
}

/// Whether a point of this x is beside the cut of atan2.
fn is_beside_cut(x: f64) -> bool {
    x < 0.0
}

/// The text it was read from.
impl fmt::Display for ColumnExpression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.source)
    }
}
