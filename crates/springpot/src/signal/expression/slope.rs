//! The derivative of an expression by a number that its constants follow from.

use super::error::ExpressionError;
use super::formula::Expression;
use super::parse;
use super::program::{MAX_STACK, Op};
use crate::signal::jet::Smooth;

/// Longest program of a derivative, in instructions.
const MOST: usize = 1 << 16;

/// Beside what has a logarithm.
const LEAST: f64 = 1e-150;

/// Why an expression has no derivative by a number that its constants follow from.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SlopeError {
    /// It is no expression.
    #[error(transparent)]
    Expression(#[from] ExpressionError),
    /// The number moves where a function jumps, in one way or another.
    #[error("`{function}` jumps where the constant has it")]
    Switch {
        /// The function.
        function: &'static str,
    },
    /// The derivative is too long.
    #[error("its derivative is too long an expression")]
    TooLong,
}

/// The derivative of an expression by a number that its constants follow from.
#[derive(Debug, Clone, PartialEq)]
pub struct Slope {
    /// The derivative at fixed t.
    pub function: Expression,
    /// Where it jumps at times that the number moves.
    pub jumps: Vec<MovedJump>,
}

/// A jump at a time that a number moves.
#[derive(Debug, Clone, PartialEq)]
pub struct MovedJump {
    /// Passes zero at the jump.
    pub argument: Expression,
    /// Its derivative by the number.
    pub slope: Expression,
}

/// An operand: its program, and that of its derivative where it has one.
struct Part {
    value: Vec<Op>,
    slope: Option<Vec<Op>>,
}

impl Expression {
    /// The derivative of `source` by a number with which each of `constants` (name, value, slope) changes by its slope: as a function of t. Exact:
    /// the program of the expression is differentiated. Where abs, min and max bend it jumps; what jumps itself, sign and step, is told with the
    /// argument that passes zero there.
    ///
    /// ```
    /// use springpot::signal::Expression;
    ///
    /// // d/df of A·sin(2πft) at f = 2.
    /// let slope = Expression::slope("A*sin(2*pi*f*t)", &[("A".into(), 0.5, 0.0), ("f".into(), 2.0, 1.0)])?;
    /// assert!((slope.function.value(0.5) - 0.5 * std::f64::consts::PI).abs() < 1e-15);
    /// # Ok::<(), springpot::signal::SlopeError>(())
    /// ```
    ///
    /// # Errors
    /// What is no expression; atan2 of what the number moves, whose cut moves with it.
    pub fn slope(source: &str, constants: &[(String, f64, f64)]) -> Result<Slope, SlopeError> {
        let names: Vec<&str> = constants.iter().map(|(name, ..)| name.as_str()).collect();
        let program = parse::program_of_open(source, &names)?;
        let (mut parts, mut jumps): (Vec<Part>, Vec<MovedJump>) = (Vec::new(), Vec::new());
        for op in program {
            let part = match op {
                Op::Column(k) => {
                    let (_, value, slope) = constants[k];
                    Part { value: vec![Op::Number(value)], slope: (slope != 0.0).then(|| vec![Op::Number(slope)]) }
                }
                _ => {
                    let operands = parts.split_off(parts.len() - op.operands());
                    if let (Op::Sign | Op::Step, [Part { value, slope: Some(slope) }]) = (op, &operands[..]) {
                        let argument = Self::of_program(source, value.clone())?;
                        jumps.push(MovedJump { argument, slope: Self::of_program(source, slope.clone())? });
                    }
                    derived(op, operands)?
                }
            };
            if part.value.len() + part.slope.as_ref().map_or(0, Vec::len) > MOST {
                return Err(SlopeError::TooLong);
            }
            parts.push(part);
        }
        let program = parts.pop().and_then(|part| part.slope).unwrap_or_else(|| vec![Op::Number(0.0)]);
        Ok(Slope { function: Self::of_program(&format!("d({source})"), program)?, jumps })
    }

    fn of_program(source: &str, program: Vec<Op>) -> Result<Self, SlopeError> {
        if height(&program) > MAX_STACK {
            return Err(SlopeError::TooLong);
        }
        let kinks = program.iter().filter(|op| op.has_kink()).count();
        let own = Self { source: source.to_owned(), program, kinks };
        if own.program.contains(&Op::Time) {
            return Ok(own);
        }
        // What does not follow from time is a number.
        let value = own.value(0.0);
        Ok(Self { program: vec![Op::Number(value)], kinks: 0, ..own })
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
            // So little more than the base changes no logarithm but that of 0, where the power before it is stronger.
            let log = [Number(LEAST), Add, Op::Smooth(Smooth::Log), Multiply];
            let by_power = |dv: &[Op]| join(&[u, v, &[Power], u, &log, dv, &[Multiply]]);
            sum(du.map(by_base), operands[1].slope.as_deref().map(by_power))
        }
        Negate => du.map(|du| join(&[du, &[Negate]])),
        Op::Smooth(function) | Op::Untouched(function) => {
            let slope = smooth(function, u);
            du.map(|du| join(&[&slope, du, &[Multiply]]))
        }
        Op::Abs => du.map(|du| join(&[u, &[Op::Sign], du, &[Multiply]])),
        Op::AsinSin => du.map(|du| join(&[u, &[Op::Smooth(Smooth::Cos), Op::Sign], du, &[Multiply]])),
        Op::AcosCos => du.map(|du| join(&[u, &[Op::Smooth(Smooth::Sin), Op::Sign], du, &[Multiply]])),
        Op::Min | Op::Max => {
            // The first one counts where v − u, u − v of a maximum, is positive.
            let v = &operands[1].value[..];
            let [first, second] = if op == Op::Min { [v, u] } else { [u, v] };
            let chosen =
                |one: &[Op], other: &[Op], slope: &[Op]| join(&[one, other, &[Subtract, Op::Step], slope, &[Multiply]]);
            let dv = operands[1].slope.as_deref();
            sum(du.map(|du| chosen(first, second, du)), dv.map(|dv| chosen(second, first, dv)))
        }
        // Constant but for the jump itself, which is told.
        Op::Sign | Op::Step => None,
        Op::Atan2 => return switch("atan2"),
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
            "abs(A*t - f) + min(A*t, f)^2 - max(f*t, 0.3*A) + asin(sin(3*A*t)) + acos(cos(f*t - 4))",
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
                    let found = slope.function.value(t);
                    assert!(
                        (found - difference).abs() < 1e-9 * (1.0 + found.abs()),
                        "{text} by {which} at {t}: {found} {difference}"
                    );
                }
            }
        }
    }

    #[test]
    fn jumps_that_move_are_told() {
        let by = [("A".to_owned(), 0.3, 1.0), ("f".to_owned(), 2.0, 0.0)];
        let slope = Expression::slope("f*step(t - 2*A) + A*sign(f*t - 1)*t", &by).unwrap();
        let [jump] = &slope.jumps[..] else { panic!("{:?}", slope.jumps) };
        assert_eq!([jump.argument.value(0.6), jump.argument.at(0.6).first, jump.slope.value(0.6)], [0.0, 1.0, -2.0]);
        assert_eq!([0.2, 0.9].map(|t| slope.function.value(t)), [-0.2, 0.9]);
        assert_eq!(Expression::slope("atan2(A, t - 1)", &by).unwrap_err(), SlopeError::Switch { function: "atan2" });
        assert!(matches!(Expression::slope("B", &by), Err(SlopeError::Expression(_))));
        // A constant that nothing follows from.
        assert_eq!(Expression::slope("2*t", &by).unwrap().function.is_constant(), Some(0.0));
    }
}
