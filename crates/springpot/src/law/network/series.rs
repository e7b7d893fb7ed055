//! Parts one behind the other: the strokes of the parts at the nodes of a step are found so that all have one force.
//!
//! Everything is composed in strokes: carried inner rates would grow without bound. With F = F_m + G_m δ_m of part m about inner strokes x_m
//! that need not fit yet, r = x − Σ x_m and C_m = G_m⁻¹: F = (Σ C_m)⁻¹ (r + Σ C_m F_m), δ_m = C_m (F − F_m), and ∂F/∂x = (Σ C_m)⁻¹. For
//! linear parts one such step is exact; others iterate, and where they find no force that all parts have, forces are NaN. The force at the
//! start of a step never enters, so that starts need not be consistent.
//!
//! In a step with three Radau nodes the parts are asked at four ([`Nodes::Inner`]): inner strokes bend more than the stroke of the whole, and
//! at three nodes a forward run would be of order three. The force at the three is that of the cubic through the four.

mod asked;
mod solve;
mod start;

use super::part::{self, Onset, Part, Reported, Take};
use super::{Guard, Holds, MOST_IN_SERIES, Network};
use crate::collocation::inner::TABLEAU_OF_FOUR;
use crate::collocation::{MAX_NODES, Nodes};
use crate::fractional::KernelError;
use crate::law::past::Recalled;
use crate::law::state::{State, StateMut, StateRef, StateSize};
use crate::law::step::{Course, InputValue, LocalError, Point, Power, Powers, Response, Start, Step, Term};
use crate::law::tangent::{self, AtRest};
use asked::Asked;
use num_complex::Complex64;
use solve::{Inner, Solved, solve};

pub(in crate::law) use solve::Ready;

/// Parts one behind the other.
#[derive(Debug, Clone)]
pub struct Series {
    parts: Vec<Network>,
}

type Matrix = [[f64; MAX_NODES]; MAX_NODES];
type Values = [f64; MAX_NODES + 1];

/// Where so many steps have led since t = 0, inner strokes no longer bend as at a start.
const LAYER: f64 = 10.0;

/// How much more an estimate counts before that: what it misses stays for as long as the parts relax.
const ONSET: f64 = 6.0;

/// What rounding of the strokes does to the estimate of a rate, in units of it over h, and what memories take from strokes of their own.
const ROUNDING: f64 = 40.0;
const OF_MEMORIES: f64 = 6.0;

/// The largest share of a step in which what its strokes move may count as rounding.
const NEAR: f64 = 1e-6;

/// Iterations of nonlinear parts, and how often one of them is halved.
const MOST_ITERATIONS: usize = 60;
const MOST_HALVINGS: usize = 30;

/// Change of the strokes, in units of the largest, at which they end.
const ENOUGH: f64 = 1e-14;

/// Iterations for the rates of nonlinear parts between two steps.
const MOST_SECANTS: usize = 200;

impl Series {
    pub(super) fn new(parts: Vec<Network>) -> Self {
        Self { parts }
    }

    pub(super) fn into_parts(self) -> Vec<Network> {
        self.parts
    }

    /// Whether no part gives a force that follows from its stroke alone.
    fn is_yielding(&self, step: &Step) -> bool {
        let at = step.point(0);
        self.parts.iter().all(|part| part.ask().asymptote(&at, Onset::Short).order > 0.0)
    }

    /// The step as the parts are asked it.
    fn asked(&self, step: &Step, ready: Option<&Ready>) -> Asked {
        let ready = ready.filter(|ready| ready.is_for(step.t, step.h));
        Asked::whole(step, ready.map_or_else(|| self.is_yielding(step), |ready| ready.is_yielding))
    }

    /// What the parts are asked and how they answer; leaves the state at their shares.
    fn solved(&self, step: &Step, state: &mut StateRef) -> (Asked, Solved) {
        let ready = state.take_ready();
        let asked = self.asked(step, ready);
        let strokes = state.take(self.own_size()).variables;
        let solved = solve(&self.parts, &asked.step(step), strokes, ready, *state);
        (asked, solved)
    }

    /// The force at θ: the polynomial through that at its start and at the nodes, on which accelerations rest where strokes are sought.
    fn between(&self, step: &Step, theta: f64, mut state: StateRef) -> f64 {
        let start = self.now(&step.point(0), &mut state.clone(), &mut |_| ()).observation.regular;
        let (_, Solved { force, .. }) = self.solved(step, &mut state);
        let values = [start, force[0], force[1], force[2], force[3]];
        let at = |row: &Values| row.iter().zip(values).map(|(weight, value)| weight * value).sum::<f64>();
        TABLEAU_OF_FOUR.values.iter().rev().fold(0.0, |sum, row| sum * theta + at(row))
    }
}

