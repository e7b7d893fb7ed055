//! What an expression does in a cell of time, without asking at single times: bounds of its derivatives, and whether any of its
//! kinks lies there.

use super::branch::Branch;
use super::formula::Expression;
use super::program::{MAX_STACK, Op, Trace, argument, stack_after, triangle};
use crate::signal::jet::{Jet, Smooth};
use crate::signal::series::Series;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// An expression seen over a whole cell.
#[derive(Debug, Clone)]
pub(in crate::signal) struct Look {
    /// Bounds of the expression; in a cell with a kink they are those of all its branches.
    pub(in crate::signal) series: Series,
    /// The kinks that switch in the cell.
    pub(in crate::signal) crossing: Branch,
    /// Whether a kink may switch several times, as far as bounds over the whole cell can tell.
    pub(in crate::signal) is_unsettled: bool,
}

/// What a kink does in a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Verdict {
    /// It stays on this side: true is below.
    Stays(bool),
    Unknown,
}

pub(super) struct Judge<'s> {
    /// Sides just after the start of the cell, and at its end.
    sides: &'s [Branch; 2],
    count: usize,
    crossing: Branch,
    is_unsettled: bool,
    /// Of the last kink.
    pub(super) last: Verdict,
}

impl<'s> Judge<'s> {
    pub(super) fn new(sides: &'s [Branch; 2]) -> Self {
        Self { sides, count: 0, crossing: Branch::default(), is_unsettled: false, last: Verdict::Unknown }
    }

    /// The next kink, whose argument is `u`.
    fn side(&mut self, u: &Series) -> Verdict {
        let value = u.value();
        let known = if value.lo > 0.0 || value.is_zero() {
            Some(false)
        } else if value.hi < 0.0 {
            Some(true)
        } else {
            None
        };
        self.settle(known, u.is_monotone())
    }

    /// The next kink, where it need not be looked at: whatever its argument does, nothing turns.
    fn pass(&mut self) -> Verdict {
        self.count += 1;
        self.last = Verdict::Stays(false);
        self.last
    }

    /// The next kink of a function whose domain ends where `is_inside` does not hold; it turns where u' changes its sign.
    fn touch(&mut self, u: &Series, is_inside: bool) {
        if is_inside || u.is_monotone() {
            self.pass();
        } else {
            self.settle(None, u.at[2].lo >= 0.0 || u.at[2].hi <= 0.0);
        }
    }

    fn settle(&mut self, known: Option<bool>, once: bool) -> Verdict {
        let kink = self.count;
        self.count += 1;
        let [before, after] = [0, 1].map(|end| self.sides[end].is_below(kink));
        self.last = if before != after {
            self.crossing.set(kink);
            Verdict::Unknown
        } else if known.is_some() || once {
            // Beside a kink bounds may be on its other side, by rounding.
            Verdict::Stays(before)
        } else {
            self.is_unsettled = true;
            Verdict::Unknown
        };
        self.last
    }
}

impl Expression {
    /// The cell from `a` to `b`, `sides` being [`branch`](Self::branch) at its ends.
    pub(in crate::signal) fn look(&self, a: f64, b: f64, sides: &[Branch; 2]) -> Look {
        let mut judge = Judge::new(sides);
        let time = Series::time(a, b);
        let mut stack = [time; MAX_STACK];
        let mut top = 0;
        for &op in &self.program {
            top -= op.operands();
            stack[top] = match op.operands() {
                0 => operand(op, &time),
                1 => unary(op, &stack[top], &mut judge),
                _ => binary(op, &stack[top], &stack[top + 1], &mut judge),
            };
            top += 1;
        }
        Look { series: stack[0], crossing: judge.crossing, is_unsettled: judge.is_unsettled }
    }

    /// The argument at `t` whose sign is that of this kink; it and its slope.
    pub(in crate::signal) fn kink_argument(&self, wanted: usize, t: f64) -> (f64, f64) {
        // The argument is what stands on the stack when the kink's turn comes: the program up to there leaves it on top.
        let mut kinks = self.program.iter().enumerate().filter(|(_, op)| op.has_kink());
        let Some((at, &op)) = kinks.nth(wanted) else { return (f64::NAN, f64::NAN) };
        let (stack, top) = stack_after::<Jet, MAX_STACK>(
            &self.program[..at],
            Jet::time(t),
            &|_| Jet::default(),
            &mut Trace::default(),
        );
        match argument(op, &stack[..top]) {
            Some(argument) => (argument.value, argument.first),
            None => (stack[top - 1].first, stack[top - 1].second),
        }
    }
}

