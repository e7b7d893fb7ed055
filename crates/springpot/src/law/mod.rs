//! Material laws: stroke history (and inputs) → force. A law knows no bodies and chooses no step.
//!
//! One contract for linear and nonlinear laws, with or without inner states. A step of size h has nodes 0 < c_1 < … < c_s ≤ 1;
//! [`Law::respond`] answers with the forces at the nodes and their tangents and may be asked any number of times;
//! [`Law::commit`] is the only mutation, on accepted steps. The state is a plain serialisable value outside the law.
//!
//! Signs: stroke x = l − l0, force F > 0 in tension. Power: F·x' = d(stored)/dt + dissipation − input.
//!
//! A law is a row of the [`Catalog`], an [`Entry`] with name, equation, parameters, inputs and how to build it; whoever must know
//! all laws reads the catalog. Most rows are sums of [`leaf`] laws ([`Parallel`]).
//!
//! ```
//! use springpot::law::{Catalog, Derivative, Point};
//!
//! let catalog = Catalog::standard();
//! let row = catalog.get("fractional-kelvin-voigt").expect("a law that comes with Springpot");
//! assert_eq!(row.equation, "F = k·x + c·D^alpha x");
//! let law = (row.build)(&[100.0, 50.0, 0.5], Derivative::Caputo)?;
//! let at = Point { t: 1.0, stroke: 0.02, rate: 0.1, inputs: &[] };
//! assert_eq!(law.force(&at, 0.04), 100.0 * 0.02 + 50.0 * 0.04); // D^½ x = 0.04
//! # Ok::<(), springpot::law::RuleError>(())
//! ```

pub mod catalog;
pub mod datasheet;
pub mod leaf;
pub mod parallel;

mod kelvin_voigt;
mod magnetorheological;
mod piezo;
mod thermoviscoelastic;

pub use crate::fractional::Kind as Derivative;
pub use catalog::{Catalog, Entry, Input, Param, Range, RuleError};
pub use parallel::Parallel;

use crate::fractional::step::{MAX_NODES, quadrature};
use crate::fractional::{Form, KernelError, Memory, Nodes, StepStart};
use serde::{Deserialize, Serialize};

/// Value and rate of one input at one time, SI.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct InputValue {
    /// Value.
    pub value: f64,
    /// Time derivative.
    pub rate: f64,
}

/// An element's kinematics and inputs at one time.
#[derive(Debug, Clone, Copy)]
pub struct Point<'a> {
    /// Time, s.
    pub t: f64,
    /// x, m.
    pub stroke: f64,
    /// x', m/s.
    pub rate: f64,
    /// Inputs in the order of the catalog.
    pub inputs: &'a [InputValue],
}

/// One step of the time loop: its data at the start (index 0) and at the nodes (1 … s).
#[derive(Debug, Clone, Copy)]
pub struct Step<'a> {
    /// Start t_n, s.
    pub t: f64,
    /// Size h, s.
    pub h: f64,
    /// Where the step is evaluated.
    pub nodes: Nodes,
    /// Which data make the memory's polynomial.
    pub form: Form,
    /// x, s + 1 values, m.
    pub stroke: &'a [f64],
    /// x', s + 1 values, m/s.
    pub rate: &'a [f64],
    /// Inputs, (s + 1) × (number of inputs), point by point.
    pub inputs: &'a [InputValue],
    /// Rounding of the strokes, m: differences below it mean nothing.
    pub resolution: f64,
    /// How a singular start enters the forces at the nodes.
    pub singular: Singular,
}

/// How the singular part x(0) t^−alpha/Γ(1−alpha) of a Riemann–Liouville start enters the forces at the nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Singular {
    /// By its value there.
    Value,
    /// By its moments over the step, so that impulses are exact ([`crate::fractional::Memory::singular_moments`]).
    Moments,
}

impl<'a> Step<'a> {
    /// The step's data at its start (0) or at node `index`.
    pub fn point(&self, index: usize) -> Point<'a> {
        let theta = if index == 0 { 0.0 } else { self.nodes.positions()[index - 1] };
        let count = self.inputs.len() / self.stroke.len();
        Point {
            t: self.t + theta * self.h,
            stroke: self.stroke[index],
            rate: self.rate[index],
            inputs: &self.inputs[index * count..(index + 1) * count],
        }
    }

    /// The start as a memory sees it.
    pub fn start(&self) -> StepStart {
        StepStart { t: self.t, h: self.h, stroke: self.stroke[0], rate: self.rate[0] }
    }
}

/// What a law must know before the first step.
#[derive(Debug, Clone, Copy)]
pub struct Start {
    /// x(0), m.
    pub stroke: f64,
    /// x(0) where it counts as different from 0, else 0, m.
    pub jump: f64,
    /// Relative error allowed to the memory's kernel.
    pub tolerance: f64,
    /// Shortest lag the first step asks for, s.
    pub delta: f64,
    /// Longest lag the run asks for, s.
    pub horizon: f64,
}

