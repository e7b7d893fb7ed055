//! A law as a network of leaves, and how it is asked.

mod heated;
mod leaf;
mod part;
mod series;
mod vary;

pub use heated::{Heated, Warmth};
pub use leaf::LeafPart;
pub(super) use part::Part;
pub(super) use series::Ready;
pub use series::Series;

use super::harmonic::Sine;
use super::heat::Heat;
use super::leaf::{Clock, Coefficient, Dashpot, Free, Guard, Holds, Jenkins, Leaf, Source, Spring, Springpot, When};
use super::past::{Recalled, RecalledVariation};
use super::rule::RuleError;
use super::state::{State, StateRef, StateSize};
use super::step::{InputValue, LeafState, LocalError, Observation, Point, Powers, Response, Start, Step, Term};
use super::tangent::AtRest;
use super::told::Told;
use super::variation::{LawVariation, ObservationVariation, PointVariation, PowersVariation, StepVariation, TakeError};
use crate::collocation::MAX_NODES;
use crate::dual::Dual;
use crate::fractional::Kind as Derivative;
use crate::fractional::{KernelError, MemoryTangent};
use num_complex::Complex64;
use part::{Onset, asymptote_by};
use std::sync::Arc;
use vary::Vary;

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
    Series(Series),
    /// A whole law and what temperature does to it.
    Heated(Box<Heated>),
}

impl Network {
    /// Whoever answers for it.
    #[inline]
    pub(super) fn ask(&self) -> &dyn Vary {
        match self {
            Self::Leaf(part) => part,
            Self::Parallel(parts) => parts,
            Self::Series(series) => series,
            Self::Heated(heated) => &**heated,
        }
    }

    /// What it is made of, in order: nothing of a leaf, the law itself of one under heat.
    pub fn parts(&self) -> &[Self] {
        self.ask().parts()
    }

    /// A leaf.
    pub fn leaf(leaf: impl Leaf + 'static) -> Self {
        Self::Leaf(LeafPart { name: None, leaf: Arc::new(leaf) })
    }

    /// A leaf that others hold too.
    pub fn shared(leaf: Arc<dyn Leaf>) -> Self {
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
        self.ask().for_each_leaf(&mut |part| parts.push(part.clone()));
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
        self.ask().for_each_leaf(&mut |leaf| {
            let order = || if leaf.linearised(at).order == 1.0 { 1.0 } else { 0.0 };
            orders.push((leaf.size().memories == 0).then(order));
        });
        orders
    }

    /// Whether it carries force wherever it is.
    pub fn holds(&self) -> Holds {
        self.ask().holds()
    }

    /// The strokes at which it carries nothing ([`Leaf::free`]).
    pub(super) fn free(&self) -> Option<Free> {
        self.ask().free()
    }

    /// Whether it is a spring that slips, or such a one and others one behind the other ([`Leaf::slips`]).
    pub(super) fn slips(&self) -> bool {
        match self {
            Self::Leaf(leaf) => leaf.slips().is_some(),
            Self::Series(series) => series.parts().iter().any(Self::slips),
            _ => false,
        }
    }

    /// F = k·x, k in N/m.
    pub fn spring(stiffness: impl Into<Dual>) -> Self {
        Self::leaf(Spring { stiffness: stiffness.into() })
    }

    /// F = c·x', c in N·s/m.
    pub fn dashpot(viscosity: impl Into<Dual>) -> Self {
        Self::leaf(Dashpot { viscosity: viscosity.into() })
    }

    /// F = c·D^alpha x, 0 ≤ alpha ≤ 1, c in N·s^alpha/m.
    pub fn springpot(coefficient: impl Into<Dual>, alpha: impl Into<Dual>, derivative: Derivative) -> Self {
        Self::varying_springpot(Coefficient::constant(coefficient), alpha, derivative)
    }

    /// F = c·D^alpha x with a coefficient that follows an input.
    pub fn varying_springpot(coefficient: Coefficient, alpha: impl Into<Dual>, derivative: Derivative) -> Self {
        Self::leaf(Springpot { coefficient, alpha: alpha.into(), derivative })
    }

