//! One step of Radau IIA(5) in the accelerations: stages, Newton iteration, error estimate.

use super::tableau::{A, A_SQUARED, ESTIMATE, GAMMA, LEFT, RIGHT};
use crate::dynamics::{
    Kinematics, Pair, PairForce, RneaDerivatives, Workspace, pair_into, rnea_derivatives_into, rnea_into,
};
use crate::fractional::step::{MAX_NODES, RADAU_NODES, lagrange_row};
use crate::fractional::{Form, Nodes};
use crate::law::{InputValue, Response, Singular, State, Step};
use crate::model::Model;
use crate::motion::{Drive, Forward};
use crate::signal::Signal;
use crate::simulate::lu::Lu;
use crate::simulate::moment::FRICTION_SPEED;
use crate::simulate::{RunError, System};
use serde::{Deserialize, Serialize};

/// Newton iterations after which a step is given up.
const MOST_ITERATIONS: u32 = 10;

/// Above this stiffness a springpot of order below ½ takes its polynomial through strokes, which is stable however stiff.
const STIFF: f64 = 10.0;

/// Tolerances of positions and velocities.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tolerance {
    pub(super) rtol: f64,
    pub(super) atol: f64,
}

impl Tolerance {
    pub(super) fn of(&self, size: f64) -> f64 {
        self.atol + self.rtol * size.abs()
    }
}

/// Where a step starts.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Origin {
    pub(super) t: f64,
    pub(super) q: Vec<f64>,
    pub(super) v: Vec<f64>,
    /// Accelerations without the share of a singular start.
    pub(super) a: Vec<f64>,
    /// Forces of the elements without the share of a singular start, N.
    pub(super) forces: Vec<f64>,
}

/// One element over the step, at its start (0) and at the nodes.
#[derive(Debug, Clone)]
pub(super) struct ElementStage {
    pub(super) stroke: [f64; MAX_NODES + 1],
    pub(super) rate: [f64; MAX_NODES + 1],
    pub(super) inputs: Vec<InputValue>,
    pub(super) resolution: f64,
    pub(super) form: Form,
    pub(super) response: Response,
    pub(super) pairs: [Option<Pair>; MAX_NODES + 1],
    gradients: [Vec<f64>; MAX_NODES + 1],
}

impl ElementStage {
    pub(super) fn law_step(&self, t: f64, h: f64) -> Step<'_> {
        Step {
            t,
            h,
            nodes: Nodes::Radau,
            form: self.form,
            stroke: &self.stroke,
            rate: &self.rate,
            inputs: &self.inputs,
            resolution: self.resolution,
            singular: Singular::Moments,
        }
    }
}

/// The robot at one node.
#[derive(Debug, Clone)]
pub(super) struct Stage {
    pub(super) q: Vec<f64>,
    pub(super) v: Vec<f64>,
    /// Accelerations, the share of a singular start included.
    pub(super) a: Vec<f64>,
    /// Tangent vector from the start of the step.
    xi: Vec<f64>,
    pub(super) xi_rate: Vec<f64>,
    kinematics: Kinematics,
}

/// All that a step takes over from those before it: whatever else a [`Stepper`] holds, every attempt fills anew.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Carried {
    origin: Origin,
    last: Option<(f64, [Vec<f64>; 4])>,
    contraction: f64,
}

/// How a step went.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Outcome {
    /// Error in units of the tolerance, and the velocity with the largest share of it.
    Done { error: f64, worst: usize, iterations: u32 },
    /// The iteration did not converge.
    Diverged { iterations: u32 },
}

