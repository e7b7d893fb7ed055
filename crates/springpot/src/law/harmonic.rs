//! First harmonics of what is not linear, under x = x_0 + A·sin ωt since ever.
//!
//! K* = K' + iK'' = (1/πA) ∮ F·(sin φ + i cos φ) dφ over one steady turn, which loses ∮ F dx = π K'' A². What follows from stroke and rate at one time is integrated
//! between its kinks; what has a state is driven until its turns no longer differ, and where memories decay like a power of the turns, to their limit (Wynn 1956).

use super::leaf::Guard;
use super::leaf::Leaf;
use super::network::Network;
use super::state::{State, StateRef};
use super::step::{Course, InputValue, Point, Start, Step};
use crate::collocation::{Nodes, STAGES, quadrature};
use crate::fractional::Form;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};
use std::sync::LazyLock;

/// Places at which kinks are looked for in a turn, and halvings that find one.
const LOOKS: usize = 720;
const HALVINGS: usize = 60;

/// Points of a rule, how often a piece is halved, and what halves may differ from the whole, in units of the largest force.
const POINTS: usize = 16;
const DEEPEST: usize = 30;
const CLOSE: f64 = 1e-13;

/// Steps of a turn, tried one after the other, and what two of them may differ, or may at last.
const STEPS: [usize; 5] = [64, 128, 256, 512, 1024];
const ALIKE: f64 = 1e-9;
const ALIKE_AT_LAST: f64 = 1e-7;

/// Most turns without memories, and the change from turn to turn at which they end.
const MOST_TURNS: usize = 4000;
const SETTLED: f64 = 1e-11;

/// With memories: how often the number of turns doubles, and the change of the limit at which that ends, or is taken at last.
const DOUBLINGS: u32 = 9;
const KNOWN: f64 = 1e-10;
const KNOWN_AT_LAST: f64 = 1e-8;

/// Tolerance of memories, and their shortest lag in units of a step.
const MEMORY: f64 = 1e-11;
const SHORTEST: f64 = 1e-4;

/// How near its zero a guard counts as on it, in units of A, and the shortest step, in units of a turn.
const NEAR: f64 = 1e-11;
const SHORT: f64 = 1e-13;

/// A sine of the stroke, about that of `at`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sine<'a> {
    pub(super) at: Point<'a>,
    pub(super) amplitude: f64,
    pub(super) omega: f64,
}

impl<'a> Sine<'a> {
    /// Where it is at the phase φ.
    fn point(&self, phase: f64) -> Point<'a> {
        let (sine, cosine) = phase.sin_cos();
        let stroke = self.at.stroke + self.amplitude * sine;
        Point { stroke, rate: self.amplitude * self.omega * cosine, ..self.at }
    }

    /// ∮ … dφ as K*.
    fn scaled(&self, integral: Complex64) -> Complex64 {
        integral / (PI * self.amplitude)
    }
}

/// sin φ + i cos φ.
fn turned(phase: f64) -> Complex64 {
    Complex64::new(phase.sin(), phase.cos())
}

/// That of a leaf whose force follows from the stroke and the rate of one time.
pub(super) fn at_once(leaf: &dyn Leaf, sine: &Sine) -> Complex64 {
    let nothing = StateRef { memories: &[], variables: &[], ready: &[] };
    let force = |phase: f64| leaf.now(&sine.point(phase), nothing).force() * turned(phase);
    let guards = |phase: f64| {
        let mut values = Vec::new();
        leaf.guards(&sine.point(phase), &mut |value| values.push(value));
        values
    };
    let phase = |k: usize| TAU * k as f64 / LOOKS as f64;
    let mut ends = vec![0.0, TAU];
    let mut before = guards(phase(0));
    for k in 1..=LOOKS {
        let here = guards(phase(k));
        for (g, (a, b)) in before.iter().zip(&here).enumerate() {
            if (*a > 0.0) != (*b > 0.0) {
                let is_before = |phase: f64| (guards(phase)[g] > 0.0) == (*a > 0.0);
                ends.push(between(phase(k - 1), phase(k), is_before));
            }
        }
        before = here;
    }
    ends.sort_by(f64::total_cmp);
    let size = (0..LOOKS).map(|k| force(phase(k)).norm()).fold(0.0, f64::max);
    let pieces = ends.windows(2).filter(|ends| ends[1] > ends[0]);
    sine.scaled(pieces.map(|ends| piece(&force, ends[0], ends[1], CLOSE * size, DEEPEST)).sum())
}

/// The first place that is no longer before something.
fn between(mut low: f64, mut high: f64, is_before: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if is_before(middle) { low = middle } else { high = middle }
    }
    high
}

