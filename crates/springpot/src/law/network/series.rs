//! Parts one behind the other: the strokes of the parts at the nodes of a step are found so that all have one force.
//!
//! Everything is composed in strokes: carried inner rates would grow without bound. With F = F_m + G_m δ_m of part m about
//! inner strokes x_m that need not fit yet, r = x − Σ x_m and C_m = G_m⁻¹: F = (Σ C_m)⁻¹ (r + Σ C_m F_m), δ_m = C_m (F − F_m), and ∂F/∂x =
//! (Σ C_m)⁻¹. For linear parts one such step is exact; others iterate, and where they find no force that all parts have, forces are NaN. The force at the start of a step never enters, so that
//! starts need not be consistent.

use super::{Guard, MOST_IN_SERIES, Network, Onset, Reported, Take};
use crate::collocation::MAX_NODES;
use crate::collocation::Nodes;
use crate::fractional::Kind as Derivative;
use crate::fractional::{Form, KernelError, RatePolynomial};
use crate::law::past::Periodic;
use crate::law::state::{State, StateMut, StateRef};
use crate::law::step::{LocalError, Point, Powers, Response, Start, Step};

use num_complex::Complex64;

type Matrix = [[f64; MAX_NODES]; MAX_NODES];
type Values = [f64; MAX_NODES + 1];

/// Where so many steps have led since t = 0, inner strokes no longer bend as at a start.
const LAYER: f64 = 10.0;

/// Iterations of nonlinear parts, and how often one of them is halved.
const MOST_ITERATIONS: usize = 60;
const MOST_HALVINGS: usize = 30;

/// Change of the strokes, in units of the largest, at which they end.
const ENOUGH: f64 = 1e-14;

/// The same where rounding lets them come no nearer.
const NEARLY: f64 = 1e-9;

/// Square of what counts as rounding of forces.
const ROUNDED: f64 = 1e-28;

/// Iterations for the rates of nonlinear parts between two steps.
const MOST_SECANTS: usize = 200;

/// A part that is softer than this share of the stiffest counts as that soft.
const SOFTEST: f64 = 1e-30;

/// One part over a step, as it is told of it.
#[derive(Debug, Clone, Copy, Default)]
struct Inner {
    stroke: Values,
    rate: Values,
}

/// The inner strokes that fit, and what follows.
struct Solved {
    inner: [Inner; MOST_IN_SERIES],
    force: [f64; MAX_NODES],
    tangent: Matrix,
    /// By how much the force at the end follows an error of that of each part.
    shares: [f64; MOST_IN_SERIES],
}

impl Inner {
    /// Rates of the polynomial through the strokes.
    fn take_rates(&mut self, nodes: Nodes, h: f64) {
        let count = nodes.count();
        for (i, row) in nodes.inverse().iter().enumerate().take(count) {
            self.rate[i + 1] = (0..count).map(|j| row[j] * (self.stroke[j + 1] - self.stroke[0])).sum::<f64>() / h;
        }
        self.rate[0] = RatePolynomial::through_strokes(h, nodes, &self.stroke).u[0];
    }

    fn step<'a>(&'a self, outer: &Step<'a>) -> Step<'a> {
        let count = outer.nodes.count() + 1;
        Step { form: Form::Strokes, stroke: &self.stroke[..count], rate: &self.rate[..count], ..*outer }
    }
}

/// The strokes of the parts at t = 0, and the parts' own states.
pub(super) fn begin(parts: &[Network], start: &Start, state: &mut State) -> Result<(), KernelError> {
    let onset = match parts.iter().find_map(|part| derivative(part, start)).unwrap_or(Derivative::Caputo) {
        // What was held since ever has relaxed; what begins at t = 0 has not.
        Derivative::Caputo => Onset::Long,
        Derivative::RiemannLiouville => Onset::Short,
    };
    let at = Point { t: 0.0, stroke: start.stroke, rate: 0.0, inputs: start.inputs };
    let Shares { of_parts, order, is_limp } = shares(parts, &at, onset);
    let mut strokes: Vec<f64> = of_parts.iter().map(|share| share * start.stroke).collect();
    if order == 0.0 && !is_limp {
        let holding: Vec<usize> = (0..parts.len()).filter(|&k| of_parts[k] != 0.0).collect();
        balance(parts, &holding, start, &mut strokes)?;
    }
    strokes.iter().for_each(|stroke| state.push_variable(*stroke));
    let first = state.memories().len();
    for (k, part) in parts.iter().enumerate() {
        part.begin_part(&Start { stroke: strokes[k], jump: of_parts[k] * start.jump, ..*start }, state)?;
    }
    if onset == Onset::Short && start.jump != 0.0 {
        state.memories_mut()[first..].iter_mut().for_each(crate::fractional::Memory::lose_account);
    }
    Ok(())
}

