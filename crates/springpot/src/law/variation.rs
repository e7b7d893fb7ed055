//! What parameters change of a law: beside every number a block of derivatives, one for each parameter.

use super::network::Network;
use super::state::{State, StateSize};
use super::step::{InputValue, Point, Step};
use crate::collocation::MAX_NODES;
use crate::dual::Dual;
use crate::fractional::{MemoryTangent, PortColumns};
use crate::linalg::columns;
use serde::{Deserialize, Serialize};

/// What parameters change of what a law is told of a step: blocks of `count` derivatives.
#[derive(Debug, Clone, Copy)]
pub struct StepVariation<'a> {
    /// Number of parameters.
    pub count: usize,
    /// Of x at the start and at the nodes, s + 1 blocks.
    pub stroke: &'a [f64],
    /// Of x' there.
    pub rate: &'a [f64],
    /// Of the inputs there, value and rate, point by point; empty where no parameter moves any.
    pub inputs: [&'a [f64]; 2],
    /// Of the time that has passed since the start at each node, s blocks, by the clock of the law; `None` where no parameter moves that.
    pub passed: Option<&'a [f64]>,
}

/// What parameters change of what a law is told of one time.
#[derive(Debug, Clone, Copy)]
pub struct PointVariation<'a> {
    /// Of x, a block.
    pub stroke: &'a [f64],
    /// Of x'.
    pub rate: &'a [f64],
    /// Of the inputs, value and rate; empty where no parameter moves any.
    pub inputs: [&'a [f64]; 2],
    /// Of the step around it, where there is one.
    pub step: Option<StepVariation<'a>>,
    /// Of the time that has passed since the start of that, a block; `None` where no parameter moves that.
    pub passed: Option<&'a [f64]>,
}

/// What parameters change of what a law is at one time: blocks of derivatives, to which every leaf adds its own.
#[derive(Debug)]
pub struct ObservationVariation<'a> {
    /// Of F without the share of a singular start.
    pub force: &'a mut [f64],
    /// Of the stored energy.
    pub stored: &'a mut [f64],
    /// Of D^alpha x of a law with one springpot, with that share.
    pub derivative: &'a mut [f64],
    /// Of what leaves tell of themselves ([`super::Leaf::tells`]): a block for each number, appended leaf by leaf.
    pub told: &'a mut Vec<f64>,
    /// Of what leaves are by themselves ([`super::LeafState`]), where it is asked for: blocks of stroke, rate, force and D^alpha x, appended leaf by leaf.
    pub leaves: Option<&'a mut Vec<f64>>,
}

/// What parameters change of energy flows at the start and at the nodes of a step: s + 1 blocks of derivatives, to which every leaf adds its own.
#[derive(Debug)]
pub struct PowersVariation<'a> {
    /// Of what is dissipated.
    pub dissipation: &'a mut [f64],
    /// Of what inputs supply.
    pub input: &'a mut [f64],
}

/// How well a step knows what one parameter changes of one inner variable, in the unit of that by the unit of the parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VariationError {
    /// Which parameter.
    pub parameter: usize,
    /// Estimate of the error at the end of the step, ≥ 0.
    pub error: f64,
    /// |What changes there|.
    pub change: f64,
    /// By how much that changes over the step at most.
    pub coming: f64,
    /// How large the variable itself is, or becomes over the step.
    pub size: f64,
}

/// Takes such errors, each with the number of its inner variable.
pub type TakeError<'a> = &'a mut dyn FnMut(usize, VariationError);

/// What parameters change of a law's own: its numbers, and what it keeps between steps.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct LawVariation {
    /// Number of parameters.
    pub count: usize,
    /// Of the numbers of its leaves, in their order.
    numbers: Vec<f64>,
    /// Of its memories.
    memories: Vec<MemoryTangent>,
    /// Of its inner variables.
    variables: Vec<f64>,
    /// The same at t = 0 itself, where the state there is another one.
    at_start: Option<Box<Self>>,
}

