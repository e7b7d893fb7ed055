//! The linear dashpot.

use super::contract::{Leaf, When};
use super::kind::{LeafBuild, LeafKind};
use crate::dual::Dual;
use crate::law::catalog::{Param, Range};
use crate::law::state::StateRef;
use crate::law::step::{LocalError, Observation, Point, Powers, Response, Step, Term};
use crate::law::variation::{ObservationVariation, PointVariation, PowersVariation, StepVariation, VariationRef, add};
use std::sync::Arc;

/// F = c·x'. Dissipates c·x'².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dashpot {
    /// Viscosity c ≥ 0, N·s/m.
    pub viscosity: Dual,
}

impl Leaf for Dashpot {
    fn name(&self) -> &'static str {
        "dashpot"
    }

    fn evaluate(&self, step: &Step, _: StateRef, response: &mut Response) {
        for i in 0..step.nodes.count() {
            response.force[i] += self.viscosity.value * step.rate[i + 1];
            response.d_rate[i][i] += self.viscosity.value;
        }
    }

    fn local_errors(&self, step: &Step, _: StateRef, errors: &mut Vec<LocalError>) {
        errors.push(LocalError::told(step.rate[step.nodes.count()]));
    }

    fn powers(&self, step: &Step, _: StateRef, powers: &mut Powers) {
        for (power, rate) in powers.iter_mut().zip(step.rate) {
            power.dissipation += self.viscosity.value * rate * rate;
        }
    }

    fn now(&self, at: &Point, _: StateRef) -> Observation {
        Observation { derivative: at.rate, regular: self.viscosity.value * at.rate, singular: 0.0, stored: Some(0.0) }
    }

    fn numbers(&self, take: &mut dyn FnMut(Dual)) -> bool {
        take(self.viscosity);
        true
    }

    fn vary(&self, step: &Step, _: StateRef, _: &StepVariation, own: VariationRef, forces: &mut [f64]) {
        for (i, forces) in forces.chunks_exact_mut(own.count).enumerate() {
            add(forces, step.rate[i + 1], own.number(0));
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
        for (k, power) in sum.dissipation.chunks_exact_mut(own.count).enumerate().take(step.nodes.count() + 1) {
            let rate = step.rate[k];
            add(power, rate * rate, own.number(0));
            add(power, 2.0 * self.viscosity.value * rate, told.rate_at(k));
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
        add(sum.force, at.rate, own.number(0));
        add(sum.force, self.viscosity.value, told.rate);
    }

    fn linearised(&self, _: &Point) -> Term {
        Term { coefficient: self.viscosity.value, order: 1.0 }
    }

    fn linearised_slope(&self, _: &Point<Dual>) -> Option<Term> {
        Some(Term { coefficient: self.viscosity.slope, order: 0.0 })
    }

    fn is_linear(&self) -> bool {
        true
    }
}

/// What networks know of it.
pub(super) fn kind() -> LeafKind {
    LeafKind {
        name: "dashpot",
        equation: "F = c·x'",
        params: vec![Param::new("c", "N*s/m", "viscosity", Range::NOT_NEGATIVE)],
        build: LeafBuild::Values(|values, _| Ok(Arc::new(Dashpot { viscosity: values[0] }))),
    }
}
