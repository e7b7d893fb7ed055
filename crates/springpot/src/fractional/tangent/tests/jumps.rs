//! Jumps of a stroke's derivative.

use super::super::{MemoryTangent, Singular, TangentEnd, TangentPoint, TangentSeeds, TangentStep};
use crate::collocation::{Nodes, RADAU_NODES};
use crate::fractional::gamma::reciprocal_gamma;
use crate::fractional::{Form, Kind, Memory, RatePolynomial, StepStart};

/// δx that jumps by 1 at t* and stays: δD^α x is (t − t*)^−α/Γ(1−α) before the jump is folded into the modes and after.
#[test]
fn a_jump_is_a_power_of_its_age() {
    for alpha in [0.1f64, 0.5, 0.9] {
        let mut memory = Memory::new(alpha, Kind::Caputo, 0.0, 0.0, 1e-10, 1e-4, 10.0).unwrap();
        let mut tangent =
            MemoryTangent::new(&memory, &TangentSeeds { alpha: &[0.0], origin: &[0.0], jump: &[0.0] }).unwrap();
        let (h, mut t, at) = (1e-3, 0.0, 0.05);
        let mut was_folded = false;
        for k in 0..2000 {
            let jumped = if k >= 50 { 1.0 } else { 0.0 };
            if k == 50 {
                tangent.jump(&memory, t, &[1.0]);
            }
            let rates: Vec<f64> = [0.0].iter().chain(&RADAU_NODES).map(|c| (9.0 * (t + c * h)).cos()).collect();
            let polynomial = RatePolynomial::through_rates(h, Nodes::Radau, &rates);
            let start = StepStart { t, h, stroke: (9.0 * t).sin() / 9.0, rate: rates[0] };
            let step = TangentStep { start, nodes: Nodes::Radau, places: None, form: Form::Rates, polynomial };
            let point = TangentPoint { stroke: 0.0, rate: 0.0, delta_stroke: &[jumped], delta_rate: &[0.0] };
            let mut explicit = [0.0; 3];
            tangent.explicit(&memory, &step, Singular::Values, &point, &mut explicit);
            t += h;
            let stroke = (9.0 * t).sin() / 9.0;
            // The stroke is owed nothing of the jump, however much the memory pays.
            let end = TangentEnd { stroke, delta_stroke: &[jumped], resolution: 1e-20 };
            tangent.commit(&memory, &step, &[0.0; 4], Some(&end));
            memory.commit_rates(&polynomial, None, stroke, 1e-20);
            let (mut now, mut part) = ([0.0], [0.0]);
            tangent.now(&memory, &[jumped], &[0.0], &mut now);
            tangent.singular_part(&memory, t, &mut part);
            let exact = if jumped == 0.0 { 0.0 } else { (t - at).powf(-alpha) * reciprocal_gamma(1.0 - alpha) };
            for found in [now[0] + part[0], explicit[2]] {
                assert!((found - exact).abs() <= 2e-10 * exact, "{alpha} {t}: {found}, not {exact}");
            }
            was_folded |= k > 50 && part[0] == 0.0;
            assert!(part[0] == 0.0 || t - at < 0.06, "{alpha} {t}: it is never folded");
        }
        assert!(was_folded);
    }
}

/// x'' = −50 D^α x behind a jump of x by 1 at t = 0, in equal steps until t = 1 where the jump is folded behind steps of this part of its
/// age: x(1) and x'(1).
fn oscillator(alpha: f64, count: usize, fold: f64) -> [f64; 2] {
    let mut memory = Memory::new(alpha, Kind::RiemannLiouville, 1.0, 1.0, 1e-13, 1e-5, 1.0).unwrap();
    let (h, stiffness, matrix) = (1.0 / count as f64, 50.0, Nodes::Radau.matrix());
    let (mut x, mut v) = (1.0, 0.0);
    for n in 0..count {
        let start = StepStart { t: n as f64 * h, h, stroke: x, rate: v };
        let affine = memory.respond(&start, Nodes::Radau, Form::Rates);
        let moments = memory.singular_moments(&start, Nodes::Radau, None);
        // v_i + 50h Σ_j A_ij D_j = v_0.
        let mut system = [[0.0; 4]; 3];
        for i in 0..3 {
            system[i][i] = 1.0;
            system[i][3] = v;
            for j in 0..3 {
                let known = affine.history[j] - memory.singular_part(start.t + RADAU_NODES[j] * h) + moments[j];
                system[i][3] -= stiffness * h * matrix[i][j] * known;
                for k in 0..3 {
                    system[i][k] += stiffness * h * matrix[i][j] * affine.rate[j][k];
                }
            }
        }
        let found = solved(system);
        let rates = [v, found[0], found[1], found[2]];
        x += h * (0..3).map(|j| matrix[2][j] * found[j]).sum::<f64>();
        v = found[2];
        memory.commit(&RatePolynomial::through_rates(h, Nodes::Radau, &rates));
        let age = (n + 1) as f64 * h;
        if memory.is_singular() && h <= fold * age {
            memory.age(age);
        }
    }
    [x, v]
}

fn solved(mut system: [[f64; 4]; 3]) -> [f64; 3] {
    for k in 0..3 {
        for i in 0..3 {
            if i != k {
                let factor = system[i][k] / system[k][k];
                (0..4).for_each(|j| system[i][j] -= factor * system[k][j]);
            }
        }
    }
    std::array::from_fn(|i| system[i][3] / system[i][i])
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).abs().max((a[1] - b[1]).abs() / 7.0)
}

/// What folding adds is less than what the same steps err without it.
#[test]
fn a_jump_is_folded_when_it_does_not_matter() {
    for alpha in [0.1, 0.5, 0.9] {
        let exact = oscillator(alpha, 3200, 0.0);
        let steps = 200;
        let apart = oscillator(alpha, steps, 0.0);
        let folded = distance(oscillator(alpha, steps, super::super::jump::FOLD), apart);
        let own = distance(apart, exact);
        assert!(folded < own.max(1e-11), "{alpha}: folding adds {folded:e} to {own:e}");
    }
}

/// The table that the threshold was taken from.
#[test]
#[ignore = "a measurement, for its table"]
fn how_much_folding_adds() {
    for alpha in [0.1, 0.3, 0.5, 0.8, 0.9, 0.98] {
        let exact = oscillator(alpha, 6400, 0.0);
        for count in [100, 200, 400, 800] {
            let apart = oscillator(alpha, count, 0.0);
            let added = [0.3, 0.1, 0.05, 0.03, 0.02, 0.01]
                .map(|fold| format!("{:.1e}", distance(oscillator(alpha, count, fold), apart)));
            println!("alpha {alpha}, {count} steps: errs by {:.1e}; folding adds {added:?}", distance(apart, exact));
        }
    }
}
