//! A leaf in its place in a network.

use super::Network;
use super::part::{Onset, Part, Reported, Seen, Take};
use crate::collocation::{MAX_NODES, Nodes};
use crate::dual::Dual;
use crate::fractional::{KernelError, Memory, RatePolynomial};
use crate::law::harmonic::{self, Sine};
use crate::law::leaf::{Free, Guard, Holds, Leaf, Slide, When};
use crate::law::past::Recalled;
use crate::law::rule::RuleError;
use crate::law::state::{State, StateMut, StateRef, StateSize};
use crate::law::step::{InputValue, LocalError, Observation, Point, Powers, Response, Start, Step, Term};
use crate::law::tangent::AtRest;
use num_complex::Complex64;
use std::sync::Arc;

/// A leaf in its place in a network.
#[derive(Debug, Clone)]
pub struct LeafPart {
    pub(super) name: Option<Arc<str>>,
    pub(super) leaf: Arc<dyn Leaf>,
}

impl std::ops::Deref for LeafPart {
    type Target = dyn Leaf;

    fn deref(&self) -> &Self::Target {
        self.leaf.as_ref()
    }
}

impl LeafPart {
    fn seen(&self, when: When, at: &Point, state: StateRef, observation: Observation, take: Take) -> Reported {
        take(Seen { leaf: &**self, when, at: *at, state, observation, factor: 1.0 });
        Reported { observation, rank: Part::report(self, at).0 }
    }
}

impl Part for LeafPart {
    fn parts(&self) -> &[Network] {
        &[]
    }

    fn size(&self) -> StateSize {
        self.leaf.size()
    }

    fn begin(&self, start: &Start, state: &mut State) -> Result<(), KernelError> {
        self.leaf.begin(start, state)
    }

    fn prepare(&self, step: &Step, state: &mut StateMut) {
        self.leaf.prepare(step, state.take(self.leaf.size()));
    }

    fn evaluate(&self, step: &Step, state: &mut StateRef, response: &mut Response) {
        self.leaf.evaluate(step, state.take(self.leaf.size()), response);
    }

    fn by_input(&self, step: &Step, state: &mut StateRef, input: usize, slopes: &mut [[f64; MAX_NODES]; MAX_NODES]) {
        self.leaf.by_input(step, state.take(self.leaf.size()), input, slopes);
    }

    fn commit(&self, step: &Step, state: &mut StateMut) {
        self.leaf.commit(step, state.take(self.leaf.size()));
    }

    fn local_errors(&self, step: &Step, state: &mut StateRef, errors: &mut Vec<LocalError>) {
        self.leaf.local_errors(step, state.take(self.leaf.size()), errors);
    }

    fn powers(&self, step: &Step, state: &mut StateRef, powers: &mut Powers) {
        self.leaf.powers(step, state.take(self.leaf.size()), powers);
    }

    fn guards(&self, step: &Step, state: &mut StateRef, guards: &mut Vec<Guard>) {
        self.leaf.guards_in(step, state.take(self.leaf.size()), guards);
    }

    fn at(&self, step: &Step, theta: f64, at: &Point, state: &mut StateRef, take: Take) -> Reported {
        let own = state.take(self.leaf.size());
        self.seen(When::Within(step, theta), at, own, self.leaf.at(step, theta, at, own), take)
    }

    fn now(&self, at: &Point, state: &mut StateRef, take: Take) -> Reported {
        let own = state.take(self.leaf.size());
        self.seen(When::Between, at, own, self.leaf.now(at, own), take)
    }

    fn estimate(&self, at: &Point, state: &mut StateRef, omega: f64) -> f64 {
        let own = state.take(self.leaf.size());
        match own.memories {
            [] => self.leaf.now(at, own).force(),
            _ => self.leaf.linearised(at).stiffness(omega) * at.stroke,
        }
    }

    fn singularities(&self, inputs: &[InputValue], state: &mut StateRef, take: &mut dyn FnMut(Term)) {
        self.leaf.singular(inputs, state.take(self.leaf.size())).into_iter().for_each(take);
    }

    fn recalls(&self) -> bool {
        self.leaf.recalls()
    }

    fn recall(&self, stroke: &Recalled, _: &Point, state: &mut StateMut) {
        let StateMut { memories, variables, .. } = state.take(self.leaf.size());
        memories.iter_mut().for_each(|memory| recall(memory, stroke));
        if !variables.is_empty() {
            self.leaf.recall(&stroke.turns(), variables);
        }
    }

    fn for_each_leaf(&self, take: &mut dyn FnMut(&LeafPart)) {
        take(self);
    }

    fn holds(&self) -> Holds {
        self.leaf.holds()
    }

    fn free(&self) -> Option<Free> {
        self.leaf.free()
    }

    fn slides(&self, inputs: &[InputValue]) -> Option<Slide> {
        self.leaf.slides(inputs)
    }

    fn has_guards(&self, at: &Point) -> bool {
        let mut found = false;
        self.leaf.guards(at, &mut |_| found = true);
        found
    }

    fn stiffness(&self, at: &Point, omega: f64) -> f64 {
        self.leaf.linearised(at).stiffness(omega)
    }

    fn for_each_springpot(&self, at: &Point, take: &mut dyn FnMut(Term)) {
        if self.leaf.size().memories > 0 {
            take(self.leaf.linearised(at));
        }
    }

    fn check_inputs(&self, inputs: &[InputValue]) -> Result<(), RuleError> {
        self.leaf.check_inputs(inputs)
    }

    fn report(&self, at: &Point) -> (u8, f64) {
        match (self.leaf.size().memories, self.leaf.linearised(at).order) {
            (0, 1.0) => (1, 1.0),
            (0, _) => (0, 0.0),
            (_, order) => (2, order),
        }
    }

    fn modulus_slope(&self, at: &Point<Dual>, [s, by]: [Complex64; 2]) -> Option<[Complex64; 2]> {
        let inputs = at.values_of_inputs();
        let Term { coefficient, order } = self.leaf.linearised(&at.without_derivatives(&inputs));
        let changed = self.leaf.linearised_slope(at)?;
        let power = if order == 0.0 { Complex64::ONE } else { s.powf(order) };
        let by_order = if changed.order == 0.0 { Complex64::ZERO } else { changed.order * s.ln() };
        let by_s = if order == 0.0 { Complex64::ZERO } else { order * by / s };
        Some([coefficient * power, power * (changed.coefficient + coefficient * (by_order + by_s))])
    }

    fn harmonic(&self, sine: &Sine) -> Option<Complex64> {
        if self.leaf.is_linear() {
            return Some(self.leaf.at_rest(&sine.at, 0.0).tangent.modulus(Complex64::new(0.0, sine.omega)));
        }
        let formula = self.leaf.harmonic(&sine.at, sine.amplitude, sine.omega);
        match self.leaf.size() == StateSize::default() {
            _ if formula.is_some() => formula,
            true => Some(harmonic::at_once(&*self.leaf, sine)),
            false => harmonic::driven(&Network::Leaf(self.clone()), sine),
        }
    }

    fn is_linear(&self) -> bool {
        self.leaf.is_linear()
    }

    fn asymptote(&self, at: &Point, _: Onset) -> Term {
        self.leaf.linearised(at)
    }

    fn at_rest(&self, at: &Point, held: f64) -> Option<AtRest> {
        Some(self.leaf.at_rest(at, held))
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