/// The step from an [`Origin`].
pub(super) struct Stepper<'a> {
    system: &'a System,
    model: &'a Model,
    forward: &'a Forward,
    tolerance: Tolerance,
    rtol: f64,
    /// Velocities that no signal prescribes.
    pub(super) free: Vec<usize>,
    pub(super) origin: Origin,
    pub(super) stages: [Stage; MAX_NODES],
    pub(super) elements: Vec<ElementStage>,
    /// Accelerations at the start and at the nodes without the share of a singular start: what the cubic goes through.
    pub(super) regular: [Vec<f64>; MAX_NODES + 1],
    /// Step size and coefficients of the last cubic, from which the next one is foretold.
    last: Option<(f64, [Vec<f64>; 4])>,
    start: Kinematics,
    workspace: Workspace,
    slopes: RneaDerivatives,
    newton: Lu,
    filter: Lu,
    residual: Vec<f64>,
    tau: Vec<f64>,
    pairs: Vec<PairForce>,
    /// Actuator forces of the free velocities at the nodes.
    drives: [Vec<f64>; MAX_NODES],
    /// Ratio of successive increments, carried from step to step.
    contraction: f64,
}

impl<'a> Stepper<'a> {
    pub(super) fn new(system: &'a System, forward: &'a Forward, tolerance: Tolerance, rtol: f64) -> Self {
        let model = &system.model;
        let (nq, nv) = (model.nq(), model.nv());
        let mut free = Vec::new();
        for (j, drive) in model.own_joints().zip(&forward.drives) {
            if matches!(drive, Drive::Force(_)) {
                free.extend(model.v_range(j));
            }
        }
        let stage = Stage {
            q: vec![0.0; nq],
            v: vec![0.0; nv],
            a: vec![0.0; nv],
            xi: vec![0.0; nv],
            xi_rate: vec![0.0; nv],
            kinematics: Kinematics::new(model),
        };
        let elements = system.elements.iter().map(|element| ElementStage {
            stroke: [0.0; MAX_NODES + 1],
            rate: [0.0; MAX_NODES + 1],
            inputs: vec![InputValue::default(); (MAX_NODES + 1) * element.inputs.len()],
            resolution: 0.0,
            form: Form::Rates,
            response: Response::default(),
            pairs: [None; MAX_NODES + 1],
            gradients: std::array::from_fn(|_| vec![0.0; nv]),
        });
        let origin = Origin {
            t: 0.0,
            q: forward.q.clone(),
            v: forward.v.clone(),
            a: vec![0.0; nv],
            forces: vec![0.0; system.elements.len()],
        };
        Self {
            system,
            model,
            forward,
            tolerance,
            rtol,
            free,
            origin,
            stages: std::array::from_fn(|_| stage.clone()),
            elements: elements.collect(),
            regular: std::array::from_fn(|_| vec![0.0; nv]),
            last: None,
            start: Kinematics::new(model),
            workspace: Workspace::new(model),
            slopes: RneaDerivatives::new(model),
            newton: Lu::default(),
            filter: Lu::default(),
            residual: Vec::new(),
            tau: vec![0.0; nv],
            pairs: Vec::new(),
            drives: Default::default(),
            contraction: 0.0,
        }
    }

    /// Tries the step of size `h`; nothing but scratch changes. Inputs at the end are taken at `t_end`.
    pub(super) fn attempt(&mut self, h: f64, t_end: f64, laws: &[&State]) -> Result<Outcome, RunError> {
        self.take_inputs(h, t_end)?;
        self.linearise(h)?;
        self.foretell(h);
        self.take_drives(h, t_end)?;
        self.place_stages(h);
        self.respond(h, laws);
        let (count, mut before, mut iterations) = (self.free.len(), f64::INFINITY, 0);
        if count == 0 {
            self.collect_regular();
            return Ok(Outcome::Done { error: 0.0, worst: 0, iterations: 0 });
        }
        if !self.factor(h) {
            return Ok(Outcome::Diverged { iterations: 0 });
        }
        loop {
            iterations += 1;
            self.fill_residual();
            if self.residual.iter().any(|r| !r.is_finite()) {
                return Ok(Outcome::Diverged { iterations });
            }
            let mut change = std::mem::take(&mut self.residual);
            self.newton.solve(&mut change);
            for (stage, change) in self.stages.iter_mut().zip(change.chunks_exact(count)) {
                for (&k, delta) in self.free.iter().zip(change) {
                    stage.a[k] -= delta;
                }
            }
            let size = self.velocity_change(&change, h);
            self.residual = change;
            self.place_stages(h);
            self.respond(h, laws);
            if iterations > 1 {
                self.contraction = size / before;
            }
            if !size.is_finite() || (iterations > 2 && self.contraction >= 1.0) {
                self.contraction = 0.0;
                return Ok(Outcome::Diverged { iterations });
            }
            let theta = self.contraction.clamp(1e-3, 0.9);
            if size * theta / (1.0 - theta) <= self.enough(h) {
                break;
            }
            if iterations == MOST_ITERATIONS {
                return Ok(Outcome::Diverged { iterations });
            }
            before = size;
        }
        self.collect_regular();
        let (error, worst) = self.estimate(h);
        Ok(Outcome::Done { error, worst, iterations })
    }

