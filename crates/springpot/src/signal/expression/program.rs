//! The program that an expression is, and what it is run on.

use crate::signal::jet::{Smooth, Value};
use std::f64::consts::{PI, TAU};

/// Longest text of an expression, in bytes.
pub const MAX_LENGTH: usize = 1 << 20;
/// Deepest nesting of an expression.
pub const MAX_DEPTH: usize = 64;
/// Most functions that may have a kink (abs, sign, step, min, max, atan2, sqrt, asin, acos) in one expression of columns; of time there may be any number.
pub const MAX_KINKS: usize = 64;
/// Most intermediate results at a time, and those of most expressions.
pub(super) const MAX_STACK: usize = 32;
pub(super) const SMALL_STACK: usize = 8;

/// One instruction; operands come before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Op {
    Number(f64),
    Time,
    /// The value of a column, by its place among those that the expression names.
    Column(usize),
    Negate,
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Smooth(Smooth),
    /// The same, where it stays away from the end of its domain.
    Untouched(Smooth),
    Abs,
    Sign,
    Step,
    Min,
    Max,
    Atan2,
    /// asin(sin u): a triangle wave.
    AsinSin,
    /// acos(cos u): a triangle wave.
    AcosCos,
}

impl Op {
    pub(super) fn operands(self) -> usize {
        match self {
            Self::Number(_) | Self::Time | Self::Column(_) => 0,
            Self::Negate | Self::Smooth(_) | Self::Untouched(_) | Self::Abs | Self::Sign | Self::Step => 1,
            Self::AsinSin | Self::AcosCos => 1,
            Self::Add | Self::Subtract | Self::Multiply | Self::Divide | Self::Power => 2,
            Self::Min | Self::Max | Self::Atan2 => 2,
        }
    }

    /// Whether its value may jump where it has a kink.
    pub(super) fn may_jump(self) -> bool {
        matches!(self, Self::Sign | Self::Step | Self::Atan2)
    }

    pub(super) fn has_kink(self) -> bool {
        match self {
            Self::Abs | Self::Sign | Self::Step | Self::Min | Self::Max | Self::Atan2 => true,
            Self::AsinSin | Self::AcosCos => true,
            Self::Smooth(function) => function.may_touch(),
            _ => false,
        }
    }
}

/// Where the last `wanted` operands of a program begin that ends before instruction `at`.
pub(super) fn operands_from(program: &[Op], at: usize, mut wanted: usize) -> usize {
    let mut first = at;
    while wanted > 0 {
        first -= 1;
        wanted = wanted - 1 + program[first].operands();
    }
    first
}

/// The function of the operands of a kink that passes zero there; of functions that end there `None`.
pub(super) fn argument<V: Value>(op: Op, operands: &[V]) -> Option<V> {
    match (op, operands) {
        (Op::Min | Op::Max, [.., first, second]) => Some(first.sub(*second)),
        (Op::Atan2, [.., first, _]) => Some(*first),
        (Op::Abs | Op::Sign | Op::Step, [.., own]) => Some(*own),
        (Op::AsinSin, [.., own]) => Some(Smooth::Cos.apply(*own)),
        (Op::AcosCos, [.., own]) => Some(Smooth::Sin.apply(*own)),
        _ => None,
    }
}

/// What a name stands for.
#[derive(Debug, Clone, Copy)]
pub(super) enum Name {
    Operand(Op),
    Function(Op),
}

