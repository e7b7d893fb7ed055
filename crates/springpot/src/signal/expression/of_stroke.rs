//! An expression as the law of a force: a function of a stroke, its rate and parameters.

use super::error::ExpressionError;
use super::parse::program_of_stroke;
use super::program::{MAX_KINKS, MAX_STACK, Op, Trace, argument, carry_out, run_on};
use crate::dual::{Dual, Real};
use crate::signal::jet::Jet;
use std::fmt;

/// Variables of such an expression: stroke and rate.
pub(super) const VARIABLES: [&str; 2] = ["x", "v"];

/// A function of the stroke `x`, of its rate `v` and of parameters, which are all the other names that occur in it; otherwise as
/// [`super::Expression`], without `t`.
///
/// ```
/// use springpot::signal::StrokeExpression;
/// let force = StrokeExpression::parse("k*x + c*v*abs(v)")?;
/// assert_eq!(force.parameters(), ["k", "c"]);
/// assert_eq!(force.value(0.5, -2.0, &[10.0, 3.0]), -7.0);
/// # Ok::<(), springpot::signal::ExpressionError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct StrokeExpression {
    source: String,
    /// Its columns are x, v and the parameters.
    pub(super) program: Vec<Op>,
    parameters: Vec<String>,
}

/// A kink of such an expression.
pub(crate) struct Kink<V> {
    /// It passes zero there.
    pub(crate) argument: V,
    /// The value may jump there.
    pub(crate) jumps: bool,
}

/// How a part of an expression follows from strokes and rates.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Follows {
    Not,
    Affinely,
    Otherwise,
}

impl StrokeExpression {
    /// Reads an expression; a name that no expression knows and that no parenthesis follows is a parameter.
    ///
    /// # Errors
    /// As [`super::Expression::parse`]; [`ExpressionError::Time`] where it names t.
    pub fn parse(source: &str) -> Result<Self, ExpressionError> {
        let (program, parameters) = program_of_stroke(source)?;
        let kinks = program.iter().filter(|op| op.has_kink()).count();
        if kinks > MAX_KINKS {
            return Err(ExpressionError::TooManyKinks { given: kinks, limit: MAX_KINKS });
        }
        Ok(Self { source: source.trim().to_owned(), program, parameters })
    }

    /// The text it was read from.
    pub fn source(&self) -> &str {
        &self.source
    }

    /// The names of its parameters, in the order in which they occur.
    pub fn parameters(&self) -> &[String] {
        &self.parameters
    }

    /// The value at the stroke `x` and the rate `v`, `values` being those of [`Self::parameters`]; NaN and infinities are returned as they are.
    ///
    /// # Panics
    /// Where there are fewer values than parameters.
    pub fn value(&self, x: f64, v: f64, values: &[f64]) -> f64 {
        run_on(&self.program, 0.0, &|k| column([x, v], k, |k| values[k]), &mut Trace::default())
    }

    /// The value with what changes of it.
    pub(crate) fn value_of<T: Real>(&self, x: T, v: T, numbers: &[Dual]) -> T {
        let jet = |number: T| Jet { value: number.value(), first: number.slope(), second: 0.0 };
        let columns = |k: usize| jet(column([x, v], k, |k| T::of(numbers[k])));
        let Jet { value, first: slope, .. } = run_on(&self.program, Jet::default(), &columns, &mut Trace::default());
        T::of(Dual { value, slope })
    }

    /// Hands over its kinks, always as many in one order; functions that end somewhere have none there.
    pub(crate) fn kinks<T: Real>(&self, x: T, v: T, numbers: &[Dual], take: &mut dyn FnMut(Kink<T>)) {
        if !self.has_kinks() {
            return;
        }
        let jet = |number: T| Jet { value: number.value(), first: number.slope(), second: 0.0 };
        let columns = |k: usize| jet(column([x, v], k, |k| T::of(numbers[k])));
        let (mut stack, mut top, mut trace) = ([Jet::default(); MAX_STACK], 0, Trace::default());
        for &op in &self.program {
            if let Some(Jet { value, first: slope, .. }) = argument(op, &stack[..top]) {
                take(Kink { argument: T::of(Dual { value, slope }), jumps: op.may_jump() });
            }
            carry_out(op, &mut stack, &mut top, Jet::default(), &columns, &mut trace);
        }
    }

    /// Whether it has kinks.
    pub(crate) fn has_kinks(&self) -> bool {
        self.program.iter().any(|op| op.has_kink())
    }

    /// Whether its value may jump.
    pub(crate) fn may_jump(&self) -> bool {
        self.program.iter().any(|op| op.may_jump())
    }

    /// Whether the rate occurs in it.
    pub(crate) fn has_rate(&self) -> bool {
        self.program.contains(&Op::Column(1))
    }

    /// Whether its value is an affine function of stroke and rate.
    pub(crate) fn is_affine(&self) -> bool {
        let mut stack = Vec::new();
        for op in &self.program {
            let operands: Vec<Follows> = stack.split_off(stack.len() - op.operands());
            let most = operands.iter().copied().max().unwrap_or(Follows::Not);
            stack.push(match (op, &operands[..]) {
                (Op::Column(0 | 1), _) => Follows::Affinely,
                (Op::Add | Op::Subtract | Op::Negate, _) => most,
                (Op::Multiply, [Follows::Not, _] | [_, Follows::Not]) | (Op::Divide, [_, Follows::Not]) => most,
                _ if most == Follows::Not => Follows::Not,
                _ => Follows::Otherwise,
            });
        }
        stack.last().is_none_or(|whole| *whole != Follows::Otherwise)
    }
}