/// How the parts share a stroke.
struct Shares {
    of_parts: Vec<f64>,
    /// The order of the parts that take some.
    order: f64,
    /// Whether a part gives no force at all.
    is_limp: bool,
}

/// What share of a stroke each part takes at once, or at last.
fn shares(parts: &[Network], at: &Point, onset: Onset) -> Shares {
    let terms: Vec<_> = parts.iter().map(|part| part.asymptote(at, onset)).collect();
    let softer = |a: f64, b: f64| if onset == Onset::Short { a < b } else { a > b };
    let order = terms.iter().map(|term| term.order).reduce(|a, b| if softer(b, a) { b } else { a }).unwrap_or(0.0);
    let compliance = |k: usize| if terms[k].order == order { terms[k].coefficient.recip() } else { 0.0 };
    let whole: f64 = (0..parts.len()).map(compliance).sum();
    // Where a part gives no force at all, the first of them takes everything.
    let limp = (0..parts.len()).find(|&k| compliance(k).is_infinite());
    let share = |k: usize| limp.map_or(compliance(k) / whole, |limp| f64::from(u8::from(k == limp)));
    Shares { of_parts: (0..parts.len()).map(share).collect(), order, is_limp: limp.is_some() }
}

/// Moves the strokes of the parts that hold at rest to where all have one force: what is not linear, or gives a force at x = 0, shares
/// differently.
fn balance(parts: &[Network], holding: &[usize], start: &Start, strokes: &mut [f64]) -> Result<(), KernelError> {
    let rest = |part: &Network, stroke: f64| -> Result<[f64; 2], KernelError> {
        let mut state = State::default();
        part.begin_part(&Start { stroke, jump: 0.0, ..*start }, &mut state)?;
        let at = Point { t: 0.0, stroke, rate: 0.0, inputs: start.inputs };
        let force = part.now_part(&at, &mut state.view(), &mut |_| ()).observation.regular;
        Ok([force, part.asymptote(&at, Onset::Long).coefficient])
    };
    let (mut from, mut apart_before, mut halvings) = (strokes.to_vec(), f64::INFINITY, 0);
    for _ in 0..MOST_ITERATIONS {
        let known = holding.iter().map(|&k| rest(&parts[k], strokes[k])).collect::<Result<Vec<_>, _>>()?;
        let (low, high) =
            known.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), [f, _]| (low.min(*f), high.max(*f)));
        if high - low <= ENOUGH * low.abs().max(high.abs()) {
            return Ok(());
        }
        if high - low >= apart_before && halvings < MOST_HALVINGS {
            halvings += 1;
            strokes.iter_mut().zip(&from).for_each(|(stroke, from)| *stroke = 0.5 * (*stroke + from));
            continue;
        }
        (apart_before, halvings) = (high - low, 0);
        from.copy_from_slice(strokes);
        let compliance: f64 = known.iter().map(|[_, slope]| slope.recip()).sum();
        let whole = known.iter().map(|[force, slope]| force / slope).sum::<f64>() / compliance;
        for (&k, [force, slope]) in holding.iter().zip(&known) {
            strokes[k] += (whole - force) / slope;
        }
    }
    Ok(())
}

/// The derivative that the first springpot takes.
fn derivative(part: &Network, start: &Start) -> Option<Derivative> {
    let mut state = State::default();
    part.begin_part(start, &mut state).ok()?;
    state.memories().first().map(crate::fractional::Memory::kind)
}

pub(super) fn prepare(parts: &[Network], step: &Step, state: &mut StateMut) {
    let strokes = state.take(own(parts)).variables;
    for (part, stroke) in parts.iter().zip(strokes) {
        let inner = Inner { stroke: [*stroke; MAX_NODES + 1], ..Inner::default() };
        part.prepare_part(&inner.step(step), state);
    }
}

