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
mod loose;
mod play;
mod slide;
mod solve;
mod start;
mod vary;
mod vary_past;
mod vary_start;

use super::part::{self, Onset, Part, Reported, Take};
use super::{MOST_IN_SERIES, Network};
use crate::collocation::inner::TABLEAU_OF_FOUR;
use crate::collocation::{MAX_NODES, Nodes};
use crate::dual::Dual;
use crate::fractional::{KernelError, Kind as Derivative};
use crate::law::harmonic::{self, Sine};
use crate::law::leaf::{Guard, Holds, Jenkins, Slide};
use crate::law::past::Recalled;
use crate::law::state::{State, StateMut, StateRef, StateSize};
use crate::law::step::{Course, InputValue, LocalError, Point, Power, Powers, Response, Start, Step, Term};
use crate::law::tangent::{self, AtRest};
use asked::Asked;
use loose::{Loose, Sought};
use num_complex::Complex64;
use play::Play;
use solve::{Inner, Solved, solve};

pub(in crate::law) use solve::Ready;

/// Parts one behind the other.
#[derive(Debug, Clone)]
pub struct Series {
    parts: Vec<Network>,
    /// Those that let go at some strokes or rates.
    loose: Option<Loose>,
    /// Whether its past is that of the Riemann–Liouville derivative, where no memory among its parts says so.
    is_unloaded: bool,
}

type Matrix = [[f64; MAX_NODES]; MAX_NODES];
type Values = [f64; MAX_NODES + 1];

/// Where so many steps have led since t = 0, inner strokes no longer bend as at a start.
const LAYER: f64 = 10.0;

/// Behind a change of sides, as a share of the time that has passed.
const SOON: f64 = 1e-11;

/// How much more an estimate counts before that: what it misses stays for as long as the parts relax.
const ONSET: f64 = 6.0;

/// What rounding of the strokes does to the estimate of a rate, in units of it over h, and what memories take from strokes of their own.
const ROUNDING: f64 = 40.0;
const OF_MEMORIES: f64 = 6.0;

/// The largest share of a step in which what its strokes move may count as rounding.
const NEAR: f64 = 1e-6;

/// Steps this short, as a share of the time that has passed, resolve no kink of friction.
const NARROW: f64 = 1e-9;

/// What a part tells of its sliding that does not slide.
const NO_FRICTION: Slide = Slide { force: 1.0, rate: 1.0 };

/// Iterations of nonlinear parts, and how often one of them is halved.
const MOST_ITERATIONS: usize = 60;
const MOST_HALVINGS: usize = 30;

/// Change of the strokes, in units of the largest, at which they end.
const ENOUGH: f64 = 1e-14;

/// Iterations for the rates of nonlinear parts between two steps.
const MOST_SECANTS: usize = 200;

impl Series {
    pub(super) fn new(parts: Vec<Network>) -> Self {
        Self { loose: Loose::of(&parts), parts, is_unloaded: false }
    }

    /// With the past that this derivative stands for.
    pub(super) fn after(self, derivative: Derivative) -> Self {
        Self { is_unloaded: derivative == Derivative::RiemannLiouville, ..self }
    }

