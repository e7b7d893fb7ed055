//! A leaf with an inner variable, built from public items alone: Bouc–Wen hysteresis.

use crate::{along, departure, force, slider};
use springpot::collocation::{MAX_NODES, Nodes, quadrature, quadrature_defect};
use springpot::elements::{ElementBank, MemoryRange};
use springpot::fractional::Form;
use springpot::law::{
    Leaf, LocalError, Network, Observation, Point, Powers, Response, Start, State, StateMut, StateRef, StateSize, Step,
    Term,
};

/// F = k z with z' = A v − γ|v| z|z|^{n−1} − β v|z|^n, n = 2 (Wen 1976).
#[derive(Debug, Clone, Copy)]
struct BoucWen {
    k: f64,
    a: f64,
    beta: f64,
    gamma: f64,
}

impl BoucWen {
    fn slope(&self, z: f64, v: f64) -> f64 {
        self.a * v - self.gamma * v.abs() * z * z.abs() - self.beta * v * z * z
    }

    /// ∂z'/∂z and ∂z'/∂v.
    fn slopes(&self, z: f64, v: f64) -> [f64; 2] {
        let along = self.a - self.gamma * v.signum() * z * z.abs() - self.beta * z * z;
        [-2.0 * (self.gamma * v.abs() * z.abs() + self.beta * v * z), along]
    }

    /// z at the start and at the nodes, and ∂z_i/∂v_j: z_i = z_0 + h Σ_j A_ij z'_j by Newton's method.
    fn solve(&self, step: &Step, start: f64) -> ([f64; MAX_NODES + 1], [[f64; MAX_NODES]; MAX_NODES]) {
        let (count, matrix) = (step.nodes.count(), step.nodes.matrix());
        let mut z = [start; MAX_NODES + 1];
        let mut tangent = [[0.0; MAX_NODES]; MAX_NODES];
        for _ in 0..30 {
            // (I − h A diag(∂z'/∂z)) against the residual and against h A diag(∂z'/∂v).
            let mut system = [[0.0; 2 * MAX_NODES + 1]; MAX_NODES];
            for i in 0..count {
                system[i][i] = 1.0;
                let mut residual = start - z[i + 1];
                for j in 0..count {
                    let weight = step.h * matrix[i][j];
                    let [by_z, by_v] = self.slopes(z[j + 1], step.rate[j + 1]);
                    system[i][j] -= weight * by_z;
                    system[i][MAX_NODES + 1 + j] = weight * by_v;
                    residual += weight * self.slope(z[j + 1], step.rate[j + 1]);
                }
                system[i][MAX_NODES] = residual;
            }
            for k in 0..count {
                let pivot = system[k][k];
                system[k].iter_mut().for_each(|entry| *entry /= pivot);
                for i in (0..count).filter(|&i| i != k) {
                    let (factor, row) = (system[i][k], system[k]);
                    system[i].iter_mut().zip(row).for_each(|(entry, other)| *entry -= factor * other);
                }
            }
            let mut change = 0.0f64;
            for i in 0..count {
                z[i + 1] += system[i][MAX_NODES];
                change = change.max(system[i][MAX_NODES].abs());
                tangent[i] = std::array::from_fn(|j| system[i][MAX_NODES + 1 + j]);
            }
            if change < 1e-15 {
                break;
            }
        }
        (z, tangent)
    }

    fn rates(&self, step: &Step, z: &[f64; MAX_NODES + 1]) -> [f64; MAX_NODES + 1] {
        let mut rates = [0.0; MAX_NODES + 1];
        for (k, rate) in rates.iter_mut().enumerate().take(step.nodes.count() + 1) {
            *rate = self.slope(z[k], step.rate[k]);
        }
        rates
    }

    fn observation(&self, at: &Point, z: f64) -> Observation {
        let stored = Some(0.5 * self.k * z * z / self.a);
        Observation { derivative: at.stroke, regular: self.k * z, singular: 0.0, stored }
    }
}

impl Leaf for BoucWen {
    fn size(&self) -> StateSize {
        StateSize { memories: 0, variables: 1 }
    }

    fn begin(&self, _: &Start, state: &mut State) -> Result<(), springpot::fractional::KernelError> {
        state.push_variable(0.0);
        Ok(())
    }

