//! Hysteresis after Bouc and Wen.

use super::columns::{ByColumns, Columns};
use super::contract::{Guard, Holds, Leaf};
use super::hysteresis::{self, Hysteresis, Matrix, Values};
use super::kind::{LeafBuild, LeafKind};
use super::springpot::Coefficient;
use crate::collocation::{MAX_NODES, Nodes};
use crate::dual::{Dual, Real};
use crate::fractional::KernelError;
use crate::law::catalog::{Param, Range};
use crate::law::rule::RuleError;
use crate::law::state::{State, StateMut, StateRef, StateSize};
use crate::law::step::{InputValue, LocalError, Observation, Point, Power, Powers, Response, Start, Step, Term};
use std::sync::Arc;

/// F = alpha_h·z, z' = A·x' − gamma·|x'|·z·|z|^(n−1) − beta·x'·|z|^n, z(0) = 0 (Bouc 1967, Wen 1976).
///
/// Stores alpha_h·z²/(2A), dissipates (alpha_h/A)·|z|^(n+1)·(gamma·|x'| + beta·x'·sgn z); an alpha_h that follows an input is supplied with
/// ∫ alpha_h'·z²/(2A) dt by it. z is one inner variable, collocated at the nodes of the step; where the stroke turns round z' has a kink.
#[derive(Debug, Clone, PartialEq)]
pub struct BoucWen {
    alpha_h: Coefficient,
    hysteresis: Hysteresis,
}

impl BoucWen {
    /// alpha_h in N/m, A without unit, beta and gamma in 1/mⁿ.
    ///
    /// # Errors
    /// [`RuleError`]: alpha_h ≥ 0, A > 0, n ≥ 1, gamma ≥ |beta| so that it dissipates, gamma + beta > 0 so that z is bounded.
    pub fn new(
        alpha_h: impl Into<Dual>,
        a: impl Into<Dual>,
        beta: impl Into<Dual>,
        gamma: impl Into<Dual>,
        n: impl Into<Dual>,
    ) -> Result<Self, RuleError> {
        let alpha_h = alpha_h.into();
        RuleError::unless(alpha_h.value >= 0.0, "alpha_h ≥ 0", "alpha_h")?;
        Ok(Self { alpha_h: Coefficient::constant(alpha_h), hysteresis: Hysteresis::new(a, beta, gamma, n)? })
    }

    /// With a coefficient that may follow an input.
    pub fn varying(alpha_h: Coefficient, hysteresis: Hysteresis) -> Self {
        Self { alpha_h, hysteresis }
    }

    fn solve(&self, step: &Step, start: f64) -> (Values, Matrix) {
        self.hysteresis.solve((step.nodes.count(), &step.matrix()), step.h, step.rate, None, start)
    }

    fn rates<T: Real>(&self, step: &Step<T>, z: &Values<T>) -> Values<T> {
        let last = step.nodes.count();
        std::array::from_fn(|k| if k > last { 0.0.into() } else { self.hysteresis.rate(z[k], step.rate[k]) })
    }
}

impl Leaf for BoucWen {
    fn name(&self) -> &'static str {
        "bouc-wen"
    }

    fn size(&self) -> StateSize {
        StateSize { memories: 0, variables: 1 }
    }

    fn begin(&self, _: &Start, state: &mut State) -> Result<(), KernelError> {
        state.push_variable(0.0);
        Ok(())
    }

    fn evaluate(&self, step: &Step, state: StateRef, response: &mut Response) {
        let (z, tangent) = self.solve(step, state.variables[0]);
        for i in 0..step.nodes.count() {
            let alpha_h = self.alpha_h.at(step.point(i + 1).inputs).value;
            response.force[i] += alpha_h * z[i + 1];
            for j in 0..step.nodes.count() {
                response.d_rate[i][j] += alpha_h * tangent[i][j];
            }
        }
    }

    fn by_input(&self, step: &Step, state: StateRef, input: usize, slopes: &mut [[f64; MAX_NODES]; MAX_NODES]) {
        if self.alpha_h.input == Some(input) {
            let (z, _) = self.solve(step, state.variables[0]);
            (0..step.nodes.count()).for_each(|i| slopes[i][i] += self.alpha_h.slope.value * z[i + 1]);
        }
    }

    fn commit(&self, step: &Step, state: StateMut) {
        let start = state.variables[0];
        let (z, _) = self.solve(step, start);
        self.at_end(step, &[start], &z, &mut |z| state.variables[0] = z);
    }

    fn rates(&self, at: &Point, state: StateRef, rates: &mut Vec<f64>) -> bool {
        rates.push(self.hysteresis.rate(state.variables[0], at.rate));
        true
    }

    fn local_errors(&self, step: &Step, state: StateRef, errors: &mut Vec<LocalError>) {
        let (z, _) = self.solve(step, state.variables[0]);
        let defect = step.h * step.quadrature_defect(&self.rates(step, &z));
        // What rounding leaves of a stroke is no error of z.
        let error = if defect <= self.hysteresis.slope_at_rest::<f64>() * step.resolution { 0.0 } else { defect };
        errors.push(LocalError::collocated(error, z[step.nodes.count()]));
    }

    fn powers(&self, step: &Step, state: StateRef, powers: &mut Powers) {
        let (z, _) = self.solve(step, state.variables[0]);
        for (k, power) in powers.iter_mut().enumerate().take(step.nodes.count() + 1) {
            let own = self.power(step, state.variables, &z, k);
            power.dissipation += own.dissipation;
            power.input += own.input;
        }
    }

    fn at(&self, step: &Step, theta: f64, at: &Point, state: StateRef) -> Observation {
        let (z, _) = self.solve(step, state.variables[0]);
        self.within(step, theta, at, state.variables, &z)
    }

    fn now(&self, at: &Point, state: StateRef) -> Observation {
        self.between(at, state.variables)
    }

    fn by_columns(&self) -> Option<&dyn ByColumns> {
        Some(self)
    }

    /// About z = 0, so that at rest it gives no force and small motions meet the spring alpha_h·A.
    fn linearised(&self, at: &Point) -> Term {
        Term { coefficient: self.alpha_h.at(at.inputs).value * self.hysteresis.slope_at_rest::<f64>(), order: 0.0 }
    }

    fn guards(&self, at: &Point, take: &mut dyn FnMut(f64)) {
        take(at.rate);
    }

    /// In metres, as rounding of strokes is: a rate between two of them is told no better in a short step.
    fn guards_in(&self, step: &Step, _: StateRef, guards: &mut Vec<Guard>) {
        let last = step.nodes.count();
        guards.push(std::array::from_fn(|k| if k <= last { step.h * step.rate[k] } else { 0.0 }));
    }

    fn holds(&self) -> Holds {
        // At its largest z it yields.
        if self.alpha_h.is_none() { Holds::Never } else { Holds::AtTimes }
    }

    fn check_inputs(&self, inputs: &[InputValue]) -> Result<(), RuleError> {
        self.alpha_h.check(inputs, "the coefficient of z")
    }
}

