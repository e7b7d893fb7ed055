//! What laws are asked, and what they answer.

use crate::collocation::{MAX_NODES, Nodes, Places, quadrature, quadrature_defect};
use crate::dual::Dual;
use crate::fractional::{Form, RatePolynomial, StepStart};
use serde::{Deserialize, Serialize};

/// Value and rate of one input at one time, SI.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct InputValue<T = f64> {
    /// Value.
    pub value: T,
    /// Time derivative.
    pub rate: T,
}

/// An element's kinematics and inputs at one time: in numbers, or in numbers with a derivative ([`crate::dual::Dual`]).
#[derive(Debug, Clone, Copy)]
pub struct Point<'a, T = f64> {
    /// Time, s.
    pub t: f64,
    /// x, m.
    pub stroke: T,
    /// x', m/s.
    pub rate: T,
    /// Inputs in the order of the catalog.
    pub inputs: &'a [InputValue<T>],
}

impl Point<'_> {
    /// Its inputs as numbers without derivatives.
    pub(super) fn inputs_as_numbers(&self) -> Vec<InputValue<Dual>> {
        let number = |input: &InputValue| InputValue { value: input.value.into(), rate: input.rate.into() };
        self.inputs.iter().map(number).collect()
    }

    /// The same point where its inputs change as these do.
    pub(super) fn with_inputs<'a>(&self, inputs: &'a [InputValue<Dual>]) -> Point<'a, Dual> {
        Point { t: self.t, stroke: self.stroke.into(), rate: self.rate.into(), inputs }
    }
}

impl Point<'_, Dual> {
    /// Its inputs without their derivatives.
    pub(super) fn values_of_inputs(&self) -> Vec<InputValue> {
        let number = |input: &InputValue<Dual>| InputValue { value: input.value.value, rate: input.rate.value };
        self.inputs.iter().map(number).collect()
    }

    /// The same point without derivatives, under these inputs.
    pub(super) fn without_derivatives<'a>(&self, inputs: &'a [InputValue]) -> Point<'a> {
        Point { t: self.t, stroke: self.stroke.value, rate: self.rate.value, inputs }
    }
}

/// One step: its data at the start (index 0) and at the nodes (1 … s), as [`Point`] has them.
#[derive(Debug, Clone, Copy)]
pub struct Step<'a, T = f64> {
    /// Start t_n, s.
    pub t: f64,
    /// Size h, s.
    pub h: f64,
    /// Where the step is evaluated.
    pub nodes: Nodes,
    /// Where three nodes lie on a clock that does not run evenly; `None`: where [`Self::nodes`] has them.
    pub places: Option<&'a Places>,
    /// Which data make the memory's polynomial.
    pub form: Form,
    /// x, s + 1 values, m.
    pub stroke: &'a [T],
    /// x', s + 1 values, m/s.
    pub rate: &'a [T],
    /// Inputs, (s + 1) × (number of inputs), point by point.
    pub inputs: &'a [InputValue<T>],
    /// Rounding of the strokes, m: differences below it mean nothing.
    pub resolution: f64,
    /// Whether strokes and rates are given.
    pub course: Course,
}

/// Whether strokes and rates of a step are given, or sought so that forces fit them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Course {
    /// They are those of a motion that is known. The singular part x(0) t^−alpha/Γ(1−alpha) of a Riemann–Liouville start enters the
    /// forces at the nodes by its value there.
    Given,
    /// They follow from equations of motion. A singular part enters by its moments over the step, so that impulses are exact
    /// ([`crate::fractional::Memory::singular_moments`]).
    Sought,
}

/// Where a law starts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start<'a> {
    /// x(0), m.
    pub stroke: f64,
    /// x(0) where it counts as different from 0, else 0, m.
    pub jump: f64,
    /// Inputs at t = 0, in the order of the catalog.
    pub inputs: &'a [InputValue],
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
pub struct Power<T = f64> {
    /// Dissipated.
    pub dissipation: T,
    /// Supplied by the inputs.
    pub input: T,
}

/// Powers at the start and at the nodes of a step.
pub type Powers = [Power; MAX_NODES + 1];

/// A law at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation<T = f64> {
    /// D^alpha x of the springpot that a law reports, x' of a dashpot where it has none, else x; NaN where it is infinite.
    pub derivative: T,
    /// F without the share of a singular start, N.
    pub regular: T,
    /// The share of a singular start in F, N; NaN at t = 0, where it is infinite, and 0 without one.
    pub singular: T,
    /// Stored energy, J; unknown (`None`) after a singular start, which takes infinite work.
    pub stored: Option<T>,
}

/// A leaf of a law at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeafState {
    /// Its own stroke, m: in a series that of the part alone.
    pub stroke: f64,
    /// Its rate, m/s.
    pub rate: f64,
    /// Its force, N; NaN where it is infinite.
    pub force: f64,
    /// D^alpha of its stroke where it is a springpot, the rate of a dashpot, else the stroke.
    pub derivative: f64,
}

/// c·D^order x: what a law is like under small and fast strokes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Term {
    /// c ≥ 0, N·s^order/m.
    pub coefficient: f64,
    /// 0 for a spring, 1 for a dashpot, between them for a springpot.
    pub order: f64,
}