    /// Goes on to the end of the step that was just attempted.
    pub(super) fn accept(&mut self, h: f64) {
        let cubic = std::array::from_fn(|p| {
            (0..self.model.nv())
                .map(|j| (0..=MAX_NODES).map(|k| lagrange_row(k)[p] * self.regular[k][j]).sum())
                .collect()
        });
        self.last = Some((h, cubic));
        let end = &self.stages[MAX_NODES - 1];
        self.origin.q.copy_from_slice(&end.q);
        self.origin.v.copy_from_slice(&end.v);
        self.origin.a.copy_from_slice(&self.regular[MAX_NODES]);
        for (force, element) in self.origin.forces.iter_mut().zip(&self.elements) {
            *force = element.response.force[MAX_NODES - 1] - element.response.singular[MAX_NODES - 1];
        }
        self.origin.t += h;
    }

    /// What the next step takes over.
    pub(super) fn carried(&self) -> Carried {
        Carried { origin: self.origin.clone(), last: self.last.clone(), contraction: self.contraction }
    }

    /// Goes on from what was carried.
    pub(super) fn restore(&mut self, Carried { origin, last, contraction }: Carried) {
        (self.origin, self.last, self.contraction) = (origin, last, contraction);
    }

    /// A break in the accelerations: nothing can be foretold from what was.
    pub(super) fn forget(&mut self) {
        self.last = None;
    }

    /// Mass, damping and stiffness at the start of the step, and the elements there.
    fn linearise(&mut self, h: f64) -> Result<(), RunError> {
        self.start.update_velocity(self.model, &self.origin.q, &self.origin.v);
        self.pairs.clear();
        for (element, force) in self.system.elements.iter().zip(&self.origin.forces) {
            self.pairs.push(PairForce {
                from: element.from,
                to: element.to,
                force: *force,
                d_length: 0.0,
                d_rate: 0.0,
            });
        }
        let (origin, slopes) = (&self.origin, &mut self.slopes);
        rnea_derivatives_into(self.model, &self.start, &origin.a, &self.pairs, &mut self.workspace, slopes);
        add_resistance_slope(self.model, &origin.v, &mut slopes.d_v);
        let t = origin.t;
        for (element, stage) in self.system.elements.iter().zip(&mut self.elements) {
            let pair = pair_into(self.model, &self.start, &element.from, &element.to, &mut stage.gradients[0]);
            if pair.check().is_err() {
                return Err(RunError::ZeroLength { t, element: element.name.clone(), length: pair.length });
            }
            stage.pairs[0] = Some(pair);
            stage.stroke[0] = pair.length - element.rest_length;
            stage.rate[0] = pair.rate;
            stage.resolution = element.resolution(pair.length);
        }
        self.choose_forms(h);
        Ok(())
    }

    /// Through strokes where the rates would be unstable: order below ½ and h² c (γ_0 h)^−alpha gᵀ M⁻¹ g ≥ 10.
    fn choose_forms(&mut self, h: f64) {
        let yielding = |order: f64| order > 0.0 && order < 0.5;
        if !self.system.elements.iter().any(|element| yielding(element.law.order())) {
            return;
        }
        let shares = self.yield_of_elements();
        for (e, element) in self.system.elements.iter().enumerate() {
            let stage = &mut self.elements[e];
            let order = element.law.order();
            let point = stage.law_step(self.origin.t, h).point(0);
            let coefficient = element.law.force(&point, 1.0) - element.law.force(&point, 0.0);
            let softness: f64 = stage.gradients[0].iter().zip(&shares[e]).map(|(g, s)| -g * s).sum();
            let stiff = yielding(order) && h * h * coefficient * (GAMMA * h).powf(-order) * softness >= STIFF;
            stage.form = if stiff { Form::Strokes } else { Form::Rates };
        }
    }