/// The share of one part of a law.
#[derive(Debug, Clone, Copy)]
pub struct VariationRef<'a> {
    /// Number of parameters.
    pub count: usize,
    /// Blocks of its numbers, in the order of [`super::Leaf::numbers`].
    pub numbers: &'a [f64],
    /// Of its memories.
    pub memories: &'a [MemoryTangent],
    /// Blocks of its inner variables.
    pub variables: &'a [f64],
}

/// As [`VariationRef`], to be changed.
#[derive(Debug)]
pub struct VariationMut<'a> {
    /// Number of parameters.
    pub count: usize,
    /// Blocks of its numbers, which stay.
    pub numbers: &'a [f64],
    /// Of its memories.
    pub memories: &'a mut [MemoryTangent],
    /// Blocks of its inner variables.
    pub variables: &'a mut [f64],
}

impl LawVariation {
    /// At t = 0: of the law as each parameter has it, with its derivatives in its numbers, where it moves any; `told` is what changes of its start.
    ///
    /// # Errors
    /// The name of a leaf whose derivatives are not known.
    pub fn begin(
        law: &Network,
        by: &[Option<Network>],
        at: &Point,
        told: &PointVariation,
        state: &State,
    ) -> Result<Self, String> {
        if let Some(leaf) = law.without_derivatives() {
            return Err(leaf);
        }
        let count = by.len();
        let mut numbers = vec![0.0; law.numbers().len() * count];
        for (p, law) in by.iter().enumerate() {
            for (k, Dual { slope, .. }) in law.iter().flat_map(Network::numbers).enumerate() {
                numbers[k * count + p] = slope;
            }
        }
        if let Some(heated) = law.as_heated().filter(|heated| heated.heat().shift.is_some()) {
            let own = heated.heat().numbers().len() * count;
            let is_moved = numbers[..own].iter().any(|slope| *slope != 0.0);
            let warms = heated
                .input()
                .and_then(|input| told.input(input, count))
                .is_some_and(|blocks| blocks.iter().any(|block| block.iter().any(|change| *change != 0.0)));
            if is_moved || warms || heated.heat().thermal.is_some() {
                heated.by_a_clock_that_moves(state)?;
            }
        }
        let variables = vec![0.0; state.size().variables * count];
        let mut begun = Self { count, numbers, memories: Vec::new(), variables, at_start: None };
        let mut memories = Vec::new();
        law.begin_memories(state, &begun, &mut memories).map_err(|error| error.to_string())?;
        begun.memories = memories;
        law.begin_variation(at, state, told, &mut begun);
        Ok(begun)
    }

    /// The rates of inner variables jump by these, from before to after, at a time that parameters move so.
    pub(crate) fn jump(&mut self, [before, after]: [&[f64]; 2], moved: &[f64]) {
        let blocks = self.variables.chunks_exact_mut(self.count.max(1));
        for (block, (before, after)) in blocks.zip(before.iter().zip(after)) {
            block.iter_mut().zip(moved).for_each(|(own, moved)| *own += (before - after) * moved);
        }
    }

    /// The same by other columns, of which each moves its numbers as one of these does or not at all; the past of its memory k is told by `ports(k)`.
    pub(crate) fn narrowed(&self, of: &[Option<usize>], ports: impl Fn(usize) -> PortColumns) -> Self {
        let block = |own: &[f64]| of.iter().map(|p| p.map_or(0.0, |p| own[p])).collect::<Vec<_>>();
        Self {
            count: of.len(),
            numbers: self.numbers.chunks_exact(self.count.max(1)).flat_map(block).collect(),
            memories: self.memories.iter().enumerate().map(|(k, memory)| memory.narrowed(of, ports(k))).collect(),
            variables: vec![0.0; self.variables.len() / self.count.max(1) * of.len()],
            at_start: None,
        }
    }

    /// The same where nothing is known of it.
    pub(crate) fn lost(mut self) -> Self {
        self.numbers.fill(f64::NAN);
        self
    }

    /// The same, but at t = 0 itself as `start` has it.
    pub(crate) fn behind(self, start: Self) -> Self {
        Self { at_start: Some(Box::new(start)), ..self }
    }