pub(super) const NAMES: [(&str, Name); 22] = [
    ("t", Name::Operand(Op::Time)),
    ("pi", Name::Operand(Op::Number(std::f64::consts::PI))),
    ("\u{3c0}", Name::Operand(Op::Number(std::f64::consts::PI))),
    ("e", Name::Operand(Op::Number(std::f64::consts::E))),
    ("sin", Name::Function(Op::Smooth(Smooth::Sin))),
    ("cos", Name::Function(Op::Smooth(Smooth::Cos))),
    ("tan", Name::Function(Op::Smooth(Smooth::Tan))),
    ("asin", Name::Function(Op::Smooth(Smooth::Asin))),
    ("acos", Name::Function(Op::Smooth(Smooth::Acos))),
    ("atan", Name::Function(Op::Smooth(Smooth::Atan))),
    ("atan2", Name::Function(Op::Atan2)),
    ("sinh", Name::Function(Op::Smooth(Smooth::Sinh))),
    ("cosh", Name::Function(Op::Smooth(Smooth::Cosh))),
    ("tanh", Name::Function(Op::Smooth(Smooth::Tanh))),
    ("exp", Name::Function(Op::Smooth(Smooth::Exp))),
    ("log", Name::Function(Op::Smooth(Smooth::Log))),
    ("sqrt", Name::Function(Op::Smooth(Smooth::Sqrt))),
    ("abs", Name::Function(Op::Abs)),
    ("sign", Name::Function(Op::Sign)),
    ("min", Name::Function(Op::Min)),
    ("max", Name::Function(Op::Max)),
    ("step", Name::Function(Op::Step)),
];

pub(super) fn lookup(name: &str) -> Option<Name> {
    NAMES.iter().find(|(known, _)| *known == name).map(|(_, meaning)| *meaning)
}

/// Whether an expression knows this name.
pub fn is_name(name: &str) -> bool {
    lookup(name).is_some()
}

/// What kinks did while a program ran.
#[derive(Debug, Default)]
pub(super) struct Trace<'b> {
    /// The sides of the first 64.
    pub(super) branch: u64,
    /// Where those of the others are wanted: these, 64 at a time.
    pub(super) beyond: Option<&'b mut Vec<u64>>,
    /// Kinks so far.
    pub(super) count: u32,
    /// Whether the value is that of this instant alone.
    pub(super) turns: bool,
    /// The sides to be taken, in place of those where the arguments are; of 64 kinks at most.
    pub(super) held: Option<u64>,
}

impl Trace<'_> {
    /// On the sides of this branch, whatever the arguments are.
    pub(super) fn held(branch: u64) -> Self {
        Self { held: Some(branch), ..Self::default() }
    }

    pub(super) fn take(&mut self, below: bool) -> bool {
        let count = self.count;
        self.count += 1;
        if count >= u64::BITS {
            self.take_beyond(count, below);
            return below;
        }
        let below = self.held.map_or(below, |branch| branch >> count & 1 == 1);
        self.branch |= u64::from(below) << count;
        below
    }

    #[cold]
    fn take_beyond(&mut self, count: u32, below: bool) {
        let Some(beyond) = &mut self.beyond else { return };
        let (at, bit) = ((count / u64::BITS - 1) as usize, count % u64::BITS);
        if at == beyond.len() {
            beyond.push(0);
        }
        beyond[at] |= u64::from(below) << bit;
    }
}

/// Runs a program that `parse` has checked: operands present, at most `MAX_STACK` of them.
pub(super) fn run<V: Value>(program: &[Op], time: V, trace: &mut Trace<'_>) -> V {
    run_on(program, time, &|_| unreachable!("a program without columns"), trace)
}

/// As [`run`], where the program names columns.
pub(super) fn run_on<V: Value>(program: &[Op], time: V, columns: &dyn Fn(usize) -> V, trace: &mut Trace<'_>) -> V {
    // A stack of n takes 2n − 1 instructions at least.
    if program.len() < 2 * SMALL_STACK {
        stack_after::<V, SMALL_STACK>(program, time, columns, trace).0[0]
    } else {
        stack_after::<V, MAX_STACK>(program, time, columns, trace).0[0]
    }
}

/// The intermediate results that a program, or the beginning of one, leaves, and how many they are.
pub(super) fn stack_after<V: Value, const STACK: usize>(
    program: &[Op],
    time: V,
    columns: &dyn Fn(usize) -> V,
    trace: &mut Trace<'_>,
) -> ([V; STACK], usize) {
    let (mut stack, mut top) = ([time; STACK], 0);
    for &op in program {
        carry_out(op, &mut stack, &mut top, time, columns, trace);
    }
    (stack, top)
}

