//! The terms of a sum: kinks of the sum are theirs.

use super::formula::Expression;
use super::program::{Op, operands_from};

impl Expression {
    /// The terms of the sum that it is, each with the factors that stand before or behind the sum; signs are dropped. Those without kinks are one.
    pub(in crate::signal) fn terms(&self) -> Vec<Self> {
        let (mut program, mut factors) = (&self.program[..], Vec::new());
        let mut terms: Vec<Vec<Op>> = Vec::new();
        let mut smooth: Vec<Op> = Vec::new();
        let mut take = |term: &[Op], factors: &[Op]| {
            if term.iter().any(|op| op.has_kink()) {
                terms.push([term, factors].concat());
                return;
            }
            let is_first = smooth.is_empty();
            smooth.extend_from_slice(term);
            smooth.extend_from_slice(factors);
            if !is_first {
                smooth.push(Op::Add);
            }
        };
        while let Some((&op, operands)) = program.split_last() {
            // The last operand begins here.
            let second = if op.operands() == 2 { operands_from(operands, operands.len(), 1) } else { 0 };
            match op {
                Op::Negate => program = operands,
                Op::Add | Op::Subtract => {
                    take(&operands[second..], &factors);
                    program = &operands[..second];
                }
                Op::Multiply | Op::Divide => match (&operands[..second], &operands[second..]) {
                    (inner, [Op::Number(factor)]) => {
                        factors.splice(0..0, [Op::Number(*factor), op]);
                        program = inner;
                    }
                    ([Op::Number(factor)], inner) if op == Op::Multiply => {
                        factors.splice(0..0, [Op::Number(*factor), op]);
                        program = inner;
                    }
                    _ => break,
                },
                _ => break,
            }
        }
        take(program, &factors);
        terms.extend((!smooth.is_empty()).then_some(smooth));
        let expression = |program: Vec<Op>| {
            let kinks = program.iter().filter(|op| op.has_kink()).count();
            Self { source: String::new(), program, kinks }
        };
        terms.into_iter().map(expression).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sum_is_its_terms() {
        let whole = Expression::parse("0.5*(sin(t) + abs(t - 1) - 2*max(t, 3) + t^2 - (step(t) + 1))/2").unwrap();
        let terms = whole.terms();
        assert_eq!(terms.iter().map(|term| term.kinks).collect::<Vec<_>>(), [1, 1, 1, 0]);
        for t in [0.3, 1.7, 4.0] {
            let [step, max, abs, smooth] = [0, 1, 2, 3].map(|k| terms[k].value(t));
            // Without the sign of what is taken off.
            assert!((smooth + abs - max - step - whole.value(t)).abs() < 1e-15);
        }
        assert_eq!(Expression::parse("max(t, abs(t - 1))").unwrap().terms().len(), 1);
    }
}
