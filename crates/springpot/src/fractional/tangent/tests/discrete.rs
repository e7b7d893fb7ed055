//! The derivative of a memory is that of the memory replayed: steps, modes and shares held.

use super::super::{EnergyTangent, MemoryTangent, Singular, TangentEnd, TangentPoint, TangentSeeds, TangentStep};
use super::Dice;
use super::replay::{C, Replay, TINY, real};
use crate::collocation::{Nodes, Places};
use crate::fractional::step::SEXTIC;
use crate::fractional::{Form, Kind, Memory, StepStart};

/// What the parameters move: α, the amplitude, the frequency, x(0), and all of these at once.
const DIRECTIONS: [[f64; 4]; 6] = [
    [1.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
    [0.0, 0.0, 0.0, 1.0],
    [-0.7, 0.3, 0.2, -1.1],
    [0.0, 0.0, 0.0, 0.0],
];

/// x = x(0) + a sin ωt + t², x' with it.
#[derive(Clone, Copy)]
struct Motion {
    amplitude: C,
    frequency: C,
    origin: C,
}

impl Motion {
    fn along(direction: &[f64; 4]) -> Self {
        let [_, amplitude, frequency, origin] = *direction;
        Self {
            amplitude: C::new(0.4, amplitude * TINY),
            frequency: C::new(7.0, frequency * TINY),
            origin: C::new(0.3, origin * TINY),
        }
    }

    fn stroke(&self, t: f64) -> C {
        self.origin + self.amplitude * (self.frequency * t).sin() + t * t
    }

    fn rate(&self, t: f64) -> C {
        self.amplitude * self.frequency * (self.frequency * t).cos() + 2.0 * t
    }
}

/// How steps are taken.
#[derive(Clone, Copy)]
struct Manner {
    nodes: Nodes,
    form: Form,
    places: Option<[f64; 3]>,
    pays: bool,
    singular: Singular,
    is_prepared: bool,
}

const RADAU: Manner = Manner {
    nodes: Nodes::Radau,
    form: Form::Rates,
    places: None,
    pays: true,
    singular: Singular::Moments,
    is_prepared: true,
};

/// Largest differences over their largest values, one for each kind of answer.
#[derive(Default)]
struct Answers {
    misses: [f64; 6],
    largest: [f64; 6],
}

impl Answers {
    fn take(&mut self, kind: usize, found: &[f64], replayed: &[C]) {
        for (found, exact) in found.iter().zip(replayed) {
            let exact = exact.im / TINY;
            assert!(found.is_finite() && exact.is_finite(), "answer {kind}: {found}, not {exact}");
            self.misses[kind] = self.misses[kind].max((found - exact).abs());
            self.largest[kind] = self.largest[kind].max(exact.abs());
        }
    }

    fn check(&self, what: &str, bound: f64) {
        for (kind, (miss, largest)) in self.misses.iter().zip(self.largest).enumerate() {
            assert!(*miss <= bound * largest, "{what}, answer {kind}: {miss:e} of {largest:e}");
        }
    }
}

fn memory(alpha: f64, kind: Kind) -> Memory {
    Memory::new(alpha, kind, 0.3, 0.3, 1e-11, 1e-3, 8.0).unwrap()
}

/// Runs memory, derivative and replays side by side over these steps.
fn run(alpha: f64, kind: Kind, steps: &[f64], manner: &Manner) -> Answers {
    let mut memory = memory(alpha, kind);
    let count = DIRECTIONS.len();
    let seed = |k: usize| DIRECTIONS.map(|direction| direction[k]);
    let seeds = TangentSeeds { alpha: &seed(0), origin: &seed(3), jump: &seed(3) };
    let mut tangent = MemoryTangent::new(&memory, &seeds).unwrap();
    let motions = DIRECTIONS.map(|direction| Motion::along(&direction));
    let mut replays: Vec<Replay> = DIRECTIONS
        .iter()
        .zip(motions)
        .map(|(direction, motion)| Replay::of(&memory, direction[0], motion.origin, motion.origin))
        .collect();
    go(&mut memory, &mut tangent, &mut replays, &motions, steps, manner, count)
}

fn go(
    memory: &mut Memory,
    tangent: &mut MemoryTangent,
    replays: &mut [Replay],
    motions: &[Motion],
    steps: &[f64],
    manner: &Manner,
    count: usize,
) -> Answers {
    let mut answers = Answers::default();
    let places = manner.places.map(Places::new);
    let Manner { nodes, form, singular, .. } = *manner;
    let mut t = 0.0;
    for &h in steps {
        let positions: Vec<f64> =
            std::iter::once(0.0).chain(places.map_or(nodes.positions().to_vec(), |p| p.positions().to_vec())).collect();
        let plain = motions[count - 1];
        let strokes: Vec<Vec<C>> =
            positions.iter().map(|c| motions.iter().map(|m| m.stroke(t + c * h)).collect()).collect();
        let rates: Vec<Vec<C>> =
            positions.iter().map(|c| motions.iter().map(|m| m.rate(t + c * h)).collect()).collect();
        let parts = |values: &[Vec<C>]| -> Vec<f64> { values.iter().flatten().map(|value| value.im / TINY).collect() };
        let (delta_stroke, delta_rate) = (parts(&strokes), parts(&rates));
        let start = StepStart { t, h, stroke: strokes[0][0].re, rate: rates[0][0].re };
        let mut step = TangentStep {
            start,
            nodes,
            places: places.as_ref(),
            form,
            polynomial: crate::fractional::RatePolynomial::cubic(h, [0.0; 4]),
        };
        // u is linear in the data: that of one parameter is the real and the imaginary part.
        let [stroke, rate] = [&strokes, &rates].map(|all| all.iter().map(|values| values[0].re).collect::<Vec<_>>());
        let mut u = [0.0; SEXTIC];
        step.delta_polynomial(&stroke, &rate, &mut u[..step.coefficients()]);
        step.polynomial.u = u;
        let mut delta_u = vec![0.0; step.coefficients() * count];
        step.delta_polynomial(&delta_stroke, &delta_rate, &mut delta_u);
        let u_of = |j: usize| -> [C; SEXTIC] {
            std::array::from_fn(|p| C::new(u[p], delta_u.get(p * count + j).map_or(0.0, |delta| delta * TINY)))
        };

        if manner.is_prepared {
            memory.prepare_at(&start, nodes, places.as_ref(), form);
        }
        let point = |theta: f64| {
            let t = t + theta * h;
            let delta = |f: &dyn Fn(&Motion) -> C| -> Vec<f64> { motions.iter().map(|m| f(m).im / TINY).collect() };
            (delta(&|m| m.stroke(t)), delta(&|m| m.rate(t)), plain.stroke(t).re, plain.rate(t).re)
        };
        let (stroke_0, rate_0, x, v) = point(0.0);
        let first = TangentPoint { stroke: x, rate: v, delta_stroke: &stroke_0, delta_rate: &rate_0 };
        let mut explicit = vec![0.0; nodes.count() * count];
        tangent.explicit(memory, &step, singular, &first, &mut explicit);
        let affine = memory.respond_at(&start, nodes, places.as_ref(), form);
        for j in 0..count {
            let exact = replays[j].respond(&step, &u_of(j), singular);
            let found: Vec<f64> = (0..nodes.count())
                .map(|i| {
                    let own = |k: usize| {
                        affine.stroke[i][k] * delta_stroke[(k + 1) * count + j]
                            + affine.rate[i][k] * delta_rate[(k + 1) * count + j]
                    };
                    explicit[i * count + j] + (0..nodes.count()).map(own).sum::<f64>()
                })
                .collect();
            answers.take(0, &found, &exact);
        }
        for theta in [0.0, 0.37, 0.9, 1.0] {
            let (delta_stroke, delta_rate, stroke, rate) = point(theta);
            let at = TangentPoint { stroke, rate, delta_stroke: &delta_stroke, delta_rate: &delta_rate };
            let mut found = [const { Vec::new() }; 3].map(|_: Vec<f64>| vec![0.0; count]);
            let [derivative, stored, dissipation] = &mut found;
            if theta > 0.0 {
                tangent.at(memory, &step, theta, &at, &delta_u, derivative);
            }
            tangent.energy(memory, &step, theta, &at, &delta_u, &mut EnergyTangent { stored, dissipation });
            for j in 0..count {
                let rate = motions[j].rate(t + theta * h);
                if theta > 0.0 {
                    answers.take(1, &found[0][j..=j], &[replays[j].at(&step, &u_of(j), theta, rate)]);
                }
                if !memory.is_singular() {
                    let [stored, dissipation] = replays[j].energy(&step, &u_of(j), theta, rate);
                    answers.take(2, &found[1][j..=j], &[stored]);
                    answers.take(3, &found[2][j..=j], &[dissipation]);
                }
            }
        }
        let (end_stroke, end_rate, stroke, _) = point(1.0);
        let end = TangentEnd { stroke, delta_stroke: &end_stroke, resolution: 1e-16 };
        let pays = manner.pays && form == Form::Rates;
        for (j, replay) in replays.iter_mut().enumerate() {
            replay.commit(memory, &step, &u_of(j), pays.then(|| (motions[j].stroke(t + h), end.resolution)));
        }
        tangent.commit(memory, &step, &delta_u, pays.then_some(&end));
        if pays {
            memory.commit_rates(&step.polynomial, places.as_ref(), stroke, end.resolution);
        } else {
            memory.commit_at(&step.polynomial, places.as_ref());
        }
        t += h;
        let mut now = vec![0.0; count];
        tangent.now(memory, &end_stroke, &end_rate, &mut now);
        let mut singular = vec![0.0; count];
        tangent.singular_part(memory, t, &mut singular);
        for (j, replay) in replays.iter().enumerate() {
            answers.take(4, &now[j..=j], &[replay.now]);
            answers.take(5, &singular[j..=j], &[replay.singular_part(t)]);
        }
    }
    answers
}

/// Steps between 0.004 and 0.1 in any order.
fn random_steps(seed: u64, count: usize) -> Vec<f64> {
    let mut dice = Dice(seed);
    (0..count).map(|_| 0.004 * 25f64.powf(dice.roll())).collect()
}

/// What strokes tell beside rates is a small difference of large factors, which know some digits less.
const FORMS: [(Form, f64); 2] = [(Form::Rates, 1e-12), (Form::Hermite, 5e-11)];

#[test]
fn of_random_steps() {
    for (k, alpha) in [0.02, 0.2, 0.5, 0.8, 0.95].into_iter().enumerate() {
        for kind in [Kind::Caputo, Kind::RiemannLiouville] {
            let steps = random_steps(k as u64 + 1, 40);
            for (form, tolerance) in FORMS {
                let manner = Manner { form, ..RADAU };
                run(alpha, kind, &steps, &manner).check(&format!("{alpha} {kind:?} {form:?}"), tolerance);
            }
        }
    }
}

#[test]
fn of_all_nodes_and_forms() {
    let steps = random_steps(11, 25);
    for kind in [Kind::Caputo, Kind::RiemannLiouville] {
        for nodes in [Nodes::One, Nodes::Midpoint, Nodes::Radau, Nodes::Inner] {
            for form in [Form::Rates, Form::Strokes] {
                for singular in [Singular::Moments, Singular::Values, Singular::Apart] {
                    let manner = Manner { nodes, form, singular, is_prepared: form == Form::Rates, ..RADAU };
                    run(0.4, kind, &steps, &manner).check(&format!("{kind:?} {nodes:?} {form:?} {singular:?}"), 1e-12);
                }
            }
        }
        for (form, tolerance) in [(Form::Rates, 1e-12), (Form::Strokes, 1e-12), (Form::Hermite, 5e-11)] {
            let manner = Manner { places: Some([0.11, 0.7, 1.0]), form, ..RADAU };
            run(0.4, kind, &steps, &manner).check(&format!("{kind:?} elsewhere {form:?}"), tolerance);
        }
    }
}

/// Steps shrink by 10⁶, so that modes come, and grow again, so that they go.
#[test]
fn of_kernels_that_change() {
    let mut steps = random_steps(5, 8);
    steps.extend((0..12).map(|k| 1e-8 * 1.5f64.powi(k)));
    steps.extend([1e-8, 3e-8, 0.05, 0.06, 1e-6, 0.05, 0.1, 0.1]);
    for alpha in [0.1, 0.5, 0.9] {
        for is_prepared in [true, false] {
            // Rounding of strokes counts with h^−α.
            for (form, tolerance) in [(Form::Rates, 1e-12), (Form::Hermite, 2e-8)] {
                let manner = Manner { is_prepared, form, ..RADAU };
                run(alpha, Kind::Caputo, &steps, &manner).check(&format!("{alpha} {form:?}"), tolerance);
            }
        }
    }
}

#[test]
fn a_jump_is_the_singular_start_of_its_time() {
    let size = [0.0, 0.3, 0.0, -0.2, 0.1, 0.0];
    let mut memory = memory(0.6, Kind::Caputo);
    let seed = |k: usize| DIRECTIONS.map(|direction| direction[k]);
    let seeds = TangentSeeds { alpha: &seed(0), origin: &seed(3), jump: &[0.0; 6] };
    let mut tangent = MemoryTangent::new(&memory, &seeds).unwrap();
    let motions = DIRECTIONS.map(|direction| Motion::along(&direction));
    let mut replays: Vec<Replay> = DIRECTIONS
        .iter()
        .zip(motions)
        .map(|(direction, motion)| Replay::of(&memory, direction[0], motion.origin, real(0.0)))
        .collect();
    // Strokes move with the jump: no debt is paid for it here.
    let manner = Manner { pays: false, ..RADAU };
    tangent.jump(&memory, 0.0, &size);
    replays.iter_mut().zip(size).for_each(|(replay, size)| replay.jumps.push((0.0, C::new(0.0, size * TINY))));
    // So few and so long steps that it is never folded.
    let steps = [0.02, 0.02, 0.04, 0.1];
    go(&mut memory, &mut tangent, &mut replays, &motions, &steps, &manner, 6).check("a jump", 1e-12);
}

#[test]
fn of_what_was_held() {
    for alpha in [0.1, 0.5, 0.9] {
        let age = 0.7;
        let moved_age = [0.0, 0.0, 0.0, 0.0, 0.4, 0.0];
        let mut memory = Memory::new(alpha, Kind::RiemannLiouville, 0.3, 0.3, 1e-11, 1e-13 * age, 8.0).unwrap();
        let seed = |k: usize| DIRECTIONS.map(|direction| direction[k]);
        let seeds = TangentSeeds { alpha: &seed(0), origin: &seed(3), jump: &seed(3) };
        let mut tangent = MemoryTangent::new(&memory, &seeds).unwrap();
        let motions = DIRECTIONS.map(|direction| Motion::along(&direction));
        let mut replays: Vec<Replay> = DIRECTIONS
            .iter()
            .zip(motions)
            .map(|(direction, motion)| Replay::of(&memory, direction[0], motion.origin, motion.origin))
            .collect();
        tangent.age(&memory, age, &moved_age);
        memory.age(age);
        replays.iter_mut().zip(moved_age).for_each(|(replay, moved)| replay.age(C::new(age, moved * TINY)));
        let mut now = [0.0; 6];
        tangent.now(&memory, &[0.0; 6], &[0.0; 6], &mut now);
        for (found, replay) in now.iter().zip(&replays) {
            let exact = replay.now.im / TINY;
            assert!((found - exact).abs() < 1e-13 * (1.0 + exact.abs()), "{found} {exact}");
        }
        let steps = random_steps(3, 20);
        go(&mut memory, &mut tangent, &mut replays, &motions, &steps, &RADAU, 6).check(&format!("held {alpha}"), 1e-12);
    }
}
