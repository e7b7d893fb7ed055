//! The derivative of an expression by a number that its constants follow from.

use super::error::ExpressionError;
use super::formula::Expression;
use super::parse;
use super::program::{MAX_STACK, Op};
use crate::signal::jet::Smooth;

/// Longest program of a derivative, in instructions.
const MOST: usize = 1 << 16;

/// Why an expression has no derivative by a number that its constants follow from.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SlopeError {
    /// It is no expression.
    #[error(transparent)]
    Expression(#[from] ExpressionError),
    /// The number moves where a function bends or jumps.
    #[error("`{function}` bends or jumps where the constant has it")]
    Switch {
        /// The function.
        function: &'static str,
    },
    /// The derivative is too long.
    #[error("its derivative is too long an expression")]
    TooLong,
}

/// An operand: its program, and that of its derivative where it has one.
struct Part {
    value: Vec<Op>,
    slope: Option<Vec<Op>>,
}

impl Expression {
    /// The derivative of `source` by a number with which each of `constants` (name, value, slope) changes by its slope: as a function of t. Exact:
    /// the program of the expression is differentiated.
    ///
    /// ```
    /// use springpot::signal::Expression;
    ///
    /// // d/df of A·sin(2πft) at f = 2.
    /// let slope = Expression::slope("A*sin(2*pi*f*t)", &[("A".into(), 0.5, 0.0), ("f".into(), 2.0, 1.0)])?;
    /// assert!((slope.value(0.5) - 0.5 * std::f64::consts::PI).abs() < 1e-15);
    /// # Ok::<(), springpot::signal::SlopeError>(())
    /// ```
    ///
    /// # Errors
    /// What is no expression; abs, sign, step, min, max and atan2 of what the number moves, whose bends and jumps move with it.
    pub fn slope(source: &str, constants: &[(String, f64, f64)]) -> Result<Self, SlopeError> {
        let names: Vec<&str> = constants.iter().map(|(name, ..)| name.as_str()).collect();
        let program = parse::program_of_open(source, &names)?;
        let mut parts: Vec<Part> = Vec::new();
        for op in program {
            let part = match op {
                Op::Column(k) => {
                    let (_, value, slope) = constants[k];
                    Part { value: vec![Op::Number(value)], slope: (slope != 0.0).then(|| vec![Op::Number(slope)]) }
                }
                _ => {
                    let operands = parts.split_off(parts.len() - op.operands());
                    derived(op, operands)?
                }
            };
            if part.value.len() + part.slope.as_ref().map_or(0, Vec::len) > MOST {
                return Err(SlopeError::TooLong);
            }
            parts.push(part);
        }
        let program = parts.pop().and_then(|part| part.slope).unwrap_or_else(|| vec![Op::Number(0.0)]);
        if height(&program) > MAX_STACK {
            return Err(SlopeError::TooLong);
        }
        let kinks = program.iter().filter(|op| op.has_kink()).count();
        Ok(Self { source: format!("d({source})"), program, kinks })
    }
}

/// Most intermediate results at a time.
fn height(program: &[Op]) -> usize {
    let heights = program.iter().scan(0, |height, op| {
        *height = *height + 1 - op.operands();
        Some(*height)
    });
    heights.max().unwrap_or(0)
}

/// What `op` makes of its operands.
fn derived(op: Op, operands: Vec<Part>) -> Result<Part, SlopeError> {
    let moved = operands.iter().any(|part| part.slope.is_some());
    let value = operands.iter().flat_map(|part| part.value.iter().copied()).chain([op]).collect();
    let slope = if moved { slope_of(op, &operands)? } else { None };
    Ok(Part { value, slope })
}

/// The derivative of an instruction, one of whose operands at least has one.
fn slope_of(op: Op, operands: &[Part]) -> Result<Option<Vec<Op>>, SlopeError> {
    use Op::{Add, Divide, Multiply, Negate, Number, Power, Subtract};
    let join = |parts: &[&[Op]]| parts.concat();
    let switch = |function| Err(SlopeError::Switch { function });
    let u = &operands[0].value[..];
    let du = operands[0].slope.as_deref();
    Ok(match op {
        Add | Subtract => match (du, operands[1].slope.as_deref()) {
            (Some(du), Some(dv)) => Some(join(&[du, dv, &[op]])),
            (None, Some(dv)) if op == Subtract => Some(join(&[dv, &[Negate]])),
            (Some(one), None) | (None, Some(one)) => Some(one.to_vec()),
            (None, None) => None,
        },
        Multiply => {
            let v = &operands[1].value[..];
            sum(
                du.map(|du| join(&[du, v, &[Multiply]])),
                operands[1].slope.as_deref().map(|dv| join(&[u, dv, &[Multiply]])),
            )
        }
        Divide => {
            let v = &operands[1].value[..];
            let by_second = |dv: &[Op]| join(&[u, dv, &[Multiply, Negate], v, v, &[Multiply, Divide]]);
            sum(du.map(|du| join(&[du, v, &[Divide]])), operands[1].slope.as_deref().map(by_second))
        }
        Power => {
            let v = &operands[1].value[..];
            let by_base = |du: &[Op]| join(&[v, u, v, &[Number(1.0), Subtract, Power, Multiply], du, &[Multiply]]);
            let by_power =
                |dv: &[Op]| join(&[u, v, &[Power], u, &[Op::Smooth(Smooth::Log), Multiply], dv, &[Multiply]]);
            sum(du.map(by_base), operands[1].slope.as_deref().map(by_power))
        }
        Negate => du.map(|du| join(&[du, &[Negate]])),
        Op::Smooth(function) | Op::Untouched(function) => {
            let slope = smooth(function, u);
            du.map(|du| join(&[&slope, du, &[Multiply]]))
        }
        Op::Abs => return switch("abs"),
        Op::Sign => return switch("sign"),
        Op::Step => return switch("step"),
        Op::Min => return switch("min"),
        Op::Max => return switch("max"),
        Op::Atan2 => return switch("atan2"),
        Op::AsinSin => return switch("asin"),
        Op::AcosCos => return switch("acos"),
        Number(_) | Op::Time | Op::Column(_) => None,
    })
}

