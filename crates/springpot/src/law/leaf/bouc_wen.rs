//! Hysteresis after Bouc and Wen.

use super::contract::Leaf;
use super::kind::{LeafBuild, LeafKind};
use crate::collocation::{MAX_NODES, Nodes};
use crate::fractional::KernelError;
use crate::law::catalog::{Param, Range};
use crate::law::network::{Holds, Network};
use crate::law::rule::RuleError;
use crate::law::state::{State, StateMut, StateRef, StateSize};
use crate::law::step::{LocalError, Observation, Point, Powers, Response, Start, Step, Term};

/// Iterations for z at the nodes.
const MOST_ITERATIONS: usize = 60;

/// Change of z, in units of the largest, at which they end; they converge quadratically.
const ENOUGH: f64 = 1e-12;

type Values = [f64; MAX_NODES + 1];
type Matrix = [[f64; MAX_NODES]; MAX_NODES];

/// F = alpha_h·z, z' = A·x' − gamma·|x'|·z·|z|^(n−1) − beta·x'·|z|^n, z(0) = 0 (Bouc 1967, Wen 1976).
///
/// Stores alpha_h·z²/(2A), dissipates (alpha_h/A)·|z|^(n+1)·(gamma·|x'| + beta·x'·sgn z). z is one inner variable, collocated at the nodes of
/// the step; where the stroke turns round z' has a kink.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoucWen {
    alpha_h: f64,
    a: f64,
    beta: f64,
    gamma: f64,
    n: f64,
}

impl BoucWen {
    /// alpha_h in N/m, A without unit, beta and gamma in 1/mⁿ.
    ///
    /// # Errors
    /// [`RuleError`]: alpha_h ≥ 0, A > 0, n ≥ 1, gamma ≥ |beta| so that it dissipates, gamma + beta > 0 so that z is bounded.
    pub fn new(alpha_h: f64, a: f64, beta: f64, gamma: f64, n: f64) -> Result<Self, RuleError> {
        RuleError::unless(alpha_h >= 0.0, "alpha_h ≥ 0", "alpha_h")?;
        RuleError::unless(a > 0.0, "A > 0", "A")?;
        RuleError::unless(n >= 1.0, "n ≥ 1", "n")?;
        RuleError::unless(gamma >= beta.abs(), "gamma ≥ |beta|", "gamma")?;
        RuleError::unless(gamma + beta > 0.0, "gamma + beta > 0", "beta")?;
        Ok(Self { alpha_h, a, beta, gamma, n })
    }

    fn slope(&self, z: f64, v: f64) -> f64 {
        self.a * v - z.abs().powf(self.n) * (self.gamma * v.abs() * sign(z) + self.beta * v)
    }

    /// ∂z'/∂z and ∂z'/∂v.
    fn slopes(&self, z: f64, v: f64) -> [f64; 2] {
        let power = z.abs().powf(self.n);
        let by_z = -self.n * z.abs().powf(self.n - 1.0) * (self.gamma * v.abs() + self.beta * v * sign(z));
        [by_z, self.a - power * (self.gamma * sign(v) * sign(z) + self.beta)]
    }

    /// The largest |z| that strokes lead to.
    fn largest(&self) -> f64 {
        (self.a / (self.gamma + self.beta)).powf(self.n.recip())
    }

    /// z at the start and at the nodes, and ∂z_i/∂v_j: z_i = z_0 + h Σ_j A_ij z'_j by Newton's method; NaN where that finds none.
    fn solve(&self, step: &Step, start: f64) -> (Values, Matrix) {
        let (count, matrix) = (step.nodes.count(), step.matrix());
        // Beyond what it can be the powers would throw the iteration far off.
        let bound = 2.0 * self.largest().max(start.abs());
        let mut z = [start; MAX_NODES + 1];
        let mut tangent = Matrix::default();
        for _ in 0..MOST_ITERATIONS {
            // (I − h A diag(∂z'/∂z)) against h A diag(∂z'/∂v) and against the residual.
            let mut system = [[0.0; 2 * MAX_NODES + 1]; MAX_NODES];
            for i in 0..count {
                system[i][i] = 1.0;
                let mut residual = start - z[i + 1];
                for j in 0..count {
                    let (weight, at) = (step.h * matrix[i][j], (z[j + 1], step.rate[j + 1]));
                    let [by_z, by_v] = self.slopes(at.0, at.1);
                    system[i][j] -= weight * by_z;
                    system[i][MAX_NODES + j] = weight * by_v;
                    residual += weight * self.slope(at.0, at.1);
                }
                system[i][2 * MAX_NODES] = residual;
            }
            eliminate(&mut system, count);
            let (mut change, mut size) = (0.0f64, f64::MIN_POSITIVE);
            for i in 0..count {
                let next = (z[i + 1] + system[i][2 * MAX_NODES]).clamp(-bound, bound);
                // Not `max`, which would pass over what is no number.
                let moved = (next - z[i + 1]).abs();
                change = if moved > change || moved.is_nan() { moved } else { change };
                z[i + 1] = next;
                size = size.max(next.abs());
                tangent[i] = std::array::from_fn(|j| system[i][MAX_NODES + j]);
            }
            if change <= ENOUGH * size {
                return (z, tangent);
            }
        }
        ([f64::NAN; MAX_NODES + 1], [[f64::NAN; MAX_NODES]; MAX_NODES])
    }