    /// What changes at time t between two steps.
    pub(crate) fn seen_at(&self, t: f64) -> &Self {
        self.at_start.as_deref().filter(|_| t == 0.0).unwrap_or(self)
    }

    /// Goes on behind t = 0.
    pub(super) fn leave_start(&mut self) {
        self.at_start = None;
    }

    /// Takes the place of all but the first `variables`.
    pub(super) fn take_inner(&mut self, inner: Self, variables: usize) {
        self.memories = inner.memories;
        self.variables[variables * self.count..].copy_from_slice(&inner.variables);
    }

    /// Of the inner variables of the law, a block for each.
    pub fn variables(&self) -> &[f64] {
        &self.variables
    }

    /// The same, to be changed.
    pub(crate) fn variables_mut(&mut self) -> &mut [f64] {
        &mut self.variables
    }

    /// Of its memories.
    pub(crate) fn memories_mut(&mut self) -> &mut [MemoryTangent] {
        &mut self.memories
    }

    /// Whether something of it is infinite at t = 0.
    pub(crate) fn is_singular(&self) -> bool {
        self.memories.iter().any(MemoryTangent::has_jumps)
    }

    /// All of it.
    pub(crate) fn view(&self) -> VariationRef<'_> {
        VariationRef { count: self.count, numbers: &self.numbers, memories: &self.memories, variables: &self.variables }
    }

    /// All of it, to be changed.
    pub(crate) fn view_mut(&mut self) -> VariationMut<'_> {
        VariationMut {
            count: self.count,
            numbers: &self.numbers,
            memories: &mut self.memories,
            variables: &mut self.variables,
        }
    }
}

impl<'a> VariationRef<'a> {
    /// Splits off the share of the next leaf.
    pub(super) fn take(&mut self, numbers: usize, size: StateSize) -> Self {
        let (own, rest) = self.numbers.split_at(numbers * self.count);
        let (variables, other) = self.variables.split_at(size.variables * self.count);
        // None of a law that is only beginning.
        let (memories, others) = self.memories.split_at(size.memories.min(self.memories.len()));
        (self.numbers, self.memories, self.variables) = (rest, others, other);
        Self { count: self.count, numbers: own, memories, variables }
    }

    /// The block of its number `k`.
    pub fn number(&self, k: usize) -> &'a [f64] {
        &self.numbers[k * self.count..(k + 1) * self.count]
    }

    /// The block of its inner variable `k`.
    pub fn variable(&self, k: usize) -> &'a [f64] {
        &self.variables[k * self.count..(k + 1) * self.count]
    }
}

impl<'a> VariationMut<'a> {
    /// Splits off the share of the next leaf.
    pub(super) fn take(&mut self, numbers: usize, size: StateSize) -> VariationMut<'a> {
        let (own, rest) = self.numbers.split_at(numbers * self.count);
        let variables = self.variables.split_off_mut(..size.variables * self.count).expect("a state of this law");
        let memories = self.memories.split_off_mut(..size.memories).expect("a state of this law");
        self.numbers = rest;
        VariationMut { count: self.count, numbers: own, memories, variables }
    }

    /// The same for a while.
    pub(super) fn reborrow(&mut self) -> VariationMut<'_> {
        VariationMut { count: self.count, numbers: self.numbers, memories: self.memories, variables: self.variables }
    }

    /// The same, to be looked at.
    pub fn view(&self) -> VariationRef<'_> {
        VariationRef { count: self.count, numbers: self.numbers, memories: self.memories, variables: self.variables }
    }
}

