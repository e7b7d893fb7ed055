//! A leaf behind its driver, whose output follows the command with a lag.

use super::contract::{Clock, Guard, Holds, Leaf, When};
use super::hysteresis::{Matrix, Values, resolvent};
use crate::collocation::{MAX_NODES, Nodes, quadrature, quadrature_defect};
use crate::dual::Dual;
use crate::fractional::{KernelError, MemoryTangent};
use crate::law::rule::RuleError;
use crate::law::state::{State, StateMut, StateRef, StateSize};
use crate::law::step::{InputValue, LocalError, Observation, Point, Powers, Response, Start, Step, Term};
use crate::law::tangent::AtRest;
use crate::law::variation::{
    AtNodes, ObservationVariation, PointVariation, PowersVariation, StepVariation, TakeError, VariationError,
    VariationMut, VariationRef,
};

/// A leaf whose only input is w, w' = −eta·(w − u), w(0) = u(0), u the first input of the law: the current of a driver that was told u.
///
/// w is one inner variable, collocated at the nodes of the step. It stays among the values that u has had, so that rules over u hold for w.
/// It is meant for leaves whose force does not follow the input at rest.
#[derive(Debug, Clone)]
pub(in crate::law) struct Lagged<L> {
    leaf: L,
    rate: Dual,
}

/// w over a step: what the leaf is told as its input at the start and at the nodes, and ∂w_i/∂u_j.
struct Followed {
    inputs: [InputValue; MAX_NODES + 1],
    by_command: Matrix,
    /// What maps drives of w' to it.
    resolvent: Matrix,
}

/// How far w goes, and what changes of it: blocks of w and of w' at the start and at the nodes.
struct Changes([Vec<f64>; 2]);

/// What of a state and of the numbers is that of w.
const OWN: StateSize = StateSize { memories: 0, variables: 1 };

impl<L: Leaf> Lagged<L> {
    /// Behind a driver of the rate eta, 1/s.
    ///
    /// # Errors
    /// [`RuleError`]: eta > 0.
    pub(in crate::law) fn new(leaf: L, eta: impl Into<Dual>) -> Result<Self, RuleError> {
        let rate = eta.into();
        RuleError::unless(rate.value > 0.0, "eta > 0", "eta")?;
        Ok(Self { leaf, rate })
    }

    fn follow(&self, step: &Step, start: f64) -> Followed {
        let (nodes, count, eta) = (step.nodes, step.nodes.count(), self.rate.value);
        let command: Values = std::array::from_fn(|k| if k <= count { step.point(k).inputs[0].value } else { 0.0 });
        // w'_i + eta·h Σ_j A_ij w'_j = eta·(u_i − w_0).
        let followed = resolvent(nodes, &[1.0; MAX_NODES][..count], eta * step.h);
        let mut inputs = [InputValue { value: start, rate: eta * (command[0] - start) }; MAX_NODES + 1];
        for (input, row) in inputs[1..=count].iter_mut().zip(&followed) {
            input.rate = (0..count).map(|j| row[j] * eta * (command[j + 1] - start)).sum();
        }
        let rates: Values = std::array::from_fn(|k| inputs[k].rate);
        let mut by_command = Matrix::default();
        for (i, row) in nodes.matrix().iter().enumerate().take(count) {
            inputs[i + 1].value = start + step.h * (0..count).map(|j| row[j] * rates[j + 1]).sum::<f64>();
            by_command[i] = std::array::from_fn(|m| (0..count).map(|j| step.h * row[j] * followed[j][m] * eta).sum());
        }
        Followed { inputs, by_command, resolvent: followed }
    }