    fn rates(&self, step: &Step, z: &Values) -> Values {
        let last = step.nodes.count();
        std::array::from_fn(|k| if k > last { 0.0 } else { self.slope(z[k], step.rate[k]) })
    }

    fn observation(&self, at: &Point, z: f64) -> Observation {
        let stored = Some(0.5 * self.alpha_h * z * z / self.a);
        Observation { derivative: at.stroke, regular: self.alpha_h * z, singular: 0.0, stored }
    }
}

/// −1, 0 or 1.
fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}

/// Solves the leading `count` rows for their right sides.
fn eliminate<const WIDTH: usize>(system: &mut [[f64; WIDTH]; MAX_NODES], count: usize) {
    for k in 0..count {
        let pivot = (k..count).max_by(|&a, &b| system[a][k].abs().total_cmp(&system[b][k].abs())).unwrap_or(k);
        system.swap(k, pivot);
        let scale = system[k][k];
        system[k].iter_mut().for_each(|entry| *entry /= scale);
        for i in (0..count).filter(|&i| i != k) {
            let (factor, row) = (system[i][k], system[k]);
            system[i].iter_mut().zip(row).for_each(|(entry, other)| *entry -= factor * other);
        }
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
            response.force[i] += self.alpha_h * z[i + 1];
            for j in 0..step.nodes.count() {
                response.d_rate[i][j] += self.alpha_h * tangent[i][j];
            }
        }
    }

    fn commit(&self, step: &Step, state: StateMut) {
        let start = state.variables[0];
        let last = self.solve(step, start).0[step.nodes.count()];
        state.variables[0] = if step.nodes == Nodes::Midpoint { 2.0 * last - start } else { last };
    }

    fn local_errors(&self, step: &Step, state: StateRef, errors: &mut Vec<LocalError>) {
        let (z, _) = self.solve(step, state.variables[0]);
        let defect = step.h * step.quadrature_defect(&self.rates(step, &z));
        // What rounding leaves of a stroke is no error of z.
        let error = if defect <= self.a * step.resolution { 0.0 } else { defect };
        errors.push(LocalError { error, value: z[step.nodes.count()], order: 0.0, sharpness: 1.0 });
    }

    fn powers(&self, step: &Step, state: StateRef, powers: &mut Powers) {
        let (z, _) = self.solve(step, state.variables[0]);
        for (k, power) in powers.iter_mut().enumerate().take(step.nodes.count() + 1) {
            let (z, v) = (z[k], step.rate[k]);
            let lost = z.abs().powf(self.n + 1.0) * (self.gamma * v.abs() + self.beta * v * sign(z));
            power.dissipation += self.alpha_h / self.a * lost;
        }
    }

    fn at(&self, step: &Step, theta: f64, at: &Point, state: StateRef) -> Observation {
        let (z, _) = self.solve(step, state.variables[0]);
        let rates = self.rates(step, &z);
        let moved: f64 = step.quadrature(theta).iter().zip(rates).map(|(weight, rate)| weight * rate).sum();
        self.observation(at, state.variables[0] + step.h * moved)
    }

    fn now(&self, at: &Point, state: StateRef) -> Observation {
        self.observation(at, state.variables[0])
    }

    /// About z = 0, so that at rest it gives no force and small motions meet the spring alpha_h·A.
    fn linearised(&self, _: &Point) -> Term {
        Term { coefficient: self.alpha_h * self.a, order: 0.0 }
    }

    fn guards(&self, at: &Point, take: &mut dyn FnMut(f64)) {
        take(at.rate);
    }

    fn holds(&self) -> Holds {
        // At its largest z it yields.
        if self.alpha_h == 0.0 { Holds::Never } else { Holds::AtTimes }
    }
}

/// Its parameters, in the order of its arguments.
pub(in crate::law) fn params() -> Vec<Param> {
    vec![
        Param::new("alpha_h", "N/m", "force per unit of the hysteretic variable z", Range::NOT_NEGATIVE),
        Param::new("A", "", "rate of z per unit of x' where z = 0", Range { low: f64::MIN_POSITIVE, high: f64::MAX }),
        Param::new("beta", "1/m^n", "shape of the loops", Range::ANY),
        Param::new("gamma", "1/m^n", "shape of the loops, |beta| or more", Range::NOT_NEGATIVE),
        Param::new("n", "", "how sharply it yields", Range { low: 1.0, high: f64::MAX }),
    ]
}

/// What networks know of it.
pub(super) fn kind() -> LeafKind {
    LeafKind {
        name: "bouc-wen",
        equation: "F = alpha_h·z, z' = A·x' − gamma·|x'|·z·|z|^(n−1) − beta·x'·|z|^n",
        params: params(),
        build: LeafBuild::Values(|values, _| {
            let &[alpha_h, a, beta, gamma, n] = values else { unreachable!("values follow params") };
            Ok(Network::leaf(BoucWen::new(alpha_h, a, beta, gamma, n)?))
        }),
    }
}