/// The state of a law: its memory and the states of its parts.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct State {
    /// The memory of the fractional derivative, where the law has one.
    pub memory: Option<Memory>,
    /// States of the parts of a network.
    pub parts: Vec<State>,
}

impl State {
    /// As [`Memory::prepare`] for all memories.
    pub fn prepare(&self, lags: &[f64]) {
        self.memory.iter().for_each(|memory| memory.prepare(lags));
        self.parts.iter().for_each(|part| part.prepare(lags));
    }

    /// Number of exponentials in all memories.
    pub fn modes(&self) -> usize {
        self.memory.as_ref().map_or(0, Memory::modes) + self.parts.iter().map(Self::modes).sum::<usize>()
    }
}

/// Forces at the nodes of a step and their tangents.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Response {
    /// F_i, N.
    pub force: [f64; MAX_NODES],
    /// ∂F_i/∂x_j, N/m.
    pub d_stroke: [[f64; MAX_NODES]; MAX_NODES],
    /// ∂F_i/∂x'_j, N·s/m.
    pub d_rate: [[f64; MAX_NODES]; MAX_NODES],
    /// The share of a singular start in F_i, N.
    pub singular: [f64; MAX_NODES],
}

/// Energy flows at one time, W.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Power {
    /// Dissipated.
    pub dissipation: f64,
    /// Supplied by the inputs.
    pub input: f64,
}

/// Powers at the start and at the nodes of a step.
pub type Powers = [Power; MAX_NODES + 1];

/// An element at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// D^alpha x; NaN where it is singular.
    pub derivative: f64,
    /// F, N; NaN where it is singular.
    pub force: f64,
    /// Stored energy, J; unknown (`None`) after a singular start, which takes infinite work.
    pub stored: Option<f64>,
}

/// A material law; what is provided is that of a law without memory.
pub trait Law: Send + Sync + std::fmt::Debug {
    /// The state at t = 0.
    ///
    /// # Errors
    /// [`KernelError`] where the memory's kernel cannot be built.
    fn begin(&self, _start: &Start) -> Result<State, KernelError> {
        Ok(State::default())
    }

    /// Forces at the nodes of `step` and their tangents.
    fn respond(&self, step: &Step, state: &State) -> Response;

    /// Takes an accepted step into the state.
    fn commit(&self, _step: &Step, _state: &mut State) {}

    /// Embedded error estimate of D^alpha x at the end of the step; 0 for a law without memory.
    fn defect(&self, _step: &Step, _state: &State) -> f64 {
        0.0
    }

    /// Energy flows at the start and at the nodes of the step; zeros after a singular start.
    fn powers(&self, _step: &Step, _state: &State) -> Powers {
        Powers::default()
    }

    /// The element at t_n + theta·h, 0 < theta ≤ 1, where its exact kinematics are those of `at`.
    fn observe(&self, _step: &Step, _theta: f64, at: &Point, state: &State) -> Observation {
        self.observe_start(at, state)
    }

    /// D^alpha x at t = 0 without the share of a singular start.
    fn start_derivative(&self, at: &Point, derivative: Derivative) -> f64 {
        match self.order() {
            1.0 => at.rate,
            0.0 if derivative == Derivative::RiemannLiouville => at.stroke,
            _ => 0.0,
        }
    }

    /// The element at t = 0.
    fn observe_start(&self, at: &Point, state: &State) -> Observation;

    /// The order alpha of the derivative that the law takes; 0 and 1 are x and x'.
    fn order(&self) -> f64;

    /// Stored energy after the last committed step, under the stroke, rate and inputs of `at`; `None` where unknown.
    fn stored(&self, at: &Point, state: &State) -> Option<f64>;

    /// The share x(0) t^−alpha/Γ(1−alpha) of a singular start in D^alpha x; 0 without one.
    fn singular(&self, _t: f64, _state: &State) -> f64 {
        0.0
    }

    /// F at one point when D^alpha x is known by other means; affine in `derivative`.
    fn force(&self, at: &Point, derivative: f64) -> f64;

    /// Rules over the inputs, to hold at every time.
    ///
    /// # Errors
    /// [`RuleError`] names the broken rule.
    fn check_inputs(&self, _inputs: &[InputValue]) -> Result<(), RuleError> {
        Ok(())
    }
}

impl Power {
    /// ∫ of the powers over the step up to t_n + theta·h: by the Radau weights at its end, else by the polynomial through them.
    pub fn integrate(powers: &Powers, nodes: Nodes, h: f64, theta: f64) -> Power {
        let weights = quadrature(nodes, theta);
        let mut sum = Power::default();
        for (power, weight) in powers.iter().zip(weights) {
            sum.dissipation += h * weight * power.dissipation;
            sum.input += h * weight * power.input;
        }
        sum
    }
}
