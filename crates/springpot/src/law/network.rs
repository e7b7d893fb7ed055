//! A law as a network of leaves, and how it is asked.

mod heated;
mod series;

pub use heated::{Heated, Warmth};
pub(super) use series::Ready;

use super::heat::Heat;
use super::leaf::{Coefficient, Dashpot, Leaf, Source, Spring, Springpot, When};
use super::past::Recalled;
use super::rule::RuleError;
use super::state::{State, StateMut, StateRef, StateSize};
use super::step::{
    Electric, InputValue, LeafState, LocalError, Observation, Point, Powers, Response, Start, Step, Term,
};
use crate::collocation::{MAX_NODES, Nodes};
use crate::fractional::Kind as Derivative;
use crate::fractional::{KernelError, Memory, RatePolynomial};
use num_complex::Complex64;
use std::sync::Arc;

/// Most parts side by side in one series; more of them are nested.
const MOST_IN_SERIES: usize = 8;

/// A law: leaves, and parts that share their stroke or their force. It may hold any number of springpots of any orders.
///
/// A network knows no body and chooses no step. Whatever is in it, to the outside it is one map from strokes and rates at the nodes of a
/// step to forces there; what it keeps between steps is a [`State`] outside it.
///
/// ```
/// use springpot::collocation::Nodes;
/// use springpot::fractional::Form;
/// use springpot::law::{Derivative, Network, Course, Start, Step};
///
/// // A fractional Maxwell element: a spring, and a springpot behind it.
/// let law = Network::series([Network::spring(100.0), Network::springpot(50.0, 0.5, Derivative::Caputo)]);
/// let mut state = law.begin(&Start { stroke: 0.0, jump: 0.0, inputs: &[] })?;
/// state.open(1e-11, 1e-3, 1.0)?;
/// // x = t²/10 over one step of 10 ms that is asked at its end.
/// let (stroke, rate) = ([0.0, 1e-5], [0.0, 2e-3]);
/// let step = Step {
///     t: 0.0, h: 0.01, nodes: Nodes::One, places: None, form: Form::Strokes, stroke: &stroke, rate: &rate, inputs: &[],
///     resolution: 0.0, course: Course::Given,
/// };
/// let force = law.evaluate(&step, &state).force[0];
/// assert!(0.0 < force && force < 100.0 * 1e-5); // softer than the spring alone
/// # Ok::<(), springpot::fractional::KernelError>(())
/// ```
#[derive(Debug, Clone)]
pub enum Network {
    /// What gives a force by itself.
    Leaf(LeafPart),
    /// One stroke, forces add.
    Parallel(Vec<Network>),
    /// One force, strokes add.
    Series(Vec<Network>),
    /// A whole law and what temperature does to it.
    Heated(Box<Heated>),
}

/// A leaf in its place in a network.
#[derive(Debug, Clone)]
pub struct LeafPart {
    name: Option<Arc<str>>,
    leaf: Arc<dyn Leaf>,
}

impl std::ops::Deref for LeafPart {
    type Target = dyn Leaf;

    fn deref(&self) -> &Self::Target {
        self.leaf.as_ref()
    }
}

/// A function whose zeros are kinks of a force, at the start and at the nodes of a step.
pub type Guard = [f64; MAX_NODES + 1];

/// Whether a part of a network carries force: what stands behind it in a series is free where it does not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Holds {
    /// It never gives any.
    Never,
    /// There are strokes at which it yields to every force.
    AtTimes,
    /// Wherever it is.
    Always,
}

impl Network {
    /// A leaf.
    pub fn leaf(leaf: impl Leaf + 'static) -> Self {
        Self::Leaf(LeafPart { name: None, leaf: Arc::new(leaf) })
    }

