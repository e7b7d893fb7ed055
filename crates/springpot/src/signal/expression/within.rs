//! An expression of many kinks as far as a cell of time sees it: what its kinks choose there is carried out, so that a staircase of a
//! thousand steps is, between two of them, a number.

use super::branch::Branch;
use super::formula::Expression;
use super::look::{Judge, Verdict, result};
use super::program::{MAX_STACK, Op, Trace, run};
use crate::signal::series::Series;

impl Expression {
    /// An expression with the values of this one from `a` to `b`, but for rounding, and the kinks that may switch there; `sides` is [`branch`](Self::branch) at
    /// the ends.
    pub(in crate::signal) fn within(&self, a: f64, b: f64, sides: &[Branch; 2]) -> Self {
        let mut judge = Judge::new(sides);
        let time = Series::time(a, b);
        let (mut stack, mut starts, mut top) = ([time; MAX_STACK], [0; MAX_STACK], 0);
        let mut kept = Vec::new();
        for &op in &self.program {
            top -= op.operands();
            if op.operands() == 0 {
                starts[top] = kept.len();
            }
            let operands = [stack[top], stack[(top + 1).min(MAX_STACK - 1)]];
            stack[top] = result(op, &time, &operands, &mut judge);
            let second = starts[(top + 1).min(MAX_STACK - 1)];
            match judge.verdict().filter(|_| op.has_kink()) {
                Some(below) => choose(&mut kept, op, [starts[top], second], below, &operands[0]),
                None => {
                    kept.push(op);
                    fold(&mut kept, [starts[top], second], &operands);
                }
            }
            top += 1;
        }
        let kinks = kept.iter().filter(|op| op.has_kink()).count();
        Self { source: String::new(), program: kept, kinks }
    }
}

/// Carries out an instruction whose kink stays below or not; its operands begin at `starts`.
fn choose(kept: &mut Vec<Op>, op: Op, starts: [usize; 2], below: bool, argument: &Series) {
    let number = match op {
        Op::Step => f64::from(!below),
        Op::Sign if below => -1.0,
        Op::Sign => f64::from(!argument.value().is_zero()),
        Op::Abs => {
            return if below {
                kept.push(Op::Negate)
            };
        }
        Op::Min | Op::Max => {
            if below == (op == Op::Min) {
                kept.truncate(starts[1]);
            } else {
                kept.drain(starts[0]..starts[1]);
            }
            return;
        }
        Op::Smooth(function) => return kept.push(Op::Untouched(function)),
        _ => return kept.push(op),
    };
    kept.truncate(starts[0]);
    kept.push(Op::Number(number));
}

/// Carries out what the last instruction does to numbers; its operands begin at `starts` and have these bounds.
fn fold(kept: &mut Vec<Op>, starts: [usize; 2], operands: &[Series; 2]) {
    let Some((&op, before)) = kept.split_last() else { return };
    if op.operands() == 0 || before.len() <= starts[0] {
        return;
    }
    if before[starts[0]..].iter().all(|op| matches!(op, Op::Number(_))) {
        let value = run(&kept[starts[0]..], 0.0, &mut Trace::default());
        kept.truncate(starts[0]);
        return kept.push(Op::Number(value));
    }
    if op.operands() < 2 {
        return;
    }
    let single = |from: usize, to: usize| match before[from..to] {
        [Op::Number(value)] => Some(value),
        _ => None,
    };
    let (first, second) = (single(starts[0], starts[1]), single(starts[1], before.len()));
    let is_finite = |bounds: &Series| bounds.value().magnitude().is_finite();
    match (op, first, second) {
        (Op::Add | Op::Subtract, _, Some(0.0)) | (Op::Multiply | Op::Divide, _, Some(1.0)) => kept.truncate(starts[1]),
        (Op::Add, Some(0.0), _) | (Op::Multiply, Some(1.0), _) => {
            kept.pop();
            kept.remove(starts[0]);
        }
        (Op::Multiply, Some(0.0), _) if is_finite(&operands[1]) => kept.truncate(starts[1]),
        (Op::Multiply, _, Some(0.0)) if is_finite(&operands[0]) => {
            kept.truncate(starts[0]);
            kept.push(Op::Number(0.0));
        }
        // x ± a ± b.
        (Op::Add | Op::Subtract, _, Some(b)) => {
            if let [.., Op::Number(a), inner @ (Op::Add | Op::Subtract)] = before[..starts[1]] {
                let signed = |op: Op, value: f64| if op == Op::Add { value } else { -value };
                let sum = signed(inner, a) + signed(op, b);
                kept.truncate(starts[1] - 2);
                kept.extend([Op::Number(sum), Op::Add]);
            }
        }
        _ => {}
    }
}

impl Judge<'_> {
    /// The side on which the last kink stays; `None` where it may switch.
    fn verdict(&self) -> Option<bool> {
        match self.last {
            Verdict::Stays(below) => Some(below),
            Verdict::Unknown => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn within(text: &str, a: f64, b: f64) -> Expression {
        let whole = Expression::parse(text).unwrap();
        let narrow = whole.within(a, b, &[whole.branch(a), whole.branch(b)]);
        for k in 0..=200 {
            let t = a + (b - a) * f64::from(k) / 200.0;
            let (one, other) = (narrow.value(t), whole.value(t));
            assert!((one - other).abs() <= 1e-13 * other.abs().max(1.0), "{text} at {t}: {one} for {other}");
        }
        narrow
    }

    #[test]
    fn staircases_are_numbers_between_their_steps() {
        let stairs: String = (0..200).map(|k| format!(" + 0.25*step(t - {})", f64::from(k) * 0.01)).collect();
        let stairs = format!("sin(t){stairs}");
        assert_eq!(within(&stairs, 0.501, 0.509).program.len(), 4);
        assert_eq!(within(&stairs, 0.501, 0.519).kinks, 1);
        assert_eq!(within(&stairs, 2.5, 3.0).kinks, 0);
        let down: String = (0..200).rev().map(|k| format!(" - step(t - {})", f64::from(k) * 0.01)).collect();
        assert_eq!(within(&format!("0{down}"), 0.501, 0.509).program, [Op::Number(-51.0)]);
    }

    #[test]
    fn every_kink_that_stays_is_carried_out() {
        for (text, a, b, kinks) in [
            ("abs(t - 1)*2 + abs(t - 3)", 1.5, 2.5, 0),
            ("max(0, min(1, t - 1)) + max(0, min(1, t - 2))", 1.2, 1.9, 0),
            ("max(0, min(1, t - 1)) + max(0, min(1, t - 2))", 1.2, 2.1, 2),
            ("sign(t - 1)*sign(t) - sqrt(1 + t^2)", 0.1, 0.9, 0),
            ("(t - 1)*step(t - 1) + (t - 2)*step(t - 2)*step(5 - t)", 1.1, 1.9, 0),
            ("abs(sin(9*t))", 0.0, 3.0, 1),
            ("step(t - 1)/step(t)", 0.5, 2.0, 1),
            // Angles and waves have no simpler form on one side.
            ("atan2(sin(t), -1) + asin(sin(t))", 0.1, 0.9, 2),
            ("sign(0*t) + t", 0.1, 0.9, 0),
        ] {
            let narrow = within(text, a, b);
            assert!(narrow.kinks <= kinks, "{text}: {} kinks, {:?}", narrow.kinks, narrow.program);
        }
    }
}
