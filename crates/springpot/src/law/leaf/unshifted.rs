//! A leaf that temperature does not shift, in a law that is told in reduced time.

use super::contract::{Leaf, Slide};
use crate::collocation::MAX_NODES;
use crate::fractional::KernelError;
use crate::law::network::{Holds, LeafPart};
use crate::law::rule::RuleError;
use crate::law::state::{State, StateMut, StateRef, StateSize};
use crate::law::step::{InputValue, LocalError, Observation, Point, Powers, Response, Start, Step, Term};
use crate::law::tangent::LeafAtRest;

/// A leaf that is told rates by the clock of the wall, x', where others are told dx/dξ = a_T x'; a_T is an input.
///
/// It keeps nothing between steps, so that the clock of its step does not matter to it.
#[derive(Debug, Clone)]
pub(in crate::law) struct Unshifted {
    pub(in crate::law) leaf: LeafPart,
    /// Which input is a_T.
    pub(in crate::law) factor: usize,
}

/// Rates of a step by another clock.
struct Rates {
    factor: [f64; MAX_NODES + 1],
    rate: [f64; MAX_NODES + 1],
}

impl Unshifted {
    /// a_T; 1 where nobody tells it.
    fn factor(&self, inputs: &[InputValue]) -> f64 {
        inputs.get(self.factor).map_or(1.0, |factor| factor.value)
    }

    fn rates(&self, step: &Step) -> Rates {
        let (mut factor, mut rate) = ([1.0; MAX_NODES + 1], [0.0; MAX_NODES + 1]);
        for (k, told) in step.rate.iter().enumerate() {
            factor[k] = self.factor(step.point(k).inputs);
            rate[k] = told / factor[k];
        }
        Rates { factor, rate }
    }

    fn point<'a>(&self, at: &Point<'a>) -> Point<'a> {
        Point { rate: at.rate / self.factor(at.inputs), ..*at }
    }

    fn step<'a>(step: &Step<'a>, rates: &'a Rates) -> Step<'a> {
        Step { rate: &rates.rate[..step.rate.len()], ..*step }
    }

    /// A term by its own clock in reduced time.
    fn reduced(&self, term: Term, at: &Point) -> Term {
        Term { coefficient: term.coefficient * self.factor(at.inputs).powf(-term.order), ..term }
    }
}

impl Leaf for Unshifted {
    fn name(&self) -> &'static str {
        self.leaf.name()
    }

    fn size(&self) -> StateSize {
        self.leaf.size()
    }

    fn begin(&self, start: &Start, state: &mut State) -> Result<(), KernelError> {
        self.leaf.begin(start, state)
    }

    fn evaluate(&self, step: &Step, state: StateRef, response: &mut Response) {
        let (rates, mut own) = (self.rates(step), Response::default());
        self.leaf.evaluate(&Self::step(step, &rates), state, &mut own);
        for i in 0..step.nodes.count() {
            response.force[i] += own.force[i];
            for j in 0..step.nodes.count() {
                response.d_stroke[i][j] += own.d_stroke[i][j];
                response.d_rate[i][j] += own.d_rate[i][j] / rates.factor[j + 1];
            }
        }
    }

    fn commit(&self, step: &Step, state: StateMut) {
        self.leaf.commit(&Self::step(step, &self.rates(step)), state);
    }

    fn local_errors(&self, step: &Step, state: StateRef, errors: &mut Vec<LocalError>) {
        self.leaf.local_errors(&Self::step(step, &self.rates(step)), state, errors);
    }

    fn powers(&self, step: &Step, state: StateRef, powers: &mut Powers) {
        let (rates, mut own) = (self.rates(step), Powers::default());
        self.leaf.powers(&Self::step(step, &rates), state, &mut own);
        for ((power, own), factor) in powers.iter_mut().zip(own).zip(rates.factor) {
            power.dissipation += factor * own.dissipation;
            power.input += factor * own.input;
        }
    }

    fn at(&self, step: &Step, theta: f64, at: &Point, state: StateRef) -> Observation {
        self.leaf.at(&Self::step(step, &self.rates(step)), theta, &self.point(at), state)
    }

    fn now(&self, at: &Point, state: StateRef) -> Observation {
        self.leaf.now(&self.point(at), state)
    }

    fn by_input(&self, step: &Step, state: StateRef, input: usize, slopes: &mut [[f64; MAX_NODES]; MAX_NODES]) {
        self.leaf.by_input(&Self::step(step, &self.rates(step)), state, input, slopes);
    }

    fn linearised(&self, at: &Point) -> Term {
        self.reduced(self.leaf.linearised(&self.point(at)), at)
    }

    fn at_rest(&self, at: &Point, held: f64) -> LeafAtRest {
        let rest = self.leaf.at_rest(&self.point(at), held);
        LeafAtRest { term: self.reduced(rest.term, at), damping: rest.damping / self.factor(at.inputs), ..rest }
    }

    fn holds(&self) -> Holds {
        self.leaf.holds()
    }

    fn slides(&self, inputs: &[InputValue]) -> Option<Slide> {
        let own = self.leaf.slides(inputs)?;
        Some(Slide { rate: own.rate * self.factor(inputs), ..own })
    }

    fn jumps(&self) -> bool {
        self.leaf.jumps()
    }

    fn guards(&self, at: &Point, take: &mut dyn FnMut(f64)) {
        self.leaf.guards(&self.point(at), take);
    }

    fn is_linear(&self) -> bool {
        self.leaf.is_linear()
    }

    fn check_inputs(&self, inputs: &[InputValue]) -> Result<(), RuleError> {
        self.leaf.check_inputs(inputs)
    }
}
