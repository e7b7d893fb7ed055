//! A force that an input commands.

use super::contract::{Leaf, When};
use crate::collocation::MAX_NODES;
use crate::dual::Dual;
use crate::law::state::StateRef;
use crate::law::step::{Observation, Point, Powers, Response, Step, Term};
use crate::law::tangent::{AtRest, Tangent};
use crate::law::variation::{ObservationVariation, PointVariation, PowersVariation, StepVariation, VariationRef, add};

/// F = −gain·(input − reference): expansion by heat or voltage, turned into force by a stiffness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Source {
    /// Force per unit of the input, N.
    pub gain: Dual,
    /// Input without force.
    pub reference: Dual,
    /// Which input.
    pub input: usize,
}

impl Source {
    fn force(&self, at: &Point) -> f64 {
        -self.gain.value * (at.inputs[self.input].value - self.reference.value)
    }
}

impl Source {
    /// Adds what changes of its force.
    fn add_change(&self, at: &Point, input: Option<&[f64]>, own: VariationRef, force: &mut [f64]) {
        add(force, self.reference.value - at.inputs[self.input].value, own.number(0));
        add(force, self.gain.value, own.number(1));
        input.into_iter().for_each(|input| add(force, -self.gain.value, input));
    }
}

impl Leaf for Source {
    fn name(&self) -> &'static str {
        "source"
    }

    fn evaluate(&self, step: &Step, _: StateRef, response: &mut Response) {
        for i in 0..step.nodes.count() {
            response.force[i] += self.force(&step.point(i + 1));
        }
    }

    fn by_input(&self, step: &Step, _: StateRef, input: usize, slopes: &mut [[f64; MAX_NODES]; MAX_NODES]) {
        if input == self.input {
            (0..step.nodes.count()).for_each(|i| slopes[i][i] -= self.gain.value);
        }
    }

    fn powers(&self, step: &Step, _: StateRef, powers: &mut Powers) {
        for (k, power) in powers.iter_mut().enumerate().take(step.nodes.count() + 1) {
            let at = step.point(k);
            power.input -= self.force(&at) * at.rate;
        }
    }

    fn now(&self, at: &Point, _: StateRef) -> Observation {
        Observation { derivative: at.stroke, regular: self.force(at), singular: 0.0, stored: Some(0.0) }
    }

    fn numbers(&self, take: &mut dyn FnMut(Dual)) -> bool {
        [self.gain, self.reference].into_iter().for_each(take);
        true
    }

    fn vary(&self, step: &Step, _: StateRef, told: &StepVariation, own: VariationRef, forces: &mut [f64]) {
        for (i, forces) in forces.chunks_exact_mut(own.count).enumerate() {
            let at = step.point(i + 1);
            let input = told.input_at(i + 1, self.input, at.inputs.len()).map(|[value, _]| value);
            self.add_change(&at, input, own, forces);
        }
    }

    fn vary_powers(
        &self,
        step: &Step,
        _: StateRef,
        told: &StepVariation,
        own: VariationRef,
        sum: &mut PowersVariation,
    ) {
        let mut change = vec![0.0; own.count];
        for (k, power) in sum.input.chunks_exact_mut(own.count).enumerate().take(step.nodes.count() + 1) {
            let at = step.point(k);
            let input = told.input_at(k, self.input, at.inputs.len()).map(|[value, _]| value);
            change.fill(0.0);
            self.add_change(&at, input, own, &mut change);
            add(power, -at.rate, &change);
            add(power, -self.force(&at), told.rate_at(k));
        }
    }

    fn vary_at(
        &self,
        _: When,
        at: &Point,
        _: StateRef,
        told: &PointVariation,
        own: VariationRef,
        sum: &mut ObservationVariation,
    ) {
        self.add_change(at, told.input(self.input, own.count).map(|[value, _]| value), own, sum.force);
    }

    fn linearised(&self, _: &Point) -> Term {
        Term { coefficient: 0.0, order: 0.0 }
    }

    fn linearised_slope(&self, _: &Point<Dual>) -> Option<Term> {
        Some(Term { coefficient: 0.0, order: 0.0 })
    }

    fn at_rest(&self, at: &Point, _: f64) -> AtRest {
        let tangent = Tangent::Leaf(self.linearised(at), Some((self.input, -self.gain.value)));
        AtRest { force: self.force(at), stiffness: None, tangent }
    }

    fn is_linear(&self) -> bool {
        true
    }
}