    /// First guess of the stages' accelerations: the last cubic goes on.
    fn foretell(&mut self, h: f64) {
        for (stage, c) in self.stages.iter_mut().zip(RADAU_NODES) {
            match &self.last {
                Some((size, cubic)) => {
                    let theta = 1.0 + c * (h / size).min(4.0);
                    for (j, a) in stage.a.iter_mut().enumerate() {
                        *a = cubic.iter().rev().fold(0.0, |sum, u| sum * theta + u[j]);
                    }
                }
                None => stage.a.copy_from_slice(&self.origin.a),
            }
        }
    }

    fn take_inputs(&mut self, h: f64, t_end: f64) -> Result<(), RunError> {
        let t = self.origin.t;
        for (element, stage) in self.system.elements.iter().zip(&mut self.elements) {
            let count = element.inputs.len();
            for k in 0..=MAX_NODES {
                let at = if k == 0 {
                    t
                } else if k == MAX_NODES {
                    t_end
                } else {
                    t + RADAU_NODES[k - 1] * h
                };
                let values = &mut stage.inputs[k * count..(k + 1) * count];
                element.inputs_at(at, values);
                element.check_inputs(at, values)?;
            }
        }
        Ok(())
    }

    /// What drives the joints at the nodes.
    fn take_drives(&mut self, h: f64, t_end: f64) -> Result<(), RunError> {
        let t = self.origin.t;
        for (stage, (c, drives)) in self.stages.iter_mut().zip(RADAU_NODES.into_iter().zip(&mut self.drives)) {
            let at = if c == 1.0 { t_end } else { t + c * h };
            drives.clear();
            for (j, drive) in self.model.own_joints().zip(&self.forward.drives) {
                let (range, v) = (self.model.q_range(j), self.model.v_range(j));
                match drive {
                    Drive::Force(signals) => {
                        for signal in signals {
                            drives.push(force_at(self.model, j, signal, at)?);
                        }
                    }
                    Drive::Prescribed(path) => {
                        path.at(at, &mut stage.q[range], &mut stage.v[v.clone()], &mut stage.a[v]);
                    }
                    Drive::Locked => stage.a[v].fill(0.0),
                }
            }
        }
        Ok(())
    }

    /// Positions and velocities of the stages from their accelerations, and the elements there.
    fn place_stages(&mut self, h: f64) {
        for i in 0..MAX_NODES {
            for &k in &self.free {
                let push: f64 = (0..MAX_NODES).map(|j| A[i][j] * self.stages[j].a[k]).sum();
                let travel: f64 = (0..MAX_NODES).map(|j| A_SQUARED[i][j] * self.stages[j].a[k]).sum();
                let v = self.origin.v[k];
                self.stages[i].v[k] = v + h * push;
                self.stages[i].xi[k] = h * (RADAU_NODES[i] * v + h * travel);
            }
        }
        if !self.model.is_one_degree() {
            self.bend_tangents(h);
        }
        for i in 0..MAX_NODES {
            let stage = &mut self.stages[i];
            let whole = self.free.len() == self.model.nv();
            if whole {
                self.model.integrate_into(&self.origin.q, &stage.xi, &mut stage.q);
            } else {
                let held = stage.q.clone();
                self.model.integrate_into(&self.origin.q, &stage.xi, &mut stage.q);
                for (j, drive) in self.model.own_joints().zip(&self.forward.drives) {
                    if matches!(drive, Drive::Prescribed(_)) {
                        stage.q[self.model.q_range(j)].copy_from_slice(&held[self.model.q_range(j)]);
                    }
                }
            }
            stage.kinematics.update_velocity(self.model, &stage.q, &stage.v);
            for (element, step) in self.system.elements.iter().zip(&mut self.elements) {
                let gradient = &mut step.gradients[i + 1];
                let pair = pair_into(self.model, &stage.kinematics, &element.from, &element.to, gradient);
                step.pairs[i + 1] = Some(pair);
                step.stroke[i + 1] = pair.length - element.rest_length;
                step.rate[i + 1] = pair.rate;
            }
        }
    }

