//! What a run keeps of the error of one joint for its controller: an integral or a fractional derivative.

mod filter;
mod variation;

use filter::Filter;
pub(super) use filter::longest_step;
pub(super) use variation::TermVariation;

use crate::collocation::{MAX_NODES, Nodes, STAGES};
use crate::control::ErrorTerm;
use crate::fractional::{Affine, Form, KernelError, Kind, Memory, RatePolynomial, StepStart};
use crate::law::Response;
use crate::linalg::Lu;
use serde::{Deserialize, Serialize};

/// gain·D^order e over a run.
///
/// An integral of order lambda is D^{1−lambda} of ∫e, so that both kinds are memories of a stroke: e, or ∫e. In a step of which only the ends are known the
/// stroke is the Hermite cubic.
#[derive(Debug, Clone)]
pub(super) struct Term {
    pub(super) law: ErrorTerm,
    pub(super) kept: Kept,
    /// What a derivative goes through.
    filter: Option<Filter>,
    nodes: Nodes,
    form: Form,
    start: StepStart,
    affine: Affine,
    /// Stroke and its rate at the start and at the nodes of the step.
    stroke: [f64; STAGES + 1],
    rate: [f64; STAGES + 1],
    /// D^order e there.
    pub(super) value: [f64; STAGES + 1],
}

/// What of it outlasts a step.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Kept {
    memory: Memory,
    /// ∫e of an integral.
    integral: f64,
    /// What is integrated, at the end of the last step; the rate of e of a derivative.
    rate: f64,
    /// What a filter gives there.
    filtered: f64,
}

/// What an integral does in a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub(super) enum Integrand {
    /// It takes the error.
    #[default]
    Runs,
    /// It takes nothing.
    Frozen,
    /// It takes what keeps the force at its limit.
    Slides,
}

impl Term {
    /// At t = 0, where the error is `error`; a derivative goes through a `filter` of that time, s.
    pub(super) fn begin(law: ErrorTerm, error: f64, filter: Option<f64>) -> Result<Self, KernelError> {
        let is_integral = law.order < 0.0;
        let filter = filter.filter(|_| !is_integral).map(Filter::new);
        let (alpha, stroke) = if is_integral { (1.0 + law.order, 0.0) } else { (law.order, error) };
        let memory = Memory::closed(alpha, Kind::Caputo, stroke, 0.0)?;
        Ok(Self {
            law,
            kept: Kept { memory, integral: 0.0, rate: 0.0, filtered: 0.0 },
            filter,
            nodes: Nodes::Radau,
            form: Form::Rates,
            start: StepStart { t: 0.0, h: 0.0, stroke, rate: 0.0 },
            affine: Affine::default(),
            stroke: [stroke; STAGES + 1],
            rate: [0.0; STAGES + 1],
            value: [0.0; STAGES + 1],
        })
    }

    pub(super) fn open(&mut self, tolerance: f64, first: f64, horizon: f64) -> Result<(), KernelError> {
        self.kept.memory.open(tolerance, Nodes::Radau.positions()[0] * first, horizon)
    }

    pub(super) fn is_integral(&self) -> bool {
        self.law.order < 0.0
    }

    /// gain·D^order e between two steps, where the error and its rate are these.
    pub(super) fn now(&self, [error, rate]: [f64; 2], integrand: Integrand) -> f64 {
        let Kept { memory, integral, filtered, .. } = &self.kept;
        let value = if self.filter.is_some() {
            *filtered
        } else if self.is_integral() {
            memory.now(*integral, if integrand == Integrand::Runs { error } else { 0.0 })
        } else {
            memory.now(error, rate)
        };
        self.law.gain * value
    }