    /// A leaf that others hold too.
    pub fn shared<L: Leaf + 'static>(leaf: Arc<L>) -> Self {
        Self::Leaf(LeafPart { name: None, leaf })
    }

    /// A leaf under this name; parts that are none stay as they are.
    pub fn named(self, name: &Arc<str>) -> Self {
        match self {
            Self::Leaf(LeafPart { leaf, .. }) => Self::Leaf(LeafPart { name: Some(name.clone()), leaf }),
            other => other,
        }
    }

    /// Names of all leaves, in their order: given ones, else `spring1`, `spring2`, `dashpot1`, …
    pub fn leaf_names(&self) -> Vec<String> {
        let mut parts = Vec::new();
        self.for_each_leaf(&mut |part| parts.push(part.clone()));
        let unnamed = |part: &LeafPart| part.name.is_none().then(|| part.leaf.name());
        let name = |(k, part): (usize, &LeafPart)| {
            let number = |kind: &str| 1 + parts[..k].iter().filter(|other| unnamed(other) == Some(kind)).count();
            part.name
                .as_ref()
                .map_or_else(|| format!("{}{}", part.leaf.name(), number(part.leaf.name())), ToString::to_string)
        };
        parts.iter().enumerate().map(name).collect()
    }

    /// By leaf: the order of the derivative that it tells, 0 or 1; any (`None`) where it is a springpot.
    pub fn leaf_orders(&self, at: &Point) -> Vec<Option<f64>> {
        let mut orders = Vec::new();
        self.for_each_leaf(&mut |leaf| {
            let order = || if leaf.linearised(at).order == 1.0 { 1.0 } else { 0.0 };
            orders.push((leaf.size().memories == 0).then(order));
        });
        orders
    }

    fn for_each_leaf(&self, take: &mut dyn FnMut(&LeafPart)) {
        match self {
            Self::Leaf(part) => take(part),
            Self::Parallel(parts) | Self::Series(parts) => parts.iter().for_each(|part| part.for_each_leaf(take)),
            Self::Heated(heated) => heated.law().for_each_leaf(take),
        }
    }

    /// Whether it carries force wherever it is.
    pub fn holds(&self) -> Holds {
        match self {
            Self::Leaf(leaf) => leaf.holds(),
            Self::Parallel(parts) => parts.iter().map(Self::holds).max().unwrap_or(Holds::Never),
            Self::Series(parts) => parts.iter().map(Self::holds).min().unwrap_or(Holds::Always),
            Self::Heated(heated) => heated.law().holds(),
        }
    }

    /// F = k·x, k in N/m.
    pub fn spring(stiffness: f64) -> Self {
        Self::leaf(Spring { stiffness })
    }

    /// F = c·x', c in N·s/m.
    pub fn dashpot(viscosity: f64) -> Self {
        Self::leaf(Dashpot { viscosity })
    }

    /// F = c·D^alpha x, 0 ≤ alpha ≤ 1, c in N·s^alpha/m.
    pub fn springpot(coefficient: f64, alpha: f64, derivative: Derivative) -> Self {
        Self::varying_springpot(Coefficient::constant(coefficient), alpha, derivative)
    }

    /// F = c·D^alpha x with a coefficient that follows an input.
    pub fn varying_springpot(coefficient: Coefficient, alpha: f64, derivative: Derivative) -> Self {
        Self::leaf(Springpot { coefficient, alpha, derivative })
    }

    /// F = −gain·(input − reference), the input counted from 0.
    pub fn source(gain: f64, reference: f64, input: usize) -> Self {
        Self::leaf(Source { gain, reference, input })
    }

    /// Parts side by side: one stroke, forces add. None: no force.
    pub fn parallel(parts: impl IntoIterator<Item = Self>) -> Self {
        Self::Parallel(parts.into_iter().collect())
    }

    /// Parts one behind the other: one force, strokes add. None: rigid, which no element may be. A series among the parts is none of its own: its
    /// parts are those of the whole.
    ///
    /// # Panics
    /// Where a part is a law under heat, which is always a whole one.
    pub fn series(parts: impl IntoIterator<Item = Self>) -> Self {
        let own = |part: Self| match part {
            Self::Series(parts) => parts,
            other => vec![other],
        };
        let mut parts: Vec<Self> = parts.into_iter().flat_map(own).collect();
        assert!(parts.iter().all(|part| part.as_heated().is_none()), "a law under heat is a whole one");
        while parts.len() > MOST_IN_SERIES {
            let nested = parts.drain(..MOST_IN_SERIES).collect();
            parts.push(Self::Series(nested));
        }
        Self::Series(parts)
    }

    /// A law under `heat`, of so many `inputs`, of which `takes` is the temperature.
    pub(super) fn heated(law: Self, heat: Heat, inputs: usize, takes: Option<usize>) -> Self {
        Self::Heated(Box::new(Heated::new(law, heat, inputs, takes)))
    }

    /// What temperature does to it, where it does anything.
    pub fn as_heated(&self) -> Option<&Heated> {
        match self {
            Self::Heated(heated) => Some(heated),
            _ => None,
        }
    }

    /// Whether it keeps a temperature of its own.
    pub fn is_thermal(&self) -> bool {
        self.as_heated().is_some_and(|heated| heated.heat().thermal.is_some())
    }

    /// The input, a temperature, that stretches it.
    pub fn stretched_by(&self) -> Option<usize> {
        self.as_heated().and_then(Heated::stretch).map(|(input, _)| input)
    }

    /// The temperature that inputs from outside say, K; NaN where they say none.
    pub(crate) fn temperature(&self, inputs: &[InputValue]) -> f64 {
        let input = self.as_heated().and_then(Heated::input).and_then(|input| inputs.get(input));
        input.map_or(f64::NAN, |input| input.value)
    }

    /// Temperature and heat of a law that keeps a temperature: at θ of a step, or between two steps.
    pub fn warmth(&self, within: Option<(&Step, f64)>, state: &State) -> Option<Warmth> {
        self.as_heated()?.warmth(within, state.view())
    }

    /// What of a state belongs to this part.
    fn size(&self) -> StateSize {
        let (parts, own) = match self {
            Self::Leaf(leaf) => return leaf.size(),
            Self::Heated(heated) => return heated.size(),
            Self::Parallel(parts) => (parts, 0),
            Self::Series(parts) => (parts, parts.len()),
        };
        parts.iter().map(Self::size).fold(StateSize { memories: 0, variables: own }, |sum, part| StateSize {
            memories: sum.memories + part.memories,
            variables: sum.variables + part.variables,
        })
    }

    /// The state at t = 0. Its memories have no kernels yet ([`State::open`]): only [`Network::now`] may be asked.
    ///
    /// Who takes x(0) in a series: the part of the lowest order where the derivative is Riemann–Liouville's, that of the highest where it is
    /// Caputo's, for which the stroke was held since ever; parts of the same order share it.
    ///
    /// # Errors
    /// [`KernelError`] where a memory cannot be.
    pub fn begin(&self, start: &Start) -> Result<State, KernelError> {
        let mut state = State::default();
        self.begin_part(start, &mut state)?;
        Ok(state)
    }

    fn begin_part(&self, start: &Start, state: &mut State) -> Result<(), KernelError> {
        match self {
            Self::Leaf(leaf) => leaf.begin(start, state),
            Self::Parallel(parts) => parts.iter().try_for_each(|part| part.begin_part(start, state)),
            Self::Series(parts) => series::begin(parts, start, state),
            Self::Heated(heated) => heated.begin(start, state),
        }
    }

    /// Whether a state can be one of this law.
    pub fn has_state(&self, state: &State) -> bool {
        self.size() == state.size()
    }

    /// Makes ready what does not change while a step is worked out; no answer changes.
    pub fn prepare(&self, step: &Step, state: &mut State) {
        state.make_room(self.series_count());
        self.prepare_part(step, &mut state.view_mut());
    }

    /// How many series are in it.
    fn series_count(&self) -> usize {
        match self {
            Self::Leaf(_) => 0,
            Self::Parallel(parts) => parts.iter().map(Self::series_count).sum(),
            Self::Series(parts) => 1 + parts.iter().map(Self::series_count).sum::<usize>(),
            Self::Heated(heated) => heated.law().series_count(),
        }
    }

    /// Passes over its share of a state.
    fn pass(&self, state: &mut StateRef) {
        state.skip(self.size(), self.series_count());
    }

    fn prepare_part(&self, step: &Step, state: &mut StateMut) {
        match self {
            Self::Leaf(leaf) => leaf.prepare(step, state.take(leaf.size())),
            Self::Parallel(parts) => parts.iter().for_each(|part| part.prepare_part(step, state)),
            Self::Series(parts) => series::prepare(parts, step, state),
            Self::Heated(heated) => heated.prepare(step, state),
        }
    }

    /// Forces at the nodes of `step` and their tangents. Pure.
    pub fn evaluate(&self, step: &Step, state: &State) -> Response {
        let mut response = Response::default();
        self.evaluate_part(step, &mut state.view(), &mut response);
        response
    }

    fn evaluate_part(&self, step: &Step, state: &mut StateRef, response: &mut Response) {
        match self {
            Self::Leaf(leaf) => leaf.evaluate(step, state.take(leaf.size()), response),
            Self::Parallel(parts) => parts.iter().for_each(|part| part.evaluate_part(step, state, response)),
            Self::Series(parts) => series::evaluate(parts, step, state, response),
            Self::Heated(heated) => heated.evaluate(step, state, response),
        }
    }

    /// ∂F_i/∂u_j for input `input`, u_j its value at node j, at the strokes of `step`. Pure. Inputs of parts in series are left out: a method
    /// that solves for them converges without, more slowly.
    pub fn by_input(&self, step: &Step, state: &State, input: usize) -> [[f64; MAX_NODES]; MAX_NODES] {
        let mut slopes = [[0.0; MAX_NODES]; MAX_NODES];
        self.by_input_part(step, &mut state.view(), input, &mut slopes);
        slopes
    }

    fn by_input_part(
        &self,
        step: &Step,
        state: &mut StateRef,
        input: usize,
        slopes: &mut [[f64; MAX_NODES]; MAX_NODES],
    ) {
        match self {
            Self::Leaf(leaf) => leaf.by_input(step, state.take(leaf.size()), input, slopes),
            Self::Parallel(parts) => parts.iter().for_each(|part| part.by_input_part(step, state, input, slopes)),
            Self::Series(_) => self.pass(state),
            Self::Heated(heated) => heated.by_input(step, state, input, slopes),
        }
    }

    /// Takes an accepted step into the state: the only change of it.
    pub fn commit(&self, step: &Step, state: &mut State) {
        self.commit_part(step, &mut state.view_mut());
        state.leave_start();
    }

    fn commit_part(&self, step: &Step, state: &mut StateMut) {
        match self {
            Self::Leaf(leaf) => leaf.commit(step, state.take(leaf.size())),
            Self::Parallel(parts) => parts.iter().for_each(|part| part.commit_part(step, state)),
            Self::Series(parts) => series::commit(parts, step, state),
            Self::Heated(heated) => heated.commit(step, state),
        }
    }

    /// Appends how well the step knows each memory, inner variable and dashpot, in the order of the leaves. Pure.
    pub fn local_errors(&self, step: &Step, state: &State, errors: &mut Vec<LocalError>) {
        self.local_errors_part(step, &mut state.view(), errors);
    }

    fn local_errors_part(&self, step: &Step, state: &mut StateRef, errors: &mut Vec<LocalError>) {
        match self {
            Self::Leaf(leaf) => leaf.local_errors(step, state.take(leaf.size()), errors),
            Self::Parallel(parts) => parts.iter().for_each(|part| part.local_errors_part(step, state, errors)),
            Self::Series(parts) => series::local_errors(parts, step, state, errors),
            Self::Heated(heated) => heated.local_errors(step, state, errors),
        }
    }

    /// Energy flows at the start and at the nodes of the step; of dissipation zeros after a singular start. Pure.
    pub fn powers(&self, step: &Step, state: &State) -> Powers {
        let mut powers = Powers::default();
        self.powers_part(step, &mut state.view(), &mut powers);
        powers
    }

    fn powers_part(&self, step: &Step, state: &mut StateRef, powers: &mut Powers) {
        match self {
            Self::Leaf(leaf) => leaf.powers(step, state.take(leaf.size()), powers),
            Self::Parallel(parts) => parts.iter().for_each(|part| part.powers_part(step, state, powers)),
            Self::Series(parts) => series::powers(parts, step, state, powers),
            Self::Heated(heated) => heated.powers(step, state, powers),
        }
    }

    /// Appends functions whose zeros are kinks of a force, by their values at the start and at the nodes of the step. Pure.
    pub fn guards(&self, step: &Step, state: &State, guards: &mut Vec<Guard>) {
        self.guards_part(step, &mut state.view(), guards);
    }

    fn guards_part(&self, step: &Step, state: &mut StateRef, guards: &mut Vec<Guard>) {
        match self {
            Self::Leaf(leaf) => leaf.guards_in(step, state.take(leaf.size()), guards),
            Self::Parallel(parts) => parts.iter().for_each(|part| part.guards_part(step, state, guards)),
            Self::Series(parts) => series::guards(parts, step, state, guards),
            Self::Heated(heated) => heated.guards(step, state, guards),
        }
    }

    /// Whether its force may have kinks that steps are to end on.
    pub fn has_guards(&self, at: &Point) -> bool {
        if let Self::Heated(heated) = self {
            return heated.has_guards(at);
        }
        let mut found = false;
        self.for_each_leaf(&mut |leaf| leaf.guards(at, &mut |_| found = true));
        found
    }

    /// The law at t_n + theta·h, 0 < theta ≤ 1, where its exact kinematics are those of `at`. Pure.
    pub fn at(&self, step: &Step, theta: f64, at: &Point, state: &State) -> Observation {
        self.at_part(step, theta, at, &mut state.view(), &mut |_| ()).observation
    }

    /// Appends every leaf, in their order, as [`Self::at`] has it. Pure.
    pub fn leaves_at(&self, step: &Step, theta: f64, at: &Point, state: &State, leaves: &mut Vec<LeafState>) {
        self.at_part(step, theta, at, &mut state.view(), &mut |leaf| leaves.push(leaf));
    }

    fn at_part(&self, step: &Step, theta: f64, at: &Point, state: &mut StateRef, take: Take) -> Reported {
        match self {
            Self::Leaf(leaf) => {
                let size = leaf.size();
                Reported::leaf(&**leaf, at, leaf.at(step, theta, at, state.take(size)), take)
            }
            Self::Parallel(parts) => {
                Reported::sum(at, parts.iter().map(|part| part.at_part(step, theta, at, state, take)))
            }
            Self::Series(parts) => series::at(parts, step, theta, at, state, take),
            Self::Heated(heated) => heated.at(step, theta, at, state, take),
        }
    }

    /// The law between two steps, under the kinematics and inputs of `at`, which may have jumped since the last one: memories and inner
    /// variables do not jump. Pure.
    pub fn now(&self, at: &Point, state: &State) -> Observation {
        self.now_part(at, &mut state.seen_at(at.t).view(), &mut |_| ()).observation
    }

    /// Appends every leaf, in their order, as [`Self::now`] has it. Pure.
    pub fn leaves_now(&self, at: &Point, state: &State, leaves: &mut Vec<LeafState>) {
        self.now_part(at, &mut state.seen_at(at.t).view(), &mut |leaf| leaves.push(leaf));
    }

    fn now_part(&self, at: &Point, state: &mut StateRef, take: Take) -> Reported {
        match self {
            Self::Leaf(leaf) => Reported::leaf(&**leaf, at, leaf.now(at, state.take(leaf.size())), take),
            Self::Parallel(parts) => Reported::sum(at, parts.iter().map(|part| part.now_part(at, state, take))),
            Self::Series(parts) => series::now(parts, at, state, take),
            Self::Heated(heated) => heated.now(at, state, take),
        }
    }

    /// The electrical side of the law: that of its first leaf that has one and is in no series. Pure.
    pub fn electric(&self, when: When, at: &Point, state: &State) -> Option<Electric> {
        self.electric_part(when, at, &mut state.view())
    }

    fn electric_part(&self, when: When, at: &Point, state: &mut StateRef) -> Option<Electric> {
        match self {
            Self::Leaf(leaf) => leaf.electric(when, at, state.take(leaf.size())),
            Self::Parallel(parts) => parts.iter().find_map(|part| part.electric_part(when, at, state)),
            Self::Series(_) | Self::Heated(_) => {
                self.pass(state);
                None
            }
        }
    }

    /// Whether something in it goes on by itself with time ([`Leaf::has_clock`]).
    pub(super) fn has_clock(&self) -> bool {
        let mut found = false;
        self.for_each_leaf(&mut |leaf| found |= leaf.has_clock());
        found
    }

    /// Whether it has an electrical side to tell.
    pub fn is_electric(&self) -> bool {
        match self {
            Self::Leaf(leaf) => leaf.is_electric(),
            Self::Parallel(parts) => parts.iter().any(Self::is_electric),
            Self::Series(_) | Self::Heated(_) => false,
        }
    }

    /// |∂F/∂x| of small strokes about `at` at the rate `omega`, rad/s, without any memory: k + c·ω + Σ c·ω^alpha of parallel parts.
    pub fn stiffness(&self, at: &Point, omega: f64) -> f64 {
        match self {
            Self::Leaf(leaf) => leaf.linearised(at).stiffness(omega),
            Self::Parallel(parts) => parts.iter().map(|part| part.stiffness(at, omega)).sum(),
            Self::Series(parts) => parts.iter().map(|part| part.stiffness(at, omega).recip()).sum::<f64>().recip(),
            Self::Heated(heated) => heated.stiffness(at, omega),
        }
    }

    /// The size of the force where x was reached at the rate `omega`, rad/s, signed.
    pub fn estimate(&self, at: &Point, state: &State, omega: f64) -> f64 {
        self.estimate_part(at, &mut state.view(), omega)
    }

    fn estimate_part(&self, at: &Point, state: &mut StateRef, omega: f64) -> f64 {
        match self {
            Self::Leaf(leaf) => {
                let own = state.take(leaf.size());
                match own.memories {
                    [] => leaf.now(at, own).force(),
                    _ => leaf.linearised(at).stiffness(omega) * at.stroke,
                }
            }
            Self::Parallel(parts) => parts.iter().map(|part| part.estimate_part(at, state, omega)).sum(),
            Self::Series(_) => {
                self.pass(state);
                self.stiffness(at, omega) * at.stroke
            }
            Self::Heated(heated) => heated.estimate(at, state, omega),
        }
    }

    /// Hands over c·D^alpha x of every springpot that the stroke reaches at once; of a series what it is like at short times.
    pub fn for_each_springpot(&self, at: &Point, take: &mut dyn FnMut(Term)) {
        match self {
            Self::Leaf(leaf) if leaf.size().memories > 0 => take(leaf.linearised(at)),
            Self::Leaf(_) => {}
            Self::Parallel(parts) => parts.iter().for_each(|part| part.for_each_springpot(at, take)),
            Self::Series(_) => {
                let term = self.asymptote(at, Onset::Short);
                if term.order > 0.0 && term.order < 1.0 {
                    take(term);
                }
            }
            Self::Heated(heated) => heated.for_each_springpot(at, take),
        }
    }

    /// Whether the force is without bound behind a stroke that is there at once, by what stands in series.
    pub(super) fn jolts(&self, at: &Point) -> bool {
        match self {
            Self::Leaf(_) | Self::Heated(_) => false,
            Self::Parallel(parts) => parts.iter().any(|part| part.jolts(at)),
            Self::Series(_) => self.asymptote(at, Onset::Short).order > 0.0,
        }
    }

    /// The coefficient of the dashpot that it is like at short times; 0 where it is like none.
    pub(super) fn dashed(&self, at: &Point) -> f64 {
        let Term { coefficient, order } = self.asymptote(at, Onset::Short);
        if order == 1.0 { coefficient } else { 0.0 }
    }

    /// Hands over s and alpha of every share s·t^−alpha of a singular start in F.
    pub fn for_each_singularity(&self, inputs: &[InputValue], state: &State, take: &mut dyn FnMut(Term)) {
        if state.is_singular() {
            self.singularities(inputs, &mut state.view(), take);
        }
    }

    fn singularities(&self, inputs: &[InputValue], state: &mut StateRef, take: &mut dyn FnMut(Term)) {
        match self {
            Self::Leaf(leaf) => {
                if let Some(term) = leaf.singular(inputs, state.take(leaf.size())) {
                    take(term);
                }
            }
            Self::Parallel(parts) => parts.iter().for_each(|part| part.singularities(inputs, state, take)),
            Self::Series(_) => self.pass(state),
            Self::Heated(heated) => heated.singularities(inputs, state, take),
        }
    }

    /// Rules over the inputs, to hold at every time.
    ///
    /// # Errors
    /// [`RuleError`] names the broken rule.
    pub fn check_inputs(&self, inputs: &[InputValue]) -> Result<(), RuleError> {
        match self {
            Self::Leaf(leaf) => leaf.check_inputs(inputs),
            Self::Parallel(parts) | Self::Series(parts) => parts.iter().try_for_each(|part| part.check_inputs(inputs)),
            Self::Heated(heated) => heated.check_inputs(inputs),
        }
    }

    /// The order of the derivative that an [`Observation`] tells; 0 where it is the stroke.
    pub fn reported_order(&self, at: &Point) -> f64 {
        self.report(at).1
    }

    fn report(&self, at: &Point) -> (u8, f64) {
        match self {
            Self::Leaf(leaf) => report(&**leaf, at),
            Self::Parallel(parts) | Self::Series(parts) => {
                let reports = parts.iter().map(|part| part.report(at));
                reports.fold((0, 0.0), |first, next| if next.0 > first.0 { next } else { first })
            }
            Self::Heated(heated) => heated.report(at),
        }
    }

    /// Whether there is one derivative that an [`Observation`] tells: that of its only springpot; without one and without series the rate of
    /// a dashpot, else the stroke.
    pub fn tells_derivative(&self) -> bool {
        let mut springpots = 0;
        self.for_each_leaf(&mut |leaf| springpots += usize::from(leaf.size().memories > 0));
        springpots == 1 || (springpots == 0 && self.is_linear() && !self.has_series())
    }

    fn has_series(&self) -> bool {
        match self {
            Self::Leaf(_) => false,
            Self::Parallel(parts) => parts.iter().any(Self::has_series),
            Self::Series(_) => true,
            Self::Heated(heated) => heated.law().has_series(),
        }
    }

    /// Whether a part of a series has a memory.
    pub(super) fn has_memories_in_series(&self) -> bool {
        match self {
            Self::Leaf(_) => false,
            Self::Parallel(parts) => parts.iter().any(Self::has_memories_in_series),
            Self::Series(_) => self.size().memories > 0,
            Self::Heated(heated) => heated.law().has_memories_in_series(),
        }
    }

    /// Whether it keeps inner strokes or inner variables, whose errors no stroke shows.
    pub fn has_inner_variables(&self) -> bool {
        self.size().variables > 0
    }

    /// How many of its local errors, the first of them, are those of what no stroke shows: all of them where it keeps inner strokes.
    pub fn hidden_errors(&self) -> usize {
        match self {
            Self::Heated(heated) => heated.hidden_errors(),
            _ if self.has_inner_variables() => usize::MAX,
            _ => 0,
        }
    }

    /// Puts the stroke before t = 0 into the state of a law that is linear, its memories opened.
    pub(super) fn recall(&self, stroke: &Recalled, at: &Point, state: &mut State) {
        self.recall_part(stroke, at, &mut state.view_mut());
    }

    fn recall_part(&self, stroke: &Recalled, at: &Point, state: &mut StateMut) {
        match self {
            Self::Leaf(leaf) => state.take(leaf.size()).memories.iter_mut().for_each(|memory| recall(memory, stroke)),
            Self::Parallel(parts) => parts.iter().for_each(|part| part.recall_part(stroke, at, state)),
            Self::Series(parts) => series::recall(parts, stroke, at, state),
            Self::Heated(heated) => heated.recall(stroke, at, state),
        }
    }

    /// F/x under e^{st} of a linear law, N/m: k + c·s + Σ c·s^alpha of parallel parts.
    pub fn modulus(&self, at: &Point, s: Complex64) -> Complex64 {
        match self {
            Self::Leaf(leaf) => {
                let Term { coefficient, order } = leaf.linearised(at);
                coefficient * if order == 0.0 { Complex64::ONE } else { s.powf(order) }
            }
            Self::Parallel(parts) => parts.iter().map(|part| part.modulus(at, s)).sum(),
            Self::Series(parts) => {
                let moduli = parts.iter().map(|part| part.modulus(at, s));
                // At s = 0 one that carries nothing lets all of them carry nothing.
                let compliance =
                    moduli.map(|one| (one != Complex64::ZERO).then(|| one.inv())).sum::<Option<Complex64>>();
                compliance.map_or(Complex64::ZERO, |compliance| compliance.inv())
            }
            Self::Heated(heated) => heated.modulus(at, s),
        }
    }

    /// K' and K'' of K* = [`Self::modulus`] under e^{iωt}, N/m: what is stored, and what is lost.
    pub fn complex_modulus(&self, at: &Point, omega: f64) -> [f64; 2] {
        let modulus = self.modulus(at, Complex64::new(0.0, omega));
        [modulus.re, modulus.im]
    }

    /// Whether F is an affine function of strokes and rates.
    pub fn is_linear(&self) -> bool {
        match self {
            Self::Leaf(leaf) => leaf.is_linear(),
            Self::Parallel(parts) | Self::Series(parts) => parts.iter().all(Self::is_linear),
            Self::Heated(heated) => heated.law().is_linear(),
        }
    }

    /// What remains of the network at short or at long times.
    fn asymptote(&self, at: &Point, onset: Onset) -> Term {
        let (parts, adds) = match self {
            Self::Leaf(leaf) => return leaf.linearised(at),
            Self::Heated(heated) => return heated.asymptote(at, onset),
            Self::Parallel(parts) => (parts, true),
            Self::Series(parts) => (parts, false),
        };
        // The stiffest of parallel parts and the softest of those in series: that of the higher order at short times.
        let takes_highest = adds == (onset == Onset::Short);
        let terms = || parts.iter().map(|part| part.asymptote(at, onset)).filter(|term| term.coefficient != 0.0);
        let orders = terms().map(|term| term.order);
        let order = if takes_highest { orders.fold(0.0, f64::max) } else { orders.fold(f64::INFINITY, f64::min) };
        let order = if order.is_finite() { order } else { 0.0 };
        let same = terms().filter(|term| term.order == order).map(|term| term.coefficient);
        let coefficient = if adds { same.sum() } else { same.map(f64::recip).sum::<f64>().recip() };
        Term { coefficient, order }
    }
}