    /// Floating joints: ξ_i = h Σ_j A_ij J_r⁻¹(ξ_j) v_j, by iteration.
    fn bend_tangents(&mut self, h: f64) {
        for _ in 0..30 {
            for stage in &mut self.stages {
                self.model.tangent_rate_into(&stage.xi, &stage.v, &mut stage.xi_rate);
            }
            let mut change: f64 = 0.0;
            for i in 0..MAX_NODES {
                for &k in &self.free {
                    let xi = h * (0..MAX_NODES).map(|j| A[i][j] * self.stages[j].xi_rate[k]).sum::<f64>();
                    change = change.max((xi - self.stages[i].xi[k]).abs());
                    self.stages[i].xi[k] = xi;
                }
            }
            if change.is_nan() || change <= 4.0 * f64::EPSILON {
                return;
            }
        }
    }

    /// The laws' answers to the stages.
    fn respond(&mut self, h: f64, laws: &[&State]) {
        for ((element, stage), law) in self.system.elements.iter().zip(&mut self.elements).zip(laws) {
            stage.response = element.law.respond(&stage.law_step(self.origin.t, h), law);
        }
    }

    /// RNEA(q_i, v_i, a_i) + resistance − drive, node by node, of the free velocities.
    fn fill_residual(&mut self) {
        self.residual.clear();
        for i in 0..MAX_NODES {
            self.inverse_dynamics(i);
            let forces = self.free.iter().zip(&self.drives[i]);
            self.residual.extend(forces.map(|(&k, drive)| self.tau[k] - drive));
        }
    }

    /// The actuator forces that stage `i` takes, into `tau`.
    fn inverse_dynamics(&mut self, i: usize) {
        self.pairs.clear();
        for (element, stage) in self.system.elements.iter().zip(&self.elements) {
            let force = stage.response.force[i];
            self.pairs.push(PairForce { from: element.from, to: element.to, force, d_length: 0.0, d_rate: 0.0 });
        }
        let stage = &self.stages[i];
        rnea_into(self.model, &stage.q, &stage.v, &stage.a, &self.pairs, &mut self.workspace, &mut self.tau);
        add_resistance(self.model, &stage.v, &mut self.tau);
    }

    /// I⊗M + hA⊗D + h²A²⊗K + Σ (h² G A² + h P A)⊗ggᵀ over the free velocities.
    fn factor(&mut self, h: f64) -> bool {
        let (n, count, free) = (self.model.nv(), self.free.len(), &self.free);
        let (slopes, elements) = (&self.slopes, &self.elements);
        let size = MAX_NODES * count;
        let product = |x: &[[f64; 3]; 3], y: &[[f64; 3]; 3], i: usize, j: usize| -> f64 {
            (0..MAX_NODES).map(|m| x[i][m] * y[m][j]).sum()
        };
        self.newton.factor(size, |matrix| {
            for i in 0..MAX_NODES {
                for j in 0..MAX_NODES {
                    let (damping, stiffness) = (h * A[i][j], h * h * A_SQUARED[i][j]);
                    for (r, &row) in free.iter().enumerate() {
                        let line = &mut matrix[(i * count + r) * size + j * count..][..count];
                        for (entry, &column) in line.iter_mut().zip(free) {
                            let at = row * n + column;
                            *entry = damping * slopes.d_v[at] + stiffness * slopes.d_q[at];
                            if i == j {
                                *entry += slopes.d_a[at];
                            }
                        }
                    }
                    for element in elements {
                        let response = &element.response;
                        let factor = h * h * product(&response.d_stroke, &A_SQUARED, i, j)
                            + h * product(&response.d_rate, &A, i, j);
                        let g = &element.gradients[0];
                        for (r, &row) in free.iter().enumerate() {
                            let line = &mut matrix[(i * count + r) * size + j * count..][..count];
                            for (entry, &column) in line.iter_mut().zip(free) {
                                *entry += factor * g[row] * g[column];
                            }
                        }
                    }
                }
            }
        })
    }

