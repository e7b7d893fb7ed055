//! The memory against reference derivatives, its orders of convergence, and the identities it must keep.

use crate::steps::{Interpolation, march, random_steps, uniform};
use crate::support::oracle::{file, number};
use crate::support::{largest, truth::Truth};
use springpot::collocation::{Nodes, RADAU_NODES};
use springpot::fractional::gamma::gamma;
use springpot::fractional::{Form, Kind, Memory, RatePolynomial, StepStart};

const ALPHAS: [f64; 3] = [0.1, 0.5, 0.9];

fn memory(alpha: f64, first: f64, end: f64) -> Memory {
    Memory::new(alpha, Kind::Caputo, 0.0, 0.0, 1e-12, RADAU_NODES[0] * first, end).unwrap()
}

/// 0.7 sin 8t + 0.1 t.
fn task(t: f64) -> f64 {
    0.7 * (8.0 * t).sin() + 0.1 * t
}

fn task_rate(t: f64) -> f64 {
    5.6 * (8.0 * t).cos() + 0.1
}

#[test]
fn orders_of_convergence() {
    for alpha in ALPHAS {
        let truth = Truth::new(alpha, 2.0, 0.1, &[]);
        for (kind, theory, coarsest) in [
            (Interpolation::Rates, 5.0 - alpha, 80),
            (Interpolation::Strokes, 4.0 - alpha, 160),
            (Interpolation::Hermite, 4.0 - alpha, 160),
            (Interpolation::Linear, 2.0 - alpha, 640),
        ] {
            // The largest error over forty common times, so that no lucky point makes the order.
            let exact: Vec<f64> = (1..=40).map(|k| truth.caputo(0.05 * f64::from(k), &task_rate)).collect();
            let error = |count: usize| {
                let grid = uniform(2.0, count);
                let values = march(&mut memory(alpha, grid[1], 2.0), kind, &grid, &task, &task_rate);
                let every = count / 40;
                let errors = exact.iter().enumerate().map(|(k, exact)| (values[(k + 1) * every - 1] - exact).abs());
                errors.fold(0.0, f64::max)
            };
            let errors = [1, 2, 4].map(|k| error(k * coarsest));
            let orders = [(errors[0] / errors[1]).log2(), (errors[1] / errors[2]).log2()];
            println!("alpha {alpha} {kind:?}: errors {errors:?}, orders {orders:.2?}, theory {theory}");
            assert!(errors[2] > 2e-12, "alpha = {alpha}, {kind:?}: rounding, not the order, is measured: {errors:?}");
            for order in orders {
                assert!((order - theory).abs() < 0.25, "alpha = {alpha}, {kind:?}: order {order:.2}, theory {theory}");
            }
        }
    }
}