/// Puts the stroke before t = 0 into a memory.
fn recall(memory: &mut Memory, stroke: &Recalled) {
    let (alpha, width) = (memory.alpha(), stroke.last());
    let rate = |t: f64| stroke.sum(|s| s * (s * t).exp());
    let mode = |lambda: f64| stroke.sum(|s| s / (lambda + s));
    let nodes = Nodes::Radau;
    let rates: Vec<f64> = [0.0].iter().chain(nodes.positions()).map(|theta| rate((theta - 1.0) * width)).collect();
    let last = RatePolynomial::through_rates(width, nodes, &rates);
    let derivative = stroke.sum(|s| if alpha == 0.0 { Complex64::ONE } else { s.powf(alpha) });
    memory.recall(&mode, &last, derivative, stroke.mean());
}

/// How much the derivative that a leaf tells is worth, and its order.
fn report(leaf: &dyn Leaf, at: &Point) -> (u8, f64) {
    match (leaf.size().memories, leaf.linearised(at).order) {
        (0, 1.0) => (1, 1.0),
        (0, _) => (0, 0.0),
        (_, order) => (2, order),
    }
}

/// Which end of the times a law is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Onset {
    Short,
    Long,
}

/// Takes the leaves of a network, one after the other.
type Take<'a> = &'a mut dyn FnMut(LeafState);