    /// rms over stages and velocities of |h Σ_j A_ij Δa_j| in units of the velocities' tolerance.
    fn velocity_change(&self, change: &[f64], h: f64) -> f64 {
        let count = self.free.len();
        let mut sum = 0.0;
        for row in &A {
            for (r, &k) in self.free.iter().enumerate() {
                let moved: f64 = (0..MAX_NODES).map(|j| row[j] * change[j * count + r]).sum();
                sum += (h * moved / self.tolerance.of(self.origin.v[k])).powi(2);
            }
        }
        (sum / (MAX_NODES * count) as f64).sqrt()
    }

    /// When the iteration may stop: a share of the tolerance, not below rounding.
    fn enough(&self, h: f64) -> f64 {
        let largest = self.free.iter().fold(0.0, |m: f64, &k| m.max(self.stages[MAX_NODES - 1].a[k].abs()));
        self.rtol.sqrt().min(0.03) + 2e-14 * (1.0 + h * largest) / self.tolerance.atol
    }

    /// Accelerations without what a singular start adds: a_i − s σ_i with s σ = −M⁻¹ Σ g F_singular.
    fn collect_regular(&mut self) {
        self.regular[0].copy_from_slice(&self.origin.a);
        for i in 0..MAX_NODES {
            self.regular[i + 1].copy_from_slice(&self.stages[i].a);
        }
        if self.elements.iter().all(|element| element.response.singular == [0.0; MAX_NODES]) {
            return;
        }
        let share = self.yield_of_elements();
        for i in 0..MAX_NODES {
            for (e, element) in self.elements.iter().enumerate() {
                for &k in &self.free {
                    self.regular[i + 1][k] -= share[e][k] * element.response.singular[i];
                }
            }
        }
    }

    /// −M(q)⁻¹ g of every element at the start of the step: the accelerations that a unit of its force gives.
    pub(super) fn yield_of_elements(&self) -> Vec<Vec<f64>> {
        let (n, free, slopes) = (self.model.nv(), &self.free, &self.slopes);
        let count = free.len();
        let mut mass = Lu::default();
        mass.factor(count, |m| {
            (0..count * count).for_each(|k| m[k] = slopes.d_a[free[k / count] * n + free[k % count]])
        });
        self.elements
            .iter()
            .map(|element| {
                let mut x: Vec<f64> = free.iter().map(|&k| -element.gradients[0][k]).collect();
                mass.solve(&mut x);
                let mut full = vec![0.0; n];
                free.iter().zip(x).for_each(|(&k, x)| full[k] = x);
                full
            })
            .collect()
    }

