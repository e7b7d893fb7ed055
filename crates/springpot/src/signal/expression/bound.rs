//! An expression of a stroke and its rate whose parameters are numbers, made ready to be asked often.

use super::of_stroke::{StrokeExpression, VARIABLES};
use super::program::{MAX_STACK, Op, Trace, argument, binary, operands_from, unary};
use crate::signal::gradient::Gradient;
use crate::signal::jet::Value;

/// Most intermediate results of what is asked on a small stack.
const FEW: usize = 4;

/// An instruction: one of the program, or one that takes a number from it.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Step {
    Number(f64),
    Variable(usize),
    Scale(f64),
    Shift(f64),
    Power(f64),
    Other(Op),
}

/// f(x, v) of numbers.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BoundExpression {
    steps: Vec<Step>,
    /// Whether a small stack will do.
    is_low: bool,
    has_kinks: bool,
}

impl StrokeExpression {
    /// With these values of its parameters.
    pub(crate) fn bind(&self, values: &[f64]) -> BoundExpression {
        let numbers = self.program.iter().map(|op| match op {
            Op::Column(k) if *k >= VARIABLES.len() => Op::Number(values[k - VARIABLES.len()]),
            op => *op,
        });
        let program: Vec<Op> = numbers.collect();
        let mut steps = vec![None; program.len()];
        for (at, op) in program.iter().enumerate() {
            steps[at] = Some(match op {
                Op::Number(value) => Step::Number(*value),
                Op::Column(k) => Step::Variable(*k),
                op => Step::Other(*op),
            });
            if op.operands() != 2 {
                continue;
            }
            // The second operand ends before the instruction, the first one before the second.
            let second = operands_from(&program, at, 1);
            let (first, of_first) = (operands_from(&program, second, 1), second - 1);
            let [is_first, is_second] = [first == of_first, second + 1 == at];
            let number = |at: usize| match program[at] {
                Op::Number(value) => Some(value),
                _ => None,
            };
            let [a, b] = [is_first.then(|| number(first)).flatten(), is_second.then(|| number(second)).flatten()];
            let fused = match (op, a, b) {
                (Op::Multiply, Some(a), _) => Some((first, Step::Scale(a))),
                (Op::Multiply, None, Some(b)) => Some((second, Step::Scale(b))),
                (Op::Add, Some(a), _) => Some((first, Step::Shift(a))),
                (Op::Add, None, Some(b)) => Some((second, Step::Shift(b))),
                (Op::Subtract, None, Some(b)) => Some((second, Step::Shift(-b))),
                (Op::Power, None, Some(b)) => Some((second, Step::Power(b))),
                _ => None,
            };
            if let Some((number, step)) = fused {
                (steps[number], steps[at]) = (None, Some(step));
            }
        }
        let steps: Vec<Step> = steps.into_iter().flatten().collect();
        let (mut height, mut most) = (0, 0);
        for step in &steps {
            height = match step {
                Step::Number(_) | Step::Variable(_) => height + 1,
                Step::Other(op) => height + 1 - op.operands(),
                _ => height,
            };
            most = most.max(height);
        }
        BoundExpression { steps, is_low: most <= FEW, has_kinks: self.has_kinks() }
    }
}

impl BoundExpression {
    /// Whether it has kinks.
    pub(crate) fn has_kinks(&self) -> bool {
        self.has_kinks
    }

    /// f(x, v).
    pub(crate) fn value(&self, x: f64, v: f64) -> f64 {
        self.run([x, v], &mut Trace::default())
    }

    /// The value and its derivatives by stroke and rate; at a kink those of the side above.
    pub(crate) fn gradient(&self, x: f64, v: f64) -> Gradient {
        let variables = [Gradient { value: x, by: [1.0, 0.0] }, Gradient { value: v, by: [0.0, 1.0] }];
        self.run(variables, &mut Trace::default())
    }

    /// A bit for each of its kinks: on which side it is.
    pub(crate) fn branch(&self, x: f64, v: f64) -> u64 {
        let mut trace = Trace::default();
        self.run([x, v], &mut trace);
        trace.branch
    }

    /// Hands over what passes zero at its kinks ([`StrokeExpression::kinks`]).
    pub(crate) fn kinks(&self, x: f64, v: f64, take: &mut dyn FnMut(f64)) {
        if self.has_kinks {
            self.carry_out::<f64, MAX_STACK>([x, v], &mut Trace::default(), &mut |op, operands| {
                argument(op, operands).into_iter().for_each(&mut *take);
            });
        }
    }

