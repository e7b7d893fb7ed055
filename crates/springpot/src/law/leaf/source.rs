//! A force that an input commands.

use super::contract::Leaf;
use crate::collocation::MAX_NODES;
use crate::law::state::StateRef;
use crate::law::step::{Observation, Point, Powers, Response, Step, Term};
use crate::law::tangent::LeafAtRest;

/// F = −gain·(input − reference): expansion by heat or voltage, turned into force by a stiffness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Source {
    /// Force per unit of the input, N.
    pub gain: f64,
    /// Input without force.
    pub reference: f64,
    /// Which input.
    pub input: usize,
}

impl Source {
    fn force(&self, at: &Point) -> f64 {
        -self.gain * (at.inputs[self.input].value - self.reference)
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
            (0..step.nodes.count()).for_each(|i| slopes[i][i] -= self.gain);
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

    fn linearised(&self, _: &Point) -> Term {
        Term { coefficient: 0.0, order: 0.0 }
    }

    fn at_rest(&self, at: &Point, _: f64) -> LeafAtRest {
        let input = Some((self.input, -self.gain));
        LeafAtRest { force: self.force(at), stiffness: None, term: self.linearised(at), input, damping: 0.0 }
    }

    fn is_linear(&self) -> bool {
        true
    }
}