    /// The embedded estimate, filtered by the linearised equations of motion; rms in units of the tolerance.
    fn estimate(&mut self, h: f64) -> (f64, usize) {
        let (n, count) = (self.model.nv(), self.free.len());
        let step = h * GAMMA;
        let raw = |start: f64, at: [f64; 3]| -> f64 {
            h * (GAMMA * start + ESTIMATE.iter().zip(at).map(|(e, x)| e * x).sum::<f64>())
        };
        let r_v: Vec<f64> =
            self.free.iter().map(|&k| raw(self.regular[0][k], [1, 2, 3].map(|i| self.regular[i][k]))).collect();
        let r_q: Vec<f64> =
            self.free.iter().map(|&k| raw(self.origin.v[k], [0, 1, 2].map(|i| self.stages[i].v[k]))).collect();
        // K with the elements' stiffness as the scheme sees it: lᵀ G r + lᵀ P r/(h γ_0).
        let (free, slopes) = (&self.free, &self.slopes);
        let mut stiffness: Vec<f64> =
            (0..count * count).map(|k| slopes.d_q[free[k / count] * n + free[k % count]]).collect();
        for element in &self.elements {
            let along = |m: &[[f64; 3]; 3]| -> f64 {
                (0..3).map(|i| LEFT[i] * (0..3).map(|j| m[i][j] * RIGHT[j]).sum::<f64>()).sum()
            };
            let k = along(&element.response.d_stroke) + along(&element.response.d_rate) / step;
            let g = &element.gradients[0];
            for r in 0..count {
                for c in 0..count {
                    stiffness[r * count + c] += k * g[free[r]] * g[free[c]];
                }
            }
        }
        let mut e_v = vec![0.0; count];
        for r in 0..count {
            for c in 0..count {
                let mass = slopes.d_a[free[r] * n + free[c]];
                e_v[r] += mass * r_v[c] - step * stiffness[r * count + c] * r_q[c];
            }
        }
        let regular = self.filter.factor(count, |matrix| {
            for (k, entry) in matrix.iter_mut().enumerate() {
                let at = free[k / count] * n + free[k % count];
                *entry = slopes.d_a[at] + step * slopes.d_v[at] + step * step * stiffness[k];
            }
        });
        if !regular {
            return (f64::INFINITY, 0);
        }
        self.filter.solve(&mut e_v);
        let end = &self.stages[MAX_NODES - 1];
        let (mut sum, mut worst, mut largest) = (0.0, 0, -1.0);
        for (r, &k) in self.free.iter().enumerate() {
            let v = self.tolerance.of(self.origin.v[k].abs().max(end.v[k].abs()));
            let q = self.tolerance.of(self.sizes(k));
            let square = (e_v[r] / v).powi(2) + ((r_q[r] + step * e_v[r]) / q).powi(2);
            if square > largest {
                (worst, largest) = (k, square);
            }
            sum += square;
        }
        ((sum / (2 * count) as f64).sqrt(), worst)
    }

    /// The size of the coordinate that velocity `k` moves: 1 for those of a floating joint.
    fn sizes(&self, k: usize) -> f64 {
        if self.model.is_one_degree() { self.origin.q[k].abs().max(self.stages[MAX_NODES - 1].q[k].abs()) } else { 1.0 }
    }
}

/// The actuator force of joint `j` at t.
pub(super) fn force_at(model: &Model, j: usize, signal: &Signal, t: f64) -> Result<f64, RunError> {
    let value = signal.at(t).value;
    if value.is_finite() {
        return Ok(value);
    }
    Err(RunError::NotFinite { t, what: format!("tau.{}", model.joint_names()[j]), value })
}

/// Joint damping and smooth Coulomb friction, added to the actuator forces.
pub(super) fn add_resistance(model: &Model, v: &[f64], tau: &mut [f64]) {
    for_each_resistance(model, v, |index, ratio, resistance, _| tau[index] += ratio * resistance);
}

fn add_resistance_slope(model: &Model, v: &[f64], d_v: &mut [f64]) {
    let n = model.nv();
    for_each_resistance(model, v, |index, ratio, _, slope| d_v[index * n + index] += ratio * ratio * slope);
}

/// Hands velocity index, ratio, resistance and its slope of every joint of one degree to `visit`.
fn for_each_resistance(model: &Model, v: &[f64], mut visit: impl FnMut(usize, f64, f64, f64)) {
    for j in 0..model.joint_count() {
        let (damping, friction) = (model.damping()[j], model.friction()[j]);
        if model.joint_kind(j).nv() != 1 || (damping == 0.0 && friction == 0.0) {
            continue;
        }
        let (index, ratio) = (model.v_range(j).start, model.followed(j).map_or(1.0, |(_, ratio, _)| ratio));
        let speed = ratio * v[index];
        let sign = (speed / FRICTION_SPEED).tanh();
        let slope = damping + friction * (1.0 - sign * sign) / FRICTION_SPEED;
        visit(index, ratio, damping * speed + friction * sign, slope);
    }
}
