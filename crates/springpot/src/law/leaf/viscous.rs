//! A dashpot whose viscosity follows an input.

use super::columns::{ByColumns, Columns, add_dissipation};
use super::contract::{Holds, Leaf};
use super::springpot::Coefficient;
use crate::collocation::MAX_NODES;
use crate::dual::{Dual, Real};
use crate::law::rule::RuleError;
use crate::law::state::StateRef;
use crate::law::step::{InputValue, LocalError, Observation, Point, Power, Powers, Response, Step, Term};

/// F = c·x', c following an input. Dissipates c·x'².
#[derive(Debug, Clone, PartialEq)]
pub struct Viscous {
    /// Viscosity c ≥ 0, N·s/m.
    pub viscosity: Coefficient,
}

impl Leaf for Viscous {
    fn name(&self) -> &'static str {
        "dashpot"
    }

    fn evaluate(&self, step: &Step, _: StateRef, response: &mut Response) {
        for i in 0..step.nodes.count() {
            let c = self.viscosity.at(step.point(i + 1).inputs).value;
            response.force[i] += c * step.rate[i + 1];
            response.d_rate[i][i] += c;
        }
    }

    fn by_input(&self, step: &Step, _: StateRef, input: usize, slopes: &mut [[f64; MAX_NODES]; MAX_NODES]) {
        if self.viscosity.input == Some(input) {
            (0..step.nodes.count()).for_each(|i| slopes[i][i] += self.viscosity.slope.value * step.rate[i + 1]);
        }
    }

    fn local_errors(&self, step: &Step, _: StateRef, errors: &mut Vec<LocalError>) {
        errors.push(LocalError::told(step.rate[step.nodes.count()]));
    }

    fn powers(&self, step: &Step, _: StateRef, powers: &mut Powers) {
        add_dissipation(self, step, powers);
    }

    fn now(&self, at: &Point, _: StateRef) -> Observation {
        self.between(at, &[])
    }

    fn by_columns(&self) -> Option<&dyn ByColumns> {
        Some(self)
    }

    fn linearised(&self, at: &Point) -> Term {
        Term { coefficient: self.viscosity.at(at.inputs).value, order: 1.0 }
    }

    fn linearised_slope(&self, at: &Point<Dual>) -> Option<Term> {
        Some(Term { coefficient: self.viscosity.at(at.inputs).value.slope, order: 0.0 })
    }

    fn holds(&self) -> Holds {
        if self.viscosity.is_none() { Holds::Never } else { Holds::Always }
    }

    fn is_linear(&self) -> bool {
        true
    }

    fn check_inputs(&self, inputs: &[InputValue]) -> Result<(), RuleError> {
        self.viscosity.check(inputs, "the coefficient of x'")
    }
}

impl Columns for Viscous {
    type Solved<T: Real> = ();

    fn each_number(&mut self, take: &mut dyn FnMut(&mut Dual)) {
        self.viscosity.numbers().into_iter().for_each(take);
    }

    fn solved(&self, _: &Step, _: &[f64]) {}

    fn follow(&self, _: &Step<Dual>, _: &[Dual], (): &()) {}

    fn force<T: Real>(&self, step: &Step<T>, (): &(), k: usize) -> T {
        self.between(&step.point(k), &[]).regular
    }

    fn power<T: Real>(&self, step: &Step<T>, _: &[T], (): &(), k: usize) -> Power<T> {
        let c = self.viscosity.at(step.inputs_at(k)).value;
        Power { dissipation: c * step.rate[k] * step.rate[k], input: 0.0.into() }
    }

    fn between<T: Real>(&self, at: &Point<T>, _: &[T]) -> Observation<T> {
        let force = self.viscosity.at(at.inputs).value * at.rate;
        Observation { derivative: at.rate, regular: force, singular: 0.0.into(), stored: Some(0.0.into()) }
    }
}
