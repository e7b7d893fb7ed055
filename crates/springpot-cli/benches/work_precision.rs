//! Work against precision: two seconds of the falling three-body arm by Springpot and by two rivals, side by side in one run.
//!
//! The rivals: the average-acceleration method with an L1 sum over the whole past (in this file, with the same rigid-body
//! algorithms), and SciPy's Radau on the state extended by exponentials (`benches/peers/falling_arm.py`; left out where no `python3`
//! with SciPy is found; another interpreter by the variable PYTHON). Every setting of the printed grids is run; the best ones of
//! each rival make its curve. `-- --figure FILE.svg` (or .png) writes the figure.

mod comparison;

use comparison::{Timed, best, curve, median, save};
use std::hint::black_box;
use std::io::{BufRead, BufReader, Write};
use std::process::{Command, Stdio};
use std::time::Instant;

use springpot::actuation::{Drive, Forward};
use springpot::driver::run;
use springpot::dynamics::{Kinematics, PairForce, RneaDerivatives, Workspace, pair, rnea_derivatives_into, rnea_into};
use springpot::elements::{Line, Measure};
use springpot::fractional::{Kernel, gamma::gamma};
use springpot::law::Catalog;
use springpot::observe::Quantity;
use springpot::signal::Signal;
use springpot::system::{RowTimes, Settings, Stop, System};
use springpot_report::{Panel, Plot};
use springpot_scenario::Scenario;

/// Length of the run, s.
const END: f64 = 2.0;
const ORDERS: [f64; 3] = [0.1, 0.5, 0.9];
/// Steps of the rival with the full history.
const STEPS: [usize; 7] = [250, 500, 1000, 2000, 4000, 10_000, 20_000];
/// Errors of SciPy's kernels, relative, and their shortest lags, s.
const KERNELS: [(f64, f64); 4] = [(1e-5, 1e-3), (1e-7, 1e-4), (1e-8, 1e-5), (1e-9, 1e-6)];

/// One run: seconds, and the largest error of q and v at the end.
#[derive(Clone, Copy)]
struct Point {
    seconds: f64,
    error: f64,
}

impl Timed for Point {
    fn seconds(&self) -> f64 {
        self.seconds
    }

    fn error(&self) -> f64 {
        self.error
    }
}

/// The arm of the shipped scenario at the order `alpha`, left to itself at q = 0.
fn arm(alpha: f64) -> (System, Settings) {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/thermoviscoelastic_order.toml");
    let scenario = Scenario::read(std::path::Path::new(file)).expect("the scenario is there");
    let cases = scenario.cases(&Catalog::standard()).expect("the scenario is right");
    let plan = (0..cases.len())
        .map(|k| cases.plan(k).expect("a case"))
        .find(|plan| plan.elements[0].parameters.contains(&alpha));
    let plan = plan.expect("the order is swept");
    let mut system = plan.system();
    let drives = (0..3).map(|_| Drive::Force(vec![Signal::constant(0.0)])).collect();
    system.motion = Forward { q: vec![0.0; 3], v: vec![0.0; 3], drives }.into();
    let settings = Settings { end: END, rows: RowTimes::Times([END].into()), ..plan.settings.clone() };
    (system, settings)
}

/// q and v at the end, and the seconds of the fastest of `repeats` runs.
fn springpot(system: &System, settings: &Settings, rtol: f64, repeats: usize) -> (f64, Vec<f64>) {
    let memory_rtol = (rtol / 100.0).max(1e-12);
    let settings = Settings { rtol, atol: Some(rtol), memory_rtol, ..settings.clone() };
    let (mut times, mut table) = (Vec::new(), system.table());
    for _ in 0..repeats {
        let begun = Instant::now();
        run(system, &settings, &mut table, &Stop::new(false)).1.expect("the run succeeds");
        times.push(begun.elapsed().as_secs_f64());
    }
    let q = (0..system.model.nq()).map(Quantity::Coordinate);
    let state = q.chain((0..system.model.nv()).map(Quantity::Velocity));
    let last = |quantity| table.value(table.len() - 1, quantity).expect("the row at the end");
    (median(times), state.map(last).collect())
}