/// The strokes of the parts under a periodic stroke since ever: all have one force at each frequency.
pub(super) fn recall(parts: &[Network], whole: &Periodic, at: &Point, state: &mut StateMut) {
    let mut inner: Vec<Vec<Complex64>> = vec![Vec::new(); parts.len()];
    let rest = shares(parts, at, Onset::Long).of_parts;
    for (n, (s, stroke)) in whole.harmonics().enumerate() {
        let compliances: Vec<Complex64> = parts.iter().map(|part| part.modulus(at, s).inv()).collect();
        let compliance: Complex64 = compliances.iter().sum();
        for (k, inner) in inner.iter_mut().enumerate() {
            inner.push(if n == 0 { rest[k] * stroke } else { compliances[k] / compliance * stroke });
        }
    }
    let strokes = state.take(own(parts)).variables;
    for ((part, spectrum), stroke) in parts.iter().zip(inner).zip(strokes) {
        let own = whole.with(spectrum);
        *stroke = own.stroke(0.0);
        part.recall_part(&own, at, state);
    }
}

pub(super) fn evaluate(parts: &[Network], step: &Step, state: &mut StateRef, response: &mut Response) {
    let strokes = state.take(own(parts)).variables;
    let Solved { force, tangent, .. } = solve(parts, step, strokes, state);
    for i in 0..step.nodes.count() {
        response.force[i] += force[i];
        for j in 0..step.nodes.count() {
            response.d_stroke[i][j] += tangent[i][j];
        }
    }
}

pub(super) fn commit(parts: &[Network], step: &Step, state: &mut StateMut) {
    let strokes = state.take(own(parts)).variables;
    let mut view = StateRef { memories: state.memories, variables: state.variables };
    let Solved { inner, .. } = solve(parts, step, strokes, &mut view);
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
    let strokes = state.take(own(parts)).variables;
    let Solved { mut inner, shares, .. } = solve(parts, step, strokes, &mut state.clone());
    for ((part, inner), share) in parts.iter().zip(&mut inner).zip(shares) {
        let (first, end) = (errors.len(), step.nodes.count());
        let rate = inner.rate[end];
        if step.nodes == Nodes::Radau {
            // The rates of the parabola through three of the strokes: what departs from it is the estimate.
            inner.rate = rates_of_parabola(&inner.stroke, step.h);
        }
        part.local_errors_part(&inner.step(step), state, errors);
        for error in &mut errors[first..] {
            // Dashpots are told rates that are known no better than the strokes.
            if error.error == 0.0 && error.order == 1.0 {
                error.error = (rate - inner.rate[end]).abs();
            }
            // A part that hardly yields in the step does not matter, however little is known of it. With share = (h/τ)^α what a step near the
            // start errs is h/τ of it later on, and no estimate is sharpened where strokes bend like t^α.
            (error.error, error.sharpness) = match step.t > LAYER * step.h || error.order == 0.0 {
                true => (error.error * share, (4.0 - error.order) / (3.0 - error.order)),
                false => (error.error * share.powf(error.order.recip()), 1.0),
            };
        }
    }
}

/// x' at 0 and at the nodes of the parabola through x at 0, at the second node and at the end.
fn rates_of_parabola(stroke: &Values, h: f64) -> Values {
    let positions = Nodes::Radau.positions();
    let middle = positions[1];
    let [a, b] = [stroke[2] - stroke[0], stroke[3] - stroke[0]];
    let bend = (b - a / middle) / (1.0 - middle);
    let slope = b - bend;
    std::array::from_fn(|k| (slope + 2.0 * bend * if k == 0 { 0.0 } else { positions[k - 1] }) / h)
}

pub(super) fn powers(parts: &[Network], step: &Step, state: &mut StateRef, powers: &mut Powers) {
    let strokes = state.take(own(parts)).variables;
    let Solved { inner, .. } = solve(parts, step, strokes, &mut state.clone());
    for (part, inner) in parts.iter().zip(&inner) {
        part.powers_part(&inner.step(step), state, powers);
    }
}

pub(super) fn guards(parts: &[Network], step: &Step, state: &mut StateRef, guards: &mut Vec<Guard>) {
    let strokes = state.take(own(parts)).variables;
    if !parts.iter().any(|part| part.has_guards(&step.point(0))) {
        *state = advance(parts, *state);
        return;
    }
    let Solved { inner, .. } = solve(parts, step, strokes, &mut state.clone());
    for (part, inner) in parts.iter().zip(&inner) {
        part.guards_part(&inner.step(step), state, guards);
    }
}