    /// What passes zero at kink `bit` of [`Self::branch`].
    pub(crate) fn argument(&self, bit: u32, x: f64, v: f64) -> Option<f64> {
        let (mut kinks, mut found) = (0, None);
        self.carry_out::<f64, MAX_STACK>([x, v], &mut Trace::default(), &mut |op, operands| {
            if op.has_kink() {
                found = if kinks == bit { argument(op, operands) } else { found };
                kinks += 1;
            }
        });
        found
    }

    fn run<V: Value>(&self, variables: [V; VARIABLES.len()], trace: &mut Trace<'_>) -> V {
        match self.is_low {
            true => self.carry_out::<V, FEW>(variables, trace, &mut |_, _| ()),
            false => self.carry_out::<V, MAX_STACK>(variables, trace, &mut |_, _| ()),
        }
    }

    /// The value; `before` is shown every instruction of the program with what lies on the stack.
    #[inline(always)]
    fn carry_out<V: Value, const STACK: usize>(
        &self,
        variables: [V; VARIABLES.len()],
        trace: &mut Trace<'_>,
        before: &mut impl FnMut(Op, &[V]),
    ) -> V {
        let (mut stack, mut top) = ([variables[0]; STACK], 0);
        for step in &self.steps {
            match *step {
                Step::Number(value) => {
                    stack[top] = V::constant(value);
                    top += 1;
                }
                Step::Variable(k) => {
                    stack[top] = variables[k];
                    top += 1;
                }
                Step::Scale(factor) => stack[top - 1] = stack[top - 1].scale(factor),
                Step::Shift(by) => stack[top - 1] = stack[top - 1].shift(by),
                Step::Power(exponent) => stack[top - 1] = stack[top - 1].pow(V::constant(exponent)),
                Step::Other(op) => {
                    before(op, &stack[..top]);
                    top -= op.operands();
                    stack[top] = match op.operands() {
                        1 => unary(op, stack[top], trace),
                        _ => binary(op, stack[top], stack[top + 1], trace),
                    };
                    top += 1;
                }
            }
        }
        stack[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dual::Dual;

    #[test]
    fn what_is_bound_is_the_same() {
        for text in [
            "k*x + b*x^3 + c*v*abs(v)",
            "(k + x)*(2 - b*v)/c - x^c",
            "max(k*x - b, 0) + min(v*c, x - 1) + sign(x - b)*k",
            "k - (b - (c - x*(v - k/(x + b))))",
            "2*x + x*2 + 1 - x + (x - 1)",
            "((((x + k)*v + b)*x + (c*v - x*k)*(v + 1))*(x - (v*(k + x*(b + v*(c + x))))))",
            "k",
        ] {
            let force = StrokeExpression::parse(text).unwrap();
            let values = &[1.3, 0.4, 2.7][..force.parameters().len()];
            let numbers: Vec<Dual> = values.iter().map(|value| Dual::from(*value)).collect();
            let bound = force.bind(values);
            for (x, v) in [(0.3, -0.7), (-1.2, 0.6), (2.0, 1.9)] {
                let close = |a: f64, b: f64| (a - b).abs() <= 1e-14 * (1.0 + b.abs()) || (a.is_nan() && b.is_nan());
                let own = bound.gradient(x, v);
                let along = |x, v| force.value_of::<Dual>(x, v, &numbers);
                let by_x = along(Dual::variable(x), v.into());
                let by_v = along(x.into(), Dual::variable(v));
                assert!(close(own.value, by_x.value) && close(bound.value(x, v), by_x.value), "{text}");
                assert!(
                    close(own.by[0], by_x.slope) && close(own.by[1], by_v.slope),
                    "{text}: {own:?} {by_x:?} {by_v:?}"
                );
                let [mut own, mut wanted] = [Vec::new(), Vec::new()];
                bound.kinks(x, v, &mut |argument| own.push(argument));
                force.kinks::<f64>(x, v, &numbers, &mut |kink| wanted.push(kink.argument));
                assert_eq!(own.len(), wanted.len(), "{text}");
                assert!(own.iter().zip(&wanted).all(|(a, b)| close(*a, *b)), "{text}");
            }
        }
    }
}