impl Part for Series {
    fn parts(&self) -> &[Network] {
        &self.parts
    }

    /// The strokes of its parts.
    fn own_size(&self) -> StateSize {
        StateSize { memories: 0, variables: self.parts.len() }
    }

    fn series_count(&self) -> usize {
        1 + self.parts.iter().map(|part| part.ask().series_count()).sum::<usize>()
    }

    fn begin(&self, start: &Start, state: &mut State) -> Result<(), KernelError> {
        start::begin(&self.parts, start, state)
    }

    fn recall(&self, stroke: &Recalled, at: &Point, state: &mut StateMut) {
        start::recall(self, stroke, at, state);
    }

    fn prepare(&self, step: &Step, state: &mut StateMut) {
        let is_yielding = self.is_yielding(step);
        let asked = Asked::whole(step, is_yielding);
        let step = &asked.step(step);
        let (ready, strokes) = (state.take_ready(), state.take(self.own_size()).variables);
        let mut shares = state.reborrow();
        for (part, stroke) in self.parts.iter().zip(&*strokes) {
            let inner = Inner { stroke: [*stroke; MAX_NODES + 1], ..Inner::default() };
            part.ask().prepare(&inner.step(step), &mut shares);
        }
        if let Some(ready) = ready {
            ready.get(&self.parts, is_yielding, step, strokes, state.view());
        }
        self.parts.iter().for_each(|part| part.ask().pass_mut(state));
    }

    fn evaluate(&self, step: &Step, state: &mut StateRef, response: &mut Response) {
        let (asked, Solved { force, tangent, .. }) = self.solved(step, state);
        self.parts.iter().for_each(|part| part.ask().pass(state));
        asked.respond(&force, &tangent, response);
    }

    fn commit(&self, step: &Step, state: &mut StateMut) {
        let ready = state.take_ready();
        let asked = self.asked(step, ready.as_deref());
        let step = &asked.step(step);
        let strokes = state.take(self.own_size()).variables;
        let Solved { inner, .. } = solve(&self.parts, step, strokes, ready.as_deref(), state.view());
        if let Some(ready) = ready {
            ready.forget();
        }
        for ((part, inner), stroke) in self.parts.iter().zip(&inner).zip(strokes) {
            part.ask().commit(&inner.step(step), state);
            *stroke = match step.nodes {
                // The rate is constant, and the node in the middle.
                Nodes::Midpoint => 2.0 * inner.stroke[1] - inner.stroke[0],
                nodes => inner.stroke[nodes.count()],
            };
        }
    }

    fn local_errors(&self, step: &Step, state: &mut StateRef, errors: &mut Vec<LocalError>) {
        let (asked, Solved { mut inner, shares, .. }) = self.solved(step, state);
        // Of series within each other the outermost one weighs.
        let onset = if step.nodes == Nodes::Inner { 1.0 } else { ONSET };
        let step = &asked.step(step);
        for ((part, inner), share) in self.parts.iter().zip(&mut inner).zip(shares) {
            let (first, end) = (errors.len(), step.nodes.count());
            let rate = inner.rate[end];
            if step.nodes == Nodes::Inner {
                // The rates of the cubic through all strokes but one: what departs from it is the estimate.
                inner.rate = embedded_rates(&inner.stroke, step.h);
            }
            // Strokes of parts may be larger than that of the whole by far.
            let largest = inner.stroke[..=end].iter().fold(0.0f64, |largest, stroke| largest.max(stroke.abs()));
            let resolution = ROUNDING * (step.resolution + 4.0 * f64::EPSILON * largest);
            let told = Step { resolution: resolution / OF_MEMORIES, ..inner.step(step) };
            part.ask().local_errors(&told, state, errors);
            for error in &mut errors[first..] {
                // Dashpots are told rates that are known no better than the strokes; those of a series inside know it already.
                if error.sharpness == 0.0 {
                    error.error = ((rate - inner.rate[end]).abs() - resolution / step.h).max(0.0);
                }
                // A part that hardly yields in the step does not matter, however little is known of it. With share = (h/τ)^α what a step near
                // the start errs is h/τ of it later on.
                (error.error, error.sharpness) = match step.t > LAYER * step.h || error.order == 0.0 {
                    true => (error.error * share, (5.0 - error.order) / (4.0 - error.order)),
                    false => (onset * error.error * share.powf(error.order.recip()), 1.0),
                };
            }
        }
    }