/// Average acceleration with D^alpha x by L1 over the whole past: q and v at the end.
fn full_history(system: &System, alpha: f64, steps: usize) -> Vec<f64> {
    let (model, element) = (&system.model, &system.elements[0]);
    let Measure::Line(Line { from, to }) = element.measure else { unreachable!("an element between two points") };
    let h = END / steps as f64;
    let scale = h.powf(-alpha) / gamma(2.0 - alpha);
    let power = |k: usize| (k as f64).powf(1.0 - alpha);
    let weights: Vec<f64> = (0..steps).map(|k| power(k + 1) - power(k)).collect();
    let (k, c, drive) = (50.0, 50.0, 0.0007 * 20.0 * 25.0);
    let stretch = |q: &[f64], v: &[f64]| {
        let (here, gradient) = pair(model, &Kinematics::at_velocity(model, q, v), &from, &to);
        (here.length - element.rest, gradient)
    };
    let (mut q, mut v, mut a) = (vec![0.0; 3], vec![0.0; 3], vec![0.0; 3]);
    let mut workspace = Workspace::new(model);
    let mut slopes = RneaDerivatives::new(model);
    let mut residual = vec![0.0; 3];
    let mut travels: Vec<f64> = Vec::with_capacity(steps);
    let mut before = stretch(&q, &v).0;
    let start = [PairForce { from, to, force: k * before - drive, d_length: 0.0, d_rate: 0.0 }];
    a.copy_from_slice(&springpot::dynamics::aba(model, &q, &v, &[0.0; 3], &start));
    for n in 0..steps {
        let past: f64 = travels.iter().rev().zip(&weights[1..]).map(|(travel, weight)| travel * weight).sum();
        let (q0, v0, a0) = (q.clone(), v.clone(), a.clone());
        for _ in 0..3 {
            for j in 0..3 {
                v[j] = v0[j] + 0.5 * h * (a0[j] + a[j]);
                q[j] = q0[j] + h * v0[j] + 0.25 * h * h * (a0[j] + a[j]);
            }
            let stroke = stretch(&q, &v).0;
            let force = k * stroke + c * scale * (past + stroke - before) - drive;
            let stiffness = k + c * scale;
            let pairs = [PairForce { from, to, force, d_length: stiffness, d_rate: 0.0 }];
            rnea_into(model, &q, &v, &a, &pairs, &mut workspace, &mut residual);
            rnea_derivatives_into(
                model,
                &Kinematics::at_velocity(model, &q, &v),
                &a,
                &pairs,
                &mut workspace,
                &mut slopes,
            );
            let matrix: Vec<f64> =
                (0..9).map(|i| slopes.d_a[i] + 0.5 * h * slopes.d_v[i] + 0.25 * h * h * slopes.d_q[i]).collect();
            let change = solve(&matrix, &residual);
            (0..3).for_each(|j| a[j] -= change[j]);
        }
        let stroke = stretch(&q, &v).0;
        travels.push(stroke - before);
        before = stroke;
        black_box(n);
    }
    [q, v].concat()
}

/// x of a 3 × 3 system by Cramer's rule.
fn solve(m: &[f64], y: &[f64]) -> [f64; 3] {
    let det = |m: &[f64]| {
        m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6])
    };
    let whole = det(m);
    std::array::from_fn(|c| {
        let mut replaced = m.to_vec();
        (0..3).for_each(|r| replaced[3 * r + c] = y[r]);
        det(&replaced) / whole
    })
}

