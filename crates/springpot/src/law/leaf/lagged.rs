//! A leaf behind its driver, whose output follows the command with a lag.

use super::contract::Leaf;
use super::hysteresis::{Matrix, Values, resolvent};
use crate::collocation::{MAX_NODES, Nodes, quadrature, quadrature_defect};
use crate::fractional::KernelError;
use crate::law::network::{Guard, Holds};
use crate::law::rule::RuleError;
use crate::law::state::{State, StateMut, StateRef, StateSize};
use crate::law::step::{InputValue, LocalError, Observation, Point, Powers, Response, Start, Step, Term};
use crate::law::tangent::{LeafAtRest, Tangent};

/// A leaf whose only input is w, w' = −eta·(w − u), w(0) = u(0), u the first input of the law: the current of a driver that was told u.
///
/// w is one inner variable, collocated at the nodes of the step. It stays among the values that u has had, so that rules over u hold for w.
/// It is meant for leaves whose force does not follow the input at rest.
#[derive(Debug, Clone)]
pub(in crate::law) struct Lagged<L> {
    leaf: L,
    rate: f64,
}

/// w over a step: what the leaf is told as its input at the start and at the nodes, and ∂w_i/∂u_j.
struct Followed {
    inputs: [InputValue; MAX_NODES + 1],
    by_command: Matrix,
}

impl<L: Leaf> Lagged<L> {
    /// Behind a driver of the rate eta, 1/s.
    ///
    /// # Errors
    /// [`RuleError`]: eta > 0.
    pub(in crate::law) fn new(leaf: L, eta: f64) -> Result<Self, RuleError> {
        RuleError::unless(eta > 0.0, "eta > 0", "eta")?;
        Ok(Self { leaf, rate: eta })
    }

    fn follow(&self, step: &Step, start: f64) -> Followed {
        let (nodes, count) = (step.nodes, step.nodes.count());
        let command: Values = std::array::from_fn(|k| if k <= count { step.point(k).inputs[0].value } else { 0.0 });
        // w'_i + eta·h Σ_j A_ij w'_j = eta·(u_i − w_0).
        let followed = resolvent(nodes, &[1.0; MAX_NODES][..count], self.rate * step.h);
        let mut inputs = [InputValue { value: start, rate: self.rate * (command[0] - start) }; MAX_NODES + 1];
        for (input, row) in inputs[1..=count].iter_mut().zip(&followed) {
            input.rate = (0..count).map(|j| row[j] * self.rate * (command[j + 1] - start)).sum();
        }
        let rates: Values = std::array::from_fn(|k| inputs[k].rate);
        let mut by_command = Matrix::default();
        for (i, row) in nodes.matrix().iter().enumerate().take(count) {
            inputs[i + 1].value = start + step.h * (0..count).map(|j| row[j] * rates[j + 1]).sum::<f64>();
            by_command[i] =
                std::array::from_fn(|m| (0..count).map(|j| step.h * row[j] * followed[j][m] * self.rate).sum());
        }
        Followed { inputs, by_command }
    }

    fn settled(at: &Point) -> [InputValue; 1] {
        [InputValue { value: at.inputs[0].value, rate: 0.0 }]
    }

    /// Splits off w.
    fn split<'a>(mut state: StateRef<'a>) -> (f64, StateRef<'a>) {
        (state.take(StateSize { memories: 0, variables: 1 }).variables[0], state)
    }
}

impl Followed {
    fn step<'a>(&'a self, step: &Step<'a>) -> Step<'a> {
        Step { inputs: &self.inputs[..=step.nodes.count()], ..*step }
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
        let start = state.take(StateSize { memories: 0, variables: 1 }).variables[0];
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
        let own = state.take(StateSize { memories: 0, variables: 1 });
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
        errors.push(LocalError { error, value: last, order: 0.0, sharpness: 1.0 });
        self.leaf.local_errors(&followed.step(step), rest, errors);
    }

    fn powers(&self, step: &Step, state: StateRef, powers: &mut Powers) {
        let (start, rest) = Self::split(state);
        self.leaf.powers(&self.follow(step, start).step(step), rest, powers);
    }

    fn at(&self, step: &Step, theta: f64, at: &Point, state: StateRef) -> Observation {
        let (start, rest) = Self::split(state);
        let followed = self.follow(step, start);
        let moved =
            quadrature(step.nodes, theta).iter().zip(followed.inputs).map(|(w, input)| w * input.rate).sum::<f64>();
        let value = start + step.h * moved;
        let inputs = [InputValue { value, rate: self.rate * (at.inputs[0].value - value) }];
        self.leaf.at(&followed.step(step), theta, &Point { inputs: &inputs, ..*at }, rest)
    }

    fn now(&self, at: &Point, state: StateRef) -> Observation {
        let (value, rest) = Self::split(state);
        let inputs = [InputValue { value, rate: self.rate * (at.inputs[0].value - value) }];
        self.leaf.now(&Point { inputs: &inputs, ..*at }, rest)
    }

    fn linearised(&self, at: &Point) -> Term {
        self.leaf.linearised(&Point { inputs: &Self::settled(at), ..*at })
    }

    fn at_rest(&self, at: &Point, held: f64) -> LeafAtRest {
        self.leaf.at_rest(&Point { inputs: &Self::settled(at), ..*at }, held)
    }

    fn tangent(&self, at: &Point) -> Option<Tangent> {
        self.leaf.tangent(&Point { inputs: &Self::settled(at), ..*at })
    }

    fn has_clock(&self) -> bool {
        true
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