    /// What changes of w, of which `start` is that at the start of the step.
    fn vary_command(
        &self,
        step: &Step,
        start: f64,
        followed: &Followed,
        told: &StepVariation,
        own: &VariationRef,
    ) -> Changes {
        let (count, matrix, points) = (own.count, step.nodes.matrix(), step.nodes.count());
        let mut changes = [vec![0.0; (points + 1) * count], vec![0.0; (points + 1) * count]];
        for p in 0..count {
            let column = told.column(step, p, AtNodes::AsTold);
            let step = column.step(step);
            let [eta, start] = [(self.rate.value, own.number(0)), (start, own.variable(0))]
                .map(|(value, block)| Dual { value, slope: block[p] });
            let command = |k: usize| step.inputs_at(k)[0].value;
            let mut rates = followed.inputs.map(|input| Dual::from(input.rate));
            let reached = |rates: &[Dual; MAX_NODES + 1], i: usize| -> Dual {
                let row = matrix[i].iter().take(points).zip(&rates[1..]);
                start + Dual::from(step.h) * row.map(|(weight, rate)| Dual::from(*weight) * *rate).sum()
            };
            // What drives w' where it stays.
            let driven: [f64; MAX_NODES] = std::array::from_fn(|i| match i < points {
                true => (eta * (command(i + 1) - reached(&rates, i))).slope,
                false => 0.0,
            });
            rates[0] = eta * (command(0) - start);
            for i in 0..points {
                rates[i + 1].slope = (0..points).map(|j| followed.resolvent[i][j] * driven[j]).sum();
            }
            for k in 0..=points {
                let value = if k == 0 { start } else { reached(&rates, k - 1) };
                changes[0][k * count + p] = value.slope;
                changes[1][k * count + p] = rates[k].slope;
            }
        }
        Changes(changes)
    }

    /// What the leaf is told where w is `value`.
    fn told(&self, at: &Point, value: f64) -> [InputValue; 1] {
        [InputValue { value, rate: self.rate.value * (at.inputs[0].value - value) }]
    }

    fn settled(at: &Point) -> [InputValue; 1] {
        [InputValue { value: at.inputs[0].value, rate: 0.0 }]
    }

    /// Splits off w.
    fn split<'a>(mut state: StateRef<'a>) -> (f64, StateRef<'a>) {
        (state.take(OWN).variables[0], state)
    }
}

impl Followed {
    fn step<'a>(&'a self, step: &Step<'a>) -> Step<'a> {
        Step { inputs: &self.inputs[..=step.nodes.count()], ..*step }
    }

    /// w at θ of the step.
    fn until(&self, step: &Step, theta: f64, start: f64) -> f64 {
        let weights = quadrature(step.nodes, theta);
        let moved = weights.iter().zip(self.inputs).map(|(w, input)| w * input.rate).sum::<f64>();
        start + step.h * moved
    }
}

impl Changes {
    /// What changes of the step as the leaf is told it.
    fn step<'a>(&'a self, told: &StepVariation<'a>) -> StepVariation<'a> {
        StepVariation { inputs: self.0.each_ref().map(Vec::as_slice), ..*told }
    }

    /// What changes of w at node `k` (0: the start).
    fn value(&self, k: usize, count: usize) -> &[f64] {
        &self.0[0][k * count..(k + 1) * count]
    }
}

