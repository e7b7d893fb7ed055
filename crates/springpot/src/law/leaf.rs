//! The leaves of every law: spring, dashpot, springpot, and a force that an input commands.

use super::{
    Derivative, InputValue, Law, Observation, Point, Power, Powers, Response, RuleError, Singular, Start, State, Step,
};
use crate::fractional::step::MAX_NODES;
use crate::fractional::{Form, KernelError, Memory, Nodes, RatePolynomial};

/// F = k·x. Stores ½k·x².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spring {
    /// Stiffness k ≥ 0, N/m.
    pub stiffness: f64,
}

/// F = c·x'. Dissipates c·x'².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dashpot {
    /// Viscosity c ≥ 0, N·s/m.
    pub viscosity: f64,
}

/// A coefficient that may follow an input: constant + slope·input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficient {
    /// Value where the input is 0.
    pub constant: f64,
    /// Change per unit of the input.
    pub slope: f64,
    /// Which input; `None`: constant.
    pub input: Option<usize>,
    /// The rule that keeps it from turning negative, as the message says it.
    pub rule: &'static str,
}

/// F = c·D^alpha x, c outside the derivative also when it varies.
///
/// At alpha = 0 a spring (on x, or on x − x(0) for Caputo), at alpha = 1 a dashpot. Stores c·ψ, dissipates c·P with ψ and P of
/// [`crate::fractional::Energy`]; a varying c exchanges ∫ c'ψ dt with its input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Springpot {
    /// Coefficient c ≥ 0, N·s^alpha/m.
    pub coefficient: Coefficient,
    /// Order, 0 ≤ alpha ≤ 1.
    pub alpha: f64,
    /// Which derivative.
    pub derivative: Derivative,
}

/// F = −gain·(input − reference): expansion by heat or voltage, turned into force by a stiffness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Force per unit of the input, N.
    pub gain: f64,
    /// Input without force.
    pub reference: f64,
    /// Which input.
    pub input: usize,
}

impl Coefficient {
    /// A coefficient that never changes.
    pub fn constant(value: f64) -> Self {
        Self { constant: value, slope: 0.0, input: None, rule: "c ≥ 0" }
    }

    /// Value and rate under the inputs.
    pub fn at(&self, inputs: &[InputValue]) -> InputValue {
        match self.input {
            None => InputValue { value: self.constant, rate: 0.0 },
            Some(i) => {
                InputValue { value: self.constant + self.slope * inputs[i].value, rate: self.slope * inputs[i].rate }
            }
        }
    }
}

impl Drive {
    fn force_at(&self, at: &Point) -> f64 {
        -self.gain * (at.inputs[self.input].value - self.reference)
    }
}

impl Law for Spring {
    fn respond(&self, step: &Step, _: &State) -> Response {
        let mut response = Response::default();
        for i in 0..step.nodes.count() {
            response.force[i] = self.stiffness * step.stroke[i + 1];
            response.d_stroke[i][i] = self.stiffness;
        }
        response
    }

    fn observe_start(&self, at: &Point, state: &State) -> Observation {
        Observation { derivative: at.stroke, force: self.force(at, at.stroke), stored: self.stored(at, state) }
    }

    fn stored(&self, at: &Point, _: &State) -> Option<f64> {
        Some(0.5 * self.stiffness * at.stroke * at.stroke)
    }

    fn order(&self) -> f64 {
        0.0
    }

    fn force(&self, at: &Point, _: f64) -> f64 {
        self.stiffness * at.stroke
    }
}

impl Law for Dashpot {
    fn respond(&self, step: &Step, _: &State) -> Response {
        let mut response = Response::default();
        for i in 0..step.nodes.count() {
            response.force[i] = self.viscosity * step.rate[i + 1];
            response.d_rate[i][i] = self.viscosity;
        }
        response
    }

    fn powers(&self, step: &Step, _: &State) -> Powers {
        let mut powers = Powers::default();
        for (power, rate) in powers.iter_mut().zip(step.rate) {
            power.dissipation = self.viscosity * rate * rate;
        }
        powers
    }

    fn observe_start(&self, at: &Point, _: &State) -> Observation {
        Observation { derivative: at.rate, force: self.force(at, at.rate), stored: Some(0.0) }
    }

    fn stored(&self, _: &Point, _: &State) -> Option<f64> {
        Some(0.0)
    }

    fn order(&self) -> f64 {
        1.0
    }

    fn force(&self, at: &Point, _: f64) -> f64 {
        self.viscosity * at.rate
    }
}

impl Springpot {
    fn memory(state: &State) -> &Memory {
        state.memory.as_ref().expect("begin made the memory")
    }

    fn polynomial(&self, step: &Step) -> RatePolynomial {
        match step.form {
            Form::Rates => RatePolynomial::through_rates(step.h, step.nodes, step.rate),
            Form::Strokes => RatePolynomial::through_strokes(step.h, step.nodes, step.stroke),
        }
    }
}

impl Law for Springpot {
    fn begin(&self, start: &Start) -> Result<State, KernelError> {
        let memory = Memory::new(
            self.alpha,
            self.derivative,
            start.stroke,
            start.jump,
            start.tolerance,
            start.delta,
            start.horizon,
        )?;
        Ok(State { memory: Some(memory), ..State::default() })
    }