    /// Splits off what it keeps itself: the strokes of its parts, and when a play last changed sides.
    fn own<'a>(&self, state: &mut StateRef<'a>) -> (&'a [f64], f64) {
        let (strokes, since) = state.take(self.own_size()).variables.split_at(self.parts.len());
        (strokes, since.first().copied().unwrap_or(0.0))
    }

    pub(super) fn into_parts(self) -> Vec<Network> {
        self.parts
    }

    /// Those of the parts that are free at some strokes.
    fn play(&self) -> Option<&Play> {
        self.loose.as_ref()?.play.as_ref()
    }

    /// Whether part `k` is one of those.
    fn is_free(&self, k: usize) -> bool {
        self.loose.as_ref().is_some_and(|loose| loose.is_free(k))
    }

    /// Whether part `k` is friction.
    fn slides(&self, k: usize) -> bool {
        self.lets_go(k) && !self.is_free(k)
    }

    /// Part `k` where it is a spring that slips.
    fn slips(&self, k: usize) -> Option<Jenkins> {
        match &self.parts[k] {
            Network::Leaf(leaf) => leaf.slips(),
            _ => None,
        }
    }

    /// Whether part `k` is one that lets go.
    fn lets_go(&self, k: usize) -> bool {
        self.loose.as_ref().is_some_and(|loose| loose.has(k))
    }

    /// The compliance of a play beside one of the others.
    fn softness(&self, others: f64) -> f64 {
        others + self.play().map_or(0.0, |play| play.stiffness().recip())
    }

    /// Whether all but those are linear.
    fn others_are_linear(&self) -> bool {
        self.parts.iter().enumerate().all(|(k, part)| self.lets_go(k) || part.is_linear())
    }

    /// The strokes of those that are never free, together, and of a play.
    fn split(&self, strokes: &[f64]) -> [f64; 2] {
        if self.loose.is_none() {
            return [strokes.iter().sum(), 0.0];
        }
        let of = |is_free: bool| {
            (0..self.parts.len()).filter(|k| self.is_free(*k) == is_free).map(|k| strokes[k]).sum::<f64>()
        };
        [of(false), of(true)]
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
    fn solved(&self, step: &Step, state: &mut StateRef, sought: Sought) -> (Asked, Solved) {
        let ready = state.take_ready();
        let asked = self.asked(step, ready);
        let (strokes, _) = self.own(state);
        let solved = solve(self, &asked.step(step), strokes, ready, *state, sought);
        (asked, solved)
    }

    /// The force at θ: the polynomial through that at its start and at the nodes, on which accelerations rest where strokes are sought.
    fn between(&self, step: &Step, theta: f64, mut state: StateRef) -> f64 {
        let start = self.now(&step.point(0), &mut state.clone(), &mut |_| ()).observation.regular;
        let (_, Solved { force, .. }) = self.solved(step, &mut state, Sought::Fit);
        let values = [start, force[0], force[1], force[2], force[3]];
        let at = |row: &Values| row.iter().zip(values).map(|(weight, value)| weight * value).sum::<f64>();
        TABLEAU_OF_FOUR.values.iter().rev().fold(0.0, |sum, row| sum * theta + at(row))
    }

    /// What holds between two steps, where strokes do not jump; the state is at the shares of the parts.
    fn settle(&self, at: &Point, strokes: &[f64], state: StateRef) -> Settled {
        let slack = self.play().filter(|play| play.force(play.stroke(|k| strokes[k])) == 0.0);
        let force = |part: &Network, stroke: f64, rate: f64, state: &StateRef| {
            part.ask().now(&Point { stroke, rate, ..*at }, &mut state.clone(), &mut |_| ()).observation.regular
        };
        // F = a_m + b_m v_m, v = Σ v_m; of parts that are not linear b_m is that of the secant to v_m.
        let (mut rates, mut whole) = ([1.0; MOST_IN_SERIES], f64::NAN);
        let (mut lines, mut followed) = ([[0.0; 2]; MOST_IN_SERIES], None);
        let iterations = if self.parts.iter().all(Network::is_linear) { 1 } else { MOST_SECANTS };
        for _ in 0..iterations {
            let (mut follows, mut yielding, mut owed): (Option<(f64, f64, usize)>, _, _) = (None, 0.0, 0.0);
            let (mut ahead, before) = (state, whole);
            for (k, (part, &stroke)) in self.parts.iter().zip(strokes).enumerate() {
                let rest = force(part, stroke, 0.0, &ahead);
                let slope = (force(part, stroke, rates[k], &ahead) - rest) / rates[k];
                if slope == 0.0 {
                    // What springpots have not begun to tell springs know.
                    let order = part.ask().asymptote(at, Onset::Short).order;
                    if follows.is_none_or(|(least, ..)| order < least) {
                        follows = Some((order, rest, k));
                    }
                } else {
                    (yielding, owed) = (yielding + slope.recip(), owed + rest / slope);
                }
                lines[k] = [rest, slope];
                part.ask().pass(&mut ahead);
            }
            whole =
                follows.map_or((at.rate + owed) / yielding, |(_, rest, _)| if slack.is_some() { 0.0 } else { rest });
            followed = follows.map(|(.., k)| k);
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
        for k in (0..self.parts.len()).filter(|k| self.slides(*k)) {
            // Where it slides as fast as that no force tells its rate, and nothing else moves; behind a jump it is what gives way.
            let slide = self.parts[k].ask().slides(at.inputs).unwrap_or(NO_FRICTION);
            let others: f64 = (0..self.parts.len()).filter(|other| *other != k).map(|other| rates[other]).sum();
            let unknown = || if at.t == 0.0 { slide.most(whole) } else { at.rate - others };
            rates[k] = slide.rate_under(whole).unwrap_or_else(unknown);
        }
        if let Some(play) = slack {
            // What is slack moves as the whole does but for how the others come back.
            let others: f64 = (0..self.parts.len()).filter(|k| !play.has(*k)).map(|k| rates[k]).sum();
            rates[play.first()] = at.rate - others;
        }
        Settled { rates, whole, lines, follows: followed, is_slack: slack.is_some() }
    }
}

/// Rates and force between two steps.
struct Settled {
    /// Of the parts.
    rates: [f64; MOST_IN_SERIES],
    whole: f64,
    /// The force of each part where its rate is 0, and how it follows that.
    lines: [[f64; 2]; MOST_IN_SERIES],
    /// The part that the force is that of, whatever the rates.
    follows: Option<usize>,
    is_slack: bool,
}

impl Part for Series {
    fn parts(&self) -> &[Network] {
        &self.parts
    }

    /// The strokes of its parts, and when a play last changed sides.
    fn own_size(&self) -> StateSize {
        StateSize { memories: 0, variables: self.parts.len() + usize::from(self.play().is_some()) }
    }

    fn series_count(&self) -> usize {
        1 + self.parts.iter().map(|part| part.ask().series_count()).sum::<usize>()
    }

    fn begin(&self, start: &Start, state: &mut State) -> Result<(), KernelError> {
        start::begin(self, start, state)
    }

    /// The strokes of its parts follow from their moduli alone.
    fn recalls(&self) -> bool {
        self.is_linear()
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
            ready.get(self, is_yielding, step, &strokes[..self.parts.len()], state.view());
        }
        self.parts.iter().for_each(|part| part.ask().pass_mut(state));
    }

    fn evaluate(&self, step: &Step, state: &mut StateRef, response: &mut Response) {
        let (asked, Solved { force, tangent, .. }) = self.solved(step, state, Sought::Fit);
        self.parts.iter().for_each(|part| part.ask().pass(state));
        asked.respond(&force, &tangent, response);
    }

    fn commit(&self, step: &Step, state: &mut StateMut) {
        let ready = state.take_ready();
        let asked = self.asked(step, ready.as_deref());
        let step = &asked.step(step);
        let (strokes, since) = state.take(self.own_size()).variables.split_at_mut(self.parts.len());
        let Solved { inner, .. } = solve(self, step, strokes, ready.as_deref(), state.view(), Sought::Fit);
        if let Some((play, since)) = self.play().zip(since.first_mut()) {
            let side = |point: usize| play.side(play.stroke(|k| inner[k].stroke[point]), play::near(step));
            let end = side(step.nodes.count());
            *since = if end.is_none() || end != side(0) { step.t + step.h } else { *since };
        }
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
        let mut behind_ready = *state;
        behind_ready.take_ready();
        let (strokes, since) = self.own(&mut behind_ready);
        let (asked, Solved { mut inner, shares, .. }) = self.solved(step, state, Sought::Fit);
        // Of series within each other the outermost one weighs.
        let onset = if step.nodes == Nodes::Inner { 1.0 } else { ONSET };
        let step = &asked.step(step);
        let is_on_end = |play: &Play| play.side(play.stroke(|k| strokes[k]), play::near(step)).is_none();
        let since = if self.play().is_some_and(is_on_end) { step.t } else { since };
        for (k, ((part, inner), share)) in self.parts.iter().zip(&mut inner).zip(shares).enumerate() {
            let (first, end) = (errors.len(), step.nodes.count());
            let exact = inner.rate;
            let rate = exact[end];
            if step.nodes == Nodes::Inner {
                // The rates of the cubic through all strokes but one: what departs from it is the estimate.
                inner.rate = embedded_rates(&inner.stroke, step.h);
            }
            // Strokes of parts may be larger than that of the whole by far.
            let largest = inner.stroke[..=end].iter().fold(0.0f64, |largest, stroke| largest.max(stroke.abs()));
            let resolution = ROUNDING * (step.resolution + 4.0 * f64::EPSILON * largest);
            let told = Step { resolution: resolution / OF_MEMORIES, ..inner.step(step) };
            part.ask().local_errors(&told, state, errors);
            if self.slides(k) {
                errors.push(of_friction(part, step, &exact, share, resolution));
                continue;
            }
            for error in &mut errors[first..] {
                // Dashpots are told rates that are known no better than the strokes; those of a series inside know it already.
                if error.sharpness == 0.0 {
                    error.error = ((rate - inner.rate[end]).abs() - resolution / step.h).max(0.0);
                }
            }
            // Behind a change of sides strokes begin as at t = 0, alike on every scale of time: the first of them err by what is soon nothing.
            let is_onset = since > 0.0 && step.t + step.h - since <= SOON * since;
            for error in &mut errors[first..] {
                if is_onset && error.error.is_finite() {
                    error.error = 0.0;
                }
                // A part that hardly yields in the step does not matter, however little is known of it. With share = (h/τ)^α what a step near
                // the start errs is h/τ of it later on.
                (error.error, error.sharpness) = match step.t - since > LAYER * step.h || error.order == 0.0 {
                    true => (error.error * share, (5.0 - error.order) / (4.0 - error.order)),
                    false => (onset * error.error * share.powf(error.order.recip()), 1.0),
                };
            }
        }
    }

    fn powers(&self, step: &Step, state: &mut StateRef, powers: &mut Powers) {
        let (asked, Solved { inner, .. }) = self.solved(step, state, Sought::Fit);
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
            return self.pass(state);
        }
        let (asked, Solved { inner, .. }) = self.solved(step, state, Sought::Held);
        let step = &asked.step(step);
        let first = guards.len();
        for (k, (part, inner)) in self.parts.iter().zip(&inner).enumerate() {
            match self.is_free(k) {
                true => part.ask().pass(state),
                false => part.ask().guards(&inner.step(step), state, guards),
            }
        }
        if let Some(play) = self.play() {
            let stroke: Guard = std::array::from_fn(|point| play.stroke(|k| inner[k].stroke[point]));
            guards.extend(play.ends().map(|end| stroke.map(|stroke| stroke - end)));
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
        let (strokes, _) = self.own(state);
        let Solved { inner, force, side, .. } = solve(self, step, strokes, ready, *state, Sought::Fit);
        let last = step.nodes.count();
        let mut sum = Reported::sum(
            at,
            self.parts.iter().zip(&inner).map(|(part, inner)| {
                let inside = Point { stroke: inner.stroke[last], rate: inner.rate[last], ..*at };
                part.ask().at(&inner.step(step), 1.0, &inside, state, take)
            }),
        );
        let own = force[last - 1];
        let regular = match (self.play(), known) {
            // Between nodes a polynomial may pass beyond what a play gives.
            (Some(_), Some(_)) if side == 0 => own,
            (Some(_), Some(known)) if f64::from(side) * known < 0.0 => own,
            (_, known) => known.unwrap_or(own),
        };
        (sum.observation.regular, sum.observation.singular) = (regular, 0.0);
        sum
    }

    /// Between two steps strokes do not jump: the force is that of the parts whose force follows from them alone; where every part has a
    /// dashpot beside it, that of the rates that add up.
    fn now(&self, at: &Point, state: &mut StateRef, take: Take) -> Reported {
        state.take_ready();
        let (strokes, _) = self.own(state);
        let Settled { rates, whole, .. } = self.settle(at, strokes, *state);
        let each = self.parts.iter().zip(strokes).zip(rates).map(|((part, &stroke), rate)| {
            let inside = Point { stroke, rate, ..*at };
            let owed = if at.t == 0.0 { start::owed(part, &inside, whole, state) } else { Vec::new() };
            start::now_with(part, &inside, &owed, state, take)
        });
        let mut sum = Reported::sum(at, each);
        (sum.observation.regular, sum.observation.singular) = (whole, 0.0);
        sum
    }

    fn by_input(&self, step: &Step, state: &mut StateRef, input: usize, slopes: &mut [[f64; MAX_NODES]; MAX_NODES]) {
        let (asked, solved) = self.solved(step, state, Sought::Fit);
        let inside = solve::by_input(self, &asked.step(step), &solved, input, *state);
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
        match self.play() {
            Some(play) if !play.is_any() => Holds::Never,
            _ => self.parts.iter().map(Network::holds).min().unwrap_or(Holds::Always),
        }
    }

    fn stiffness(&self, at: &Point, omega: f64) -> f64 {
        let own = |(k, part): (usize, &Network)| match self.play() {
            // Where the whole is stretched says nothing of whether what is free at times is engaged.
            Some(play) if play.has(k) => play.stiffness_of(k),
            _ => part.stiffness(at, omega),
        };
        self.parts.iter().enumerate().map(|part| own(part).recip()).sum::<f64>().recip()
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

    fn harmonic(&self, sine: &Sine) -> Option<Complex64> {
        match self.is_linear() {
            true => Some(self.at_rest(&sine.at, 0.0)?.tangent.modulus(Complex64::new(0.0, sine.omega))),
            false => harmonic::driven(&Network::Series(self.clone()), sine),
        }
    }

    fn modulus_slope(&self, at: &Point<Dual>, s: [Complex64; 2]) -> Option<[Complex64; 2]> {
        let moduli = self.parts.iter().map(|part| part.ask().modulus_slope(at, s)).collect::<Option<Vec<_>>>()?;
        let slack: Vec<&[Complex64; 2]> = moduli.iter().filter(|[own, _]| *own == Complex64::ZERO).collect();
        match slack[..] {
            [] => {}
            // What carries nothing is all that tells, where it is alone.
            [[own, slope]] => return Some([*own, *slope]),
            _ => return Some([Complex64::ZERO; 2]),
        }
        let whole = moduli.iter().map(|[own, _]| own.inv()).sum::<Complex64>().inv();
        let slope: Complex64 = moduli.iter().map(|[own, slope]| slope * (whole / own).powi(2)).sum();
        Some([whole, slope])
    }

    /// That of the softest part.
    fn asymptote(&self, at: &Point, onset: Onset) -> Term {
        let own = |(k, part): (usize, &Network)| match self.play() {
            Some(play) if play.has(k) => Term { coefficient: play.stiffness_of(k), order: 0.0 },
            _ => part.ask().asymptote(at, onset),
        };
        part::asymptote(self.parts.iter().enumerate().map(own), onset, false)
    }

    fn at_rest(&self, at: &Point, _: f64) -> Option<AtRest> {
        tangent::series(&self.parts, at)
    }
}

/// How well friction knows its force, in units of f/v0, by its rates at the nodes: what they miss of its stroke as its force follows that, by the
/// `compliance` of the others, where it sticks; where it slides no force tells, but it will stick again. Where it begins to slide no order is sharp.
fn of_friction(part: &Network, step: &Step, rate: &Values, compliance: f64, resolution: f64) -> LocalError {
    let end = step.nodes.count();
    let Slide { force, rate: turns } = part.ask().slides(step.inputs_at(end)).unwrap_or(NO_FRICTION);
    let value = turns * (rate[end] / turns).tanh();
    let known = |error| LocalError { error, sharpness: 1.0, ..LocalError::told(value) };
    // Where it begins to slide far faster than v0 the force has a kink for every step: a shorter one only moves it by so much.
    if step.nodes != Nodes::Inner || step.h < NARROW * step.t {
        return known(0.0);
    }
    // By what the rates themselves make of the strokes: differences of these round more than friction may.
    let along = |rate: &[f64]| {
        let moved = step.matrix().map(|row| row.iter().zip(rate).map(|(entry, rate)| entry * rate).sum::<f64>());
        moved.map(|moved| step.h * moved)
    };
    let [first, second, third, last] = along(&rate[1..]);
    let embedded = along(&embedded_rates(&[0.0, first, second, third, last], step.h)[1..]);
    let off = [first - embedded[0], second - embedded[1], third - embedded[2], last - embedded[3]];
    let largest = off.iter().fold(0.0f64, |largest, off| if off.is_nan() { f64::NAN } else { largest.max(off.abs()) });
    let yields = compliance * force / turns + step.h * step.matrix()[end - 1][end - 1];
    known(if largest > resolution || largest.is_nan() { (largest - resolution) / yields } else { 0.0 })
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
