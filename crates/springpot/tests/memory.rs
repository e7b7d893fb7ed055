//! The memory against reference derivatives, its orders of convergence, and the identities it must keep.

use springpot::fractional::{Form, Kind, Memory, Nodes, RatePolynomial, StepStart, step::RADAU_NODES};

/// How a step's polynomial is made.
#[derive(Clone, Copy, Debug)]
enum Interpolation {
    Rates,
    Strokes,
    Hermite,
    Linear,
}

fn polynomial(kind: Interpolation, t: f64, h: f64, x: &dyn Fn(f64) -> f64, v: &dyn Fn(f64) -> f64) -> RatePolynomial {
    let at = |f: &dyn Fn(f64) -> f64| -> Vec<f64> { [0.0].iter().chain(&RADAU_NODES).map(|c| f(t + c * h)).collect() };
    match kind {
        Interpolation::Rates => RatePolynomial::through_rates(h, Nodes::Radau, &at(v)),
        Interpolation::Strokes => RatePolynomial::through_strokes(h, Nodes::Radau, &at(x)),
        Interpolation::Hermite => RatePolynomial::hermite(h, [x(t), x(t + h)], [v(t), v(t + h)]),
        Interpolation::Linear => RatePolynomial::through_strokes(h, Nodes::One, &[x(t), x(t + h)]),
    }
}

/// D^alpha x at the times of `grid` (starting at 0).
fn march(
    memory: &mut Memory,
    kind: Interpolation,
    grid: &[f64],
    x: &dyn Fn(f64) -> f64,
    v: &dyn Fn(f64) -> f64,
) -> Vec<f64> {
    grid.windows(2)
        .map(|w| {
            let (t, h) = (w[0], w[1] - w[0]);
            let step = polynomial(kind, t, h, x, v);
            let start = StepStart { t, h, stroke: x(t), rate: v(t) };
            let value = memory.derivative(&start, &step, 1.0, x(w[1]), v(w[1]));
            memory.commit(&step);
            value
        })
        .collect()
}

fn uniform(end: f64, count: usize) -> Vec<f64> {
    (0..=count).map(|k| end * k as f64 / count as f64).collect()
}

/// Task A of the literature table: 0.7 sin 8t + 0.1 t.
fn task_a(t: f64) -> f64 {
    0.7 * (8.0 * t).sin() + 0.1 * t
}

fn task_a_rate(t: f64) -> f64 {
    5.6 * (8.0 * t).cos() + 0.1
}

struct Reference {
    t: f64,
    alpha: f64,
    caputo: f64,
    riemann_liouville: f64,
}

fn references(name: &str) -> Vec<Reference> {
    let text = include_str!("../../../testdata/fractional/derivatives.json");
    let file: serde_json::Value = serde_json::from_str(text).unwrap();
    let number = |row: &serde_json::Value, key: &str| row[key].as_str().unwrap().parse::<f64>().unwrap();
    file["functions"][name]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| Reference {
            t: number(row, "t"),
            alpha: number(row, "alpha"),
            caputo: number(row, "caputo"),
            riemann_liouville: number(row, "rl"),
        })
        .collect()
}

#[test]
fn orders_of_convergence() {
    let references = references("0.7*sin(8t)+0.1*t");
    for alpha in [0.1, 0.5, 0.9] {
        let exact = references.iter().find(|r| r.alpha == alpha && r.t == 10.0).unwrap().caputo;
        for (kind, theory, counts) in [
            (Interpolation::Rates, 5.0 - alpha, [400, 800]),
            (Interpolation::Strokes, 4.0 - alpha, [800, 1600]),
            (Interpolation::Hermite, 4.0 - alpha, [800, 1600]),
            (Interpolation::Linear, 2.0 - alpha, [4000, 8000]),
        ] {
            let error = |count: usize| {
                let h = 10.0 / count as f64;
                let mut memory = Memory::new(alpha, Kind::Caputo, 0.0, 0.0, 1e-12, RADAU_NODES[0] * h, 10.0).unwrap();
                let values = march(&mut memory, kind, &uniform(10.0, count), &task_a, &task_a_rate);
                (values[count - 1] - exact).abs()
            };
            let (coarse, fine) = (error(counts[0]), error(counts[1]));
            println!("{alpha} {kind:?}: {coarse:.2e} {fine:.2e} order {:.2} theory {theory}", (coarse / fine).log2());
        }
    }
}