    fn respond(&self, step: &Step, state: &State) -> Response {
        let memory = Self::memory(state);
        let start = step.start();
        let affine = memory.respond(&start, step.nodes, step.form);
        let moments = match step.singular {
            Singular::Moments if memory.is_singular() => memory.singular_moments(&start, step.nodes),
            _ => [0.0; MAX_NODES],
        };
        let mut response = Response::default();
        let count = step.nodes.count();
        for i in 0..count {
            let c = self.coefficient.at(step.point(i + 1).inputs).value;
            let mut derivative = affine.history[i];
            if memory.is_singular() {
                let value = memory.singular_part(step.t + step.nodes.positions()[i] * step.h);
                let share = if step.singular == Singular::Moments { moments[i] } else { value };
                derivative += share - value;
                response.singular[i] = c * share;
            }
            for j in 0..count {
                derivative += affine.stroke[i][j] * (step.stroke[j + 1] - step.stroke[0]);
                derivative += affine.rate[i][j] * step.rate[j + 1];
                response.d_stroke[i][j] = c * affine.stroke[i][j];
                response.d_rate[i][j] = c * affine.rate[i][j];
            }
            response.force[i] = c * derivative;
        }
        response
    }

    fn commit(&self, step: &Step, state: &mut State) {
        let polynomial = self.polynomial(step);
        let memory = state.memory.as_mut().expect("begin made the memory");
        match step.form {
            Form::Rates => memory.commit_rates(&polynomial, step.stroke[step.nodes.count()], step.resolution),
            Form::Strokes => memory.commit(&polynomial),
        }
    }

    fn defect(&self, step: &Step, state: &State) -> f64 {
        let last = step.nodes.count();
        Self::memory(state).defect(
            &self.polynomial(step),
            [step.stroke[0], step.stroke[last]],
            [step.rate[0], step.rate[last]],
            step.resolution,
        )
    }

    fn powers(&self, step: &Step, state: &State) -> Powers {
        let memory = Self::memory(state);
        let mut powers = Powers::default();
        let polynomial = self.polynomial(step);
        for (k, power) in powers.iter_mut().enumerate().take(step.nodes.count() + 1) {
            let at = step.point(k);
            if memory.is_singular() {
                // The stored energy is infinite, and what a varying coefficient makes of it is unknown.
                power.input = if self.coefficient.at(at.inputs).rate == 0.0 { 0.0 } else { f64::NAN };
                continue;
            }
            let energy = match k {
                0 => memory.energy(&polynomial, 0.0, at.stroke, at.rate),
                _ => memory.energy(&polynomial, step.nodes.positions()[k - 1], at.stroke, at.rate),
            };
            let c = self.coefficient.at(at.inputs);
            *power = Power { dissipation: c.value * energy.dissipation, input: c.rate * energy.stored };
        }
        powers
    }

    fn observe(&self, step: &Step, theta: f64, at: &Point, state: &State) -> Observation {
        let memory = Self::memory(state);
        let polynomial = self.polynomial(step);
        let start = step.start();
        let derivative = if step.form == Form::Rates && step.nodes == Nodes::Radau && theta < 1.0 {
            memory.derivative_between(&start, &polynomial, theta, at.stroke, at.rate)
        } else {
            memory.derivative(&start, &polynomial, theta, at.stroke, at.rate)
        };
        let stored = (!memory.is_singular()).then(|| {
            self.coefficient.at(at.inputs).value * memory.energy(&polynomial, theta, at.stroke, at.rate).stored
        });
        Observation { derivative, force: self.force(at, derivative), stored }
    }

    fn observe_start(&self, at: &Point, state: &State) -> Observation {
        let memory = Self::memory(state);
        if memory.is_singular() {
            return Observation { derivative: f64::NAN, force: f64::NAN, stored: None };
        }
        let derivative = match self.alpha {
            1.0 => at.rate,
            0.0 if self.derivative == Derivative::RiemannLiouville => at.stroke,
            _ => 0.0,
        };
        Observation { derivative, force: self.force(at, derivative), stored: self.stored(at, state) }
    }

    fn stored(&self, at: &Point, state: &State) -> Option<f64> {
        let memory = Self::memory(state);
        let c = self.coefficient.at(at.inputs).value;
        (!memory.is_singular()).then(|| c * memory.stored(at.stroke, at.rate))
    }

    fn order(&self) -> f64 {
        self.alpha
    }

    fn singular(&self, t: f64, state: &State) -> f64 {
        Self::memory(state).singular_part(t)
    }

    fn check_inputs(&self, inputs: &[InputValue]) -> Result<(), RuleError> {
        let c = self.coefficient.at(inputs).value;
        if c >= 0.0 {
            return Ok(());
        }
        let rule = format!("{} is broken: the coefficient of D^alpha x is {c}", self.coefficient.rule);
        Err(RuleError { rule, parameter: "mu" })
    }

    fn force(&self, at: &Point, derivative: f64) -> f64 {
        self.coefficient.at(at.inputs).value * derivative
    }
}

impl Law for Drive {
    fn respond(&self, step: &Step, _: &State) -> Response {
        let mut response = Response::default();
        for i in 0..step.nodes.count() {
            response.force[i] = self.force_at(&step.point(i + 1));
        }
        response
    }

    fn powers(&self, step: &Step, _: &State) -> Powers {
        let mut powers = Powers::default();
        for (k, power) in powers.iter_mut().enumerate().take(step.nodes.count() + 1) {
            let at = step.point(k);
            power.input = -self.force_at(&at) * at.rate;
        }
        powers
    }

    fn observe_start(&self, at: &Point, _: &State) -> Observation {
        Observation { derivative: 0.0, force: self.force_at(at), stored: Some(0.0) }
    }

    fn stored(&self, _: &Point, _: &State) -> Option<f64> {
        Some(0.0)
    }

    fn order(&self) -> f64 {
        0.0
    }

    fn force(&self, at: &Point, _: f64) -> f64 {
        self.force_at(at)
    }
}