    /// F = −gain·(input − reference), the input counted from 0.
    pub fn source(gain: impl Into<Dual>, reference: impl Into<Dual>, input: usize) -> Self {
        Self::leaf(Source { gain: gain.into(), reference: reference.into(), input })
    }

    /// Parts side by side: one stroke, forces add. None: no force.
    pub fn parallel(parts: impl IntoIterator<Item = Self>) -> Self {
        Self::Parallel(parts.into_iter().collect())
    }

    /// Parts one behind the other: one force, strokes add. None: rigid, which no element may be. A series among the parts is none of its own: its
    /// parts are those of the whole. Springs that slip and plain ones beside them are one leaf, a spring that slips.
    ///
    /// # Panics
    /// Where a part is a law under heat, which is always a whole one.
    pub fn series(parts: impl IntoIterator<Item = Self>) -> Self {
        let own = |part: Self| match part {
            Self::Series(series) => series.into_parts(),
            other => vec![other],
        };
        let mut parts: Vec<Self> = parts.into_iter().flat_map(own).collect();
        assert!(parts.iter().all(|part| part.as_heated().is_none()), "a law under heat is a whole one");
        parts = with_one_that_slips(parts);
        if let [Self::Leaf(leaf)] = &parts[..]
            && leaf.slips().is_some()
        {
            return parts.remove(0);
        }
        while parts.len() > MOST_IN_SERIES {
            let nested = parts.drain(..MOST_IN_SERIES).collect();
            parts.push(Self::Series(Series::new(nested)));
        }
        Self::Series(Series::new(parts))
    }

    /// A series with the past that this derivative stands for: it says who has a force that is there unstretched where no springpot does.
    pub(super) fn after(self, derivative: Derivative) -> Self {
        match self {
            Self::Series(series) => Self::Series(series.after(derivative)),
            other => other,
        }
    }

    /// A law under `heat`, of so many `inputs`, of which `takes` is the temperature.
    pub(super) fn heated(law: Self, heat: Heat, inputs: usize, takes: Option<usize>) -> Self {
        Self::Heated(Box::new(Heated::new(law, heat, inputs, takes)))
    }

