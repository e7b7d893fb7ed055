//! What every part of a network answers.

use super::{LeafPart, Network};
use crate::collocation::MAX_NODES;
use crate::dual::Dual;
use crate::fractional::KernelError;
use crate::law::harmonic::Sine;
use crate::law::leaf::{Free, Guard, Holds, Leaf, Slide, When};
use crate::law::past::Recalled;
use crate::law::rule::RuleError;
use crate::law::state::{State, StateMut, StateRef, StateSize};
use crate::law::step::{InputValue, LeafState, LocalError, Observation, Point, Powers, Response, Start, Step, Term};
use crate::law::tangent::{AtRest, Tangent};
use num_complex::Complex64;

/// A part of a network: a leaf, parts side by side or one behind the other, or a whole law under heat.
///
/// Every question that walks through a law is one method here. What is provided is the answer of parts side by side, which see one stroke and
/// whose forces add; a kind of part overrides what it changes. A question about a step is asked with the state of the network, of which each part
/// takes its own share from the front, in the order of the parts.
pub(in crate::law) trait Part: std::fmt::Debug {
    /// What it is made of, in order.
    fn parts(&self) -> &[Network];

    /// What it keeps itself, in front of what its parts keep.
    fn own_size(&self) -> StateSize {
        StateSize::default()
    }

    /// What of a state belongs to it.
    fn size(&self) -> StateSize {
        self.parts().iter().map(|part| part.ask().size()).fold(self.own_size(), |sum, part| StateSize {
            memories: sum.memories + part.memories,
            variables: sum.variables + part.variables,
        })
    }

    /// How many series are in it, which work something out for a step.
    fn series_count(&self) -> usize {
        self.parts().iter().map(|part| part.ask().series_count()).sum()
    }

    /// Passes over its share of a state.
    fn pass(&self, state: &mut StateRef) {
        state.skip(self.size(), self.series_count());
    }

    /// The same of a state to be changed.
    fn pass_mut(&self, state: &mut StateMut) {
        state.skip(self.size(), self.series_count());
    }

    /// Appends its state at t = 0.
    fn begin(&self, start: &Start, state: &mut State) -> Result<(), KernelError> {
        self.parts().iter().try_for_each(|part| part.ask().begin(start, state))
    }

    /// Makes ready what does not change while a step is worked out.
    fn prepare(&self, step: &Step, state: &mut StateMut) {
        self.parts().iter().for_each(|part| part.ask().prepare(step, state));
    }

    /// Adds forces at the nodes and their tangents.
    fn evaluate(&self, step: &Step, state: &mut StateRef, response: &mut Response) {
        self.parts().iter().for_each(|part| part.ask().evaluate(step, state, response));
    }

    /// Adds ∂F_i/∂u_j of the input `input`.
    fn by_input(&self, step: &Step, state: &mut StateRef, input: usize, slopes: &mut [[f64; MAX_NODES]; MAX_NODES]) {
        self.parts().iter().for_each(|part| part.ask().by_input(step, state, input, slopes));
    }

    /// Takes an accepted step into the state.
    fn commit(&self, step: &Step, state: &mut StateMut) {
        self.parts().iter().for_each(|part| part.ask().commit(step, state));
    }

    /// Appends how well the step knows each memory, inner variable and dashpot.
    fn local_errors(&self, step: &Step, state: &mut StateRef, errors: &mut Vec<LocalError>) {
        self.parts().iter().for_each(|part| part.ask().local_errors(step, state, errors));
    }

    /// Adds energy flows at the start and at the nodes.
    fn powers(&self, step: &Step, state: &mut StateRef, powers: &mut Powers) {
        self.parts().iter().for_each(|part| part.ask().powers(step, state, powers));
    }

    /// Appends functions whose zeros are kinks of a force.
    fn guards(&self, step: &Step, state: &mut StateRef, guards: &mut Vec<Guard>) {
        self.parts().iter().for_each(|part| part.ask().guards(step, state, guards));
    }

    /// The part at t_n + theta·h, handing over its leaves.
    fn at(&self, step: &Step, theta: f64, at: &Point, state: &mut StateRef, take: Take) -> Reported {
        Reported::sum(at, self.parts().iter().map(|part| part.ask().at(step, theta, at, state, take)))
    }

    /// The part between two steps, handing over its leaves.
    fn now(&self, at: &Point, state: &mut StateRef, take: Take) -> Reported {
        Reported::sum(at, self.parts().iter().map(|part| part.ask().now(at, state, take)))
    }

