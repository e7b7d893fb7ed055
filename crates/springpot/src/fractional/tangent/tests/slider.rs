//! A slider on a springpot and a spring that meets a wall: derivatives of whole runs against differences of runs, kernels made anew.

use super::super::{MemoryTangent, Singular, TangentEnd, TangentPoint, TangentSeeds, TangentStep};
use crate::collocation::{Nodes, RADAU_NODES};
use crate::fractional::{Form, Kind, Memory, RatePolynomial, StepStart};

/// α, c, k, x(0), x'(0) and the wall; columns of the derivative in this order.
const COUNT: usize = 6;
type Numbers = [f64; COUNT];

/// When the run ends, s, and how much of its speed a blow leaves.
const END: f64 = 0.9;
const RESTITUTION: f64 = 0.7;

/// x'' = −c D^α x − k x between blows.
struct Slider {
    numbers: Numbers,
    memory: Memory,
    tangent: MemoryTangent,
    t: f64,
    x: f64,
    v: f64,
    dx: Numbers,
    dv: Numbers,
}

/// Equations of the rates at the nodes: their factors, and what is known for each column.
type System<const C: usize> = ([[f64; 3]; 3], [[f64; C]; 3]);

fn solved<const C: usize>((mut factors, mut known): System<C>) -> [[f64; C]; 3] {
    for k in 0..3 {
        for i in (0..3).filter(|i| *i != k) {
            let share = factors[i][k] / factors[k][k];
            (0..3).for_each(|j| factors[i][j] -= share * factors[k][j]);
            (0..C).for_each(|j| known[i][j] -= share * known[k][j]);
        }
    }
    std::array::from_fn(|i| known[i].map(|value| value / factors[i][i]))
}

impl Slider {
    fn new(numbers: Numbers, kind: Kind) -> Self {
        let [alpha, _, _, x, v, _] = numbers;
        let unit = |k: usize| -> Numbers { std::array::from_fn(|j| f64::from(u8::from(j == k))) };
        let memory = Memory::new(alpha, kind, x, x, 1e-13, 1e-8, END).unwrap();
        let seeds = TangentSeeds { alpha: &unit(0), origin: &unit(3), jump: &unit(3) };
        let tangent = MemoryTangent::new(&memory, &seeds).unwrap();
        Self { numbers, memory, tangent, t: 0.0, x, v, dx: unit(3), dv: unit(4) }
    }

    /// What a step of h would make: rates at the nodes, the stroke at its end, and D^α x at the nodes.
    fn attempt(&self, h: f64) -> ([f64; 3], f64, [f64; 3]) {
        let [_, c, k, ..] = self.numbers;
        let start = StepStart { t: self.t, h, stroke: self.x, rate: self.v };
        let (affine, matrix) = (self.memory.respond(&start, Nodes::Radau, Form::Rates), Nodes::Radau.matrix());
        let moments = self.memory.singular_moments(&start, Nodes::Radau, None);
        let known: [f64; 3] = std::array::from_fn(|j| {
            affine.history[j] - self.memory.singular_part(start.t + RADAU_NODES[j] * h) + moments[j]
        });
        let right = std::array::from_fn(|i| {
            [self.v - h * (0..3).map(|j| matrix[i][j] * (c * known[j] + k * self.x)).sum::<f64>()]
        });
        let rates = solved((self.factors(h), right)).map(|[v]| v);
        let end = self.x + h * (0..3).map(|j| matrix[2][j] * rates[j]).sum::<f64>();
        let derivative = std::array::from_fn(|i| known[i] + (0..3).map(|j| affine.rate[i][j] * rates[j]).sum::<f64>());
        (rates, end, derivative)
    }

    /// v_i + h Σ_j A_ij (c Σ_k R_jk v_k + k h Σ_k A_jk v_k).
    fn factors(&self, h: f64) -> [[f64; 3]; 3] {
        let [_, c, k, ..] = self.numbers;
        let start = StepStart { t: self.t, h, stroke: self.x, rate: self.v };
        let (affine, matrix) = (self.memory.respond(&start, Nodes::Radau, Form::Rates), Nodes::Radau.matrix());
        std::array::from_fn(|i| {
            std::array::from_fn(|l| {
                let own = (0..3).map(|j| matrix[i][j] * (c * affine.rate[j][l] + k * h * matrix[j][l])).sum::<f64>();
                h * own + f64::from(u8::from(i == l))
            })
        })
    }