impl Columns for BoucWen {
    /// z at the start and at the nodes.
    type Solved<T: Real> = Values<T>;

    fn each_number(&mut self, take: &mut dyn FnMut(&mut Dual)) {
        self.alpha_h.numbers().into_iter().chain(self.hysteresis.numbers()).for_each(take);
    }

    fn at_start<T: Real>(&self, _: &Point<T>, take: &mut dyn FnMut(T)) {
        take(0.0.into());
    }

    fn solved(&self, step: &Step, start: &[f64]) -> Values {
        self.solve(step, start[0]).0
    }

    fn follow(&self, step: &Step<Dual>, start: &[Dual], found: &Values) -> Values<Dual> {
        let nodes = (step.nodes.count(), &step.matrix());
        self.hysteresis.follow(nodes, step.h, step.rate, None, start[0], found)
    }

    fn force<T: Real>(&self, step: &Step<T>, z: &Values<T>, k: usize) -> T {
        self.alpha_h.at(step.inputs_at(k)).value * z[k]
    }

    fn power<T: Real>(&self, step: &Step<T>, _: &[T], z: &Values<T>, k: usize) -> Power<T> {
        let (a, alpha_h) = (self.hysteresis.slope_at_rest(), self.alpha_h.at(step.inputs_at(k)));
        Power {
            dissipation: alpha_h.value / a * self.hysteresis.lost(z[k], step.rate[k]),
            input: T::from(0.5) * alpha_h.rate * z[k] * z[k] / a,
        }
    }

    fn at_end<T: Real>(&self, step: &Step<T>, start: &[T], z: &Values<T>, take: &mut dyn FnMut(T)) {
        let last = z[step.nodes.count()];
        take(if step.nodes == Nodes::Midpoint { T::from(2.0) * last - start[0] } else { last });
    }

    fn each_rate<T: Real>(&self, step: &Step<T>, _: &[T], z: &Values<T>, take: &mut dyn FnMut(T, Values<T>)) {
        take(z[step.nodes.count()], self.rates(step, z));
    }

    fn within<T: Real>(&self, step: &Step<T>, theta: f64, at: &Point<T>, start: &[T], z: &Values<T>) -> Observation<T> {
        let rates = self.rates(step, z);
        let moved: T = step.quadrature(theta).iter().zip(rates).map(|(weight, rate)| T::from(*weight) * rate).sum();
        self.between(at, &[start[0] + T::from(step.h) * moved])
    }

    fn between<T: Real>(&self, at: &Point<T>, variables: &[T]) -> Observation<T> {
        let (alpha_h, z) = (self.alpha_h.at(at.inputs).value, variables[0]);
        let stored = T::from(0.5) * alpha_h * z * z / self.hysteresis.slope_at_rest();
        Observation { derivative: at.stroke, regular: alpha_h * z, singular: 0.0.into(), stored: Some(stored) }
    }
}

/// Its parameters, in the order of its arguments.
pub(in crate::law) fn params() -> Vec<Param> {
    let alpha_h = Param::new("alpha_h", "N/m", "force per unit of the hysteretic variable z", Range::NOT_NEGATIVE);
    [alpha_h].into_iter().chain(hysteresis::params("1/m^n")).collect()
}

/// What networks know of it.
pub(super) fn kind() -> LeafKind {
    LeafKind {
        name: "bouc-wen",
        equation: "F = alpha_h·z, z' = A·x' − gamma·|x'|·z·|z|^(n−1) − beta·x'·|z|^n",
        params: params(),
        build: LeafBuild::Values(|numbers, _| {
            let &[alpha_h, a, beta, gamma, n] = numbers else { unreachable!("values follow params") };
            Ok(Arc::new(BoucWen::new(alpha_h, a, beta, gamma, n)?))
        }),
    }
}