/// An observation, and whose derivative it tells: that of the first springpot, else that of the first dashpot.
#[derive(Debug, Clone, Copy)]
struct Reported {
    observation: Observation,
    rank: u8,
}

impl Reported {
    fn leaf(leaf: &dyn Leaf, at: &Point, observation: Observation, take: Take) -> Self {
        let Point { stroke, rate, .. } = *at;
        take(LeafState { stroke, rate, force: observation.force(), derivative: observation.derivative });
        Self { observation, rank: report(leaf, at).0 }
    }

    /// That of a step in which no force is found.
    fn unknown() -> Self {
        let observation = Observation { derivative: f64::NAN, regular: f64::NAN, singular: 0.0, stored: None };
        Self { observation, rank: 0 }
    }

    fn sum(at: &Point, parts: impl Iterator<Item = Self>) -> Self {
        let none = Observation { derivative: at.stroke, regular: 0.0, singular: 0.0, stored: Some(0.0) };
        parts.fold(Self { observation: none, rank: 0 }, |mut sum, part| {
            let (own, other) = (&mut sum.observation, part.observation);
            own.regular += other.regular;
            own.singular += other.singular;
            own.stored = own.stored.zip(other.stored).map(|(a, b)| a + b);
            if part.rank > sum.rank {
                (own.derivative, sum.rank) = (other.derivative, part.rank);
            }
            sum
        })
    }
}