impl<'a> StepVariation<'a> {
    /// The block of x at its start (0) or at a node.
    pub fn stroke_at(&self, point: usize) -> &'a [f64] {
        &self.stroke[point * self.count..(point + 1) * self.count]
    }

    /// The block of x' there.
    pub fn rate_at(&self, point: usize) -> &'a [f64] {
        &self.rate[point * self.count..(point + 1) * self.count]
    }

    /// The blocks of value and rate of input `input`, of `inputs` that the law has, there; none where no parameter moves it.
    pub fn input_at(&self, point: usize, input: usize, inputs: usize) -> Option<[&'a [f64]; 2]> {
        let from = (point * inputs + input) * self.count;
        let [values, rates] = self.inputs;
        Some([values.get(from..from + self.count)?, rates.get(from..from + self.count)?])
    }

    /// The parameters that move the clock.
    pub(super) fn moves_clock(&self) -> impl Iterator<Item = usize> + 'a {
        let (count, passed) = (self.count, self.passed.unwrap_or_default());
        (0..count).filter(move |p| passed.iter().skip(*p).step_by(count).any(|moved| *moved != 0.0))
    }

    /// As parameter `p` has it: strokes and rates at the nodes stay unless they are those that `told` says.
    pub(super) fn column(&self, step: &Step, p: usize, at_nodes: AtNodes) -> Column {
        let (count, inputs) = (step.nodes.count(), step.inputs_at(0).len());
        let mut column = Column { stroke: [Dual::default(); MAX_NODES + 1], ..Column::default() };
        for k in 0..=count {
            let moves = k == 0 || at_nodes == AtNodes::AsTold;
            let slope = |block: &[f64]| if moves { block[p] } else { 0.0 };
            column.stroke[k] = Dual { value: step.stroke[k], slope: slope(self.stroke_at(k)) };
            column.rate[k] = Dual { value: step.rate[k], slope: slope(self.rate_at(k)) };
            for (i, InputValue { value, rate }) in step.inputs_at(k).iter().enumerate() {
                let [by_value, by_rate] = self.input_at(k, i, inputs).map_or([0.0; 2], |of| of.map(|block| block[p]));
                let [value, rate] = [(*value, by_value), (*rate, by_rate)].map(|(value, slope)| Dual { value, slope });
                column.inputs.push(InputValue { value, rate });
            }
        }
        column
    }
}

/// Which strokes and rates of a step's nodes change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum AtNodes {
    /// None.
    Still,
    /// Those that are told.
    AsTold,
}

/// A step as one parameter has it.
#[derive(Debug, Default)]
pub(super) struct Column {
    stroke: [Dual; MAX_NODES + 1],
    rate: [Dual; MAX_NODES + 1],
    inputs: Vec<InputValue<Dual>>,
}

impl Column {
    /// Of the step that it was made of.
    pub(super) fn step<'a>(&'a self, of: &Step<'a>) -> Step<'a, Dual> {
        let &Step { t, h, nodes, places, form, resolution, course, .. } = of;
        let known = ..=nodes.count();
        let (stroke, rate) = (&self.stroke[known], &self.rate[known]);
        Step { t, h, nodes, places, form, stroke, rate, inputs: &self.inputs, resolution, course }
    }

    /// Whether nothing of it changes.
    pub(super) fn is_still(&self) -> bool {
        let of_inputs = self.inputs.iter().flat_map(|input| [input.value, input.rate]);
        self.stroke.iter().chain(&self.rate).copied().chain(of_inputs).all(|number| number.slope == 0.0)
    }
}

impl<'a> PointVariation<'a> {
    /// The blocks of value and rate of input `input`, `count` long; none where no parameter moves it.
    pub fn input(&self, input: usize, count: usize) -> Option<[&'a [f64]; 2]> {
        let [values, rates] = self.inputs;
        let own = input * count..(input + 1) * count;
        Some([values.get(own.clone())?, rates.get(own)?])
    }

    /// The inputs of `at` as parameter `p` of `count` has them.
    pub(super) fn inputs_of(&self, at: &Point, p: usize, count: usize) -> Vec<InputValue<Dual>> {
        let of = |(i, input): (usize, &InputValue)| {
            let [by_value, by_rate] = self.input(i, count).map_or([0.0; 2], |of| of.map(|block| block[p]));
            let [value, rate] =
                [(input.value, by_value), (input.rate, by_rate)].map(|(value, slope)| Dual { value, slope });
            InputValue { value, rate }
        };
        at.inputs.iter().enumerate().map(of).collect()
    }
}

/// Adds factor·block to a block.
pub(crate) fn add(to: &mut [f64], factor: f64, block: &[f64]) {
    let count = to.len().min(block.len());
    columns::add(&mut to[..count], [factor], [block]);
}