    fn powers(&self, step: &Step, state: &mut StateRef, powers: &mut Powers) {
        let (asked, Solved { inner, .. }) = self.solved(step, state);
        let step = &asked.step(step);
        let mut own = Powers::default();
        for (part, inner) in self.parts.iter().zip(&inner) {
            part.ask().powers(&inner.step(step), state, &mut own);
        }
        let outer = |of: fn(&Power) -> f64| asked.outer(&own.each_ref().map(of));
        let [dissipation, input] = [outer(|power| power.dissipation), outer(|power| power.input)];
        for (k, power) in powers.iter_mut().enumerate() {
            power.dissipation += dissipation[k];
            power.input += input[k];
        }
    }

    fn guards(&self, step: &Step, state: &mut StateRef, guards: &mut Vec<Guard>) {
        if !self.parts.iter().any(|part| part.has_guards(&step.point(0))) {
            state.take_ready();
            state.take(self.own_size());
            self.parts.iter().for_each(|part| part.ask().pass(state));
            return;
        }
        let (asked, Solved { inner, .. }) = self.solved(step, state);
        let step = &asked.step(step);
        let first = guards.len();
        for (part, inner) in self.parts.iter().zip(&inner) {
            part.ask().guards(&inner.step(step), state, guards);
        }
        for guard in &mut guards[first..] {
            *guard = asked.outer(guard);
        }
    }

    /// Inside a step: as a shorter one that ends there, so that rows are as good as ends of steps.
    fn at(&self, step: &Step, theta: f64, at: &Point, state: &mut StateRef, take: Take) -> Reported {
        if is_near(step, theta) {
            let force = self.between(step, theta, *state);
            let mut told = self.now(at, state, take);
            told.observation.regular = force;
            return told;
        }
        let known = (theta < 1.0 && step.nodes == Nodes::Radau && step.course == Course::Sought)
            .then(|| self.between(step, theta, *state));
        let ready = state.take_ready();
        let asked =
            if theta == 1.0 { self.asked(step, ready) } else { Asked::until(step, self.is_yielding(step), theta, at) };
        let step = &asked.step(step);
        let strokes = state.take(self.own_size()).variables;
        let Solved { inner, force, .. } = solve(&self.parts, step, strokes, ready, *state);
        let last = step.nodes.count();
        let mut sum = Reported::sum(
            at,
            self.parts.iter().zip(&inner).map(|(part, inner)| {
                let inside = Point { stroke: inner.stroke[last], rate: inner.rate[last], ..*at };
                part.ask().at(&inner.step(step), 1.0, &inside, state, take)
            }),
        );
        (sum.observation.regular, sum.observation.singular) = (known.unwrap_or(force[last - 1]), 0.0);
        sum
    }

    /// Between two steps strokes do not jump: the force is that of the parts whose force follows from them alone; where every part has a
    /// dashpot beside it, that of the rates that add up.
    fn now(&self, at: &Point, state: &mut StateRef, take: Take) -> Reported {
        state.take_ready();
        let strokes = state.take(self.own_size()).variables;
        let force = |part: &Network, stroke: f64, rate: f64, state: &StateRef| {
            part.ask().now(&Point { stroke, rate, ..*at }, &mut state.clone(), &mut |_| ()).observation.regular
        };
        // F = a_m + b_m v_m, v = Σ v_m; of parts that are not linear b_m is that of the secant to v_m.
        let (mut rates, mut whole) = ([1.0; MOST_IN_SERIES], f64::NAN);
        let iterations = if self.parts.iter().all(Network::is_linear) { 1 } else { MOST_SECANTS };
        for _ in 0..iterations {
            let (mut follows, mut yielding, mut owed): (Option<(f64, f64)>, _, _) = (None, 0.0, 0.0);
            let (mut ahead, before) = (*state, whole);
            let mut lines = [[0.0; 2]; MOST_IN_SERIES];
            for (k, (part, &stroke)) in self.parts.iter().zip(strokes).enumerate() {
                let rest = force(part, stroke, 0.0, &ahead);
                let slope = (force(part, stroke, rates[k], &ahead) - rest) / rates[k];
                if slope == 0.0 {
                    // What springpots have not begun to tell springs know.
                    let order = part.ask().asymptote(at, Onset::Short).order;
                    if follows.is_none_or(|(least, _)| order < least) {
                        follows = Some((order, rest));
                    }
                } else {
                    (yielding, owed) = (yielding + slope.recip(), owed + rest / slope);
                }
                lines[k] = [rest, slope];
                part.ask().pass(&mut ahead);
            }
            whole = follows.map_or((at.rate + owed) / yielding, |(_, rest)| rest);
            for (rate, [rest, slope]) in rates.iter_mut().zip(lines) {
                *rate = if slope == 0.0 { 0.0 } else { (whole - rest) / slope };
            }
            if (whole - before).abs() <= ENOUGH * whole.abs() {
                break;
            }
            // A rate of 0 has no secant.
            if iterations > 1 {
                rates.iter_mut().filter(|rate| **rate == 0.0).for_each(|rate| *rate = f64::MIN_POSITIVE.sqrt());
            }
        }
        let mut sum = Reported::sum(
            at,
            self.parts
                .iter()
                .zip(strokes)
                .zip(rates)
                .map(|((part, &stroke), rate)| part.ask().now(&Point { stroke, rate, ..*at }, state, take)),
        );
        (sum.observation.regular, sum.observation.singular) = (whole, 0.0);
        sum
    }