impl<L: Leaf> Leaf for Lagged<L> {
    fn name(&self) -> &'static str {
        self.leaf.name()
    }

    fn size(&self) -> StateSize {
        let StateSize { memories, variables } = self.leaf.size();
        StateSize { memories, variables: 1 + variables }
    }

    fn begin(&self, start: &Start, state: &mut State) -> Result<(), KernelError> {
        let command = start.inputs[0].value;
        state.push_variable(command);
        self.leaf.begin(&Start { inputs: &[InputValue { value: command, rate: 0.0 }], ..*start }, state)
    }

    fn prepare(&self, step: &Step, mut state: StateMut) {
        let start = state.take(OWN).variables[0];
        self.leaf.prepare(&self.follow(step, start).step(step), state);
    }

    fn evaluate(&self, step: &Step, state: StateRef, response: &mut Response) {
        let (start, rest) = Self::split(state);
        self.leaf.evaluate(&self.follow(step, start).step(step), rest, response);
    }

    fn by_input(&self, step: &Step, state: StateRef, input: usize, slopes: &mut [[f64; MAX_NODES]; MAX_NODES]) {
        if input != 0 {
            return;
        }
        let (start, rest) = Self::split(state);
        let (followed, mut own) = (self.follow(step, start), Matrix::default());
        self.leaf.by_input(&followed.step(step), rest, 0, &mut own);
        for (slopes, own) in slopes.iter_mut().zip(&own) {
            for (j, slope) in slopes.iter_mut().enumerate() {
                *slope += own.iter().zip(&followed.by_command).map(|(by_w, w)| by_w * w[j]).sum::<f64>();
            }
        }
    }

    fn commit(&self, step: &Step, mut state: StateMut) {
        let own = state.take(OWN);
        let (start, followed) = (own.variables[0], self.follow(step, own.variables[0]));
        self.leaf.commit(&followed.step(step), state);
        let last = followed.inputs[step.nodes.count()].value;
        own.variables[0] = if step.nodes == Nodes::Midpoint { 2.0 * last - start } else { last };
    }

    fn local_errors(&self, step: &Step, state: StateRef, errors: &mut Vec<LocalError>) {
        let (start, rest) = Self::split(state);
        let followed = self.follow(step, start);
        let rates = followed.inputs.map(|input| input.rate);
        let error = step.h * quadrature_defect(step.nodes, &rates);
        let last = followed.inputs[step.nodes.count()].value;
        // What rounding leaves of a constant command is no error.
        let error = if error <= 4.0 * f64::EPSILON * last.abs() { 0.0 } else { error };
        errors.push(LocalError::collocated(error, last));
        self.leaf.local_errors(&followed.step(step), rest, errors);
    }

    fn powers(&self, step: &Step, state: StateRef, powers: &mut Powers) {
        let (start, rest) = Self::split(state);
        self.leaf.powers(&self.follow(step, start).step(step), rest, powers);
    }

    fn at(&self, step: &Step, theta: f64, at: &Point, state: StateRef) -> Observation {
        let (start, rest) = Self::split(state);
        let followed = self.follow(step, start);
        let inputs = self.told(at, followed.until(step, theta, start));
        self.leaf.at(&followed.step(step), theta, &Point { inputs: &inputs, ..*at }, rest)
    }

    fn now(&self, at: &Point, state: StateRef) -> Observation {
        let (value, rest) = Self::split(state);
        let inputs = self.told(at, value);
        self.leaf.now(&Point { inputs: &inputs, ..*at }, rest)
    }

    /// eta, and those of the leaf.
    fn numbers(&self, take: &mut dyn FnMut(Dual)) -> bool {
        take(self.rate);
        self.leaf.numbers(take)
    }

    fn begin_memories(
        &self,
        state: StateRef,
        mut own: VariationRef,
        memories: &mut Vec<MemoryTangent>,
    ) -> Result<(), KernelError> {
        own.take(1, OWN);
        self.leaf.begin_memories(Self::split(state).1, own, memories)
    }

    fn rates(&self, at: &Point, state: StateRef, rates: &mut Vec<f64>) -> bool {
        let (start, rest) = Self::split(state);
        let inputs = self.told(at, start);
        rates.push(inputs[0].rate);
        self.leaf.rates(&Point { inputs: &inputs, ..*at }, rest, rates)
    }

    fn begin_variation(&self, at: &Point, state: StateRef, told: &PointVariation, mut own: VariationMut) {
        let of_w = own.take(1, OWN);
        // w(0) = u(0), and its rate is 0.
        let still = vec![0.0; of_w.count];
        if let Some([command, _]) = told.input(0, of_w.count) {
            of_w.variables.copy_from_slice(command);
        }
        let inputs = [&*of_w.variables, &still];
        self.leaf.begin_variation(
            &Point { inputs: &Self::settled(at), ..*at },
            Self::split(state).1,
            &PointVariation { inputs, ..*told },
            own,
        );
    }

    fn vary(&self, step: &Step, state: StateRef, told: &StepVariation, mut own: VariationRef, forces: &mut [f64]) {
        let (start, rest) = Self::split(state);
        let followed = self.follow(step, start);
        let changes = self.vary_command(step, start, &followed, told, &own.take(1, OWN));
        self.leaf.vary(&followed.step(step), rest, &changes.step(told), own, forces);
    }

    fn commit_variation(&self, step: &Step, state: StateRef, told: &StepVariation, mut own: VariationMut) {
        let (start, rest) = Self::split(state);
        let (followed, of_w) = (self.follow(step, start), own.take(1, OWN));
        let changes = self.vary_command(step, start, &followed, told, &of_w.view());
        self.leaf.commit_variation(&followed.step(step), rest, &changes.step(told), own);
        let ends = changes.value(step.nodes.count(), of_w.count);
        for (own, last) in of_w.variables.iter_mut().zip(ends) {
            *own = if step.nodes == Nodes::Midpoint { 2.0 * last - *own } else { *last };
        }
    }

    fn vary_powers(
        &self,
        step: &Step,
        state: StateRef,
        told: &StepVariation,
        mut own: VariationRef,
        sum: &mut PowersVariation,
    ) {
        let (start, rest) = Self::split(state);
        let followed = self.follow(step, start);
        let changes = self.vary_command(step, start, &followed, told, &own.take(1, OWN));
        self.leaf.vary_powers(&followed.step(step), rest, &changes.step(told), own, sum);
    }

    fn vary_errors(&self, step: &Step, state: StateRef, told: &StepVariation, mut own: VariationRef, take: TakeError) {
        let (start, rest) = Self::split(state);
        let (followed, last) = (self.follow(step, start), step.nodes.count());
        let (count, of_w) = (own.count, own.take(1, OWN));
        let changes = self.vary_command(step, start, &followed, told, &of_w);
        let fastest = followed.inputs[..=last].iter().fold(0.0f64, |fastest, input| fastest.max(input.rate.abs()));
        for parameter in 0..count {
            let [values, rates] = changes.0.each_ref().map(|blocks| {
                let mut of = blocks.iter().skip(parameter).step_by(count);
                std::array::from_fn(|_| of.next().copied().unwrap_or(0.0))
            });
            let (values, rates): (Values, Values) = (values, rates);
            let error = VariationError {
                parameter,
                error: step.h * step.quadrature_defect(&rates),
                change: values[last].abs(),
                coming: step.h * rates.iter().fold(0.0f64, |fastest, rate| fastest.max(rate.abs())),
                size: followed.inputs[last].value.abs() + step.h * fastest,
            };
            take(0, error);
        }
        self.leaf.vary_errors(&followed.step(step), rest, &changes.step(told), own, &mut |k, error| take(1 + k, error));
    }

    fn vary_at(
        &self,
        when: When,
        at: &Point,
        state: StateRef,
        told: &PointVariation,
        mut own: VariationRef,
        sum: &mut ObservationVariation,
    ) {
        let (start, rest) = Self::split(state);
        let (count, of_w) = (own.count, own.take(1, OWN));
        let found = match (when, &told.step) {
            (When::Within(step, theta), Some(around)) => {
                let followed = self.follow(step, start);
                let changes = self.vary_command(step, start, &followed, around, &of_w);
                Some((step, theta, followed, changes, around))
            }
            _ => None,
        };
        let (mut value, mut by_w) = (start, of_w.variable(0).to_vec());
        if let Some((step, theta, followed, changes, _)) = &found {
            value = followed.until(step, *theta, start);
            for (weight, rates) in quadrature(step.nodes, *theta).iter().zip(changes.0[1].chunks_exact(count)) {
                by_w.iter_mut().zip(rates).for_each(|(w, rate)| *w += step.h * weight * rate);
            }
        }
        // w' = eta·(u − w).
        let command = told.input(0, count).map(|[value, _]| value);
        let off = at.inputs[0].value - value;
        let rate = |p: usize| {
            self.rate.value * (command.map_or(0.0, |command| command[p]) - by_w[p]) + off * of_w.number(0)[p]
        };
        let rates: Vec<f64> = (0..count).map(rate).collect();
        let (inputs, at) = (self.told(at, value), *at);
        let at = Point { inputs: &inputs, ..at };
        let own_step = found
            .as_ref()
            .map(|(step, theta, followed, changes, around)| (followed.step(step), *theta, changes.step(around)));
        let told = PointVariation { inputs: [&by_w, &rates], step: own_step.as_ref().map(|(.., told)| *told), ..*told };
        let when = own_step.as_ref().map_or(When::Between, |(step, theta, _)| When::Within(step, *theta));
        self.leaf.vary_at(when, &at, rest, &told, own, sum);
    }

    fn linearised(&self, at: &Point) -> Term {
        self.leaf.linearised(&Point { inputs: &Self::settled(at), ..*at })
    }

    fn at_rest(&self, at: &Point, held: f64) -> AtRest {
        self.leaf.at_rest(&Point { inputs: &Self::settled(at), ..*at }, held)
    }

    fn clock(&self) -> Clock {
        Clock::Own
    }

    fn holds(&self) -> Holds {
        self.leaf.holds()
    }

    fn jumps(&self) -> bool {
        self.leaf.jumps()
    }

    fn guards(&self, at: &Point, take: &mut dyn FnMut(f64)) {
        self.leaf.guards(&Point { inputs: &Self::settled(at), ..*at }, take);
    }

    fn guards_in(&self, step: &Step, state: StateRef, guards: &mut Vec<Guard>) {
        let (start, rest) = Self::split(state);
        self.leaf.guards_in(&self.follow(step, start).step(step), rest, guards);
    }

    fn is_linear(&self) -> bool {
        self.leaf.is_linear()
    }

    fn check_inputs(&self, inputs: &[InputValue]) -> Result<(), RuleError> {
        self.leaf.check_inputs(&inputs[..1])
    }
}