    /// The size of the force where x was reached at the rate `omega`.
    fn estimate(&self, at: &Point, state: &mut StateRef, omega: f64) -> f64 {
        self.parts().iter().map(|part| part.ask().estimate(at, state, omega)).sum()
    }

    /// Hands over s and alpha of every share s·t^−alpha of a singular start in F.
    fn singularities(&self, inputs: &[InputValue], state: &mut StateRef, take: &mut dyn FnMut(Term)) {
        self.parts().iter().for_each(|part| part.ask().singularities(inputs, state, take));
    }

    /// Whether its state is known after a stroke that was periodic since ever.
    fn recalls(&self) -> bool {
        self.parts().iter().all(|part| part.ask().recalls())
    }

    /// Puts the stroke before t = 0 into the state.
    fn recall(&self, stroke: &Recalled, at: &Point, state: &mut StateMut) {
        self.parts().iter().for_each(|part| part.ask().recall(stroke, at, state));
    }

    /// Hands over its leaves.
    fn for_each_leaf(&self, take: &mut dyn FnMut(&LeafPart)) {
        self.parts().iter().for_each(|part| part.ask().for_each_leaf(take));
    }

    /// Whether it carries force wherever it is.
    fn holds(&self) -> Holds {
        self.parts().iter().map(|part| part.ask().holds()).max().unwrap_or(Holds::Never)
    }

    /// The strokes at which it carries nothing ([`Leaf::free`]).
    fn free(&self) -> Option<Free> {
        None
    }

    /// How it slides, of friction ([`Leaf::slides`]).
    fn slides(&self, _: &[InputValue]) -> Option<Slide> {
        None
    }

    /// Whether its force may have kinks that steps are to end on.
    fn has_guards(&self, at: &Point) -> bool {
        self.parts().iter().any(|part| part.ask().has_guards(at))
    }

    /// |∂F/∂x| of small strokes about `at` at the rate `omega`, without any memory.
    fn stiffness(&self, at: &Point, omega: f64) -> f64 {
        self.parts().iter().map(|part| part.ask().stiffness(at, omega)).sum()
    }

    /// Hands over c·D^alpha x of every springpot that the stroke reaches at once.
    fn for_each_springpot(&self, at: &Point, take: &mut dyn FnMut(Term)) {
        self.parts().iter().for_each(|part| part.ask().for_each_springpot(at, take));
    }

    /// Whether the force is without bound behind a stroke that is there at once, by what stands in series.
    fn jolts(&self, at: &Point) -> bool {
        self.parts().iter().any(|part| part.ask().jolts(at))
    }

    /// Rules over the inputs.
    fn check_inputs(&self, inputs: &[InputValue]) -> Result<(), RuleError> {
        self.parts().iter().try_for_each(|part| part.ask().check_inputs(inputs))
    }

    /// How much the derivative that it tells is worth, and its order.
    fn report(&self, at: &Point) -> (u8, f64) {
        let reports = self.parts().iter().map(|part| part.ask().report(at));
        reports.fold((0, 0.0), |first, next| if next.0 > first.0 { next } else { first })
    }

    /// Whether a part of a series has a memory.
    fn has_memories_in_series(&self) -> bool {
        self.parts().iter().any(|part| part.ask().has_memories_in_series())
    }

    /// How many of its local errors, the first of them, are those of what no stroke shows.
    fn hidden_errors(&self) -> usize {
        if self.size().variables > 0 { usize::MAX } else { 0 }
    }

    /// [`Network::modulus_slope`].
    fn modulus_slope(&self, at: &Point<Dual>, s: [Complex64; 2]) -> Option<[Complex64; 2]> {
        self.parts().iter().try_fold([Complex64::ZERO; 2], |[value, slope], part| {
            let [own, by] = part.ask().modulus_slope(at, s)?;
            Some([value + own, slope + by])
        })
    }

    /// K* of the first harmonic under a sine since ever, linear or not; `None` where no steady turn is found.
    fn harmonic(&self, sine: &Sine) -> Option<Complex64> {
        self.parts().iter().map(|part| part.ask().harmonic(sine)).sum()
    }

    /// Whether F is an affine function of strokes and rates.
    fn is_linear(&self) -> bool {
        self.parts().iter().all(|part| part.ask().is_linear())
    }

    /// What remains of it at short or at long times: the stiffest of parts side by side.
    fn asymptote(&self, at: &Point, onset: Onset) -> Term {
        asymptote(self.parts().iter().map(|part| part.ask().asymptote(at, onset)), onset, true)
    }

