//! Designs whose optimum is known by other means: an absorber on a mass that was struck.

use springpot::law::Catalog;
use springpot::system::Stop;
use springpot_run::design::{Designed, design};
use springpot_scenario::Scenario;
use std::path::Path;

const MASSES: [f64; 2] = [10.0, 1.0];
const STIFFNESS: f64 = 1000.0;
const END: f64 = 6.0;
const STEP: f64 = 5e-3;

const STRUCK: &str = r#"
robot.gravity = [0, 0, 0]
[[robot.body]]
name = "main"
joint = { name = "x", kind = "prismatic", axis = [1, 0, 0] }
mass = 10
[[robot.body]]
name = "absorber"
joint = { name = "r", kind = "prismatic", axis = [1, 0, 0] }
mass = 1
[[element]]
name = "base"
joint = "x"
law = "spring"
parameters = { k = 1000 }
[[element]]
name = "pad"
joint = "r"
law = "kelvin-voigt"
parameters = { k = 60, c = 1.5 }
[motion]
kind = "forward"
start = { v = { x = 1 } }
[time]
end = 6
output_step = 0.005
[solver]
rtol = 1e-7
[[metric]]
name = "ring"
of = "q.x"
kind = "rms"
[[metric]]
name = "travel"
of = "q.r"
kind = "rms"
"#;

const C: &str = "[[parameter]]\nname = \"c\"\npath = \"element.pad.c\"\nbounds = [0.2, 20]\n";
const K: &str = "[[parameter]]\nname = \"k\"\npath = \"element.pad.k\"\nbounds = [20, 400]\n";

/// The rms of both coordinates over the rows for k and c of the absorber, by the classical Runge–Kutta method with two steps a row.
fn struck([k, c]: [f64; 2]) -> [f64; 2] {
    let slope = |s: &[f64; 4]| {
        let [x, r, v, w] = *s;
        let pull = -(k * r + c * w);
        let a = (-STIFFNESS * x - pull) / MASSES[0];
        [v, w, a, pull / MASSES[1] - a]
    };
    let along = |s: &[f64; 4], d: &[f64; 4], h: f64| std::array::from_fn(|i| s[i] + h * d[i]);
    let (mut s, h, mut sums) = ([0.0, 0.0, 1.0, 0.0], 0.5 * STEP, [0.0; 2]);
    let rows = (END / STEP).round() as usize;
    for row in 1..=rows {
        for _ in 0..2 {
            let a = slope(&s);
            let b = slope(&along(&s, &a, 0.5 * h));
            let c = slope(&along(&s, &b, 0.5 * h));
            let d = slope(&along(&s, &c, h));
            s = std::array::from_fn(|i| s[i] + h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]));
        }
        let weight = if row == rows { 0.5 } else { 1.0 };
        sums.iter_mut().zip(s).for_each(|(sum, x)| *sum += weight * x * x);
    }
    sums.map(|sum| (sum * STEP / END).sqrt())
}

/// Where a function of one valley is least, by golden sections.
fn least([mut low, mut high]: [f64; 2], of: impl Fn(f64) -> f64) -> f64 {
    let share = 0.5 * (5f64.sqrt() - 1.0);
    while high - low > 1e-6 * high {
        let (one, other) = (high - share * (high - low), low + share * (high - low));
        if of(one) < of(other) { high = other } else { low = one }
    }
    0.5 * (low + high)
}

fn designed(text: &str) -> Designed {
    let scenario = Scenario::parse(text, "a.toml", Path::new(".")).unwrap_or_else(|refusals| panic!("{refusals}"));
    let found = design(&scenario, &Catalog::standard(), (None, 1), &Stop::new(false));
    let found = found.unwrap_or_else(|refusals| panic!("{refusals}"));
    assert_eq!(found.status, "converged");
    let runs: Vec<usize> = found.starts.iter().map(|start| start.runs).collect();
    println!("{:?} after {runs:?} runs", found.values);
    assert!(runs.iter().all(|runs| *runs < 40), "{runs:?}");
    found
}

fn is_near(found: &[f64], exact: &[f64]) {
    for (found, exact) in found.iter().zip(exact) {
        assert!((found / exact - 1.0).abs() < 5e-4, "{found} for {exact}");
    }
}

#[test]
fn the_oracle_knows_the_metrics_of_runs() {
    let found = designed(&format!("{STRUCK}{C}[design]\nminimise = \"ring\"\nstarts = 1\n"));
    let [ring, _] = struck([60.0, found.values[0]]);
    assert!((found.after / ring - 1.0).abs() < 1e-6, "{} for {ring}", found.after);
    is_near(&found.values, &[least([0.2, 20.0], |c| struck([60.0, c])[0])]);
}

#[test]
fn two_parameters_find_the_optimum_from_every_start() {
    let found = designed(&format!("{STRUCK}{K}{C}[design]\nminimise = \"ring\"\nstarts = 4\n"));
    let damping = |k: f64| least([0.2, 20.0], |c| struck([k, c])[0]);
    let k = least([20.0, 400.0], |k| struck([k, damping(k)])[0]);
    is_near(&found.values, &[k, damping(k)]);
    for start in &found.starts {
        assert_eq!(start.status, "converged");
        is_near(&start.values, &found.values);
    }
}

/// The absorber may move by so much that the limit is active, and k and c are where the limit is met best.
#[test]
fn a_limit_that_is_active_is_met_where_it_costs_least() {
    let limit = 0.05;
    let text = format!(
        "{STRUCK}{K}{C}[design]\nminimise = \"ring\"\nstarts = 4\nconstraints = [{{ metric = \"travel\", max = {limit} }}]\n"
    );
    let found = designed(&text);
    // The more damping, the less it moves.
    let damping = |k: f64| {
        let (mut low, mut high) = (0.2, 20.0);
        while high - low > 1e-8 * high {
            let middle = 0.5 * (low + high);
            if struck([k, middle])[1] > limit { low = middle } else { high = middle }
        }
        high
    };
    let k = least([20.0, 400.0], |k| struck([k, damping(k)])[0]);
    is_near(&found.values, &[k, damping(k)]);
    let (_, value, _, is_active, multiplier) = &found.constraints[0];
    assert!(*is_active && *multiplier > 0.0 && (value / limit - 1.0).abs() < 1e-5, "{:?}", found.constraints);
}