/// Inside a step: as a shorter one that ends there, so that rows are as good as ends of steps.
pub(super) fn at(parts: &[Network], step: &Step, theta: f64, at: &Point, state: &mut StateRef, take: Take) -> Reported {
    let shorter = Shorter::new(step, theta, at);
    let step = &shorter.step(step, theta);
    let strokes = state.take(own(parts)).variables;
    let Solved { inner, force, .. } = solve(parts, step, strokes, &mut state.clone());
    let last = step.nodes.count();
    let mut sum = Reported::sum(
        at,
        parts.iter().zip(&inner).map(|(part, inner)| {
            let inside = Point { stroke: inner.stroke[last], rate: inner.rate[last], ..*at };
            part.at_part(&inner.step(step), 1.0, &inside, state, take)
        }),
    );
    (sum.observation.regular, sum.observation.singular) = (force[last - 1], 0.0);
    sum
}

/// The first share of a step, with the nodes of a whole one.
struct Shorter {
    stroke: Values,
    rate: Values,
    inputs: Vec<crate::law::step::InputValue>,
}

impl Shorter {
    fn new(step: &Step, theta: f64, at: &Point) -> Self {
        let polynomial = match step.form {
            Form::Rates => RatePolynomial::through_rates(step.h, step.nodes, step.rate),
            Form::Strokes => RatePolynomial::through_strokes(step.h, step.nodes, step.stroke),
        };
        let last = step.nodes.count();
        let place = |k: usize| if k == 0 { 0.0 } else { theta * step.nodes.positions()[k - 1] };
        let mut stroke: Values =
            std::array::from_fn(|k| if k > last { 0.0 } else { step.stroke[0] + polynomial.travel_until(place(k)) });
        let mut rate: Values = std::array::from_fn(|k| if k > last { 0.0 } else { polynomial.rate(place(k)) });
        if step.nodes != Nodes::Midpoint {
            (stroke[last], rate[last]) = (at.stroke, at.rate);
        }
        // Inputs hardly bend within a step; at the end they are those asked for.
        let count = at.inputs.len();
        let mut inputs = step.inputs.to_vec();
        let (start, rest) = inputs.split_at_mut(count);
        for (k, values) in rest.chunks_exact_mut(count.max(1)).enumerate() {
            let c = step.nodes.positions()[k];
            for ((value, from), to) in values.iter_mut().zip(&*start).zip(at.inputs) {
                value.value = from.value + c * (to.value - from.value);
                value.rate = to.rate;
            }
        }
        Self { stroke, rate, inputs }
    }

    fn step<'a>(&'a self, whole: &Step<'a>, theta: f64) -> Step<'a> {
        let count = whole.nodes.count() + 1;
        Step {
            h: theta * whole.h,
            stroke: &self.stroke[..count],
            rate: &self.rate[..count],
            inputs: &self.inputs,
            ..*whole
        }
    }
}

