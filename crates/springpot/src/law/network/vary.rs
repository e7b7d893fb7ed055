//! What every part of a network says of its derivatives by parameters.

use super::part::Part;
use super::{LeafPart, Network};
use crate::dual::Dual;
use crate::fractional::{KernelError, MemoryTangent};
use crate::law::leaf::When;
use crate::law::past::{Recalled, RecalledVariation, recall_variation as recall};
use crate::law::state::StateRef;
use crate::law::step::{Point, Response, Step};
use crate::law::variation::{
    ObservationVariation, PointVariation, PowersVariation, StepVariation, TakeError, VariationMut, VariationRef, add,
};

/// A part whose derivatives can be asked for.
///
/// As of [`Part`]: what is provided is the answer of parts side by side, and each part takes its own share of state and changes from the front.
pub(in crate::law) trait Vary: Part {
    /// Hands over the numbers of its own and of its parts, in their order, with their derivatives where it was built of such.
    fn numbers(&self, take: &mut dyn FnMut(Dual)) {
        self.parts().iter().for_each(|part| part.ask().numbers(take));
    }

    /// How many numbers it hands over.
    fn number_count(&self) -> usize {
        let mut count = 0;
        self.numbers(&mut |_| count += 1);
        count
    }

    /// The part of it of which no derivative is known ([`crate::law::Leaf::numbers`]), as it is called.
    fn without_derivatives(&self) -> Option<String> {
        self.parts().iter().find_map(|part| part.ask().without_derivatives())
    }

    /// Appends what changes of its memories at t = 0 ([`crate::law::Leaf::begin_memories`]).
    fn begin_memories(
        &self,
        state: &mut StateRef,
        own: &mut VariationRef,
        memories: &mut Vec<MemoryTangent>,
    ) -> Result<(), KernelError> {
        state.take(self.own_size());
        own.take(0, self.own_size());
        self.parts().iter().try_for_each(|part| part.ask().begin_memories(state, own, memories))
    }

    /// Puts what changes of its state at t = 0 ([`crate::law::Leaf::begin_variation`]).
    fn begin_variation(&self, at: &Point, state: &mut StateRef, told: &PointVariation, own: &mut VariationMut) {
        self.parts().iter().for_each(|part| part.ask().begin_variation(at, state, told, own));
    }

    /// Puts what changes of a stroke before t = 0 into what changes of its state, which recalls that stroke ([`Part::recall`]); `laws` is it as each
    /// parameter has it.
    ///
    /// # Errors
    /// What no derivative is known of.
    fn recall_variation(
        &self,
        stroke: (&Recalled, &RecalledVariation),
        at: (&Point, &PointVariation),
        laws: &[&Network],
        state: &mut StateRef,
        own: &mut VariationMut,
    ) -> Result<(), String> {
        self.parts().iter().enumerate().try_for_each(|(k, part)| {
            let laws: Vec<&Network> = laws.iter().map(|law| &law.parts()[k]).collect();
            part.ask().recall_variation(stroke, at, &laws, state, own)
        })
    }

    /// [`Part::evaluate`] with tangents that are exact where iterations take others ([`Self::slips_inside`]).
    fn evaluate_exactly(&self, step: &Step, state: &mut StateRef, response: &mut Response) {
        self.parts().iter().for_each(|part| part.ask().evaluate_exactly(step, state, response));
    }

    /// Whether there are such: springs that slip behind what is no spring.
    fn slips_inside(&self) -> bool {
        self.parts().iter().any(|part| part.ask().slips_inside())
    }

    /// Appends how fast its inner variables change ([`crate::law::Leaf::rates`]).
    fn rates(&self, at: &Point, state: &mut StateRef, rates: &mut Vec<f64>) -> bool {
        self.parts().iter().all(|part| part.ask().rates(at, state, rates))
    }

    /// Adds what changes of its forces at the nodes ([`crate::law::Leaf::vary`]).
    fn vary(
        &self,
        step: &Step,
        state: &mut StateRef,
        told: &StepVariation,
        own: &mut VariationRef,
        forces: &mut [f64],
    ) {
        self.parts().iter().for_each(|part| part.ask().vary(step, state, told, own, forces));
    }