/// A reference function: its name in the file, x, x' and the step at which its error has vanished.
type Function = (&'static str, fn(f64) -> f64, fn(f64) -> f64, f64);

const FUNCTIONS: [Function; 4] = [
    ("0.7*sin(8t)+0.1*t", task, task_rate, 1.0 / 800.0),
    ("1+sin(3t)", |t| 1.0 + (3.0 * t).sin(), |t| 3.0 * (3.0 * t).cos(), 1.0 / 400.0),
    ("cos(3t)", |t| (3.0 * t).cos(), |t| -3.0 * (3.0 * t).sin(), 1.0 / 400.0),
    ("exp(-t)", |t| (-t).exp(), |t| -(-t).exp(), 1.0 / 400.0),
];

#[test]
fn reference_derivatives() {
    let file = file("fractional/derivatives.json");
    let mut compared = 0;
    for (name, x, rate, h) in FUNCTIONS {
        let rows = file["functions"][name].as_array().unwrap();
        for alpha in ALPHAS {
            let rows: Vec<_> = rows.iter().filter(|row| number(&row["alpha"]) == alpha).collect();
            let largest = largest(&rows.iter().map(|row| number(&row["caputo"])).collect::<Vec<_>>());
            let grid = uniform(50.0, (50.0 / h).round() as usize);
            for kind in [Kind::Caputo, Kind::RiemannLiouville] {
                let mut memory = Memory::new(alpha, kind, x(0.0), x(0.0), 1e-12, RADAU_NODES[0] * h, 50.0).unwrap();
                let values = march(&mut memory, Interpolation::Rates, &grid, &x, &rate);
                for row in &rows {
                    let (t, caputo, rl) = (number(&row["t"]), number(&row["caputo"]), number(&row["rl"]));
                    let exact = if kind == Kind::Caputo { caputo } else { rl };
                    let value = values[(t / h).round() as usize - 1];
                    let error = (value - exact).abs();
                    // The singular term is larger than anything else at small t.
                    let tolerance = 5e-12 * largest + 1e-14 * (rl - caputo).abs();
                    assert!(error < tolerance, "{name}, alpha = {alpha}, {kind:?}, t = {t}: {error:.1e} of {largest}");
                    compared += 1;
                }
            }
        }
    }
    // 4 functions · 20 times · 3 orders · 2 kinds
    assert_eq!(compared, 480);
}

#[test]
fn reference_powers() {
    // The cubic of the rates holds x' up to t³ exactly; x' = 5t⁴ misses it by 5h⁴|θ(θ − c₁)(θ − c₂)(θ − 1)| ≤ 0.2h⁴ in every step.
    let file = file("fractional/derivatives.json");
    let mut compared = 0;
    for (power, miss) in [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (5.0, 0.2)] {
        let (x, rate) =
            (move |t: f64| t.powf(power), move |t: f64| if power == 0.0 { 0.0 } else { power * t.powf(power - 1.0) });
        let h = 0.01;
        let grid = uniform(50.0, 5000);
        for alpha in ALPHAS {
            let mut memory = Memory::new(alpha, Kind::Caputo, x(0.0), 0.0, 1e-12, RADAU_NODES[0] * h, 50.0).unwrap();
            let values = march(&mut memory, Interpolation::Rates, &grid, &x, &rate);
            for row in file["powers_t^k"].as_array().unwrap() {
                if number(&row["k"]) != power || number(&row["alpha"]) != alpha {
                    continue;
                }
                let (t, exact) = (number(&row["t"]), number(&row["caputo"]));
                let error = (values[(t / h).round() as usize - 1] - exact).abs();
                let tolerance = 2e-12 * exact.abs() + miss * h.powf(5.0 - alpha);
                assert!(error <= tolerance, "t^{power}, alpha = {alpha}, t = {t}: {error:.1e} of {exact:.1e}");
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 4 * 3 * 20);
}

/// Strokes and rates at 0 and at the nodes of a step.
fn samples(t: f64, h: f64, f: &dyn Fn(f64) -> f64, nodes: Nodes) -> Vec<f64> {
    std::iter::once(0.0).chain(nodes.positions().iter().copied()).map(|c| f(t + c * h)).collect()
}

#[test]
fn the_affine_map_is_the_derivative() {
    for alpha in [0.0, 0.05, 0.5, 0.95, 1.0] {
        for kind in [Kind::Caputo, Kind::RiemannLiouville] {
            for (nodes, form) in [
                (Nodes::Radau, Form::Rates),
                (Nodes::Radau, Form::Strokes),
                (Nodes::Radau, Form::Hermite),
                (Nodes::One, Form::Rates),
                (Nodes::One, Form::Strokes),
            ] {
                let x = |t: f64| 0.3 + task(t);
                let mut memory = Memory::new(alpha, kind, 0.3, 0.3, 1e-12, 1e-3, 10.0).unwrap();
                let mut worst = 0.0f64;
                for (t, h) in random_steps(7, 60, 1e-3, 3e-2) {
                    let (stroke, rate) = (samples(t, h, &x, nodes), samples(t, h, &task_rate, nodes));
                    let polynomial = match form {
                        Form::Rates => RatePolynomial::through_rates(h, nodes, &rate),
                        Form::Strokes => RatePolynomial::through_strokes(h, nodes, &stroke),
                        Form::Hermite => RatePolynomial::through_strokes_and_rates(h, None, [&stroke, &rate]),
                    };
                    let start = StepStart { t, h, stroke: stroke[0], rate: rate[0] };
                    let affine = memory.respond(&start, nodes, form);
                    for (i, c) in nodes.positions().iter().enumerate() {
                        let mut sum = affine.history[i];
                        for j in 0..nodes.count() {
                            sum += affine.stroke[i][j] * (stroke[j + 1] - stroke[0]) + affine.rate[i][j] * rate[j + 1];
                        }
                        // At order 1 the strokes are asked for the slope of their polynomial.
                        let rate_there = if form == Form::Strokes { polynomial.rate(*c) } else { rate[i + 1] };
                        let value = memory.derivative(&start, &polynomial, *c, stroke[i + 1], rate_there);
                        worst = worst.max((sum - value).abs() / value.abs().max(1.0));
                    }
                    memory.commit(&polynomial);
                }
                assert!(worst < 2e-12, "alpha = {alpha}, {kind:?}, {nodes:?}, {form:?}: {worst:.1e}");
            }
        }
    }
}

#[test]
fn riemann_liouville_less_caputo_is_the_singular_term() {
    let grid = uniform(5.0, 500);
    let x = |t: f64| 0.4 + task(t);
    for alpha in [0.01, 0.1, 0.5, 0.9, 0.99] {
        let values = |kind: Kind| {
            let mut memory = Memory::new(alpha, kind, 0.4, 0.4, 1e-10, 1e-3, 5.0).unwrap();
            assert_eq!(memory.is_singular(), kind == Kind::RiemannLiouville);
            march(&mut memory, Interpolation::Rates, &grid, &x, &task_rate)
        };
        let (caputo, rl) = (values(Kind::Caputo), values(Kind::RiemannLiouville));
        for (k, t) in grid[1..].iter().enumerate() {
            let term = 0.4 * t.powf(-alpha) / gamma(1.0 - alpha);
            let error = (rl[k] - caputo[k] - term).abs();
            assert!(error < 1e-14 * (rl[k].abs() + caputo[k].abs() + term), "alpha = {alpha}, t = {t}: {error:.1e}");
        }
    }
}

#[test]
fn the_limits_are_a_spring_and_a_dashpot() {
    let grid = uniform(2.0, 200);
    let x = |t: f64| 0.4 + task(t);
    for kind in [Kind::Caputo, Kind::RiemannLiouville] {
        let values = |alpha: f64| {
            let mut memory = Memory::new(alpha, kind, 0.4, 0.4, 1e-12, 1e-3, 2.0).unwrap();
            march(&mut memory, Interpolation::Rates, &grid, &x, &task_rate)
        };
        let (spring, dashpot) = (values(0.0), values(1.0));
        let held = if kind == Kind::Caputo { 0.4 } else { 0.0 };
        for (k, t) in grid[1..].iter().enumerate() {
            assert_eq!(spring[k], x(*t) - held, "{kind:?}, t = {t}");
            assert_eq!(dashpot[k], task_rate(*t), "{kind:?}, t = {t}");
        }
        // Continuity towards them: the gap is linear in the distance of alpha. At order 1 the singular start leaves an impulse
        // that no row sees, and both kinds tend to x'.
        for (limit, reference, sign) in [(0.0, &spring, 1.0), (1.0, &dashpot, -1.0)] {
            let gap = |distance: f64| {
                let rows = values(limit + sign * distance).into_iter().zip(reference).skip(20);
                rows.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest(reference)
            };
            let (near, nearer) = (gap(1e-3), gap(1e-4));
            println!("{kind:?} alpha -> {limit}: gaps {near:.2e} {nearer:.2e}");
            assert!((near / nearer - 10.0).abs() < 0.5, "{kind:?}, alpha -> {limit}: {near:.2e}, {nearer:.2e}");
            assert!(nearer < 2e-3, "{kind:?}, alpha -> {limit}: {nearer:.2e}");
        }
    }
}

#[test]
fn steps_of_any_size_keep_the_accuracy() {
    // 10 ms, then at t = 0.5 down to 1e-10 s and back up, as at an event; delta was chosen for the first step.
    for alpha in [0.01, 0.1, 0.5, 0.9, 0.99, 0.999] {
        let mut grid = uniform(0.5, 50);
        for exponent in [2, 4, 7, 10, 10, 10, 9, 8, 6, 5, 4, 3] {
            for _ in 0..4 {
                grid.push(grid.last().unwrap() + 10f64.powi(-exponent));
            }
        }
        while *grid.last().unwrap() < 1.0 {
            grid.push(grid.last().unwrap() + 0.008);
        }
        let end = *grid.last().unwrap();
        let mut memory = memory(alpha, 1e-2, 2.0);
        let begun = memory.modes();
        let mut most = 0;
        let (mut worst, mut scale) = (0.0f64, 0.0f64);
        let truth = Truth::new(alpha, end, 0.05, &[]);
        for w in grid.windows(2) {
            let value = march(&mut memory, Interpolation::Rates, w, &task, &task_rate)[0];
            let exact = truth.caputo(w[1], &task_rate);
            worst = worst.max((value - exact).abs());
            scale = scale.max(exact.abs());
            most = most.max(memory.modes());
        }
        println!("alpha {alpha}: {:.1e} of the largest, modes {begun} … {most} … {}", worst / scale, memory.modes());
        assert!(worst < 2e-8 * scale, "alpha = {alpha}: {:.1e}", worst / scale);
        assert!(most > begun && memory.modes() < begun + 20, "alpha = {alpha}: {begun} {most} {}", memory.modes());
    }
}

#[test]
fn random_steps_keep_the_accuracy() {
    for alpha in [0.01, 0.1, 0.5, 0.9, 0.999] {
        for seed in [1, 2, 3] {
            let steps = random_steps(seed, 600, 1e-6, 1e-2);
            let mut grid = vec![0.0];
            grid.extend(steps.iter().map(|(t, h)| t + h));
            let end = *grid.last().unwrap();
            let truth = Truth::new(alpha, end, 0.05, &[]);
            let values = march(&mut memory(alpha, 1e-3, end), Interpolation::Rates, &grid, &task, &task_rate);
            let rows = grid[1..].iter().zip(&values).step_by(7);
            let pairs: Vec<(f64, f64)> = rows.map(|(t, v)| (truth.caputo(*t, &task_rate), *v)).collect();
            let scale = largest(&pairs.iter().map(|(exact, _)| *exact).collect::<Vec<_>>());
            let worst = pairs.iter().map(|(exact, v)| (exact - v).abs()).fold(0.0, f64::max);
            assert!(worst < 2e-8 * scale, "alpha = {alpha}, seed {seed}: {:.1e}", worst / scale);
        }
    }
}

fn text(memory: &Memory) -> String {
    serde_json::to_string(memory).unwrap()
}

#[test]
fn written_and_read_memories_go_on_to_the_bit() {
    for alpha in [0.0, 0.3, 0.9, 1.0] {
        let mut memory = Memory::new(alpha, Kind::RiemannLiouville, 0.0, 0.0, 1e-10, 1e-4, 3.0).unwrap();
        let steps: Vec<f64> =
            std::iter::once(0.0).chain(random_steps(5, 80, 1e-7, 3e-2).iter().map(|(t, h)| t + h)).collect();
        march(&mut memory, Interpolation::Rates, &steps[..=40], &task, &task_rate);
        let mut read: Memory = serde_json::from_str(&text(&memory)).unwrap();
        let mut clone = memory.clone();
        let before = text(&clone);
        let rest = march(&mut memory, Interpolation::Rates, &steps[40..], &task, &task_rate);
        let again = march(&mut read, Interpolation::Rates, &steps[40..], &task, &task_rate);
        assert_eq!(rest.len(), 40);
        assert_eq!(rest, again, "alpha = {alpha}");
        assert_eq!(text(&memory), text(&read), "alpha = {alpha}");
        // The clone stayed where it was, and goes the same way.
        assert_eq!(before, text(&clone), "alpha = {alpha}");
        if alpha == 0.3 {
            assert_ne!(before, text(&memory));
        }
        assert_eq!(rest, march(&mut clone, Interpolation::Rates, &steps[40..], &task, &task_rate), "alpha = {alpha}");
    }
}

#[test]
fn asking_changes_nothing() {
    let grid: Vec<f64> =
        std::iter::once(0.0).chain(random_steps(9, 60, 1e-5, 3e-2).iter().map(|(t, h)| t + h)).collect();
    for alpha in [0.2, 0.8] {
        let (mut silent, mut asked) = (memory(alpha, 1e-3, 3.0), memory(alpha, 1e-3, 3.0));
        for w in grid.windows(2) {
            let (t, h) = (w[0], w[1] - w[0]);
            let start = StepStart { t, h, stroke: task(t), rate: task_rate(t) };
            let step = RatePolynomial::through_rates(h, Nodes::Radau, &samples(t, h, &task_rate, Nodes::Radau));
            let before = text(&asked);
            // Trial steps of other sizes, far below and above what is kept, and rows between the nodes.
            for size in [h, 1e-9, 0.3 * h, 1e3 * h] {
                let trial = StepStart { h: size, ..start };
                asked.respond(&trial, Nodes::Radau, Form::Rates);
                asked.respond(&trial, Nodes::One, Form::Strokes);
                for theta in [1e-6, 0.37, 1.0] {
                    asked.derivative(&trial, &RatePolynomial { h: size, ..step }, theta, 0.1, 0.2);
                    asked.derivative_between(&RatePolynomial { h: size, ..step }, theta, 0.1, 0.2);
                    asked.energy(&RatePolynomial { h: size, ..step }, theta, 0.1, 0.2);
                }
                asked.stored(0.1, 0.2);
                asked.defect(&step, [0.0, 0.1], [0.0, 0.1], 1e-16);
            }
            assert_eq!(before, text(&asked));
            let a = march(&mut silent, Interpolation::Rates, w, &task, &task_rate);
            let b = march(&mut asked, Interpolation::Rates, w, &task, &task_rate);
            assert_eq!(a, b, "t = {t}");
        }
        assert_eq!(text(&silent), text(&asked));
    }
}

#[test]
fn the_number_of_modes_stays_bounded() {
    // 10⁵ steps between 1e-6 and 1e-2 s, in bursts, as an adaptive run with many restarts takes them.
    for alpha in [0.1, 0.9] {
        let mut memory = Memory::new(alpha, Kind::Caputo, 0.0, 0.0, 1e-8, RADAU_NODES[0] * 1e-2, 1e3).unwrap();
        let begun = memory.modes();
        let (mut t, mut most) = (0.0, 0);
        for k in 0..100_000 {
            // One step in a hundred is the first of a restart; then the size doubles.
            let h = (1e-6 * 2f64.powi(k % 100)).min(1e-2);
            memory.commit(&RatePolynomial::hermite(h, [task(t), task(t + h)], [task_rate(t), task_rate(t + h)]));
            t += h;
            most = most.max(memory.modes());
        }
        println!("alpha {alpha}: {begun} modes at first, at most {most}, {} at t = {t:.0} s", memory.modes());
        assert!(most < begun + 40, "alpha = {alpha}: {begun} -> {most}");
    }
}
