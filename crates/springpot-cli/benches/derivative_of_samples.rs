//! The half derivative of 0.7 sin 8t + 0.1 t over 10 s from equally spaced samples, by Springpot and by the PyPI
//! packages pycaputo and differint, side by side in one run: time and error over the number of samples.
//!
//! The rivals run in `benches/peers/derivative_of_samples.py`, by `python3` or the interpreter that the variable PYTHON
//! names; a package that is missing is named and left out. All take the same samples, but for the methods of pycaputo
//! that take functions: they are given x exactly. A rival stops at the length that would take longer than `--limit
//! SECONDS` (60) by its growth so far. Times are medians; a method is run once before it is timed. The error is the
//! largest one at 200 times, relative to the largest value; the exact values come from a closed form with an integral
//! that is checked against the reference values of `testdata`. `-- --figure FILE.svg` (or .png) writes the figure.

mod comparison;

use comparison::{Timed, best, curve, median, save};
use std::f64::consts::PI;
use std::io::{BufRead, BufReader, Lines, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Instant;

use springpot::fractional::gamma::gamma;
use springpot::fractional::scheme::{Samples, Scheme};
use springpot::fractional::{Definition, Method as Rule, derivative};
use springpot_report::{Panel, Plot};

const ALPHA: f64 = 0.5;
/// Length of the record, s.
const END: f64 = 10.0;
/// Times at which errors are taken; divides every number of steps.
const CHECKS: usize = 200;
const STEPS: [usize; 10] = [1000, 2000, 5000, 10_000, 20_000, 50_000, 100_000, 200_000, 500_000, 1_000_000];
/// Time given to the repetitions of one method at one length, s.
const REPEATING: f64 = 1.0;
/// Most repetitions.
const REPEATS: usize = 15;

/// One method at one length.
#[derive(Clone, Copy)]
struct Point {
    steps: usize,
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

struct Method {
    label: String,
    points: Vec<Point>,
    /// What ended the row before the longest record.
    end: Option<String>,
}

fn signal(t: f64) -> f64 {
    0.7 * (8.0 * t).sin() + 0.1 * t
}

/// D^alpha of the signal: its steady state, less what the branch cut of s^alpha leaves,
/// sin(πα)/π ∫₀^∞ r^α ω/(r² + ω²) e^−rt dr, by the trapezoidal rule in ln r, which converges exponentially.
fn exact(t: f64) -> f64 {
    let (omega, spacing) = (8.0f64, 0.2);
    let decays = (-400..40).map(|k| {
        let r = (spacing * f64::from(k)).exp();
        r.powf(ALPHA + 1.0) * omega / (r * r + omega * omega) * (-r * t).exp()
    });
    let fade = (PI * ALPHA).sin() / PI * spacing * decays.sum::<f64>();
    0.7 * (omega.powf(ALPHA) * (omega * t + 0.5 * PI * ALPHA).sin() - fade)
        + 0.1 * t.powf(1.0 - ALPHA) / gamma(2.0 - ALPHA)
}

/// Exact values at the check times, after a comparison with the reference values.
fn exact_values() -> Vec<f64> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/fractional/derivatives.json");
    let text = std::fs::read_to_string(path).expect("the reference values are there");
    let file: serde_json::Value = serde_json::from_str(&text).expect("they are JSON");
    let number = |row: &serde_json::Value, key: &str| -> f64 {
        row[key].as_str().and_then(|text| text.parse().ok()).expect("a number")
    };
    let rows = file["functions"]["0.7*sin(8t)+0.1*t"].as_array().expect("the signal is there");
    let rows = rows.iter().filter(|row| number(row, "alpha") == ALPHA);
    let errors = rows.map(|row| (exact(number(row, "t")) - number(row, "caputo")).abs());
    assert!(errors.fold(0.0, f64::max) < 1e-13, "the closed form differs from the reference values");
    (1..=CHECKS).map(|k| exact(END * k as f64 / CHECKS as f64)).collect()
}

fn check_rows(steps: usize) -> impl Iterator<Item = usize> {
    (1..=CHECKS).map(move |k| k * (steps / CHECKS))
}

/// Largest error relative to the largest value; NaN where a value is none.
fn error(values: impl Iterator<Item = f64>, exact: &[f64]) -> f64 {
    let largest = exact.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let errors = values.zip(exact).map(|(value, exact)| (value - exact).abs() / largest);
    errors.fold(0.0, |m, e| if e.is_nan() { f64::NAN } else { m.max(e) })
}

/// Repetitions that fit into the time for them.
fn repeats(seconds: f64) -> usize {
    ((REPEATING / seconds.max(1e-6)) as usize).clamp(1, REPEATS)
}

type Own = (&'static str, Rule);

const OWN: [Own; 7] = [
    ("Springpot spline", Rule::Spline),
    ("Springpot Hermite", Rule::Hermite),
    ("Springpot exponential", Rule::Exponential),
    ("Springpot GL", Rule::Scheme(Scheme::GrunwaldLetnikov)),
    ("Springpot L1", Rule::Scheme(Scheme::L1)),
    ("Springpot L1-2", Rule::Scheme(Scheme::L12)),
    ("Springpot FBDF 2", Rule::Scheme(Scheme::Fbdf(2))),
];

fn own((label, rule): Own, exact: &[f64]) -> Method {
    let run = |t: &[f64], x: &[f64]| -> Vec<f64> {
        let samples = Samples { t, x, rate: None };
        derivative(&samples, ALPHA, Definition::Caputo, rule).expect("the samples are right")
    };
    let mut points = Vec::new();
    for steps in STEPS {
        let (t, x) = samples(steps);
        let begun = Instant::now();
        let y = run(&t, &x);
        let first = begun.elapsed().as_secs_f64();
        let times = (0..repeats(first)).map(|_| {
            let begun = Instant::now();
            std::hint::black_box(run(&t, std::hint::black_box(&x)));
            begun.elapsed().as_secs_f64()
        });
        let seconds = median(times.collect());
        points.push(Point { steps, seconds, error: error(check_rows(steps).map(|row| y[row]), exact) });
    }
    Method { label: label.into(), points, end: None }
}

fn samples(steps: usize) -> (Vec<f64>, Vec<f64>) {
    let t: Vec<f64> = (0..=steps).map(|k| END * k as f64 / steps as f64).collect();
    let x = t.iter().map(|t| signal(*t)).collect();
    (t, x)
}

/// The interpreter with the rivals.
struct Peers {
    child: Child,
    input: ChildStdin,
    lines: Lines<BufReader<ChildStdout>>,
    methods: Vec<String>,
}

impl Peers {
    fn start() -> Result<Self, String> {
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../../benches/peers/derivative_of_samples.py");
        let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".into());
        let mut command = Command::new(&python);
        command.arg(script).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = command.spawn().map_err(|error| format!("{python}: {error}"))?;
        let (Some(input), Some(output)) = (child.stdin.take(), child.stdout.take()) else {
            return Err("no pipes".into());
        };
        let mut lines = BufReader::new(output).lines();
        let hello =
            answer(&mut lines).map_err(|error| format!("{python} did not answer ({error}): is numpy there?"))?;
        for (package, version) in hello["versions"].as_object().into_iter().flatten() {
            println!("{package} {}", version.as_str().unwrap_or("?"));
        }
        for package in hello["missing"].as_array().into_iter().flatten() {
            println!("missing, left out: {}", package.as_str().unwrap_or("?"));
        }
        let methods = hello["methods"].as_array().into_iter().flatten();
        let methods = methods.filter_map(|name| name.as_str().map(String::from)).collect();
        Ok(Self { child, input, lines, methods })
    }

    /// The median time and the values at the check rows.
    fn run(&mut self, method: &str, x: &[f64], repeats: usize) -> Result<(f64, Vec<f64>), String> {
        let checks: Vec<usize> = check_rows(x.len() - 1).collect();
        let request = serde_json::json!({
            "method": method, "end": END, "alpha": ALPHA, "rows": x.len(), "repeats": repeats, "checks": checks
        });
        let bytes: Vec<u8> = x.iter().flat_map(|x| x.to_le_bytes()).collect();
        writeln!(self.input, "{request}").and_then(|()| self.input.write_all(&bytes)).map_err(|e| e.to_string())?;
        self.input.flush().map_err(|e| e.to_string())?;
        let reply = answer(&mut self.lines)?;
        match (reply["seconds"].as_f64(), reply["values"].as_array()) {
            // NaN is no JSON number to everybody: it comes as null.
            (Some(seconds), Some(values)) => {
                Ok((seconds, values.iter().map(|v| v.as_f64().unwrap_or(f64::NAN)).collect()))
            }
            _ => Err(reply["error"].as_str().unwrap_or("no answer").into()),
        }
    }

    fn method(&mut self, label: &str, exact: &[f64], limit: f64) -> Method {
        let (mut points, mut end): (Vec<Point>, _) = (Vec::new(), None);
        for steps in STEPS {
            if let Some(seconds) = expected(&points, steps).filter(|seconds| *seconds > limit) {
                end = Some(format!("{steps} steps would take about {seconds:.0} s"));
                break;
            }
            let x = samples(steps).1;
            // Long runs need neither a first one nor a median.
            let first = if points.last().is_some_and(|p| p.seconds > REPEATING) {
                self.run(label, &x, 1)
            } else {
                self.run(label, &x, 1).and_then(|(seconds, _)| self.run(label, &x, repeats(seconds)))
            };
            match first {
                Ok((seconds, values)) => {
                    points.push(Point { steps, seconds, error: error(values.into_iter(), exact) });
                }
                Err(why) => {
                    end = Some(format!("{steps} steps: {why}"));
                    break;
                }
            }
        }
        Method { label: label.into(), points, end }
    }

    fn stop(mut self) {
        drop(self.input);
        self.child.wait().ok();
    }
}

fn answer(lines: &mut Lines<BufReader<ChildStdout>>) -> Result<serde_json::Value, String> {
    let line = lines.next().ok_or("it ended")?.map_err(|error| error.to_string())?;
    serde_json::from_str(&line).map_err(|error| error.to_string())
}

/// Time at a longer record by the growth between the last two.
fn expected(points: &[Point], steps: usize) -> Option<f64> {
    let [.., a, b] = points else { return None };
    let growth = (b.seconds / a.seconds).ln() / (b.steps as f64 / a.steps as f64).ln();
    Some(b.seconds * (steps as f64 / b.steps as f64).powf(growth.clamp(1.0, 2.5)))
}

fn print(method: &Method) {
    println!("{}", method.label);
    for p in &method.points {
        println!("  {:>8} steps {:>12.3} ms   error {:.1e}", p.steps, 1e3 * p.seconds, p.error);
    }
    if let Some(end) = &method.end {
        println!("  {end}");
    }
}

/// How much longer every rival takes than the first of ours at one length, and than whichever of ours reaches its error
/// soonest.
fn compare(own: &[Method], rivals: &[Method], steps: usize) {
    for rival in rivals {
        let at = |method: &Method| method.points.iter().find(|p| p.steps == steps).copied();
        let Some(theirs) = at(rival) else { continue };
        println!("{steps} steps, {}:", rival.label);
        if let Some(ours) = at(&own[0]) {
            let (time, error) = (theirs.seconds / ours.seconds, theirs.error / ours.error);
            println!("  {time:.1} times the time of {} on the same samples, {error:.1e} times its error", own[0].label);
        }
        let points = own.iter().flat_map(|method| method.points.iter().map(move |p| (&method.label, p)));
        let as_good = points.filter(|(_, p)| p.error <= theirs.error);
        if let Some((label, ours)) = as_good.min_by(|a, b| a.1.seconds.total_cmp(&b.1.seconds)) {
            let time = theirs.seconds / ours.seconds;
            println!("  {time:.1} times the time of {label} with {} steps, which errs no more", ours.steps);
        }
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let value = |name: &str| arguments.iter().position(|a| a == name).and_then(|k| arguments.get(k + 1));
    let limit = value("--limit").map_or(60.0, |text| text.parse().expect("--limit takes seconds"));
    let exact = exact_values();

    let mut methods = Vec::new();
    for method in OWN {
        methods.push(own(method, &exact));
        print(&methods[methods.len() - 1]);
    }
    match Peers::start() {
        Ok(mut peers) => {
            for label in peers.methods.clone() {
                methods.push(peers.method(&label, &exact, limit));
                print(&methods[methods.len() - 1]);
            }
            peers.stop();
        }
        Err(why) => println!("no rivals: {why}"),
    }
    let (ours, rivals) = methods.split_at(OWN.len());
    for steps in [10_000, 100_000] {
        compare(ours, rivals, steps);
    }

    if let Some(file) = value("--figure") {
        // Beyond rounding more samples only take longer.
        let curves = ours.iter().map(|m| curve(&m.label, &best(m.points.clone())));
        let curves = curves.chain(rivals.iter().map(|m| curve(&m.label, &m.points))).collect();
        let plot = Plot {
            title: Some("D^½ of 0.7 sin 8t + 0.1 t from 10³ to 10⁶ samples".into()),
            x: "log₁₀ of the time, ms".into(),
            y: "log₁₀ of the largest error, relative".into(),
            panels: vec![Panel { curves, ..Panel::default() }],
            ..Plot::default()
        };
        save(&plot, file);
    }
}