/// Between two steps strokes do not jump: the force is that of the parts whose force follows from them alone; where every part has a
/// dashpot beside it, that of the rates that add up.
pub(super) fn now(parts: &[Network], at: &Point, state: &mut StateRef, take: Take) -> Reported {
    let strokes = state.take(own(parts)).variables;
    let force = |part: &Network, stroke: f64, rate: f64, state: &StateRef| {
        part.now_part(&Point { stroke, rate, ..*at }, &mut state.clone(), &mut |_| ()).observation.regular
    };
    // F = a_m + b_m v_m, v = Σ v_m; of parts that are not linear b_m is that of the secant to v_m.
    let (mut rates, mut whole) = ([1.0; MOST_IN_SERIES], f64::NAN);
    let iterations = if parts.iter().all(Network::is_linear) { 1 } else { MOST_SECANTS };
    for _ in 0..iterations {
        let (mut follows, mut yielding, mut owed) = (None, 0.0, 0.0);
        let (mut ahead, before) = (*state, whole);
        let mut lines = [[0.0; 2]; MOST_IN_SERIES];
        for (k, (part, &stroke)) in parts.iter().zip(strokes).enumerate() {
            let rest = force(part, stroke, 0.0, &ahead);
            let slope = (force(part, stroke, rates[k], &ahead) - rest) / rates[k];
            if slope == 0.0 {
                follows.get_or_insert(rest);
            } else {
                (yielding, owed) = (yielding + slope.recip(), owed + rest / slope);
            }
            lines[k] = [rest, slope];
            ahead.take(part.size());
        }
        whole = follows.unwrap_or((at.rate + owed) / yielding);
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
fn own(parts: &[Network]) -> crate::law::state::StateSize {
    crate::law::state::StateSize { memories: 0, variables: parts.len() }
}

/// Finds the strokes of the parts under the strokes of `step`, from those at its start.
fn solve(parts: &[Network], step: &Step, starts: &[f64], state: &mut StateRef) -> Solved {
    let nodes = step.nodes;
    let (count, inverse) = (nodes.count(), nodes.inverse());
    let is_linear = parts.iter().all(Network::is_linear);
    let mut search = Search::default();
    let mut inner = [Inner::default(); MOST_IN_SERIES];
    let missing = step.stroke[0] - starts.iter().sum::<f64>();
    for (inner, start) in inner.iter_mut().zip(starts) {
        for k in 0..=count {
            let moved = step.stroke[k] - step.stroke[0] + missing;
            // A nonlinear part would begin far from where it is: the stiffness where it was shares the way out.
            inner.stroke[k] = start + if k == 0 || !is_linear { 0.0 } else { moved / parts.len() as f64 };
        }
        inner.take_rates(nodes, step.h);
    }
    let (mut force, mut tangent) = ([0.0; MAX_NODES], [[0.0; MAX_NODES]; MAX_NODES]);
    let mut shares = [0.0; MOST_IN_SERIES];
    let mut is_found = is_linear;
    while search.ways <= MOST_ITERATIONS {
        let mut compliances = [[[0.0; MAX_NODES]; MAX_NODES]; MOST_IN_SERIES];
        let mut forces = [[0.0; MAX_NODES]; MOST_IN_SERIES];
        let mut each = *state;
        let mut stiffest = 0.0f64;
        for (k, part) in parts.iter().enumerate() {
            let mut response = Response::default();
            part.evaluate_part(&inner[k].step(step), &mut each, &mut response);
            forces[k] = response.force;
            let stiffness = &mut compliances[k];
            for i in 0..count {
                for j in 0..count {
                    let through_rates = (0..count).map(|m| response.d_rate[i][m] * inverse[m][j]).sum::<f64>();
                    stiffness[i][j] = response.d_stroke[i][j] + through_rates / step.h;
                    stiffest = stiffest.max(stiffness[i][j].abs());
                }
            }
        }
        if !is_linear && !search.goes_on(&forces[..parts.len()], count, &mut inner) {
            for inner in inner.iter_mut().take(parts.len()) {
                inner.take_rates(nodes, step.h);
            }
            if search.halvings > MOST_HALVINGS {
                is_found = search.change <= NEARLY;
                break;
            }
            continue;
        }
        let floor = (SOFTEST * stiffest).max(f64::MIN_POSITIVE);
        compliances.iter_mut().take(parts.len()).for_each(|matrix| invert(matrix, count, floor));
        let mut whole: Matrix = Default::default();
        let mut right = [0.0; MAX_NODES];
        for i in 0..count {
            let gathered: f64 = inner.iter().take(parts.len()).map(|inner| inner.stroke[i + 1]).sum();
            right[i] = step.stroke[i + 1] - gathered;
            for (matrix, forces) in compliances.iter().zip(&forces).take(parts.len()) {
                for j in 0..count {
                    whole[i][j] += matrix[i][j];
                    right[i] += matrix[i][j] * forces[j];
                }
            }
        }
        invert(&mut whole, count, f64::MIN_POSITIVE);
        tangent = whole;
        let product = |matrix: &Matrix, vector: &[f64; MAX_NODES], i: usize| -> f64 {
            (0..count).map(|j| matrix[i][j] * vector[j]).sum()
        };
        force = std::array::from_fn(|i| product(&tangent, &right, i));
        for (share, matrix) in shares.iter_mut().zip(&compliances) {
            *share = (0..count).map(|j| tangent[count - 1][j] * matrix[j][count - 1]).sum::<f64>().abs();
        }
        let (mut change, mut size) = (0.0f64, step.resolution);
        search.from = inner;
        for (k, matrix) in compliances.iter().enumerate().take(parts.len()) {
            let lacking: [f64; MAX_NODES] = std::array::from_fn(|i| force[i] - forces[k][i]);
            for i in 0..count {
                let delta = product(matrix, &lacking, i);
                inner[k].stroke[i + 1] += delta;
                // Not `max`, which would pass over what is no number.
                change = if delta.abs() > change || delta.is_nan() { delta.abs() } else { change };
                size = size.max(inner[k].stroke[i + 1].abs());
            }
            inner[k].take_rates(nodes, step.h);
        }
        if is_linear {
            break;
        }
        search.change = change / size;
        if search.change <= search.enough() {
            is_found = true;
            break;
        }
    }
    if !is_found {
        force = [f64::NAN; MAX_NODES];
        inner.iter_mut().for_each(|inner| inner.stroke[1..].fill(f64::NAN));
    }
    *state = advance(parts, *state);
    Solved { inner, force, tangent, shares }
}

/// A search for the strokes at which nonlinear parts have one force: along Newton's way, in halves where the whole does not bring
/// their forces together.
#[derive(Default)]
struct Search {
    /// Where the way begins.
    from: [Inner; MOST_IN_SERIES],
    /// How far the forces were apart there, N²; none before the first way, on which the strokes begin to add up.
    apart: Option<f64>,
    halvings: usize,
    ways: usize,
    is_rounding: bool,
    /// Change of the strokes on the last whole way, in units of the largest.
    change: f64,
}

impl Search {
    /// Whether forces are nearer each other than where the way began; else `inner` is half as far on it. Far from rounding only: there
    /// nothing brings them nearer.
    fn goes_on(&mut self, forces: &[[f64; MAX_NODES]], count: usize, inner: &mut [Inner; MOST_IN_SERIES]) -> bool {
        let (mut apart, mut size) = (0.0, 0.0);
        for i in 0..count {
            let mean = forces.iter().map(|force| force[i]).sum::<f64>() / forces.len() as f64;
            apart += forces.iter().map(|force| (force[i] - mean).powi(2)).sum::<f64>();
            size += forces.iter().map(|force| force[i].powi(2)).sum::<f64>();
        }
        self.is_rounding = self.ways > 1 && apart <= ROUNDED * size;
        let is_nearer = match self.apart {
            _ if self.ways < 2 => apart.is_finite(),
            Some(before) => apart < before || self.is_rounding,
            None => true,
        };
        if is_nearer {
            (self.apart, self.halvings) = (Some(apart), 0);
            self.ways += 1;
            return true;
        }
        self.halvings += 1;
        for (inner, from) in inner.iter_mut().zip(&self.from) {
            for (stroke, from) in inner.stroke.iter_mut().zip(from.stroke) {
                *stroke = 0.5 * (*stroke + from);
            }
        }
        false
    }

    /// Change at which the search ends: forces that are one but for rounding come no nearer.
    fn enough(&self) -> f64 {
        if self.is_rounding { NEARLY } else { ENOUGH }
    }
}

/// The state behind these parts.
fn advance<'a>(parts: &[Network], mut state: StateRef<'a>) -> StateRef<'a> {
    parts.iter().for_each(|part| {
        state.take(part.size());
    });
    state
}