/// Carries out one instruction on the `top` intermediate results of a stack.
#[inline(always)]
pub(super) fn carry_out<V: Value>(
    op: Op,
    stack: &mut [V],
    top: &mut usize,
    time: V,
    columns: &dyn Fn(usize) -> V,
    trace: &mut Trace<'_>,
) {
    let result = match op.operands() {
        0 => match op {
            Op::Number(value) => V::constant(value),
            Op::Column(k) => columns(k),
            _ => time,
        },
        1 => {
            *top -= 1;
            unary(op, stack[*top], trace)
        }
        _ => {
            *top -= 2;
            binary(op, stack[*top], stack[*top + 1], trace)
        }
    };
    stack[*top] = result;
    *top += 1;
}

pub(super) fn unary<V: Value>(op: Op, argument: V, trace: &mut Trace<'_>) -> V {
    let u = argument.value();
    match op {
        Op::Smooth(function) => {
            if function.may_touch() {
                trace.take(argument.is_falling());
            }
            function.apply(argument)
        }
        Op::Untouched(function) => function.apply(argument),
        Op::Negate => argument.neg(),
        Op::AsinSin | Op::AcosCos => {
            let (wave, value) = match op {
                Op::AsinSin => (Smooth::Cos, triangle(u)),
                _ => (Smooth::Sin, (u - TAU * (u / TAU).round()).abs()),
            };
            let falls = trace.take(wave.apply(argument).is_below_zero());
            argument.apply(value, || (if falls { -1.0 } else { 1.0 }, 0.0))
        }
        _ => {
            let below = trace.take(argument.is_below_zero());
            match op {
                Op::Abs => {
                    let value = if trace.held.is_none() { u.abs() } else { if below { -u } else { u } };
                    argument.apply(value, || (if below { -1.0 } else { 1.0 }, 0.0))
                }
                _ if u.is_nan() => argument,
                Op::Sign if trace.held.is_some() => V::constant(if below { -1.0 } else { 1.0 }),
                Op::Step if trace.held.is_some() => V::constant(if below { 0.0 } else { 1.0 }),
                Op::Sign => {
                    trace.turns |= u == 0.0 && (below || argument.neg().is_below_zero());
                    V::constant(if u == 0.0 { 0.0 } else { u.signum() })
                }
                _ => {
                    trace.turns |= u == 0.0 && below;
                    V::constant(if u >= 0.0 { 1.0 } else { 0.0 })
                }
            }
        }
    }
}

/// asin(sin u) without the loss of digits at its crests.
pub(super) fn triangle(u: f64) -> f64 {
    let turns = (u / PI).round();
    let rest = u - PI * turns;
    if turns % 2.0 == 0.0 { rest } else { -rest }
}

pub(super) fn binary<V: Value>(op: Op, first: V, second: V, trace: &mut Trace<'_>) -> V {
    match op {
        Op::Add => first.add(second),
        Op::Subtract => first.sub(second),
        Op::Multiply => first.mul(second),
        Op::Divide => first.div(second),
        Op::Power => first.pow(second),
        Op::Atan2 => {
            let below = trace.take(second.value() < 0.0 && first.is_below_zero());
            trace.turns |= below && first.value() == 0.0;
            first.atan2(second)
        }
        _ => {
            let below = trace.take(first.sub(second).is_below_zero());
            let (u, v) = (first.value(), second.value());
            if trace.held.is_some() {
                return if below == (op == Op::Min) { first } else { second };
            }
            // A NaN must not be chosen away.
            let chosen = if u.is_nan() || (!v.is_nan() && below == (op == Op::Min)) { first } else { second };
            // Of two zeros the sign must not depend on where the derivatives are taken from.
            if u == v { chosen.apply(u, || (1.0, 0.0)) } else { chosen }
        }
    }
}