/// What an instruction leaves of these operands, as many of them as it takes.
pub(super) fn result(op: Op, time: &Series, operands: &[Series; 2], judge: &mut Judge<'_>) -> Series {
    match op.operands() {
        0 => operand(op, time),
        1 => unary(op, &operands[0], judge),
        _ => binary(op, &operands[0], &operands[1], judge),
    }
}

fn operand(op: Op, time: &Series) -> Series {
    match op {
        Op::Number(value) => time.constant(value),
        _ => *time,
    }
}

fn unary(op: Op, u: &Series, judge: &mut Judge<'_>) -> Series {
    match op {
        Op::Smooth(function) => {
            let value = u.value();
            match function {
                Smooth::Sqrt => judge.touch(u, value.lo > 0.0),
                Smooth::Asin | Smooth::Acos => judge.touch(u, value.lo > -1.0 && value.hi < 1.0),
                _ => {}
            }
            function.bound(u)
        }
        Op::Untouched(function) => function.bound(u),
        Op::Negate => u.neg(),
        Op::AsinSin => fold(u, judge.side(&Smooth::Cos.bound(u)), -FRAC_PI_2, triangle),
        Op::AcosCos => fold(u, judge.side(&Smooth::Sin.bound(u)), 0.0, |x| (x - TAU * (x / TAU).round()).abs()),
        Op::Abs => match judge.side(u) {
            Verdict::Stays(false) => *u,
            Verdict::Stays(true) => u.neg(),
            Verdict::Unknown => u.either(&u.neg()),
        },
        Op::Sign => step(u, judge.side(u), -1.0),
        _ => step(u, judge.side(u), 0.0),
    }
}

/// A function that is `low` below zero and 1 above.
fn step(u: &Series, verdict: Verdict, low: f64) -> Series {
    match verdict {
        Verdict::Stays(true) => u.constant(low),
        // sign(0) is 0.
        Verdict::Stays(false) if u.value().is_zero() && low < 0.0 => u.constant(0.0),
        Verdict::Stays(false) => u.constant(1.0),
        Verdict::Unknown => u.constant(low).either(&u.constant(1.0)),
    }
}

/// A triangle wave of height π from `low`.
fn fold(u: &Series, verdict: Verdict, low: f64, value: impl Fn(f64) -> f64) -> Series {
    match verdict {
        Verdict::Stays(falls) => u.along_fold(if falls { -1.0 } else { 1.0 }, [low, low + PI], value),
        Verdict::Unknown => u.within(low, low + PI),
    }
}

fn binary(op: Op, first: &Series, second: &Series, judge: &mut Judge<'_>) -> Series {
    match op {
        Op::Add => first.add(second),
        Op::Subtract => first.sub(second),
        Op::Multiply => first.mul(second),
        Op::Divide => first.div(second),
        Op::Power => first.pow(second),
        Op::Atan2 => {
            let (y, x) = (first.value(), second.value());
            let verdict = if x.lo > 0.0 || y.lo > 0.0 || y.hi < 0.0 {
                judge.pass()
            } else if x.hi < 0.0 {
                judge.side(first)
            } else {
                judge.settle(None, false)
            };
            match verdict {
                Verdict::Stays(_) => first.atan2(second),
                Verdict::Unknown => first.within(-PI, PI),
            }
        }
        _ => match judge.side(&first.sub(second)) {
            Verdict::Stays(below) if below == (op == Op::Min) => *first,
            Verdict::Stays(_) => *second,
            Verdict::Unknown => {
                let either = first.either(second);
                let (a, b) = (first.value(), second.value());
                match op {
                    Op::Min => either.bounded(a.lo.min(b.lo), a.hi.min(b.hi)),
                    _ => either.bounded(a.lo.max(b.lo), a.hi.max(b.hi)),
                }
            }
        },
    }
}
