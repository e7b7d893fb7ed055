//! A leaf that temperature does not shift, in a law that is told in reduced time.

use crate::collocation::MAX_NODES;
use crate::dual::Dual;
use crate::fractional::{KernelError, MemoryTangent};
use crate::law::leaf::{Holds, Leaf, Slide, When};
use crate::law::network::LeafPart;
use crate::law::rule::RuleError;
use crate::law::state::{State, StateMut, StateRef, StateSize};
use crate::law::step::{InputValue, LocalError, Observation, Point, Powers, Response, Start, Step, Term};
use crate::law::tangent::AtRest;
use crate::law::variation::{
    ObservationVariation, PointVariation, PowersVariation, StepVariation, VariationMut, VariationRef, add,
};

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

    /// What changes of x' at the start and at the nodes; without what is told of it at the nodes, unless `moves`.
    fn vary_rates(&self, step: &Step, rates: &Rates, told: &StepVariation, moves: bool) -> Vec<f64> {
        let mut changes = vec![0.0; step.rate.len() * told.count];
        for (k, change) in changes.chunks_exact_mut(told.count).enumerate() {
            if moves || k == 0 {
                add(change, rates.factor[k].recip(), told.rate_at(k));
            }
            if let Some([factor, _]) = told.input_at(k, self.factor, step.inputs_at(k).len()) {
                add(change, -rates.rate[k] / rates.factor[k], factor);
            }
        }
        changes
    }

    /// What changes of x' at one time.
    fn vary_rate(&self, at: &Point, told: &PointVariation, count: usize) -> Vec<f64> {
        let factor = self.factor(at.inputs);
        let mut change = vec![0.0; count];
        add(&mut change, factor.recip(), told.rate);
        if let Some([by_factor, _]) = told.input(self.factor, count) {
            add(&mut change, -at.rate / (factor * factor), by_factor);
        }
        change
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

    fn numbers(&self, take: &mut dyn FnMut(Dual)) -> bool {
        self.leaf.numbers(take)
    }

    fn begin_memories(
        &self,
        state: StateRef,
        own: VariationRef,
        memories: &mut Vec<MemoryTangent>,
    ) -> Result<(), KernelError> {
        self.leaf.begin_memories(state, own, memories)
    }

    fn begin_variation(&self, at: &Point, state: StateRef, told: &PointVariation, own: VariationMut) {
        let rate = self.vary_rate(at, told, own.count);
        self.leaf.begin_variation(&self.point(at), state, &PointVariation { rate: &rate, ..*told }, own);
    }

    fn vary(&self, step: &Step, state: StateRef, told: &StepVariation, own: VariationRef, forces: &mut [f64]) {
        let rates = self.rates(step);
        let (count, changes) = (told.count, self.vary_rates(step, &rates, told, false));
        let inner = Self::step(step, &rates);
        if changes[count..].iter().any(|change| *change != 0.0) {
            // The rates that the leaf is told change with a_T.
            let mut response = Response::default();
            self.leaf.evaluate(&inner, state, &mut response);
            for (forces, by_rate) in forces.chunks_exact_mut(count).zip(response.d_rate) {
                for (change, by_rate) in changes[count..].chunks_exact(count).zip(by_rate) {
                    add(forces, by_rate, change);
                }
            }
        }
        self.leaf.vary(&inner, state, &StepVariation { rate: &changes, ..*told }, own, forces);
    }

    fn commit_variation(&self, step: &Step, state: StateRef, told: &StepVariation, own: VariationMut) {
        let rates = self.rates(step);
        let changes = self.vary_rates(step, &rates, told, true);
        let told = StepVariation { rate: &changes, ..*told };
        self.leaf.commit_variation(&Self::step(step, &rates), state, &told, own);
    }

    /// P by ξ is a_T·P.
    fn vary_powers(
        &self,
        step: &Step,
        state: StateRef,
        told: &StepVariation,
        own: VariationRef,
        sum: &mut PowersVariation,
    ) {
        let (rates, mut powers, count) = (self.rates(step), Powers::default(), told.count);
        let changes = self.vary_rates(step, &rates, told, true);
        let (inner, told_inside) = (Self::step(step, &rates), StepVariation { rate: &changes, ..*told });
        self.leaf.powers(&inner, state, &mut powers);
        let mut changes = [vec![0.0; sum.dissipation.len()], vec![0.0; sum.input.len()]];
        let [dissipation, input] = &mut changes;
        self.leaf.vary_powers(&inner, state, &told_inside, own, &mut PowersVariation { dissipation, input });
        for k in 0..=step.nodes.count() {
            let block = k * count..(k + 1) * count;
            let by_factor = told.input_at(k, self.factor, step.inputs_at(k).len()).map(|[value, _]| value);
            let own = [(powers[k].dissipation, &mut *sum.dissipation), (powers[k].input, &mut *sum.input)];
            for ((power, sum), change) in own.into_iter().zip(&changes) {
                let sum = &mut sum[block.clone()];
                add(sum, rates.factor[k], &change[block.clone()]);
                by_factor.into_iter().for_each(|by_factor| add(sum, power, by_factor));
            }
        }
    }

    fn vary_at(
        &self,
        when: When,
        at: &Point,
        state: StateRef,
        told: &PointVariation,
        own: VariationRef,
        sum: &mut ObservationVariation,
    ) {
        let rate = self.vary_rate(at, told, own.count);
        let around = match (when, &told.step) {
            (When::Within(step, theta), Some(around)) => {
                let rates = self.rates(step);
                let changes = self.vary_rates(step, &rates, around, true);
                Some((step, theta, rates, changes, around))
            }
            _ => None,
        };
        let inner = around.as_ref().map(|(step, theta, rates, changes, around)| {
            (Self::step(step, rates), *theta, StepVariation { rate: changes, ..**around })
        });
        let told = PointVariation { rate: &rate, step: inner.as_ref().map(|(.., told)| *told), ..*told };
        let when = inner.as_ref().map_or(When::Between, |(step, theta, _)| When::Within(step, *theta));
        self.leaf.vary_at(when, &self.point(at), state, &told, own, sum);
    }

    fn by_input(&self, step: &Step, state: StateRef, input: usize, slopes: &mut [[f64; MAX_NODES]; MAX_NODES]) {
        self.leaf.by_input(&Self::step(step, &self.rates(step)), state, input, slopes);
    }

    fn linearised(&self, at: &Point) -> Term {
        self.leaf.linearised(&self.point(at)).shifted(self.factor(at.inputs).recip())
    }

    fn at_rest(&self, at: &Point, held: f64) -> AtRest {
        let rest = self.leaf.at_rest(&self.point(at), held);
        AtRest { tangent: rest.tangent.shifted(self.factor(at.inputs).recip(), &Some), ..rest }
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
