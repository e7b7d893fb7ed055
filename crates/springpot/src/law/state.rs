//! What a law keeps between steps.

use super::network::Ready;
use crate::fractional::{KernelError, Memory, Shelf};
use serde::{Deserialize, Serialize};

/// How much of a [`State`] belongs to one leaf.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct StateSize {
    /// Memories of fractional derivatives.
    pub memories: usize,
    /// Inner variables.
    pub variables: usize,
}

/// The state of a law: the memories and the inner variables of its leaves, one leaf after the other.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct State {
    memories: Vec<Memory>,
    variables: Vec<f64>,
    /// A leaf does not know its energies.
    hides_energy: bool,
    /// What series have worked out for the step under way, one after the other; none before a step was prepared.
    #[serde(skip)]
    ready: Vec<Ready>,
    /// What holds at t = 0 itself, where the rest is that of a little later ([`super::past::settle`]).
    at_start: Option<Box<State>>,
}

/// The share of a state that belongs to one part of a law.
#[derive(Debug, Clone, Copy)]
pub struct StateRef<'a> {
    /// Its memories.
    pub memories: &'a [Memory],
    /// Its inner variables.
    pub variables: &'a [f64],
    pub(super) ready: &'a [Ready],
}

/// As [`StateRef`], to be changed.
#[derive(Debug)]
pub struct StateMut<'a> {
    /// Its memories.
    pub memories: &'a mut [Memory],
    /// Its inner variables.
    pub variables: &'a mut [f64],
    pub(super) ready: &'a mut [Ready],
}

impl State {
    /// Adds a memory of the leaf that begins.
    pub fn push_memory(&mut self, memory: Memory) {
        self.memories.push(memory);
    }

    /// Adds an inner variable of the leaf that begins.
    pub fn push_variable(&mut self, value: f64) {
        self.variables.push(value);
    }

    /// Builds the kernels of all memories that have none: `tolerance` bounds their relative error between the lag `delta`, the shortest that the first
    /// step asks for, and `horizon`, the longest of the run, s.
    ///
    /// # Errors
    /// [`KernelError`] where one cannot be built.
    pub fn open(&mut self, tolerance: f64, delta: f64, horizon: f64) -> Result<(), KernelError> {
        self.open_on(&Shelf::default(), tolerance, delta, horizon)
    }

    /// As [`Self::open`], on the shelf of other states.
    pub(crate) fn open_on(
        &mut self,
        shelf: &Shelf,
        tolerance: f64,
        delta: f64,
        horizon: f64,
    ) -> Result<(), KernelError> {
        self.memories.iter_mut().try_for_each(|memory| memory.open_on(shelf, tolerance, delta, horizon))
    }

    /// The memories, in the order of the leaves.
    pub fn memories(&self) -> &[Memory] {
        &self.memories
    }

    /// The memories, to be changed.
    pub fn memories_mut(&mut self) -> &mut [Memory] {
        &mut self.memories
    }

    /// Number of exponentials in all memories.
    pub fn modes(&self) -> usize {
        self.memories.iter().map(Memory::modes).sum()
    }

    /// Whether a force is infinite at t = 0.
    pub fn is_singular(&self) -> bool {
        self.memories.iter().any(Memory::is_singular)
    }

    /// Whether all energies are known.
    pub fn is_accounted(&self) -> bool {
        self.has_finite_work() && !self.hides_energy
    }

    /// Whether no memory began with infinite work.
    pub(crate) fn has_finite_work(&self) -> bool {
        self.memories.iter().all(Memory::is_accounted)
    }

    /// Says that the leaf that begins does not know its energies.
    pub(super) fn hide_energy(&mut self) {
        self.hides_energy = true;
    }

    /// How large it is.
    pub(crate) fn size(&self) -> StateSize {
        StateSize { memories: self.memories.len(), variables: self.variables.len() }
    }

    /// Adds the state of a part that begins.
    pub(super) fn append(&mut self, other: Self) {
        self.memories.extend(other.memories);
        self.variables.extend(other.variables);
        self.hides_energy |= other.hides_energy;
    }

    /// That of a part which has all but the first `variables`.
    pub(super) fn without(&self, variables: usize) -> Self {
        let (memories, hides_energy) = (self.memories.clone(), self.hides_energy);
        Self { memories, variables: self.variables[variables..].to_vec(), hides_energy, ..Self::default() }
    }