/// ∫ from `a` to `b`, in halves where these differ from the whole.
fn piece(f: &dyn Fn(f64) -> Complex64, a: f64, b: f64, close: f64, deepest: usize) -> Complex64 {
    let middle = 0.5 * (a + b);
    let (whole, halves) = (gauss(f, a, b), gauss(f, a, middle) + gauss(f, middle, b));
    if deepest == 0 || (whole - halves).norm() <= close * (b - a) {
        return halves;
    }
    piece(f, a, middle, close, deepest - 1) + piece(f, middle, b, close, deepest - 1)
}

/// Gauss and Legendre's rule.
fn gauss(f: &dyn Fn(f64) -> Complex64, a: f64, b: f64) -> Complex64 {
    let (centre, half) = (0.5 * (a + b), 0.5 * (b - a));
    RULE.iter().map(|[x, weight]| half * weight * f(centre + half * x)).sum()
}

/// Nodes in (−1, 1) and weights.
static RULE: LazyLock<[[f64; 2]; POINTS]> = LazyLock::new(|| {
    std::array::from_fn(|k| {
        let mut x = ((k as f64 + 0.75) / (POINTS as f64 + 0.5) * PI).cos();
        let mut slope = 1.0;
        for _ in 0..20 {
            let (mut value, mut before) = (x, 1.0);
            for n in 2..=POINTS {
                let n = n as f64;
                (value, before) = (((2.0 * n - 1.0) * x * value - (n - 1.0) * before) / n, value);
            }
            slope = POINTS as f64 * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        [x, 2.0 / ((1.0 - x * x) * slope * slope)]
    })
});

/// That of a law that is driven until it is steady; `None` where it does not become so.
pub(super) fn driven(law: &Network, sine: &Sine) -> Option<Complex64> {
    let mut turns = Turns::begin(law, *sine, STEPS[0])?;
    let (mut found, mut apart) = (limit(&mut turns)?, f64::INFINITY);
    for &steps in &STEPS[1..] {
        // What remembers nothing but its state goes on where coarser steps have brought it.
        let goes_on = turns.state.memories().is_empty();
        turns = if goes_on { Turns { steps, ..turns } } else { Turns::begin(law, *sine, steps)? };
        let finer = limit(&mut turns)?;
        (found, apart) = (finer, (finer - found).norm() / finer.norm());
        if apart <= ALIKE {
            return Some(found);
        }
    }
    (apart <= ALIKE_AT_LAST).then_some(found)
}

/// Where the turns lead.
fn limit(turns: &mut Turns) -> Option<Complex64> {
    if turns.state.memories().is_empty() {
        let mut before = turns.next()?;
        for _ in 0..MOST_TURNS {
            let here = turns.next()?;
            if (here - before).norm() <= SETTLED * here.norm() {
                return Some(here);
            }
            before = here;
        }
        return None;
    }
    // Behind 2, 4, 8, … turns, which errors like n^−(1+α) leave in a geometric sequence.
    let (mut done, mut known) = (0, f64::INFINITY);
    let mut row: Vec<Complex64> = Vec::new();
    let mut best = turns.next()?;
    for doubling in 1..=DOUBLINGS {
        let mut here = best;
        while done < 1 << doubling {
            here = turns.next()?;
            done += 1;
        }
        let last = row.last().copied();
        row = epsilons(&row, here);
        // Every other column converges; the last of them that has two entries.
        let limit = row[(row.len() - 1) / 2 * 2];
        let change = match last {
            Some(_) => (limit - best).norm() / limit.norm(),
            None => f64::INFINITY,
        };
        (best, known) = (limit, change);
        if known <= KNOWN {
            return Some(best);
        }
    }
    (known <= KNOWN_AT_LAST).then_some(best)
}

/// The next diagonal of the epsilon algorithm, from the last one and the next value.
fn epsilons(last: &[Complex64], value: Complex64) -> Vec<Complex64> {
    let mut row = vec![value];
    for k in 0..last.len() {
        let difference = row[k] - last[k];
        let before = if k == 0 { Complex64::ZERO } else { last[k - 1] };
        // Values that no longer differ have come to their limit.
        if difference.norm() <= 4.0 * f64::EPSILON * row[k].norm() {
            break;
        }
        row.push(before + difference.inv());
    }
    row
}

/// A law under a sine, turn by turn.
struct Turns<'a> {
    law: &'a Network,
    sine: Sine<'a>,
    /// Steps of a turn, but for those that end on kinks.
    steps: usize,
    state: State,
    inputs: Vec<InputValue>,
    /// Turns that are done.
    done: usize,
}