    fn by_input(&self, step: &Step, state: &mut StateRef, input: usize, slopes: &mut [[f64; MAX_NODES]; MAX_NODES]) {
        let (asked, Solved { inner, .. }) = self.solved(step, state);
        let inside = solve::by_input(&self.parts, &asked.step(step), &inner, input, *state);
        self.parts.iter().for_each(|part| part.ask().pass(state));
        asked.follow_input(&inside, slopes);
    }

    fn estimate(&self, at: &Point, state: &mut StateRef, omega: f64) -> f64 {
        self.pass(state);
        self.stiffness(at, omega) * at.stroke
    }

    fn singularities(&self, _: &[InputValue], state: &mut StateRef, _: &mut dyn FnMut(Term)) {
        self.pass(state);
    }

    fn holds(&self) -> Holds {
        self.parts.iter().map(Network::holds).min().unwrap_or(Holds::Always)
    }

    fn stiffness(&self, at: &Point, omega: f64) -> f64 {
        self.parts.iter().map(|part| part.stiffness(at, omega).recip()).sum::<f64>().recip()
    }

    fn for_each_springpot(&self, at: &Point, take: &mut dyn FnMut(Term)) {
        let term = self.asymptote(at, Onset::Short);
        if term.order > 0.0 && term.order < 1.0 {
            take(term);
        }
    }

    fn jolts(&self, at: &Point) -> bool {
        self.asymptote(at, Onset::Short).order > 0.0
    }

    fn has_memories_in_series(&self) -> bool {
        self.size().memories > 0
    }

    fn modulus(&self, at: &Point, s: Complex64) -> Complex64 {
        let moduli = self.parts.iter().map(|part| part.modulus(at, s));
        // At s = 0 one that carries nothing lets all of them carry nothing.
        let compliance = moduli.map(|one| (one != Complex64::ZERO).then(|| one.inv())).sum::<Option<Complex64>>();
        compliance.map_or(Complex64::ZERO, |compliance| compliance.inv())
    }

    /// That of the softest part.
    fn asymptote(&self, at: &Point, onset: Onset) -> Term {
        part::asymptote(&self.parts, at, onset, false)
    }

    fn at_rest(&self, at: &Point, _: f64) -> Option<AtRest> {
        tangent::series(&self.parts, at)
    }
}

/// x' at 0 and at the nodes of the cubic through x at 0 and at all nodes but the first.
fn embedded_rates(stroke: &Values, h: f64) -> Values {
    let moved: [f64; MAX_NODES] = std::array::from_fn(|j| stroke[j + 1] - stroke[0]);
    TABLEAU_OF_FOUR.embedded.map(|row| row.iter().zip(moved).map(|(weight, moved)| weight * moved).sum::<f64>() / h)
}

/// Whether θ is so near to the start that rates, as differences of strokes over θh, are of their rounding: what moves till then is less.
fn is_near(step: &Step, theta: f64) -> bool {
    let (Nodes::Radau | Nodes::Inner, [start, nodes @ ..]) = (step.nodes, step.stroke) else { return false };
    let moved = nodes.iter().fold(0.0f64, |moved, stroke| moved.max((stroke - start).abs()));
    step.t > 0.0 && theta < NEAR.min((step.resolution.max(f64::EPSILON * start.abs()) / moved).sqrt())
}
