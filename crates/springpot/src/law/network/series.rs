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

use super::{Guard, MOST_IN_SERIES, Network, Onset, Reported, Take};
use crate::collocation::inner::TABLEAU_OF_FOUR;
use crate::collocation::{MAX_NODES, Nodes};
use crate::law::state::{StateMut, StateRef, StateSize};
use crate::law::step::{Course, LocalError, Point, Power, Powers, Response, Step};
use asked::Asked;
use solve::{Inner, Solved, solve};

pub(in crate::law) use solve::Ready;
pub(super) use start::{begin, recall};

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

/// Whether no part gives a force that follows from its stroke alone.
fn is_yielding(parts: &[Network], step: &Step) -> bool {
    let at = step.point(0);
    parts.iter().all(|part| part.asymptote(&at, Onset::Short).order > 0.0)
}

/// The step as the parts are asked it.
fn asked(parts: &[Network], step: &Step, ready: Option<&Ready>) -> Asked {
    let ready = ready.filter(|ready| ready.is_for(step.t, step.h));
    Asked::whole(step, ready.map_or_else(|| is_yielding(parts, step), |ready| ready.is_yielding))
}

pub(super) fn prepare(parts: &[Network], step: &Step, state: &mut StateMut) {
    let is_yielding = is_yielding(parts, step);
    let asked = Asked::whole(step, is_yielding);
    let step = &asked.step(step);
    let (ready, strokes) = (state.take_ready(), state.take(own(parts)).variables);
    let mut shares = state.reborrow();
    for (part, stroke) in parts.iter().zip(&*strokes) {
        let inner = Inner { stroke: [*stroke; MAX_NODES + 1], ..Inner::default() };
        part.prepare_part(&inner.step(step), &mut shares);
    }
    if let Some(ready) = ready {
        ready.get(parts, is_yielding, step, strokes, state.view());
    }
    parts.iter().for_each(|part| state.skip(part.size(), part.series_count()));
}

/// What the parts are asked and how they answer; leaves the state at their shares.
fn solved(parts: &[Network], step: &Step, state: &mut StateRef) -> (Asked, Solved) {
    let ready = state.take_ready();
    let asked = asked(parts, step, ready);
    let strokes = state.take(own(parts)).variables;
    let solved = solve(parts, &asked.step(step), strokes, ready, *state);
    (asked, solved)
}

pub(super) fn evaluate(parts: &[Network], step: &Step, state: &mut StateRef, response: &mut Response) {
    let (asked, Solved { force, tangent, .. }) = solved(parts, step, state);
    parts.iter().for_each(|part| part.pass(state));
    asked.respond(&force, &tangent, response);
}

pub(super) fn commit(parts: &[Network], step: &Step, state: &mut StateMut) {
    let ready = state.take_ready();
    let asked = asked(parts, step, ready.as_deref());
    let step = &asked.step(step);
    let strokes = state.take(own(parts)).variables;
    let Solved { inner, .. } = solve(parts, step, strokes, ready.as_deref(), state.view());
    if let Some(ready) = ready {
        ready.forget();
    }
    for ((part, inner), stroke) in parts.iter().zip(&inner).zip(strokes) {
        part.commit_part(&inner.step(step), state);
        *stroke = match step.nodes {
            // The rate is constant, and the node in the middle.
            Nodes::Midpoint => 2.0 * inner.stroke[1] - inner.stroke[0],
            nodes => inner.stroke[nodes.count()],
        };
    }
}