    /// The state at time t between two steps.
    pub(crate) fn seen_at(&self, t: f64) -> &Self {
        self.at_start.as_deref().filter(|_| t == 0.0).unwrap_or(self)
    }

    /// Goes on behind t = 0.
    pub(super) fn leave_start(&mut self) {
        self.at_start = None;
    }

    /// The same, but at t = 0 itself that of `start`, whose energies are as unknown.
    pub(super) fn behind(mut self, start: Self) -> Self {
        for (own, before) in self.memories.iter_mut().zip(&start.memories) {
            if !before.is_accounted() {
                own.lose_account();
            }
        }
        Self { at_start: Some(Box::new(start)), ..self }
    }

    /// All of it.
    pub fn view(&self) -> StateRef<'_> {
        StateRef { memories: &self.memories, variables: &self.variables, ready: &self.ready }
    }

    /// All of it, to be changed.
    pub fn view_mut(&mut self) -> StateMut<'_> {
        StateMut { memories: &mut self.memories, variables: &mut self.variables, ready: &mut self.ready }
    }

    /// Makes room for what `count` series work out for a step.
    pub(super) fn make_room(&mut self, count: usize) {
        self.ready.resize_with(count, Ready::default);
    }

    /// Appends all numbers of the state to `numbers`.
    pub fn save(&self, numbers: &mut Vec<f64>) {
        self.memories.iter().for_each(|memory| memory.save(numbers));
        numbers.extend_from_slice(&self.variables);
    }

    /// Takes back what [`Self::save`] wrote, from the front of `numbers`; `None`, and the state as it was, where they are not those of a
    /// state of the same law.
    pub fn load(&mut self, numbers: &mut &[f64]) -> Option<()> {
        let (mut loaded, mut rest) = (Self { ready: Vec::new(), ..self.clone() }, *numbers);
        for memory in &mut loaded.memories {
            memory.load(&mut rest)?;
        }
        let variables = rest.split_off(..loaded.variables.len())?;
        loaded.variables.copy_from_slice(variables);
        (*self, *numbers) = (loaded, rest);
        Some(())
    }
}

impl<'a> StateRef<'a> {
    /// Splits off the share of the next leaf, or what a series itself keeps.
    pub(super) fn take(&mut self, size: StateSize) -> StateRef<'a> {
        let (memories, other_memories) = self.memories.split_at(size.memories);
        let (variables, other_variables) = self.variables.split_at(size.variables);
        (self.memories, self.variables) = (other_memories, other_variables);
        StateRef { memories, variables, ready: &[] }
    }

    /// Splits off what the next series has worked out.
    pub(super) fn take_ready(&mut self) -> Option<&'a Ready> {
        self.ready.split_off_first()
    }

    /// Passes over the share of a part that holds so many series.
    pub(super) fn skip(&mut self, size: StateSize, series: usize) {
        self.take(size);
        self.ready = self.ready.get(series..).unwrap_or_default();
    }
}

impl<'a> StateMut<'a> {
    /// Splits off the share of the next leaf, or what a series itself keeps.
    pub(super) fn take(&mut self, size: StateSize) -> StateMut<'a> {
        let memories = self.memories.split_off_mut(..size.memories).expect("a state of this law");
        let variables = self.variables.split_off_mut(..size.variables).expect("a state of this law");
        StateMut { memories, variables, ready: &mut [] }
    }

    /// Splits off what the next series works out.
    pub(super) fn take_ready(&mut self) -> Option<&'a mut Ready> {
        self.ready.split_off_first_mut()
    }

    /// Passes over the share of parts that hold so many series.
    pub(super) fn skip(&mut self, size: StateSize, series: usize) {
        self.take(size);
        self.ready = std::mem::take(&mut self.ready).get_mut(series..).unwrap_or_default();
    }

    /// The same for a while.
    pub(super) fn reborrow(&mut self) -> StateMut<'_> {
        StateMut { memories: self.memories, variables: self.variables, ready: self.ready }
    }

    /// The same, to be looked at.
    pub(super) fn view(&self) -> StateRef<'_> {
        StateRef { memories: self.memories, variables: self.variables, ready: self.ready }
    }
}
