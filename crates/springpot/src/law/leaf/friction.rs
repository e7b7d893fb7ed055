//! Smooth friction.

use super::contract::{Leaf, Slide};
use super::kind::{LeafBuild, LeafKind};
use super::springpot::Coefficient;
use crate::collocation::MAX_NODES;
use crate::law::catalog::{Param, Range};
use crate::law::network::{Holds, Network};
use crate::law::rule::RuleError;
use crate::law::state::StateRef;
use crate::law::step::{InputValue, Observation, Point, Powers, Response, Step, Term};

/// F = f·tanh(x'/v0). Dissipates F·x'; creeps where it should stick, at rates of the order of v0. f may follow an input.
#[derive(Debug, Clone, PartialEq)]
pub struct Friction {
    /// Force at speed f ≥ 0, N.
    pub force: Coefficient,
    /// Rate v0 > 0 about which it turns over, m/s.
    pub rate: f64,
}

impl Friction {
    /// Friction whose parameters keep its rules.
    ///
    /// # Errors
    /// [`RuleError`]: f ≥ 0, v0 > 0.
    pub fn new(force: f64, rate: f64) -> Result<Self, RuleError> {
        RuleError::unless(force >= 0.0, "f ≥ 0", "f")?;
        RuleError::unless(rate > 0.0, "v0 > 0", "v0")?;
        Ok(Self { force: Coefficient::constant(force), rate })
    }

    fn at(&self, at: &Point) -> f64 {
        self.force.at(at.inputs).value * (at.rate / self.rate).tanh()
    }

    fn slope(&self, at: &Point) -> f64 {
        self.force.at(at.inputs).value / self.rate * (at.rate / self.rate).cosh().powi(-2)
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
            let turned = |i: usize| (step.rate[i + 1] / self.rate).tanh();
            (0..step.nodes.count()).for_each(|i| slopes[i][i] += self.force.slope.value * turned(i));
        }
    }

    fn powers(&self, step: &Step, _: StateRef, powers: &mut Powers) {
        for (k, power) in powers.iter_mut().enumerate().take(step.nodes.count() + 1) {
            let at = step.point(k);
            power.dissipation += self.at(&at) * at.rate;
        }
    }

    fn now(&self, at: &Point, _: StateRef) -> Observation {
        Observation { derivative: at.rate, regular: self.at(at), singular: 0.0, stored: Some(0.0) }
    }

    fn linearised(&self, at: &Point) -> Term {
        Term { coefficient: self.slope(at), order: 1.0 }
    }

    fn keeps_the_wall_clock(&self) -> bool {
        true
    }

    fn holds(&self) -> Holds {
        // Above some 20·v0 its force is f to the last bit, whatever the rate.
        if self.force.is_none() { Holds::Never } else { Holds::LetsGo }
    }

    fn slides(&self, inputs: &[InputValue]) -> Option<Slide> {
        (!self.force.is_none()).then(|| Slide { force: self.force.at(inputs).value, rate: self.rate })
    }

    fn check_inputs(&self, inputs: &[InputValue]) -> Result<(), RuleError> {
        self.force.check(inputs, "the coefficient of tanh(x'/v0)")
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
        build: LeafBuild::Values(|values, _| Ok(Network::leaf(Friction::new(values[0].value, values[1].value)?))),
    }
}