fn sum(first: Option<Vec<Op>>, second: Option<Vec<Op>>) -> Option<Vec<Op>> {
    match (first, second) {
        (Some(first), Some(second)) => Some([first, second, vec![Op::Add]].concat()),
        (one, other) => one.or(other),
    }
}

/// The derivative of a function at `u`.
fn smooth(function: Smooth, u: &[Op]) -> Vec<Op> {
    use Op::{Add, Divide, Multiply, Negate, Number, Subtract};
    let of = |function| [u, &[Op::Smooth(function)]].concat();
    // 1 ± x².
    let one_and = |x: Vec<Op>, sign: Op| [vec![Number(1.0)], x.clone(), x, vec![Multiply, sign]].concat();
    let over = |below: Vec<Op>| [vec![Number(1.0)], below, vec![Divide]].concat();
    let root = |x: Vec<Op>| [x, vec![Op::Smooth(Smooth::Sqrt)]].concat();
    match function {
        Smooth::Sin => of(Smooth::Cos),
        Smooth::Cos => [of(Smooth::Sin), vec![Negate]].concat(),
        Smooth::Tan => one_and(of(Smooth::Tan), Add),
        Smooth::Asin => over(root(one_and(u.to_vec(), Subtract))),
        Smooth::Acos => [over(root(one_and(u.to_vec(), Subtract))), vec![Negate]].concat(),
        Smooth::Atan => over(one_and(u.to_vec(), Add)),
        Smooth::Sinh => of(Smooth::Cosh),
        Smooth::Cosh => of(Smooth::Sinh),
        Smooth::Tanh => one_and(of(Smooth::Tanh), Subtract),
        Smooth::Exp => of(Smooth::Exp),
        Smooth::Log => over(u.to_vec()),
        Smooth::Sqrt => [vec![Number(0.5)], of(Smooth::Sqrt), vec![Divide]].concat(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_are_derivatives() {
        let texts = [
            "A*sin(2*pi*f*t)",
            "f/(A + t)",
            "(A*t)^f + f^2 - 2^A",
            "exp(-A*t)*cos(f*t) - tan(0.1*A)",
            "log(1 + f*t)/sqrt(A)",
            "tanh(A*t) + sinh(0.2*f) + cosh(A) + atan(f*t)",
            "asin(0.1*A) + acos(0.1*f*t)",
            "A*abs(sin(3*t)) + f*step(t - 0.2) - A*max(t, 0.1)",
            "-A - (3 - f)",
        ];
        let values = [1.3, 0.7];
        for text in texts {
            for which in 0..2 {
                let constants: Vec<(String, f64, f64)> = ["A", "f"]
                    .into_iter()
                    .zip(values)
                    .enumerate()
                    .map(|(k, (name, value))| (name.to_owned(), value, if k == which { 2.0 } else { 0.0 }))
                    .collect();
                let slope = Expression::slope(text, &constants).unwrap();
                for t in [0.05, 0.43, 1.7] {
                    let at = |d: f64| {
                        let moved: Vec<(String, f64)> =
                            constants.iter().map(|(name, value, slope)| (name.clone(), value + slope * d)).collect();
                        Expression::parse_with(text, &moved).unwrap().value(t)
                    };
                    let d = 1e-4;
                    let difference = (8.0 * (at(d) - at(-d)) - (at(2.0 * d) - at(-2.0 * d))) / (12.0 * d);
                    let found = slope.value(t);
                    assert!(
                        (found - difference).abs() < 1e-9 * (1.0 + found.abs()),
                        "{text} by {which} at {t}: {found} {difference}"
                    );
                }
            }
        }
    }

    #[test]
    fn what_bends_where_the_constant_has_it_is_told() {
        let by = [("A".to_owned(), 0.3, 1.0)];
        for (text, function) in [("step(t - A)", "step"), ("min(A, t)", "min"), ("abs(t - A)", "abs")] {
            assert_eq!(Expression::slope(text, &by).unwrap_err(), SlopeError::Switch { function });
        }
        assert!(matches!(Expression::slope("B", &by), Err(SlopeError::Expression(_))));
        // A constant that nothing follows from.
        assert_eq!(Expression::slope("2*t", &by).unwrap().is_constant(), Some(0.0));
    }
}