    /// At rest since ever ([`Network::at_rest`]).
    fn at_rest(&self, at: &Point, held: f64) -> Option<AtRest> {
        let (mut force, mut stiffness, mut tangents) = (0.0, None, Vec::new());
        for part in self.parts() {
            let part = part.ask().at_rest(at, held)?;
            force += part.force;
            stiffness = part.stiffness.map(|k| k + stiffness.unwrap_or(0.0)).or(stiffness);
            tangents.push(part.tangent);
        }
        Some(AtRest { force, stiffness, tangent: Tangent::Parallel(tangents) })
    }
}

/// Parts side by side.
impl Part for Vec<Network> {
    fn parts(&self) -> &[Network] {
        self
    }

    /// A series knows what to do with one part that lets go, not with several side by side.
    fn holds(&self) -> Holds {
        match self.iter().map(Network::holds).max() {
            Some(Holds::LetsGo) => Holds::AtTimes,
            holds => holds.unwrap_or(Holds::Never),
        }
    }
}

/// What remains of parts at short or at long times, whose forces add (`adds`) or whose strokes do.
pub(super) fn asymptote(parts: impl Iterator<Item = Term> + Clone, onset: Onset, adds: bool) -> Term {
    // The stiffest of parallel parts and the softest of those in series: that of the higher order at short times.
    let takes_highest = adds == (onset == Onset::Short);
    let terms = || parts.clone().filter(|term| term.coefficient != 0.0);
    let orders = terms().map(|term| term.order);
    let order = if takes_highest { orders.fold(0.0, f64::max) } else { orders.fold(f64::INFINITY, f64::min) };
    let order = if order.is_finite() { order } else { 0.0 };
    let same = terms().filter(|term| term.order == order).map(|term| term.coefficient);
    let coefficient = if adds { same.sum() } else { same.map(f64::recip).sum::<f64>().recip() };
    Term { coefficient, order }
}

/// [`Part::asymptote`], and what the parameter that numbers and inputs carry changes of its coefficient; `None` where a leaf does not know.
pub(in crate::law) fn asymptote_by(part: &Network, at: &Point<Dual>, onset: Onset) -> Option<(Term, f64)> {
    let inputs = at.values_of_inputs();
    let whole = part.ask().asymptote(&at.without_derivatives(&inputs), onset);
    if let Network::Leaf(leaf) = part {
        return Some((whole, leaf.leaf.linearised_slope(at)?.coefficient));
    }
    let adds = !matches!(part, Network::Series(_));
    let mut slope = 0.0;
    for part in part.parts() {
        let (Term { coefficient, order }, own) = asymptote_by(part, at, onset)?;
        if order == whole.order && coefficient != 0.0 {
            slope += if adds { own } else { own * (whole.coefficient / coefficient).powi(2) };
        }
    }
    Some((whole, slope))
}

/// Which end of the times a law is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::law) enum Onset {
    Short,
    Long,
}

/// A leaf as it is seen at one time.
pub(in crate::law) struct Seen<'a> {
    pub(super) leaf: &'a dyn Leaf,
    pub(super) when: When<'a>,
    pub(super) at: Point<'a>,
    pub(super) state: StateRef<'a>,
    pub(super) observation: Observation,
    /// By how much its time runs slower than that of the wall.
    pub(super) factor: f64,
}

/// Takes the leaves of a network, one after the other.
pub(in crate::law) type Take<'a> = &'a mut dyn FnMut(Seen);

impl Seen<'_> {
    pub(super) fn state(&self) -> LeafState {
        let Point { stroke, rate, .. } = self.at;
        let Observation { derivative, .. } = self.observation;
        LeafState { stroke, rate: rate / self.factor, force: self.observation.force(), derivative }
    }
}

/// An observation, and whose derivative it tells: that of the first springpot, else that of the first dashpot.
#[derive(Debug, Clone, Copy)]
pub(in crate::law) struct Reported {
    pub(super) observation: Observation,
    pub(super) rank: u8,
}

impl Reported {
    /// That of a step in which no force is found.
    pub(super) fn unknown() -> Self {
        let observation = Observation { derivative: f64::NAN, regular: f64::NAN, singular: 0.0, stored: None };
        Self { observation, rank: 0 }
    }

    pub(super) fn sum(at: &Point, parts: impl Iterator<Item = Self>) -> Self {
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