pub(super) fn local_errors(parts: &[Network], step: &Step, state: &mut StateRef, errors: &mut Vec<LocalError>) {
    let (asked, Solved { mut inner, shares, .. }) = solved(parts, step, state);
    // Of series within each other the outermost one weighs.
    let onset = if step.nodes == Nodes::Inner { 1.0 } else { ONSET };
    let step = &asked.step(step);
    for ((part, inner), share) in parts.iter().zip(&mut inner).zip(shares) {
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
        part.local_errors_part(&told, state, errors);
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

/// x' at 0 and at the nodes of the cubic through x at 0 and at all nodes but the first.
fn embedded_rates(stroke: &Values, h: f64) -> Values {
    let moved: [f64; MAX_NODES] = std::array::from_fn(|j| stroke[j + 1] - stroke[0]);
    TABLEAU_OF_FOUR.embedded.map(|row| row.iter().zip(moved).map(|(weight, moved)| weight * moved).sum::<f64>() / h)
}

pub(super) fn powers(parts: &[Network], step: &Step, state: &mut StateRef, powers: &mut Powers) {
    let (asked, Solved { inner, .. }) = solved(parts, step, state);
    let step = &asked.step(step);
    let mut own = Powers::default();
    for (part, inner) in parts.iter().zip(&inner) {
        part.powers_part(&inner.step(step), state, &mut own);
    }
    let outer = |of: fn(&Power) -> f64| asked.outer(&own.each_ref().map(of));
    let [dissipation, input] = [outer(|power| power.dissipation), outer(|power| power.input)];
    for (k, power) in powers.iter_mut().enumerate() {
        power.dissipation += dissipation[k];
        power.input += input[k];
    }
}

pub(super) fn guards(parts: &[Network], step: &Step, state: &mut StateRef, guards: &mut Vec<Guard>) {
    if !parts.iter().any(|part| part.has_guards(&step.point(0))) {
        state.take_ready();
        state.take(own(parts));
        parts.iter().for_each(|part| part.pass(state));
        return;
    }
    let (asked, Solved { inner, .. }) = solved(parts, step, state);
    let step = &asked.step(step);
    let first = guards.len();
    for (part, inner) in parts.iter().zip(&inner) {
        part.guards_part(&inner.step(step), state, guards);
    }
    for guard in &mut guards[first..] {
        *guard = asked.outer(guard);
    }
}

/// Inside a step: as a shorter one that ends there, so that rows are as good as ends of steps.
pub(super) fn at(parts: &[Network], step: &Step, theta: f64, at: &Point, state: &mut StateRef, take: Take) -> Reported {
    if is_near(step, theta) {
        let force = between(parts, step, theta, *state);
        let mut told = now(parts, at, state, take);
        told.observation.regular = force;
        return told;
    }
    let known = (theta < 1.0 && step.nodes == Nodes::Radau && step.course == Course::Sought)
        .then(|| between(parts, step, theta, *state));
    let ready = state.take_ready();
    let asked =
        if theta == 1.0 { asked(parts, step, ready) } else { Asked::until(step, is_yielding(parts, step), theta, at) };
    let step = &asked.step(step);
    let strokes = state.take(own(parts)).variables;
    let Solved { inner, force, .. } = solve(parts, step, strokes, ready, *state);
    let last = step.nodes.count();
    let mut sum = Reported::sum(
        at,
        parts.iter().zip(&inner).map(|(part, inner)| {
            let inside = Point { stroke: inner.stroke[last], rate: inner.rate[last], ..*at };
            part.at_part(&inner.step(step), 1.0, &inside, state, take)
        }),
    );
    (sum.observation.regular, sum.observation.singular) = (known.unwrap_or(force[last - 1]), 0.0);
    sum
}

/// Whether θ is so near to the start that rates, as differences of strokes over θh, are of their rounding: what moves till then is less.
fn is_near(step: &Step, theta: f64) -> bool {
    let (Nodes::Radau | Nodes::Inner, [start, nodes @ ..]) = (step.nodes, step.stroke) else { return false };
    let moved = nodes.iter().fold(0.0f64, |moved, stroke| moved.max((stroke - start).abs()));
    step.t > 0.0 && theta < NEAR.min((step.resolution.max(f64::EPSILON * start.abs()) / moved).sqrt())
}

/// The force at θ: the polynomial through that at its start and at the nodes, on which accelerations rest where strokes are sought.
fn between(parts: &[Network], step: &Step, theta: f64, mut state: StateRef) -> f64 {
    let start = now(parts, &step.point(0), &mut state.clone(), &mut |_| ()).observation.regular;
    let (_, Solved { force, .. }) = solved(parts, step, &mut state);
    let values = [start, force[0], force[1], force[2], force[3]];
    let at = |row: &Values| row.iter().zip(values).map(|(weight, value)| weight * value).sum::<f64>();
    TABLEAU_OF_FOUR.values.iter().rev().fold(0.0, |sum, row| sum * theta + at(row))
}

/// Between two steps strokes do not jump: the force is that of the parts whose force follows from them alone; where every part has a
/// dashpot beside it, that of the rates that add up.
pub(super) fn now(parts: &[Network], at: &Point, state: &mut StateRef, take: Take) -> Reported {
    state.take_ready();
    let strokes = state.take(own(parts)).variables;
    let force = |part: &Network, stroke: f64, rate: f64, state: &StateRef| {
        part.now_part(&Point { stroke, rate, ..*at }, &mut state.clone(), &mut |_| ()).observation.regular
    };
    // F = a_m + b_m v_m, v = Σ v_m; of parts that are not linear b_m is that of the secant to v_m.
    let (mut rates, mut whole) = ([1.0; MOST_IN_SERIES], f64::NAN);
    let iterations = if parts.iter().all(Network::is_linear) { 1 } else { MOST_SECANTS };
    for _ in 0..iterations {
        let (mut follows, mut yielding, mut owed): (Option<(f64, f64)>, _, _) = (None, 0.0, 0.0);
        let (mut ahead, before) = (*state, whole);
        let mut lines = [[0.0; 2]; MOST_IN_SERIES];
        for (k, (part, &stroke)) in parts.iter().zip(strokes).enumerate() {
            let rest = force(part, stroke, 0.0, &ahead);
            let slope = (force(part, stroke, rates[k], &ahead) - rest) / rates[k];
            if slope == 0.0 {
                // What springpots have not begun to tell springs know.
                let order = part.asymptote(at, Onset::Short).order;
                if follows.is_none_or(|(least, _)| order < least) {
                    follows = Some((order, rest));
                }
            } else {
                (yielding, owed) = (yielding + slope.recip(), owed + rest / slope);
            }
            lines[k] = [rest, slope];
            part.pass(&mut ahead);
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
        parts
            .iter()
            .zip(strokes)
            .zip(rates)
            .map(|((part, &stroke), rate)| part.now_part(&Point { stroke, rate, ..*at }, state, take)),
    );
    (sum.observation.regular, sum.observation.singular) = (whole, 0.0);
    sum
}

/// What a series itself keeps: the strokes of its parts.
fn own(parts: &[Network]) -> StateSize {
    StateSize { memories: 0, variables: parts.len() }
}