/// How well a step knows one D^order x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalError {
    /// Estimate of the error at the end of the step, in the unit of D^order x.
    pub error: f64,
    /// D^order x at the end of the step, without the share of a singular start: what the error is measured by.
    pub value: f64,
    /// The order.
    pub order: f64,
    /// The error falls like the power of h with this exponent.
    pub falls: f64,
    /// The exponent that brings an estimate of a lower order to that: 1 where it has it; 0 where it is a rate as it was told, of which whoever
    /// told it knows the error.
    pub sharpness: f64,
}

impl<'a, T: Copy> Step<'a, T> {
    /// The step's data at its start (0) or at node `index`.
    pub fn point(&self, index: usize) -> Point<'a, T> {
        let theta = if index == 0 { 0.0 } else { self.positions()[index - 1] };
        let (stroke, rate) = (self.stroke[index], self.rate[index]);
        Point { t: self.t + theta * self.h, stroke, rate, inputs: self.inputs_at(index) }
    }

    /// The inputs at its start (0) or at node `index`.
    pub fn inputs_at(&self, index: usize) -> &'a [InputValue<T>] {
        let count = self.inputs.len() / self.stroke.len();
        &self.inputs[index * count..(index + 1) * count]
    }

    /// The nodes.
    pub fn positions(&self) -> &[f64] {
        match self.places {
            None => self.nodes.positions(),
            Some(places) => places.positions(),
        }
    }

    /// The collocation matrix of its nodes ([`Nodes::matrix`]).
    pub fn matrix(&self) -> [[f64; MAX_NODES]; MAX_NODES] {
        self.places.map_or_else(|| *self.nodes.matrix(), Places::matrix)
    }

    /// Weights of ∫₀^θ f dθ ([`quadrature`]).
    pub fn quadrature(&self, theta: f64) -> [f64; MAX_NODES + 1] {
        self.places.map_or_else(|| quadrature(self.nodes, theta), |places| places.quadrature(theta))
    }

    /// The estimate of a quadrature's error in units of h ([`quadrature_defect`]).
    pub fn quadrature_defect(&self, values: &[f64]) -> f64 {
        self.places.map_or_else(|| quadrature_defect(self.nodes, values), |places| places.quadrature_defect(values))
    }
}

impl Step<'_> {
    /// The polynomial of x', as the form says.
    pub fn polynomial(&self) -> RatePolynomial {
        match (self.form, self.places) {
            (Form::Rates, None) => RatePolynomial::through_rates(self.h, self.nodes, self.rate),
            (Form::Strokes, None) => RatePolynomial::through_strokes(self.h, self.nodes, self.stroke),
            (Form::Rates, Some(places)) => RatePolynomial::through_rates_at(self.h, places, self.rate),
            (Form::Strokes, Some(places)) => RatePolynomial::through_strokes_at(self.h, places, self.stroke),
            (Form::Hermite, places) => {
                RatePolynomial::through_strokes_and_rates(self.h, places, [self.stroke, self.rate])
            }
        }
    }

    /// The start as a memory sees it; one that is told strokes does not ask for the rate.
    pub fn start(&self) -> StepStart {
        let rate = if self.form == Form::Strokes { 0.0 } else { self.rate[0] };
        StepStart { t: self.t, h: self.h, stroke: self.stroke[0], rate }
    }
}

impl Observation {
    /// F, N; NaN where it is infinite.
    pub fn force(&self) -> f64 {
        self.regular + self.singular
    }

    /// F without the share of a singular start where that is infinite, at t = 0, N.
    pub fn finite_force(&self) -> f64 {
        self.regular + if self.singular.is_nan() { 0.0 } else { self.singular }
    }
}

impl Term {
    /// c·D^order in ξ as it is in t, where times are longer by a_T = `factor`.
    pub(super) fn shifted(self, factor: f64) -> Self {
        Self { coefficient: self.coefficient * factor.powf(self.order), ..self }
    }

    /// |∂F/∂x| of strokes at the rate `omega`, rad/s.
    pub fn stiffness(&self, omega: f64) -> f64 {
        self.coefficient * omega.powf(self.order)
    }

    /// Whether it takes a memory that can be unstable where it is stiff and told rates.
    pub fn is_yielding(&self) -> bool {
        self.order > 0.0 && self.order < 0.5
    }
}

impl LocalError {
    /// Of a variable that is collocated at the nodes of the step, `value` at its end.
    pub(super) fn collocated(error: f64, value: f64) -> Self {
        Self { error, value, order: 0.0, falls: 4.0, sharpness: 1.0 }
    }

    /// Of a rate, `value` at the end of the step, as it was told.
    pub(super) fn told(value: f64) -> Self {
        Self { error: 0.0, value, order: 1.0, falls: 3.0, sharpness: 0.0 }
    }

    /// The error in units of what is `allowed` where D^order x has the size `scale`.
    pub fn share(&self, scale: f64, allowed: f64) -> f64 {
        match self.error {
            0.0 => 0.0,
            error if self.sharpness == 1.0 => error / allowed,
            error => (error / scale).powf(self.sharpness) * scale / allowed,
        }
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