    fn evaluate(&self, step: &Step, state: StateRef, response: &mut Response) {
        let (z, tangent) = self.solve(step, state.variables[0]);
        for i in 0..step.nodes.count() {
            response.force[i] += self.k * z[i + 1];
            for j in 0..step.nodes.count() {
                response.d_rate[i][j] += self.k * tangent[i][j];
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
        let error = step.h * quadrature_defect(self.rates(step, &z));
        errors.push(LocalError { error, value: z[step.nodes.count()], order: 0.0, sharpness: 1.0 });
    }

    fn powers(&self, step: &Step, state: StateRef, powers: &mut Powers) {
        let (z, _) = self.solve(step, state.variables[0]);
        for (k, power) in powers.iter_mut().enumerate().take(step.nodes.count() + 1) {
            let (z, v) = (z[k], step.rate[k]);
            let lost = z.abs().powi(3) * (self.gamma * v.abs() + self.beta * v * z.signum());
            power.dissipation += self.k / self.a * lost;
        }
    }

    fn at(&self, step: &Step, theta: f64, at: &Point, state: StateRef) -> Observation {
        let (z, _) = self.solve(step, state.variables[0]);
        let rates = self.rates(step, &z);
        let moved: f64 = quadrature(step.nodes, theta).iter().zip(rates).map(|(weight, rate)| weight * rate).sum();
        self.observation(at, state.variables[0] + step.h * moved)
    }

    fn now(&self, at: &Point, state: StateRef) -> Observation {
        self.observation(at, state.variables[0])
    }

    fn linearised(&self, _: &Point) -> Term {
        Term { coefficient: self.k * self.a, order: 0.0 }
    }
}

/// For β = γ and n = 2: away from 0, z = Z tanh(κ x) with Z² = A/(2γ), κ² = 2γA; back to 0 along a straight line of slope A.
fn closed_form(leaf: &BoucWen, path: impl Iterator<Item = f64>) -> Vec<f64> {
    let (top, kappa) = ((leaf.a / (2.0 * leaf.gamma)).sqrt(), (2.0 * leaf.gamma * leaf.a).sqrt());
    let (mut x, mut z) = (0.0f64, 0.0f64);
    let mut values = Vec::new();
    for next in path {
        // In two parts where z passes 0 on the way.
        let mut left = next - x;
        if z * left < 0.0 {
            let to_zero = (-z / leaf.a).abs().min(left.abs()).copysign(left);
            z += leaf.a * to_zero;
            left -= to_zero;
        }
        if left != 0.0 {
            z = top * ((z / top).atanh() + kappa * left).tanh();
        }
        x = next;
        values.push(leaf.k * z);
    }
    values
}

#[test]
fn loops_follow_the_closed_form() {
    let leaf = BoucWen { k: 50.0, a: 1.0, beta: 300.0, gamma: 300.0 };
    // The closed form follows every turn: x is sampled finely in between, turning points among the samples.
    let run = slider(&[Network::leaf(leaf)], &along("0.1*sin(t)"), 10.0, 200, 1e-9);
    let fine = 400;
    let quarter = std::f64::consts::FRAC_PI_2;
    let mut times: Vec<f64> = (1..=200 * fine).map(|k| k as f64 * 0.05 / fine as f64).collect();
    times.extend((0..4).map(|k| quarter * f64::from(2 * k + 1)).filter(|t| *t < 10.0));
    times.sort_by(f64::total_cmp);
    let forces = closed_form(&leaf, times.iter().map(|t| 0.1 * t.sin()));
    let at = |t: f64| {
        if t == 0.0 { 0.0 } else { forces[times.partition_point(|time| *time < t - 1e-9)] }
    };
    let exact: Vec<f64> = run.t().iter().map(|t| at(*t)).collect();
    let error = departure(&force(&run), &exact);
    assert!(error < 1e-7, "{error:e} in {} steps", run.effort());
    assert!(run.residual() < 1e-6, "{:e}", run.residual());
    let lost = run.column("e0.dissipated");
    assert!(lost.windows(2).all(|pair| pair[1] >= pair[0] - 1e-12) && lost[200] > 0.1, "{}", lost[200]);
}

#[test]
fn it_moves_a_robot_and_stands_in_networks() {
    let leaf = BoucWen { k: 50.0, a: 1.0, beta: 300.0, gamma: 300.0 };
    let forward = "kind = \"forward\"\nstart = { q = { q = 0.1 }, v = { q = 1 } }";
    let beside = Network::parallel([Network::leaf(leaf), Network::spring(20.0)]);
    let apart = slider(&[Network::leaf(leaf), Network::spring(20.0)], forward, 2.0, 20, 1e-9);
    let together = slider(&[beside], forward, 2.0, 20, 1e-9);
    assert!(departure(&force(&together), &force(&apart)) < 1e-7);
    assert!(together.residual() < 1e-6, "{:e}", together.residual());
    // Behind a stiff spring it is nearly what it is alone.
    let behind = Network::series([Network::leaf(leaf), Network::spring(5e7)]);
    let [alone, behind] = [Network::leaf(leaf), behind].map(|law| slider(&[law], &along("0.1*sin(t)"), 4.0, 40, 1e-9));
    let error = departure(&force(&behind), &force(&alone));
    assert!(error < 1e-5, "{error:e}");
}

/// In steps whose node stands for their middle an inner variable goes on to their ends.
#[test]
fn steps_with_one_node_converge() {
    let leaf = BoucWen { k: 50.0, a: 1.0, beta: 300.0, gamma: 300.0 };
    let (x, end) = (|t: f64| 0.1 * t.sin(), 1.5);
    let forces = closed_form(&leaf, (1..=6000).map(|k| x(end * f64::from(k) / 6000.0)));
    for (nodes, order) in [(Nodes::One, 0.9), (Nodes::Midpoint, 1.8)] {
        let error = |steps: u32| {
            let h = end / f64::from(steps);
            let mut bank = ElementBank::new(vec![Network::leaf(leaf)], nodes, Form::Strokes);
            let memory = MemoryRange { tolerance: 1e-9, shortest: h, horizon: end };
            bank.begin(&[Start { stroke: 0.0, jump: 0.0, inputs: &[] }], memory).unwrap();
            let mut worst = 0.0f64;
            for n in 0..steps {
                let (t, from, to) = (f64::from(n) * h, x(f64::from(n) * h), x(f64::from(n + 1) * h));
                bank.start(t, h);
                bank.set(0, 0, from, t.cos() * 0.1, &[]);
                let c = nodes.positions()[0];
                bank.set(0, 1, from + c * (to - from), (to - from) / h, &[]);
                bank.evaluate();
                let at = ((t + c * h) / end * 6000.0).round() as usize;
                worst = worst.max((bank.force(0) - forces[at - 1]).abs());
                bank.commit();
            }
            worst
        };
        let found = (error(150) / error(600)).log2() / 2.0;
        assert!(found > order, "{nodes:?}: order {found}");
    }
}