    /// Begins a step from where the error and its rate are these.
    pub(super) fn start(&mut self, t: f64, h: f64, nodes: Nodes, [error, rate]: [f64; 2], integrand: Integrand) {
        let (stroke, rate) = match (self.is_integral(), integrand) {
            (false, _) => (error, rate),
            (true, Integrand::Runs) => (self.kept.integral, error),
            (true, Integrand::Frozen) => (self.kept.integral, 0.0),
            (true, Integrand::Slides) => (self.kept.integral, self.kept.rate),
        };
        self.form = if self.is_integral() && integrand == Integrand::Slides { Form::Strokes } else { Form::Rates };
        (self.nodes, self.start) = (nodes, StepStart { t, h, stroke, rate });
        (self.stroke[0], self.rate[0]) = (stroke, rate);
        self.value[0] = self.kept.memory.now(stroke, rate);
        self.kept.memory.prepare(&self.start, nodes, self.form);
        self.affine = self.kept.memory.respond(&self.start, nodes, self.form);
        if let Some(filter) = &mut self.filter {
            filter.start(h, nodes, [self.kept.filtered, self.value[0]]);
            self.value[0] = self.kept.filtered;
        }
    }

    /// Takes the errors and their rates at the nodes.
    pub(super) fn take(&mut self, errors: &[[f64; 2]; STAGES], integrand: Integrand) {
        let h = self.start.h;
        for i in 0..STAGES {
            (self.stroke[i + 1], self.rate[i + 1]) = if !self.is_integral() {
                (errors[i][0], errors[i][1])
            } else if integrand == Integrand::Runs {
                let row = &self.nodes.matrix()[i];
                (self.stroke[0] + h * (0..STAGES).map(|j| row[j] * errors[j][0]).sum::<f64>(), errors[i][0])
            } else {
                (self.stroke[0], 0.0)
            };
        }
        self.evaluate();
    }

    /// Solves for the integral that gives the values `wanted` of gain·D^order e at the nodes; `false` where there is none.
    pub(super) fn slide(&mut self, wanted: [f64; STAGES]) -> bool {
        let mut lu = Lu::default();
        let Affine { stroke, history, .. } = &self.affine;
        let regular = lu.factor(STAGES, |matrix| {
            (0..STAGES * STAGES).for_each(|k| matrix[k] = stroke[k / STAGES][k % STAGES]);
        });
        let mut moved: [f64; STAGES] = std::array::from_fn(|i| wanted[i] / self.law.gain - history[i]);
        if !regular {
            return false;
        }
        lu.solve(&mut moved);
        for i in 0..STAGES {
            self.stroke[i + 1] = self.stroke[0] + moved[i];
        }
        let polynomial = self.polynomial();
        self.rate[0] = polynomial.rate(0.0);
        for (rate, theta) in self.rate[1..].iter_mut().zip(self.nodes.positions()) {
            *rate = polynomial.rate(*theta);
        }
        self.evaluate();
        true
    }

    fn evaluate(&mut self) {
        let Affine { stroke, rate, history } = &self.affine;
        for i in 0..STAGES {
            let own = |j: usize| stroke[i][j] * (self.stroke[j + 1] - self.stroke[0]) + rate[i][j] * self.rate[j + 1];
            self.value[i + 1] = history[i] + (0..STAGES).map(own).sum::<f64>();
        }
        if let Some(filter) = &mut self.filter {
            filter.take(&mut self.value[1..]);
        }
    }

    /// What an integral takes at the start and at the nodes.
    pub(super) fn integrand(&self) -> [f64; STAGES + 1] {
        self.rate
    }

    /// −∂(gain·D^order e)_i by the coordinate and the velocity at node j, as a law would answer.
    pub(super) fn response(&self, integrand: Integrand) -> Response {
        let mut response = Response::default();
        if self.is_integral() && integrand != Integrand::Runs {
            return response;
        }
        let (h, matrix, gain) = (self.start.h, self.nodes.matrix(), self.law.gain);
        let Affine { stroke, rate, .. } = &self.affine;
        for i in 0..STAGES {
            for j in 0..STAGES {
                if self.is_integral() {
                    let through: f64 = (0..STAGES).map(|m| stroke[i][m] * h * matrix[m][j]).sum();
                    response.d_stroke[i][j] = gain * (rate[i][j] + through);
                } else {
                    response.d_stroke[i][j] = gain * stroke[i][j];
                    response.d_rate[i][j] = gain * rate[i][j];
                }
            }
        }
        self.filter.as_ref().map_or(response, |filter| filter.respond(&response))
    }