impl<'a> Turns<'a> {
    fn begin(law: &'a Network, sine: Sine<'a>, steps: usize) -> Option<Self> {
        let turn = TAU / sine.omega;
        let mut state = law.begin(&Start { stroke: sine.at.stroke, jump: 0.0, inputs: sine.at.inputs }).ok()?;
        let horizon = (2 << DOUBLINGS) as f64 * turn;
        state.open(MEMORY, SHORTEST * turn / steps as f64, horizon).ok()?;
        let inputs = sine.at.inputs.repeat(STAGES + 1);
        Some(Self { law, sine, steps, state, inputs, done: 0 })
    }

    /// K* of the next turn; `None` where no force is found.
    fn next(&mut self) -> Option<Complex64> {
        let mut integral = Complex64::ZERO;
        for k in 0..self.steps {
            let (mut from, to) = (k as f64 / self.steps as f64, (k + 1) as f64 / self.steps as f64);
            while from < to {
                let cut = self.kink(from, to);
                let end = cut.filter(|end| end - from > SHORT).unwrap_or(to);
                integral += self.take(from, end)?;
                from = end;
            }
        }
        self.done += 1;
        Some(self.sine.scaled(integral))
    }

    /// Asks the law the step between these shares of a turn.
    fn ask<T>(&self, from: f64, to: f64, question: impl FnOnce(&Step) -> T) -> T {
        let (turn, size) = (TAU / self.sine.omega, to - from);
        let places: [f64; STAGES + 1] = std::array::from_fn(|k| match k {
            0 => from,
            STAGES => to,
            k => from + size * Nodes::Radau.positions()[k - 1],
        });
        let points = places.map(|place| self.sine.point(TAU * place));
        question(&Step {
            t: (self.done as f64 + from) * turn,
            h: size * turn,
            nodes: Nodes::Radau,
            places: None,
            form: Form::Rates,
            stroke: &points.map(|point| point.stroke),
            rate: &points.map(|point| point.rate),
            inputs: &self.inputs,
            resolution: 4.0 * f64::EPSILON * (self.sine.at.stroke.abs() + self.sine.amplitude),
            course: Course::Given,
        })
    }

    /// Its share of ∮ … dφ; takes the step into the state.
    fn take(&mut self, from: f64, to: f64) -> Option<Complex64> {
        let mut state = std::mem::take(&mut self.state);
        let law = self.law;
        let force = self.ask(from, to, |step| {
            law.prepare(step, &mut state);
            let force = law.evaluate(step, &state).force;
            law.commit(step, &mut state);
            force
        });
        self.state = state;
        let weights = quadrature(Nodes::Radau, 1.0);
        let place = |k: usize| from + (to - from) * Nodes::Radau.positions()[k];
        let share = |k: usize| weights[k + 1] * force[k] * turned(TAU * place(k));
        let sum = (0..STAGES).map(share).sum::<Complex64>() * TAU * (to - from);
        sum.is_finite().then_some(sum)
    }

    /// The first kink between these shares of a turn.
    fn kink(&self, from: f64, to: f64) -> Option<f64> {
        let guards = |to: f64| {
            let mut guards: Vec<Guard> = Vec::new();
            self.ask(from, to, |step| self.law.guards(step, &self.state, &mut guards));
            guards
        };
        let near = NEAR * self.sine.amplitude;
        let sign = |guard: &Guard| if guard[0].abs() <= near { guard[1].signum() } else { guard[0].signum() };
        let mut first: Option<f64> = None;
        for (g, guard) in guards(to).iter().enumerate() {
            let side = sign(guard);
            if side * guard[STAGES] < -near {
                let is_before = |end: f64| side * guards(end)[g][STAGES] > 0.0;
                let end = between(from, to, is_before);
                first = Some(first.map_or(end, |first| first.min(end)));
            }
        }
        first
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_integrate_polynomials() {
        let moment = |n: i32| RULE.iter().map(|[x, weight]| weight * x.powi(n)).sum::<f64>();
        for n in 0..2 * POINTS as i32 {
            let exact = if n % 2 == 0 { 2.0 / f64::from(n + 1) } else { 0.0 };
            assert!((moment(n) - exact).abs() < 1e-14, "{n}");
        }
    }

    #[test]
    fn sequences_come_to_their_limits() {
        // Two powers of n, at n = 2, 4, 8, …
        let value = |k: i32| Complex64::new(3.0 + 2.0 * 0.4f64.powi(k), 1.0 - 0.2f64.powi(k));
        let mut row = Vec::new();
        (1..=5).for_each(|k| row = epsilons(&row, value(k)));
        assert!((row[4] - Complex64::new(3.0, 1.0)).norm() < 1e-9, "{row:?}");
    }
}