/// Column `k`: a variable, or a parameter.
fn column<V: Copy>(variables: [V; VARIABLES.len()], k: usize, parameter: impl Fn(usize) -> V) -> V {
    match variables.get(k) {
        Some(variable) => *variable,
        None => parameter(k - VARIABLES.len()),
    }
}

/// The text it was read from.
impl fmt::Display for StrokeExpression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.source)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::gradient::Gradient;

    const TEXTS: [&str; 8] = [
        "k*x + b*x^3 + c*v*abs(v)",
        "k*tanh(x/b)*exp(-c*v^2)",
        "max(k*x - b, 0) + min(c*v, x)",
        "k*sign(x)*abs(x)^b + c*v",
        "(k + b*x)/(1 + x^2) - c^x + atan2(x, v)",
        "sqrt(k + x^2)*sin(b*v) + cosh(x)*log(c + v^2)",
        "x^v*step(x)",
        "asin(sin(k*x)) + acos(cos(b*v)) + c",
    ];

    #[test]
    fn derivatives_are_those_of_differences() {
        let values = [3.0, 1.7, 0.6];
        for text in TEXTS {
            let force = StrokeExpression::parse(text).unwrap();
            let order =
                force.parameters().iter().map(|name| ["k", "b", "c"].iter().position(|own| own == name).unwrap());
            let numbers: Vec<Dual> = order.map(|k| Dual::from(values[k])).collect();
            let plain = Dual::values(&numbers);
            for (x, v) in [(0.31, 0.83), (0.9, -0.4), (0.17, 2.1)] {
                let Gradient { value, by } = force.bind(&plain).gradient(x, v);
                assert!((value - force.value(x, v, &plain)).abs() <= 1e-14 * (1.0 + value.abs()), "{text}");
                let d = 1e-4;
                let difference =
                    |f: &dyn Fn(f64) -> f64| (8.0 * (f(d) - f(-d)) - (f(2.0 * d) - f(-2.0 * d))) / (12.0 * d);
                let by_x = difference(&|d| force.value(x + d, v, &plain));
                let by_v = difference(&|d| force.value(x, v + d, &plain));
                let close = |a: f64, b: f64| (a - b).abs() < 1e-9 * (1.0 + b.abs()) || (a.is_nan() && b.is_nan());
                assert!(close(by[0], by_x) && close(by[1], by_v), "{text} at {x}, {v}: {by:?} {by_x} {by_v}");
                for k in 0..numbers.len() {
                    let mut moved = numbers.clone();
                    moved[k].slope = 1.0;
                    let change = force.value_of::<Dual>(Dual::variable(x), v.into(), &moved).slope;
                    let by_k = difference(&|d| {
                        let mut plain = plain.clone();
                        plain[k] += d;
                        force.value(x + d, v, &plain)
                    });
                    assert!(close(change, by_k), "{text} by {k}: {change} {by_k}");
                }
            }
        }
    }

    #[test]
    fn it_is_known_for_what_it_is() {
        let of = |text: &str| StrokeExpression::parse(text).unwrap();
        for (text, affine, rate) in [
            ("k*x + c*v - f", true, true),
            ("-(x/k)*c", true, false),
            ("k^2*x", true, false),
            ("x^1", false, false),
            ("x*v", false, true),
            ("k/x", false, false),
            ("abs(k)*x", true, false),
            ("abs(x)", false, false),
            ("f", true, false),
        ] {
            assert_eq!((of(text).is_affine(), of(text).has_rate()), (affine, rate), "{text}");
        }
        assert!(of("k*step(x - a)").may_jump() && !of("abs(x)").may_jump());
        let mut arguments = Vec::new();
        of("max(x - a, 0) + c*abs(v)")
            .kinks(0.5, -2.0, &[0.1.into(), 3.0.into()], &mut |kink| arguments.push(kink.argument));
        assert_eq!(arguments, [0.4, -2.0]);
        let bound = of("abs(x)").bind(&[]);
        assert_ne!(bound.branch(1.0, 0.0), bound.branch(-1.0, 0.0));
    }

    #[test]
    fn what_is_none_is_refused() {
        let error = |text: &str| StrokeExpression::parse(text).unwrap_err();
        assert!(matches!(error("k*x + sin(t)"), ExpressionError::Time { at } if at == (10..11)));
        assert!(
            matches!(error("sine(x)"), ExpressionError::UnknownName { suggestion: Some(name), .. } if name == "sin")
        );
        assert!(
            matches!(error("np.sin(x)"), ExpressionError::UnknownName { suggestion: Some(name), .. } if name == "sin")
        );
        assert!(matches!(error("k x"), ExpressionError::Unexpected { .. }));
        assert!(matches!(error("k*x if x > 0"), ExpressionError::Condition { .. }));
        assert!(matches!(error(""), ExpressionError::UnexpectedEnd { .. }));
    }
}