    /// The same where a parameter moves the numbers of its heat by those of `moved`, which is made of the same: [`Self::numbers`] carry that.
    pub fn with_moving_heat(self, moved: Heat) -> Self {
        match self {
            Self::Heated(heated) => Self::Heated(Box::new(heated.moving(moved))),
            other => other,
        }
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

    /// The state at t = 0. Its memories have no kernels yet ([`State::open`]): only [`Network::now`] may be asked.
    ///
    /// Who takes x(0) in a series: the part of the lowest order where the derivative is Riemann–Liouville's, that of the highest where it is
    /// Caputo's, for which the stroke was held since ever; parts of the same order share it.
    ///
    /// # Errors
    /// [`KernelError`] where a memory cannot be.
    pub fn begin(&self, start: &Start) -> Result<State, KernelError> {
        let mut state = State::default();
        self.ask().begin(start, &mut state)?;
        Ok(state)
    }

    /// The numbers of its leaves, in their order, with their derivatives where it was built of such.
    pub fn numbers(&self) -> Vec<Dual> {
        let mut numbers = Vec::new();
        self.ask().numbers(&mut |number| numbers.push(number));
        numbers
    }

    /// The part of it of which no derivative by a parameter is known, as it is called.
    pub fn without_derivatives(&self) -> Option<String> {
        self.ask().without_derivatives()
    }

    /// Appends what parameters change of its memories at t = 0 ([`super::Leaf::begin_memories`]).
    pub(super) fn begin_memories(
        &self,
        state: &State,
        own: &LawVariation,
        memories: &mut Vec<MemoryTangent>,
    ) -> Result<(), KernelError> {
        self.ask().begin_memories(&mut state.view(), &mut own.view(), memories)
    }

    /// Puts what parameters change of its state at t = 0, where `told` is what changes of its start.
    pub fn begin_variation(&self, at: &Point, state: &State, told: &PointVariation, own: &mut LawVariation) {
        self.ask().begin_variation(at, &mut state.view(), told, &mut own.view_mut());
    }

    /// Puts what parameters change of a stroke before t = 0 into what they change of a state that recalls it.
    pub(super) fn recall_variation(
        &self,
        stroke: (&Recalled, &RecalledVariation),
        at: (&Point, &PointVariation),
        laws: &[&Self],
        state: &State,
        own: &mut LawVariation,
    ) -> Result<(), String> {
        self.ask().recall_variation(stroke, at, laws, &mut state.view(), &mut own.view_mut())
    }

    /// How fast its inner variables change, in their order; `None` where somebody does not tell.
    pub(crate) fn rates(&self, at: &Point, state: &State) -> Option<Vec<f64>> {
        let mut rates = Vec::new();
        self.ask().rates(at, &mut state.view(), &mut rates).then_some(rates)
    }

    /// What parameters change of its forces at the nodes of a step where strokes and rates there stay, node by node, a block for each
    /// ([`super::Leaf::vary`]).
    pub fn vary(&self, step: &Step, state: &State, told: &StepVariation, own: &LawVariation, forces: &mut [f64]) {
        forces.fill(0.0);
        self.ask().vary(step, &mut state.view(), told, &mut own.view(), forces);
    }

    /// Takes what changes of an accepted step, which is not in the state yet, into what changes of that.
    pub fn commit_variation(&self, step: &Step, state: &State, told: &StepVariation, own: &mut LawVariation) {
        self.ask().commit_variation(step, &mut state.view(), told, &mut own.view_mut());
        own.leave_start();
    }

    /// Hands over how well a step knows what parameters change of its inner variables, each with its number ([`super::Leaf::vary_errors`]).
    pub(crate) fn vary_errors(
        &self,
        step: &Step,
        state: &State,
        told: &StepVariation,
        own: &LawVariation,
        take: TakeError,
    ) {
        let all = state.size().variables;
        self.ask().vary_errors(step, &mut state.view(), told, &mut own.view(), &mut |k, error| take(all - k, error));
    }

    /// Adds what parameters change of its energy flows at the start and at the nodes of a step.
    pub fn vary_powers(
        &self,
        step: &Step,
        state: &State,
        told: &StepVariation,
        own: &LawVariation,
        sum: &mut PowersVariation,
    ) {
        self.ask().vary_powers(step, &mut state.view(), told, &mut own.view(), sum);
    }

    /// What parameters change of its singular forces at the nodes of a step, node by node, a block for each ([`super::Leaf::vary_singular`]).
    pub fn vary_singular(
        &self,
        step: &Step,
        state: &State,
        told: &StepVariation,
        own: &LawVariation,
        forces: &mut [f64],
    ) {
        forces.fill(0.0);
        self.ask().vary_singular(step, &mut state.view(), told, &mut own.view(), forces);
    }

    /// Adds what parameters change of its singular forces at the time of `at`, and of their integrals since `from`
    /// ([`super::Leaf::vary_singularity`]).
    pub fn vary_singularity(
        &self,
        (from, at): (f64, &Point),
        state: &State,
        told: &PointVariation,
        own: &LawVariation,
        sums: [&mut [f64]; 3],
    ) {
        self.ask().vary_singularity((from, at), &mut state.view(), told, &mut own.view(), sums);
    }

    /// Adds what parameters change of it at one time: within a step, or between two.
    pub fn vary_at(
        &self,
        (when, at): (When, &Point),
        state: &State,
        told: &PointVariation,
        own: &LawVariation,
        sum: &mut ObservationVariation,
    ) {
        self.ask().vary_at((when, at), &mut state.view(), told, &mut own.view(), sum);
    }

    /// Whether a state can be one of this law.
    pub fn has_state(&self, state: &State) -> bool {
        self.ask().size() == state.size()
    }

    /// Whether its force follows from stroke, rate and inputs of one time alone: no memories, no inner variables, no clock of its own.
    pub fn keeps_nothing(&self) -> bool {
        self.ask().size() == StateSize::default() && self.as_heated().is_none()
    }

    /// Makes ready what does not change while a step is worked out; no answer changes.
    pub fn prepare(&self, step: &Step, state: &mut State) {
        state.make_room(self.ask().series_count());
        self.ask().prepare(step, &mut state.view_mut());
    }

    /// Forces at the nodes of `step` and their tangents. Pure.
    pub fn evaluate(&self, step: &Step, state: &State) -> Response {
        let mut response = Response::default();
        self.ask().evaluate(step, &mut state.view(), &mut response);
        response
    }

    /// The same with the tangents that derivatives by parameters take, where iterations take others; nothing where they are the same.
    pub(crate) fn evaluate_exactly(&self, step: &Step, state: &State) -> Option<Response> {
        let mut response = Response::default();
        self.ask().slips_inside().then(|| self.ask().evaluate_exactly(step, &mut state.view(), &mut response))?;
        Some(response)
    }

    /// ∂F_i/∂u_j for input `input`, u_j its value at node j, at the strokes of `step`. Pure.
    pub fn by_input(&self, step: &Step, state: &State, input: usize) -> [[f64; MAX_NODES]; MAX_NODES] {
        let mut slopes = [[0.0; MAX_NODES]; MAX_NODES];
        self.ask().by_input(step, &mut state.view(), input, &mut slopes);
        slopes
    }

    /// Takes an accepted step into the state: the only change of it.
    pub fn commit(&self, step: &Step, state: &mut State) {
        self.ask().commit(step, &mut state.view_mut());
        state.leave_start();
    }

    /// Appends how well the step knows each memory, inner variable and dashpot, in the order of the leaves. Pure.
    pub fn local_errors(&self, step: &Step, state: &State, errors: &mut Vec<LocalError>) {
        self.ask().local_errors(step, &mut state.view(), errors);
    }

    /// Energy flows at the start and at the nodes of the step; of dissipation zeros after a singular start. Pure.
    pub fn powers(&self, step: &Step, state: &State) -> Powers {
        let mut powers = Powers::default();
        self.ask().powers(step, &mut state.view(), &mut powers);
        powers
    }

    /// Appends functions whose zeros are kinks of a force, by their values at the start and at the nodes of the step. Pure.
    pub fn guards(&self, step: &Step, state: &State, guards: &mut Vec<Guard>) {
        self.ask().guards(step, &mut state.view(), guards);
    }

    /// Whether its force may have kinks that steps are to end on.
    pub fn has_guards(&self, at: &Point) -> bool {
        self.ask().has_guards(at)
    }

    /// Whether parts of it stand one behind the other.
    pub(crate) fn has_series(&self) -> bool {
        self.ask().series_count() > 0
    }

    /// Whether what it dissipates may begin at once at one of them, from a time that no derivative tells; springs that slip tell how far they slipped.
    pub(crate) fn begins_untold(&self, at: &Point) -> bool {
        self.has_guards(at) && self.any_leaf(|leaf| leaf.size().variables > 0 && leaf.slips().is_none())
    }

    /// Whether its force may jump at one of them ([`Leaf::jumps`]).
    pub fn jumps(&self) -> bool {
        self.any_leaf(|leaf| leaf.jumps())
    }

    /// Hands over functions of the stroke that pass zero where its force jumps ([`Leaf::jumps_at`]); in a series strokes are others, and none are known.
    pub(crate) fn jumps_at(&self, stroke: Dual, take: &mut dyn FnMut(Dual)) {
        match self {
            Self::Leaf(leaf) => leaf.jumps_at(stroke, take),
            Self::Parallel(parts) => parts.iter().for_each(|part| part.jumps_at(stroke, take)),
            _ => {}
        }
    }

    /// The law at t_n + theta·h, 0 < theta ≤ 1, where its exact kinematics are those of `at`. Pure.
    pub fn at(&self, step: &Step, theta: f64, at: &Point, state: &State) -> Observation {
        self.ask().at(step, theta, at, &mut state.view(), &mut |_| ()).observation
    }

    /// Appends every leaf, in their order, as [`Self::at`] has it. Pure.
    pub fn leaves_at(&self, step: &Step, theta: f64, at: &Point, state: &State, leaves: &mut Vec<LeafState>) {
        self.ask().at(step, theta, at, &mut state.view(), &mut |leaf| leaves.push(leaf.state()));
    }

    /// The law between two steps, under the kinematics and inputs of `at`, which may have jumped since the last one: memories and inner
    /// variables do not jump. Pure.
    pub fn now(&self, at: &Point, state: &State) -> Observation {
        self.ask().now(at, &mut state.seen_at(at.t).view(), &mut |_| ()).observation
    }

    /// Appends every leaf, in their order, as [`Self::now`] has it. Pure.
    pub fn leaves_now(&self, at: &Point, state: &State, leaves: &mut Vec<LeafState>) {
        self.ask().now(at, &mut state.seen_at(at.t).view(), &mut |leaf| leaves.push(leaf.state()));
    }

    /// What it tells of itself beside stroke, force and energies: of each of its leaves what none before it tells, and temperature and heat where it
    /// keeps a temperature.
    pub fn tells(&self) -> Vec<Told> {
        let all = self.all_told();
        self.places_of_told().into_iter().map(|place| all[place]).collect()
    }

    /// Of each of [`Self::tells`] its place among what all leaves tell.
    pub(crate) fn places_of_told(&self) -> Vec<usize> {
        let all = self.all_told();
        (0..all.len()).filter(|&k| all[..k].iter().all(|earlier| earlier.key != all[k].key)).collect()
    }

    /// What all leaves tell, and temperature and heat behind them.
    fn all_told(&self) -> Vec<Told> {
        let mut told = Vec::new();
        self.ask().for_each_leaf(&mut |leaf| told.extend(leaf.tells()));
        if self.is_thermal() {
            told.extend([Told::TEMPERATURE, Told::HEAT]);
        }
        told
    }

    /// Appends the values of [`Self::tells`], in that order, as of `when`. Pure.
    pub fn tell(&self, when: When, at: &Point, state: &State, values: &mut Vec<f64>) {
        let mut told: Vec<&str> = Vec::new();
        let mut take = |seen: part::Seen| {
            let mut own = seen.leaf.tells().iter();
            seen.leaf.tell(seen.when, &seen.at, seen.state, &mut |value| {
                if let Some(quantity) = own.next().filter(|quantity| !told.contains(&quantity.key)) {
                    told.push(quantity.key);
                    values.push(value);
                }
            });
        };
        if self.any_leaf(|leaf| !leaf.tells().is_empty()) {
            match when {
                When::Within(step, theta) => self.ask().at(step, theta, at, &mut state.view(), &mut take),
                When::Between => self.ask().now(at, &mut state.view(), &mut take),
            };
        }
        let within = match when {
            When::Within(step, theta) => Some((step, theta)),
            When::Between => None,
        };
        values.extend(self.warmth(within, state).into_iter().flat_map(|warmth| [warmth.temperature, warmth.lost]));
    }

    fn any_leaf(&self, is_one: impl Fn(&LeafPart) -> bool) -> bool {
        let mut found = false;
        self.ask().for_each_leaf(&mut |leaf| found |= is_one(leaf));
        found
    }

    /// Whether a leaf of it keeps a clock of its own.
    pub(super) fn has_clock(&self) -> bool {
        self.any_leaf(|leaf| leaf.clock() == Clock::Own)
    }

    /// |∂F/∂x| of small strokes about `at` at the rate `omega`, rad/s, without any memory: k + c·ω + Σ c·ω^alpha of parallel parts.
    pub fn stiffness(&self, at: &Point, omega: f64) -> f64 {
        self.ask().stiffness(at, omega)
    }

    /// The size of the force where x was reached at the rate `omega`, rad/s, signed.
    pub fn estimate(&self, at: &Point, state: &State, omega: f64) -> f64 {
        self.ask().estimate(at, &mut state.view(), omega)
    }

    /// Hands over c·D^alpha x of every springpot that the stroke reaches at once; of a series what it is like at short times.
    pub fn for_each_springpot(&self, at: &Point, take: &mut dyn FnMut(Term)) {
        self.ask().for_each_springpot(at, take);
    }

    /// Whether the force is without bound behind a stroke that is there at once, by what stands in series.
    pub(super) fn jolts(&self, at: &Point) -> bool {
        self.ask().jolts(at)
    }

    /// The coefficient of the dashpot that it is like at short times; 0 where it is like none.
    pub(super) fn dashed(&self, at: &Point) -> f64 {
        let Term { coefficient, order } = self.ask().asymptote(at, Onset::Short);
        if order == 1.0 { coefficient } else { 0.0 }
    }

    /// The same, with what the parameter that numbers and inputs carry changes of it; `None` where a leaf does not know.
    pub(super) fn dashed_by(&self, at: &Point<Dual>) -> Option<[f64; 2]> {
        let (Term { coefficient, order }, slope) = asymptote_by(self, at, Onset::Short)?;
        Some(if order == 1.0 { [coefficient, slope] } else { [0.0; 2] })
    }

    /// [`Self::modulus_slope`] where the inputs carry the parameter too.
    pub(super) fn modulus_by(&self, at: &Point<Dual>, s: [Complex64; 2]) -> Option<[Complex64; 2]> {
        self.ask().modulus_slope(at, s)
    }

    /// Hands over s and alpha of every share s·t^−alpha of a singular start in F.
    pub fn for_each_singularity(&self, inputs: &[InputValue], state: &State, take: &mut dyn FnMut(Term)) {
        if state.is_singular() {
            self.ask().singularities(inputs, &mut state.view(), take);
        }
    }

    /// Rules over the inputs, to hold at every time.
    ///
    /// # Errors
    /// [`RuleError`] names the broken rule.
    pub fn check_inputs(&self, inputs: &[InputValue]) -> Result<(), RuleError> {
        self.ask().check_inputs(inputs)
    }

    /// The order of the derivative that an [`Observation`] tells; 0 where it is the stroke.
    pub fn reported_order(&self, at: &Point) -> f64 {
        self.ask().report(at).1
    }

    /// Whether there is one derivative that an [`Observation`] tells: that of its only springpot; without one and without series the rate of
    /// a dashpot, else the stroke.
    pub fn tells_derivative(&self) -> bool {
        let mut springpots = 0;
        self.ask().for_each_leaf(&mut |leaf| springpots += usize::from(leaf.size().memories > 0));
        springpots == 1 || (springpots == 0 && self.is_linear() && self.ask().series_count() == 0)
    }

    /// Whether a part of a series has a memory.
    pub(crate) fn has_memories_in_series(&self) -> bool {
        self.ask().has_memories_in_series()
    }

    /// Whether it keeps fractional derivatives.
    pub(crate) fn has_memories(&self) -> bool {
        self.ask().size().memories > 0
    }

    /// Whether it keeps inner strokes or inner variables, whose errors no stroke shows.
    pub fn has_inner_variables(&self) -> bool {
        self.ask().size().variables > 0
    }

    /// How many of its local errors, the first of them, are those of what no stroke shows: all of them where it keeps inner strokes.
    pub fn hidden_errors(&self) -> usize {
        self.ask().hidden_errors()
    }

    /// Whether its state is known after a stroke that was periodic since ever: it is linear, or what is not knows it ([`Leaf::recalls`]) and stands in no
    /// series.
    pub fn recalls(&self) -> bool {
        self.ask().recalls()
    }

    /// Puts the stroke before t = 0 into the state of a law that recalls it, its memories opened.
    pub(super) fn recall(&self, stroke: &Recalled, at: &Point, state: &mut State) {
        self.ask().recall(stroke, at, &mut state.view_mut());
    }

    /// F/x under e^{st} of a linear law, N/m: k + c·s + Σ c·s^alpha of parallel parts.
    pub fn modulus(&self, at: &Point, s: Complex64) -> Complex64 {
        self.at_rest(at, at.stroke).map_or(Complex64::new(f64::NAN, f64::NAN), |rest| rest.tangent.modulus(s))
    }

    /// K' and K'' of K* = [`Self::modulus`] under e^{iωt}, N/m: what is stored, and what is lost.
    pub fn complex_modulus(&self, at: &Point, omega: f64) -> [f64; 2] {
        let modulus = self.modulus(at, Complex64::new(0.0, omega));
        [modulus.re, modulus.im]
    }

    /// [`Self::modulus`] at s, and what it changes by with the parameter that the numbers of its leaves carry while s changes as the second
    /// number says; `None` where a leaf does not know.
    pub fn modulus_slope(&self, at: &Point, s: [Complex64; 2]) -> Option<[Complex64; 2]> {
        self.ask().modulus_slope(&at.with_inputs(&at.inputs_as_numbers()), s)
    }

    /// K' and K'', N/m, of the first harmonic of F under x = x_0 + A·sin ωt since ever, x_0 the stroke of `at`, A > 0 the `amplitude`, m, ω > 0 `omega`,
    /// rad/s: K* = (1/πA) ∮ F·(sin ωt + i cos ωt) d(ωt). A turn loses π K'' A². Of a linear law it is [`Self::complex_modulus`].
    ///
    /// Parts side by side add. Linear parts, jenkins elements and what follows from stroke and rate at one time, such as polynomials, stops and friction, are
    /// exact to rounding; what has a state, alone or in a series, is driven until it is steady, to 1e-7 of |K*|. `None` where it does not become so.
    pub fn first_harmonic(&self, at: &Point, amplitude: f64, omega: f64) -> Option<[f64; 2]> {
        let harmonic = self.ask().harmonic(&Sine { at: Point { rate: 0.0, ..*at }, amplitude, omega })?;
        Some([harmonic.re, harmonic.im])
    }

    /// Whether F is an affine function of strokes and rates.
    pub fn is_linear(&self) -> bool {
        self.ask().is_linear()
    }

    /// The law at rest since ever at the stroke of `at`: what flows has relaxed, and parts in series share one force. `held` is x(0), from
    /// which Caputo's derivative of order 0 counts. `None` where parts in series come to no common force.
    pub fn at_rest(&self, at: &Point, held: f64) -> Option<AtRest> {
        self.ask().at_rest(at, held)
    }
}

/// Parts of a series where all springs that slip, and the plain ones where there is such, are one, in the place and under the name of the first that slips.
fn with_one_that_slips(mut parts: Vec<Network>) -> Vec<Network> {
    let slips = |part: &Network| match part {
        Network::Leaf(leaf) => leaf.slips(),
        _ => None,
    };
    let Some(first) = parts.iter().position(|part| slips(part).is_some()) else { return parts };
    let one = Dual::from(1.0);
    let compliance: Dual = parts.iter().filter_map(plain_spring).map(|stiffness| one / stiffness).sum();
    let mut whole = parts.iter().filter_map(slips).reduce(Jenkins::behind).expect("one that slips");
    if compliance.value > 0.0 {
        whole = whole.behind_spring(one / compliance);
    }
    let Network::Leaf(LeafPart { name, .. }) = &parts[first] else { return parts };
    parts[first] = Network::Leaf(LeafPart { name: name.clone(), leaf: Arc::new(whole) });
    let mut at = 0..;
    parts.retain(|part| at.next() == Some(first) || (slips(part).is_none() && plain_spring(part).is_none()));
    parts
}

/// The stiffness of a leaf that is a spring and nothing else, N/m: no memory, no input, no force at x = 0.
fn plain_spring(part: &Network) -> Option<Dual> {
    let Network::Leaf(leaf) = part else { return None };
    let at = Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &[] };
    let nothing = StateRef { memories: &[], variables: &[], ready: &[] };
    let is_plain = leaf.is_linear() && leaf.size() == StateSize::default();
    let Term { coefficient, order } = leaf.linearised(&at);
    // The number that it is, with its derivative.
    let mut stiffness = Dual::from(coefficient);
    leaf.numbers(&mut |number| {
        if number.value == coefficient {
            stiffness = number;
        }
    });
    (is_plain && order == 0.0 && coefficient > 0.0 && Leaf::now(&**leaf, &at, nothing).force() == 0.0)
        .then_some(stiffness)
}
