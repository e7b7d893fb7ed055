//! Smooth friction.

use super::columns::{ByColumns, Columns, add_dissipation};
use super::contract::{Clock, Holds, Leaf, Slide};
use super::kind::{LeafBuild, LeafKind};
use super::springpot::Coefficient;
use crate::collocation::MAX_NODES;
use crate::dual::{Dual, Real};
use crate::law::catalog::{Param, Range};
use crate::law::rule::RuleError;
use crate::law::state::StateRef;
use crate::law::step::{InputValue, Observation, Point, Power, Powers, Response, Step, Term};
use std::sync::Arc;

/// F = f·tanh(x'/v0). Dissipates F·x'; creeps where it should stick, at rates of the order of v0. f may follow an input.
#[derive(Debug, Clone, PartialEq)]
pub struct Friction {
    /// Force at speed f ≥ 0, N.
    pub force: Coefficient,
    /// Rate v0 > 0 about which it turns over, m/s.
    pub rate: Dual,
}

impl Friction {
    /// Friction whose parameters keep its rules.
    ///
    /// # Errors
    /// [`RuleError`]: f ≥ 0, v0 > 0.
    pub fn new(force: impl Into<Dual>, rate: impl Into<Dual>) -> Result<Self, RuleError> {
        let (force, rate) = (force.into(), rate.into());
        RuleError::unless(force.value >= 0.0, "f ≥ 0", "f")?;
        RuleError::unless(rate.value > 0.0, "v0 > 0", "v0")?;
        Ok(Self { force: Coefficient::constant(force), rate })
    }

    fn at<T: Real>(&self, at: &Point<T>) -> T {
        self.force.at(at.inputs).value * (at.rate / T::of(self.rate)).tanh()
    }

    fn slope(&self, at: &Point) -> f64 {
        let turns = self.rate.value;
        self.force.at(at.inputs).value / turns * (at.rate / turns).cosh().powi(-2)
    }
}

impl Leaf for Friction {
    fn name(&self) -> &'static str {
        "friction"
    }

    fn evaluate(&self, step: &Step, _: StateRef, response: &mut Response) {
        for i in 0..step.nodes.count() {
            let at = step.point(i + 1);
            response.force[i] += self.at(&at);
            response.d_rate[i][i] += self.slope(&at);
        }
    }

    fn by_input(&self, step: &Step, _: StateRef, input: usize, slopes: &mut [[f64; MAX_NODES]; MAX_NODES]) {
        if self.force.input == Some(input) {
            let turned = |i: usize| (step.rate[i + 1] / self.rate.value).tanh();
            (0..step.nodes.count()).for_each(|i| slopes[i][i] += self.force.slope.value * turned(i));
        }
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
        Term { coefficient: self.slope(at), order: 1.0 }
    }

    fn clock(&self) -> Clock {
        Clock::Wall
    }

    fn holds(&self) -> Holds {
        // Above some 20·v0 its force is f to the last bit, whatever the rate.
        if self.force.is_none() { Holds::Never } else { Holds::LetsGo }
    }

    fn slides(&self, inputs: &[InputValue]) -> Option<Slide> {
        (!self.force.is_none()).then(|| Slide { force: self.force.at(inputs).value, rate: self.rate.value })
    }

    fn check_inputs(&self, inputs: &[InputValue]) -> Result<(), RuleError> {
        self.force.check(inputs, "the coefficient of tanh(x'/v0)")
    }
}

impl Columns for Friction {
    type Solved<T: Real> = ();

    fn each_number(&mut self, take: &mut dyn FnMut(&mut Dual)) {
        self.force.numbers().into_iter().chain([&mut self.rate]).for_each(take);
    }

    fn solved(&self, _: &Step, _: &[f64]) {}

    fn follow(&self, _: &Step<Dual>, _: &[Dual], (): &()) {}

    fn force<T: Real>(&self, step: &Step<T>, (): &(), k: usize) -> T {
        self.at(&step.point(k))
    }

    fn power<T: Real>(&self, step: &Step<T>, _: &[T], (): &(), k: usize) -> Power<T> {
        Power { dissipation: self.at(&step.point(k)) * step.rate[k], input: 0.0.into() }
    }

    fn between<T: Real>(&self, at: &Point<T>, _: &[T]) -> Observation<T> {
        Observation { derivative: at.rate, regular: self.at(at), singular: 0.0.into(), stored: Some(0.0.into()) }
    }
}

/// What networks know of it.
pub(super) fn kind() -> LeafKind {
    let positive = Range { low: f64::MIN_POSITIVE, high: f64::MAX };
    LeafKind {
        name: "friction",
        equation: "F = f·tanh(x'/v0)",
        params: vec![
            Param::new("f", "N", "friction force", Range::NOT_NEGATIVE),
            Param::new("v0", "m/s", "rate about which it turns over", positive),
        ],
        build: LeafBuild::Values(|values, _| Ok(Arc::new(Friction::new(values[0], values[1])?))),
    }
}
