//! Laws side by side: one stroke, forces add.

use super::leaf::{Coefficient, Dashpot, Drive, Spring, Springpot};
use super::{Derivative, InputValue, Law, Observation, Point, Powers, Response, RuleError, Start, State, Step};
use crate::fractional::KernelError;
use std::sync::Arc;

/// F = Σ_m F_m of parts that share the stroke.
///
/// The derivative it reports is that of its springpot or dashpot, whichever was added first; without one it is the stroke.
#[derive(Debug, Clone, Default)]
pub struct Parallel {
    parts: Vec<Arc<dyn Law>>,
    reported: Option<usize>,
}

impl Parallel {
    /// No parts: no force.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds any law as a part.
    pub fn with(mut self, part: Arc<dyn Law>) -> Self {
        self.parts.push(part);
        self
    }

    /// Adds k·x.
    pub fn spring(self, stiffness: f64) -> Self {
        self.with(Arc::new(Spring { stiffness }))
    }

    /// Adds c·x'.
    pub fn dashpot(self, viscosity: f64) -> Self {
        self.reporting().with(Arc::new(Dashpot { viscosity }))
    }

    /// Adds c·D^alpha x.
    pub fn springpot(self, coefficient: Coefficient, alpha: f64, derivative: Derivative) -> Self {
        self.reporting().with(Arc::new(Springpot { coefficient, alpha, derivative }))
    }

    /// Adds −gain·(input − reference).
    pub fn drive(self, gain: f64, reference: f64, input: usize) -> Self {
        self.with(Arc::new(Drive { gain, reference, input }))
    }

    /// The next part is the one whose derivative is reported, unless there is one already.
    fn reporting(mut self) -> Self {
        self.reported.get_or_insert(self.parts.len());
        self
    }
}

impl Law for Parallel {
    fn begin(&self, start: &Start) -> Result<State, KernelError> {
        let parts = self.parts.iter().map(|part| part.begin(start)).collect::<Result<_, _>>()?;
        Ok(State { parts, ..State::default() })
    }

    fn respond(&self, step: &Step, state: &State) -> Response {
        let mut sum = Response::default();
        for (part, state) in self.parts.iter().zip(&state.parts) {
            let response = part.respond(step, state);
            for i in 0..step.nodes.count() {
                sum.force[i] += response.force[i];
                sum.singular[i] += response.singular[i];
                for j in 0..step.nodes.count() {
                    sum.d_stroke[i][j] += response.d_stroke[i][j];
                    sum.d_rate[i][j] += response.d_rate[i][j];
                }
            }
        }
        sum
    }

    fn commit(&self, step: &Step, state: &mut State) {
        for (part, state) in self.parts.iter().zip(&mut state.parts) {
            part.commit(step, state);
        }
    }

    fn defect(&self, step: &Step, state: &State) -> f64 {
        let defects = self.parts.iter().zip(&state.parts).map(|(part, state)| part.defect(step, state));
        defects.fold(0.0, f64::max)
    }

    fn powers(&self, step: &Step, state: &State) -> Powers {
        let mut sum = Powers::default();
        for (part, state) in self.parts.iter().zip(&state.parts) {
            for (sum, power) in sum.iter_mut().zip(part.powers(step, state)) {
                sum.dissipation += power.dissipation;
                sum.input += power.input;
            }
        }
        sum
    }

    fn observe(&self, step: &Step, theta: f64, at: &Point, state: &State) -> Observation {
        self.add(at, state, |part, state| part.observe(step, theta, at, state))
    }

    fn observe_start(&self, at: &Point, state: &State) -> Observation {
        self.add(at, state, |part, state| part.observe_start(at, state))
    }

    fn order(&self) -> f64 {
        self.reported.map_or(0.0, |part| self.parts[part].order())
    }

    fn stored(&self, at: &Point, state: &State) -> Option<f64> {
        self.parts.iter().zip(&state.parts).map(|(part, state)| part.stored(at, state)).sum()
    }

    fn singular(&self, t: f64, state: &State) -> f64 {
        self.reported.map_or(0.0, |part| self.parts[part].singular(t, &state.parts[part]))
    }

    fn force(&self, at: &Point, derivative: f64) -> f64 {
        self.parts.iter().map(|part| part.force(at, derivative)).sum()
    }

    fn check_inputs(&self, inputs: &[InputValue]) -> Result<(), RuleError> {
        self.parts.iter().try_for_each(|part| part.check_inputs(inputs))
    }
}

impl Parallel {
    fn add(&self, at: &Point, state: &State, observe: impl Fn(&dyn Law, &State) -> Observation) -> Observation {
        let mut sum = Observation { derivative: at.stroke, force: 0.0, stored: Some(0.0) };
        for (index, (part, state)) in self.parts.iter().zip(&state.parts).enumerate() {
            let observation = observe(part.as_ref(), state);
            sum.force += observation.force;
            sum.stored = sum.stored.zip(observation.stored).map(|(a, b)| a + b);
            if self.reported == Some(index) {
                sum.derivative = observation.derivative;
            }
        }
        sum
    }
}