    fn step(&mut self, h: f64) {
        let [_, c, k, ..] = self.numbers;
        let start = StepStart { t: self.t, h, stroke: self.x, rate: self.v };
        self.memory.prepare(&start, Nodes::Radau, Form::Rates);
        let (rates, end, derivative) = self.attempt(h);
        let matrix = Nodes::Radau.matrix();
        let polynomial = RatePolynomial::through_rates(h, Nodes::Radau, &[self.v, rates[0], rates[1], rates[2]]);
        let step = TangentStep { start, nodes: Nodes::Radau, places: None, form: Form::Rates, polynomial };
        let mut explicit = [0.0; 3 * COUNT];
        let point = TangentPoint { stroke: self.x, rate: self.v, delta_stroke: &self.dx, delta_rate: &self.dv };
        self.tangent.explicit(&self.memory, &step, Singular::Moments, &point, &mut explicit);
        let strokes: [f64; 3] =
            std::array::from_fn(|i| self.x + h * (0..3).map(|j| matrix[i][j] * rates[j]).sum::<f64>());
        // δ(c D + k x) where the rates at the nodes are held.
        let known = |j: usize, p: usize| {
            let own = [0.0, derivative[j], strokes[j], 0.0, 0.0, 0.0];
            c * explicit[j * COUNT + p] + k * self.dx[p] + own[p]
        };
        let right = std::array::from_fn(|i| {
            std::array::from_fn(|p| self.dv[p] - h * (0..3).map(|j| matrix[i][j] * known(j, p)).sum::<f64>())
        });
        let delta = solved::<COUNT>((self.factors(h), right));
        (0..COUNT).for_each(|p| self.dx[p] += h * (0..3).map(|j| matrix[2][j] * delta[j][p]).sum::<f64>());
        let delta_rate: Vec<f64> = self.dv.iter().chain(delta.as_flattened()).copied().collect();
        let mut delta_u = [0.0; 4 * COUNT];
        step.delta_polynomial(&[], &delta_rate, &mut delta_u);
        let last = TangentEnd { stroke: end, delta_stroke: &self.dx, resolution: 1e-17 };
        self.tangent.commit(&self.memory, &step, &delta_u, Some(&last));
        self.memory.commit_rates(&polynomial, None, end, 1e-17);
        (self.t, self.x, self.v, self.dv) = (self.t + h, end, rates[2], delta[2]);
    }

    /// A blow: x' turns round, and the derivative of x jumps with the time of the blow.
    fn bounce(&mut self) {
        let [_, c, k, ..] = self.numbers;
        let a = -c * (self.memory.now(self.x, self.v) + self.memory.singular_part(self.t)) - k * self.x;
        let (before, after) = (self.v, -RESTITUTION * self.v);
        let mut jump = [0.0; COUNT];
        for p in 0..COUNT {
            let later = -(self.dx[p] - f64::from(u8::from(p == 5))) / before;
            jump[p] = (before - after) * later;
            self.dx[p] += jump[p];
            self.dv[p] = -RESTITUTION * (self.dv[p] + a * later) - a * later;
        }
        self.v = after;
        self.tangent.jump(&self.memory, self.t, &jump);
    }

    /// x, x' and their derivatives at the end, and how often it hit the wall.
    fn run(mut self) -> ([f64; 2], [Numbers; 2], usize) {
        let (mut since, mut blows) = (0.0, 0);
        while self.t < END {
            // What begins like a power of time is resolved at any scale.
            let h = (0.2 * (self.t - since)).clamp(1e-6, 0.01).min(END - self.t);
            let beyond = |h: f64| self.attempt(h).1 < self.numbers[5];
            if self.t == since || !beyond(h) {
                self.step(h);
                self.t = if END - self.t < 1e-14 { END } else { self.t };
                continue;
            }
            let (mut low, mut high) = (0.0, h);
            for _ in 0..80 {
                let middle = 0.5 * (low + high);
                if beyond(middle) { high = middle } else { low = middle }
            }
            self.step(high);
            self.bounce();
            (since, blows) = (self.t, blows + 1);
        }
        ([self.x, self.v], [self.dx, self.dv], blows)
    }
}

/// Largest difference of tangents and differences, over the largest of a column.
fn check(numbers: Numbers, kind: Kind, blows: usize, bound: f64) {
    let (_, found, count) = Slider::new(numbers, kind).run();
    assert!(count >= blows, "{count} blows");
    for p in 0..COUNT {
        let h = 1e-3;
        let at = [-2.0, -1.0, 1.0, 2.0].map(|k| {
            let mut moved = numbers;
            moved[p] += k * h * if p < 3 { numbers[p] } else { 0.3 };
            Slider::new(moved, kind).run().0
        });
        let width = 12.0 * h * if p < 3 { numbers[p] } else { 0.3 };
        let largest = (0..2).map(|q| found[q][p].abs()).fold(1e-3, f64::max);
        for q in 0..2 {
            let difference = (at[0][q] - 8.0 * at[1][q] + 8.0 * at[2][q] - at[3][q]) / width;
            let miss = (found[q][p] - difference).abs();
            assert!(
                miss <= bound * largest,
                "{numbers:?} {kind:?} {p}: {} {difference}, {miss:e} of {largest:e}",
                found[q][p]
            );
        }
    }
}

#[test]
fn derivatives_of_runs_are_their_differences() {
    for alpha in [0.3, 0.5, 0.9] {
        for kind in [Kind::Caputo, Kind::RiemannLiouville] {
            check([alpha, 5.0, 30.0, 0.1, 1.0, -10.0], kind, 0, 1e-9);
        }
    }
}

#[test]
fn behind_a_blow_too() {
    for alpha in [0.3, 0.5, 0.8] {
        check([alpha, 5.0, 30.0, 0.1, -1.0, -0.05], Kind::Caputo, 1, 1e-8);
    }
}