    fn polynomial(&self) -> RatePolynomial {
        match self.form {
            Form::Rates => RatePolynomial::through_rates(self.start.h, self.nodes, &self.rate),
            Form::Strokes | Form::Hermite => RatePolynomial::through_strokes(self.start.h, self.nodes, &self.stroke),
        }
    }

    /// gain·D^order e at θ of the step, where the error and its rate are these.
    pub(super) fn at(&self, theta: f64, [error, rate]: [f64; 2], integrand: Integrand) -> f64 {
        if let Some(filter) = &self.filter {
            return self.law.gain * filter.at(self.nodes, self.start.h, theta);
        }
        let polynomial = self.polynomial();
        let memory = &self.kept.memory;
        let value = if self.is_integral() {
            let stroke = self.stroke[0] + polynomial.travel_until(theta);
            let rate = if integrand == Integrand::Runs { error } else { polynomial.rate(theta) };
            memory.regular_derivative(&polynomial, theta, stroke, rate)
        } else if theta < 1.0 {
            memory.derivative_between(&polynomial, theta, error, rate)
        } else {
            memory.regular_derivative(&polynomial, theta, error, rate)
        };
        self.law.gain * value
    }

    /// Takes the step into the past.
    pub(super) fn commit(&mut self) {
        if self.filter.is_some() {
            self.kept.filtered = self.value[STAGES];
        }
        let polynomial = self.polynomial();
        self.take_past(&polynomial, self.stroke[STAGES], self.rate[STAGES]);
    }

    /// Takes a step of size `h` into the past of which the ends alone are known: error and its rate there.
    pub(super) fn commit_ends(&mut self, h: f64, ends: [[f64; 2]; 2], integrand: Integrand) {
        let polynomial = self.polynomial_of_ends(h, ends, integrand);
        let [_, [e1, v1]] = ends;
        if !self.is_integral() {
            let [[e0, v0], _] = ends;
            let first = self.filter.as_ref().map(|_| self.kept.memory.now(e0, v0));
            self.take_past(&polynomial, e1, v1);
            if let Some((filter, first)) = self.filter.as_ref().zip(first) {
                self.kept.filtered = filter.along(h, self.kept.filtered, [first, self.kept.memory.now(e1, v1)]);
            }
            return;
        }
        let end = self.kept.integral + polynomial.travel();
        let rate = polynomial.rate(1.0);
        self.take_past(&polynomial, end, rate);
    }

    /// How fast the stroke goes in such a step.
    fn polynomial_of_ends(&self, h: f64, ends: [[f64; 2]; 2], integrand: Integrand) -> RatePolynomial {
        let [[e0, v0], [e1, v1]] = ends;
        if !self.is_integral() {
            return RatePolynomial::hermite(h, [e0, e1], [v0, v1]);
        }
        if integrand != Integrand::Runs {
            return RatePolynomial::cubic(h, [0.0; 4]);
        }
        // The error itself, as the cubic through both ends and their rates.
        let (d, s0, s1) = (e1 - e0, h * v0, h * v1);
        RatePolynomial::cubic(h, [e0, s0, 3.0 * d - 2.0 * s0 - s1, s0 + s1 - 2.0 * d])
    }

    fn take_past(&mut self, polynomial: &RatePolynomial, stroke: f64, rate: f64) {
        self.kept.memory.commit(polynomial);
        if self.is_integral() {
            self.kept.integral = stroke;
        }
        self.kept.rate = rate;
    }
}

/// As many nodes as a response has room for.
const _: () = assert!(STAGES <= MAX_NODES);