    /// Takes what changes of an accepted step into what changes of its state.
    fn commit_variation(&self, step: &Step, state: &mut StateRef, told: &StepVariation, own: &mut VariationMut) {
        self.parts().iter().for_each(|part| part.ask().commit_variation(step, state, told, own));
    }

    /// Hands over how well the step knows what changes of the inner variables of its leaves ([`crate::law::Leaf::vary_errors`]); the number of a
    /// variable counts from the last one of the law.
    fn vary_errors(
        &self,
        step: &Step,
        state: &mut StateRef,
        told: &StepVariation,
        own: &mut VariationRef,
        take: TakeError,
    ) {
        self.parts().iter().for_each(|part| part.ask().vary_errors(step, state, told, own, take));
    }

    /// Passes over its share of a state, and of what changes of it.
    fn pass_by(&self, state: &mut StateRef, own: &mut VariationRef) {
        own.take(self.number_count(), self.size());
        self.pass(state);
    }

    /// Adds what changes of its energy flows at the start and at the nodes ([`crate::law::Leaf::vary_powers`]).
    fn vary_powers(
        &self,
        step: &Step,
        state: &mut StateRef,
        told: &StepVariation,
        own: &mut VariationRef,
        sum: &mut PowersVariation,
    ) {
        self.parts().iter().for_each(|part| part.ask().vary_powers(step, state, told, own, sum));
    }

    /// Adds what changes of its singular forces at the nodes ([`crate::law::Leaf::vary_singular`]).
    fn vary_singular(
        &self,
        step: &Step,
        state: &mut StateRef,
        told: &StepVariation,
        own: &mut VariationRef,
        forces: &mut [f64],
    ) {
        self.parts().iter().for_each(|part| part.ask().vary_singular(step, state, told, own, forces));
    }

    /// Adds what changes of its singular forces and of their integrals ([`crate::law::Leaf::vary_singularity`]).
    fn vary_singularity(
        &self,
        (from, at): (f64, &Point),
        state: &mut StateRef,
        told: &PointVariation,
        own: &mut VariationRef,
        sums: [&mut [f64]; 3],
    ) {
        let [value, once, twice] = sums;
        for part in self.parts() {
            part.ask().vary_singularity((from, at), state, told, own, [&mut *value, &mut *once, &mut *twice]);
        }
    }

    /// Adds what changes of it at one time.
    fn vary_at(
        &self,
        (when, at): (When, &Point),
        state: &mut StateRef,
        told: &PointVariation,
        own: &mut VariationRef,
        sum: &mut ObservationVariation,
    ) {
        self.parts().iter().for_each(|part| part.ask().vary_at((when, at), state, told, own, sum));
    }
}

/// Parts side by side.
impl Vary for Vec<Network> {}

impl Vary for LeafPart {
    fn numbers(&self, take: &mut dyn FnMut(Dual)) {
        self.leaf.numbers(take);
    }

    fn without_derivatives(&self) -> Option<String> {
        let known = self.leaf.numbers(&mut |_| {});
        (!known).then(|| self.name.as_ref().map_or(self.leaf.name(), |name| name).to_owned())
    }

    fn begin_memories(
        &self,
        state: &mut StateRef,
        own: &mut VariationRef,
        memories: &mut Vec<MemoryTangent>,
    ) -> Result<(), KernelError> {
        let size = self.leaf.size();
        self.leaf.begin_memories(state.take(size), own.take(self.number_count(), size), memories)
    }

    fn begin_variation(&self, at: &Point, state: &mut StateRef, told: &PointVariation, own: &mut VariationMut) {
        let size = self.leaf.size();
        self.leaf.begin_variation(at, state.take(size), told, own.take(self.number_count(), size));
    }