/// SciPy's answers: for each kernel and tolerance of its grid.
fn scipy(alpha: f64, reference: &[f64]) -> Option<Vec<Point>> {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../../benches/peers/falling_arm.py");
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".into());
    let mut child = Command::new(python).arg(script).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().ok()?;
    let (mut input, output) = (child.stdin.take()?, BufReader::new(child.stdout.take()?));
    let mut lines = output.lines();
    let mut points = Vec::new();
    for (tolerance, delta) in KERNELS {
        let kernel = Kernel::new(alpha, tolerance, delta, END).ok()?;
        let case = serde_json::json!({
            "end": END, "rates": kernel.lambda, "weights": kernel.weight, "fast": kernel.fast_tail()[0]
        });
        writeln!(input, "{case}").ok()?;
        loop {
            let line = lines.next()?.ok()?;
            if line == "done" {
                break;
            }
            let numbers: Vec<f64> = line.split(' ').filter_map(|word| word.parse().ok()).collect();
            let point = Point { seconds: numbers[1], error: distance(&numbers[2..8], reference) };
            println!(
                "  scipy, {} modes (kernel {tolerance:.0e} from {delta:.0e} s), rtol {:.0e}: {:9.1} ms, error {:.1e}",
                kernel.modes(),
                numbers[0],
                1e3 * point.seconds,
                point.error
            );
            points.push(point);
        }
    }
    drop(input);
    child.wait().ok()?;
    Some(points)
}

fn distance(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

/// The time to reach `error`, by interpolation between the best points.
fn time_at(points: &[Point], error: f64) -> Option<f64> {
    points.windows(2).find(|w| w[0].error >= error && w[1].error <= error).map(|w| {
        let [a, b] = [w[0], w[1]].map(|p| (p.error.ln(), p.seconds.ln()));
        (a.1 + (b.1 - a.1) * (error.ln() - a.0) / (b.0 - a.0)).exp()
    })
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let figure = arguments.iter().position(|a| a == "--figure").and_then(|k| arguments.get(k + 1));
    let mut panels = Vec::new();
    for alpha in ORDERS {
        println!("order {alpha}");
        let (system, settings) = arm(alpha);
        let reference = springpot(&system, &settings, 1e-13, 1).1;
        let mut own = Vec::new();
        for k in 8..=22 {
            let rtol = 10f64.powf(-0.5 * f64::from(k));
            let (seconds, end) = springpot(&system, &settings, rtol, 15);
            let point = Point { seconds, error: distance(&end, &reference) };
            println!("  springpot, rtol {rtol:.0e}: {:9.3} ms, error {:.1e}", 1e3 * seconds, point.error);
            own.push(point);
        }
        let longer = Settings { end: 10.0, rows: RowTimes::Times([10.0].into()), ..settings.clone() };
        println!("  springpot, 10 s at rtol 1e-8: {:.1} ms", 1e3 * springpot(&system, &longer, 1e-8, 15).0);
        let mut sums = Vec::new();
        for steps in STEPS {
            let begun = Instant::now();
            let end = full_history(&system, alpha, steps);
            let point = Point { seconds: begun.elapsed().as_secs_f64(), error: distance(&end, &reference) };
            println!("  full history, {steps} steps: {:9.1} ms, error {:.1e}", 1e3 * point.seconds, point.error);
            sums.push(point);
        }
        let (own, sums) = (best(own), best(sums));
        let mut curves = vec![curve("Springpot", &own), curve("full-history L1", &sums)];
        let ratio = |what: &str, rival: &[Point], error: f64| {
            if let (Some(theirs), Some(ours)) = (time_at(rival, error), time_at(&own, error)) {
                println!("  {what} at error {error:.0e}: {:.0} times as long", theirs / ours);
            }
        };
        if let Some(points) = scipy(alpha, &reference) {
            let points = best(points);
            ratio("scipy", &points, 1e-6);
            curves.push(curve("SciPy Radau, extended state", &points));
        }
        if let Some(last) = sums.iter().rev().find(|p| p.error >= own.last().map_or(0.0, |p| p.error)) {
            ratio("full history", &sums, last.error);
        }
        panels.push(Panel { title: Some(format!("α = {alpha}")), curves, ..Panel::default() });
    }
    let plot = Plot {
        title: Some("Two seconds of the falling arm".into()),
        x: "log₁₀ of the time, ms".into(),
        y: "log₁₀ of the error of q and v".into(),
        panels,
        ..Plot::default()
    };
    if let Some(file) = figure {
        save(&plot, file);
    }
}