/// The inverse of the leading `count` rows and columns, by elimination with pivots; a pivot below `floor` counts as that.
fn invert(matrix: &mut Matrix, count: usize, floor: f64) {
    let mut inverse: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    for k in 0..count {
        let pivot = (k..count).max_by(|&a, &b| matrix[a][k].abs().total_cmp(&matrix[b][k].abs())).unwrap_or(k);
        matrix.swap(k, pivot);
        inverse.swap(k, pivot);
        if matrix[k][k].abs() < floor {
            matrix[k][k] = floor;
        }
        let scale = matrix[k][k].recip();
        (matrix[k], inverse[k]) = (matrix[k].map(|x| x * scale), inverse[k].map(|x| x * scale));
        for i in (0..count).filter(|&i| i != k) {
            let factor = matrix[i][k];
            for j in 0..count {
                matrix[i][j] -= factor * matrix[k][j];
                inverse[i][j] -= factor * inverse[k][j];
            }
        }
    }
    *matrix = inverse;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverses_undo() {
        let matrix: Matrix = [[1e-3, 2.0, 0.5], [3.0, -1.0, 2.0], [0.1, 0.2, 5.0]];
        for count in 1..=MAX_NODES {
            let mut inverse = matrix;
            invert(&mut inverse, count, f64::MIN_POSITIVE);
            for i in 0..count {
                for j in 0..count {
                    let product: f64 = (0..count).map(|k| matrix[i][k] * inverse[k][j]).sum();
                    assert!((product - f64::from(u8::from(i == j))).abs() < 1e-12, "{count}: {product}");
                }
            }
        }
    }
}