    fn recall_variation(
        &self,
        (stroke, changes): (&Recalled, &RecalledVariation),
        _: (&Point, &PointVariation),
        _: &[&Network],
        state: &mut StateRef,
        own: &mut VariationMut,
    ) -> Result<(), String> {
        let size = self.leaf.size();
        let (state, own) = (state.take(size), own.take(self.number_count(), size));
        for (memory, tangent) in state.memories.iter().zip(&mut *own.memories) {
            recall(memory, tangent, stroke, changes);
        }
        if size.variables > 0 {
            self.leaf.recall_variation([&stroke.turns(), &changes.turns(stroke)], own);
        }
        Ok(())
    }

    fn evaluate_exactly(&self, step: &Step, state: &mut StateRef, response: &mut Response) {
        self.evaluate(step, state, response);
    }

    fn rates(&self, at: &Point, state: &mut StateRef, rates: &mut Vec<f64>) -> bool {
        self.leaf.rates(at, state.take(self.leaf.size()), rates)
    }

    fn vary(
        &self,
        step: &Step,
        state: &mut StateRef,
        told: &StepVariation,
        own: &mut VariationRef,
        forces: &mut [f64],
    ) {
        let size = self.leaf.size();
        self.leaf.vary(step, state.take(size), told, own.take(self.number_count(), size), forces);
    }

    fn commit_variation(&self, step: &Step, state: &mut StateRef, told: &StepVariation, own: &mut VariationMut) {
        let size = self.leaf.size();
        self.leaf.commit_variation(step, state.take(size), told, own.take(self.number_count(), size));
    }

    fn vary_errors(
        &self,
        step: &Step,
        state: &mut StateRef,
        told: &StepVariation,
        own: &mut VariationRef,
        take: TakeError,
    ) {
        let (size, behind) = (self.leaf.size(), own.variables.len() / own.count.max(1));
        let own = own.take(self.number_count(), size);
        self.leaf.vary_errors(step, state.take(size), told, own, &mut |k, error| take(behind - k, error));
    }

    fn vary_powers(
        &self,
        step: &Step,
        state: &mut StateRef,
        told: &StepVariation,
        own: &mut VariationRef,
        sum: &mut PowersVariation,
    ) {
        let size = self.leaf.size();
        self.leaf.vary_powers(step, state.take(size), told, own.take(self.number_count(), size), sum);
    }

    fn vary_singular(
        &self,
        step: &Step,
        state: &mut StateRef,
        told: &StepVariation,
        own: &mut VariationRef,
        forces: &mut [f64],
    ) {
        let size = self.leaf.size();
        self.leaf.vary_singular(step, state.take(size), told, own.take(self.number_count(), size), forces);
    }

    fn vary_singularity(
        &self,
        (from, at): (f64, &Point),
        state: &mut StateRef,
        told: &PointVariation,
        own: &mut VariationRef,
        sums: [&mut [f64]; 3],
    ) {
        let size = self.leaf.size();
        self.leaf.vary_singularity(from, at, state.take(size), told, own.take(self.number_count(), size), sums);
    }

    fn vary_at(
        &self,
        (when, at): (When, &Point),
        state: &mut StateRef,
        told: &PointVariation,
        own: &mut VariationRef,
        sum: &mut ObservationVariation,
    ) {
        let size = self.leaf.size();
        let (own_state, share) = (state.take(size), own.take(self.number_count(), size));
        let Some(leaves) = &mut sum.leaves else {
            return self.leaf.vary_at(when, at, own_state, told, share, sum);
        };
        let count = share.count;
        let [mut force, mut derivative] = [(); 2].map(|()| vec![0.0; count]);
        let mut alone = ObservationVariation {
            force: &mut force,
            stored: &mut *sum.stored,
            derivative: &mut derivative,
            told: &mut *sum.told,
            leaves: None,
        };
        self.leaf.vary_at(when, at, own_state, told, share, &mut alone);
        add(sum.force, 1.0, &force);
        add(sum.derivative, 1.0, &derivative);
        let told_as = match (size.memories, self.leaf.linearised(at).order) {
            (0, 1.0) => told.rate,
            (0, _) => told.stroke,
            _ => &derivative,
        };
        [told.stroke, told.rate, &force, told_as].into_iter().for_each(|block| leaves.extend_from_slice(block));
    }
}
