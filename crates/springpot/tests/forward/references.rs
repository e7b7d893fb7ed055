//! Whole reference files: the falling arm, one mass on every law, oscillators.

use crate::support::forward::{at, distance, falling, slider, state};
use crate::support::{Run, run, run_case, run_system, shipped};
use serde_json::Value;
use springpot::actuation::{Drive, Forward};
use springpot::elements::{Element, Line};
use springpot::law::{Catalog, Derivative};
use springpot::model::{Anchor, BodySpec, JointSpec, ModelBuilder, Parent};
use springpot::signal::Signal;
use springpot::system::{RowTimes, Settings, System};

fn read(path: &str) -> Value {
    let file = format!("{}/../../testdata/{path}", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| value.as_str().unwrap().parse().unwrap())
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap()
}

#[test]
fn the_falling_arm() {
    let reference = read("papers/forward_thermoviscoelastic.json");
    assert_eq!((number(&reference["lambda"]), number(&reference["kw"]["T"])), (0.5, 25.0));
    let (mut compared, mut worst) = (0, 0.0f64);
    for derivative in ["riemann-liouville", "caputo"] {
        // Rows at the four times alone, where steps end, and rows between the steps.
        for times in ["0.5, 1, 2, 5", "0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.501, 0.999, 1, 1.001, 1.999, 2, 2.001, 4.999, 5"] {
            let run = run(&format!("{}{}", falling(0.5, 25.0, derivative, ""), at("5.5", times, 1e-10)));
            for (time, state) in reference["A"].as_object().unwrap() {
                let row = run.column("t").iter().position(|t| *t == time.parse::<f64>().unwrap()).unwrap();
                for (key, symbol) in [("q", "q"), ("qd", "v")] {
                    for (k, value) in state[key].as_array().unwrap().iter().enumerate() {
                        let found = run.column(&format!("{symbol}.q{}", k + 1))[row];
                        let error = (found - number(value)).abs();
                        assert!(error < 1e-8, "{derivative}, {symbol}{} at {time}: {error:e}", k + 1);
                        worst = worst.max(error);
                        compared += 1;
                    }
                }
            }
        }
    }
    assert_eq!(compared, 96);
    println!("falling arm: {compared} numbers, worst {worst:.1e}");
}

#[test]
fn energies_of_the_falling_arm() {
    let reference = read("papers/forward_thermoviscoelastic.json");
    let run = run(&format!("{}{}", falling(0.5, 25.0, "caputo", ""), at("5", "0, 0.5, 1, 2, 5", 1e-10)));
    let (kinetic, potential, stored) =
        (run.column("energy.kinetic"), run.column("energy.potential"), run.column("strut.stored"));
    let mut compared = 0;
    for (k, time) in ["0.5", "1.0", "2.0", "5.0"].into_iter().enumerate() {
        let energy = &reference["B"][time]["energy"];
        let springs = number(&energy["spring"]) + number(&energy["frac_stored"]);
        // Ours counts heat from the start and its thermal work as input; kinetic and elastic energies mean the same.
        for (name, found, expected, bound) in [
            ("kinetic", kinetic[k + 1], number(&energy["T"]), 1e-8),
            ("potential", potential[k + 1] - potential[0], number(&energy["V"]) - POTENTIAL_AT_START, 1e-8),
            ("stored", stored[k + 1], springs, 1e-6),
        ] {
            println!("{name} at {time}: {:.1e}", found - expected);
            assert!((found - expected).abs() < bound, "{name} at {time}: {found} {expected}");
            compared += 1;
        }
    }
    assert_eq!(compared, 12);
}

/// Σ m g z of the three bodies at q = 0, J.
const POTENTIAL_AT_START: f64 = 9.81 * (6.0 * 0.3 + 3.0 * (0.6 + 0.02) + 2.0 * (0.6 + 0.01));

#[test]
fn one_mass_exactly() {
    let reference = read("papers/one_mass_exact.json");
    let (mut compared, mut regular, mut singular) = (0, 0.0f64, 0.0f64);
    for case in reference["cases"].as_array().unwrap() {
        let kind = if text(&case["kind"]) == "RL" { "riemann-liouville" } else { "caputo" };
        let parameters = format!(
            "E_c = {}, E_kv = 0, E_d = {}, alpha = {}, a_kv = 0",
            text(&case["K"]),
            text(&case["C"]),
            text(&case["lambda"])
        );
        let law = format!(
            "law = \"thermoviscoelastic\"\nparameters = {{ {parameters} }}\ninputs = {{ T = 300 }}\nderivative = \"{kind}\""
        );
        // The constant force of the file as gravity.
        let gravity = number(&case["f"]) / number(&case["m"]);
        let start = state(text(&case["x0"]), text(&case["v0"]));
        let scenario = slider(text(&case["m"]), gravity, &law, &start) + &at("5", "0.5, 1, 2, 5", 1e-10);
        let run = run(&scenario);
        let is_singular = kind == "riemann-liouville" && number(&case["x0"]) != 0.0;
        for (column, key) in [("q.q", "x"), ("v.q", "xdot")] {
            let times = case[key].as_object().unwrap();
            let expected: Vec<f64> = run.column("t").iter().map(|t| number(&times[&t.to_string()])).collect();
            let error = distance(&run.column(column), &expected);
            println!("alpha {} {kind} {start} {column}: {error:.1e}, {} steps", case["lambda"], run.report.steps);
            let worst = if is_singular { &mut singular } else { &mut regular };
            *worst = worst.max(error);
            compared += expected.len();
        }
    }
    assert_eq!(compared, 48);
    println!("one mass: {regular:.1e}, singular {singular:.1e}");
    assert!(regular < 1e-8 && singular < 1e-6, "{regular:e} {singular:e}");
}

#[test]
fn one_mass_on_every_law() {
    let reference = read("forward/one_mass_laws.json");
    let times: Vec<&str> = reference["times"].as_array().unwrap().iter().map(text).collect();
    let (mut compared, mut regular, mut singular) = (0, 0.0f64, 0.0f64);
    let mut failures = Vec::new();
    for case in reference["cases"].as_array().unwrap() {
        let (name, kind) = (text(&case["law"]), text(&case["derivative"]));
        let law = format!(
            "law = \"{name}\"\nparameters = {{ {} }}\ninputs = {{ {} }}\nderivative = \"{kind}\"",
            text(&case["parameters"]),
            text(&case["inputs"])
        );
        let start = state(text(&case["x0"]), text(&case["v0"]));
        let run = run(&(slider("2", -9.81, &law, &start) + &at("5", &times.join(", "), 1e-10)));
        let alpha = number(&case["alpha"]);
        let is_singular = kind == "riemann-liouville" && number(&case["x0"]) != 0.0 && alpha > 0.0 && alpha < 1.0;
        for (column, key) in [("q.q", "x"), ("v.q", "v")] {
            let expected: Vec<f64> = case[key].as_array().unwrap().iter().map(number).collect();
            let error = distance(&run.column(column), &expected);
            let (worst, bound) = if is_singular { (&mut singular, 1e-6) } else { (&mut regular, 1e-8) };
            *worst = worst.max(error);
            if error > bound {
                failures.push(format!("{name} alpha {alpha} {kind} {start} {column}: {error:.1e}, {:?}", run.report));
            }
            compared += expected.len();
        }
    }
    println!("{compared} numbers: {regular:.1e}, singular {singular:.1e}");
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    assert_eq!(compared, 1050);
}

#[test]
fn oscillators() {
    let reference = read("fractional/oscillators.json");
    let points = reference["kv"].as_array().unwrap();
    let times: Vec<&str> = points.iter().map(|point| text(&point["t"])).collect();
    let (mut compared, mut worst) = (0, 0.0f64);
    let law = "law = \"fractional-kelvin-voigt\"\nparameters = { k = 4, c = 0.4, alpha = 0.5 }";
    assert!(points.iter().all(|p| [&p["alpha"], &p["m"], &p["c"], &p["k"]].map(text) == ["0.5", "1", "0.4", "4"]));
    let step = state("0", "0") + "\ntorque = { q = 1 }";
    for (key, start) in [("step", step), ("impulse", state("0", "1")), ("free_caputo", state("1", "0"))] {
        let run = run(&(slider("1", 0.0, law, &start) + &at("200", &times.join(", "), 1e-10)));
        let expected: Vec<f64> = points.iter().map(|point| number(&point[key])).collect();
        let error = distance(&run.column("q.q"), &expected);
        println!("{key}: {error:.1e}, {:?}", run.report);
        worst = worst.max(error);
        compared += expected.len();
    }
    assert_eq!(compared, 42);
    assert!(worst < 1e-8, "{worst:e}");
}

/// The slider of the reference built in code.
fn slider_in_code(k: f64, c: f64, alpha: f64, derivative: Derivative, start: [f64; 2]) -> System {
    let mut builder = ModelBuilder::new([0.0, 0.0, -9.81]);
    builder
        .push(BodySpec {
            name: "slider".into(),
            parent: Parent::World,
            joint: JointSpec::prismatic("q", [0.0, 0.0, 1.0], [0.0, 0.0, 8.0]),
            mass: 2.0,
            com: [0.0; 3],
            inertia: [[0.0; 3]; 3],
        })
        .unwrap();
    let model = builder.finish().unwrap();
    let site = |body| model.resolve(&Anchor { body, point: [0.0; 3] }).unwrap();
    let catalog = Catalog::standard();
    let line = Line { from: site(Parent::World), to: site(Parent::Body(0)) };
    let law = catalog.get("fractional-kelvin-voigt").unwrap();
    let element = Element::new("e", line, 8.0, law, &[k, c, alpha], derivative).unwrap();
    let drives = vec![Drive::Force(vec![Signal::constant(0.0)])];
    let forward = Forward { q: vec![start[0]], v: vec![start[1]], drives };
    System::new(model, vec![element], forward)
}

#[test]
fn the_library_alone_gives_the_same_bits_as_a_scenario() {
    let reference = read("forward/one_mass_laws.json");
    let times: Vec<f64> = reference["times"].as_array().unwrap().iter().map(number).collect();
    let mut compared = 0;
    for case in reference["cases"].as_array().unwrap() {
        let (alpha, kind) = (number(&case["alpha"]), text(&case["derivative"]));
        if text(&case["law"]) != "fractional-kelvin-voigt" || !(alpha == 0.3 || alpha == 0.9) {
            continue;
        }
        let derivative = if kind == "caputo" { Derivative::Caputo } else { Derivative::RiemannLiouville };
        let start = [number(&case["x0"]), number(&case["v0"])];
        let system = slider_in_code(50.0, 30.0, alpha, derivative, start);
        let settings =
            Settings { rtol: 1e-10, memory_rtol: 1e-12, ..Settings::new(5.0, RowTimes::Times(times.clone().into())) };
        let code = run_system(&system, &settings);
        let law = format!(
            "law = \"fractional-kelvin-voigt\"\nparameters = {{ {} }}\nderivative = \"{kind}\"",
            text(&case["parameters"])
        );
        let start = state(text(&case["x0"]), text(&case["v0"]));
        let file: Run = run(&(slider("2", -9.81, &law, &start) + &at("5", "0.1, 0.5, 1, 2, 5", 1e-10)));
        let bits = |run: &Run| -> Vec<u64> { run.rows.iter().flatten().map(|x| x.to_bits()).collect() };
        assert_eq!(bits(&code), bits(&file), "alpha {alpha}, {kind}");
        let expected: Vec<f64> = case["x"].as_array().unwrap().iter().map(number).collect();
        assert!(distance(&code.column("q.q"), &expected) < 1e-6);
        compared += 1;
    }
    assert_eq!(compared, 12);
}

/// The stiff flyball governor of IFToMM's benchmarks, as shipped.
#[test]
fn the_flyball_governor() {
    let reference = read("multibody/flyball_governor.json");
    let run = run_case(&shipped("flyball_governor.toml", &[]), 0);
    let (mut compared, mut worst) = (0, 0.0f64);
    for (k, time) in reference["t"].as_array().unwrap().iter().enumerate() {
        let row = run.column("t").iter().position(|t| (t - number(time)).abs() < 1e-9).unwrap();
        for (j, joint) in reference["columns"].as_array().unwrap().iter().enumerate() {
            for symbol in ["q", "v"] {
                let found = run.column(&format!("{symbol}.{}", text(joint)))[row];
                worst = worst.max((found - number(&reference[symbol][k][j])).abs());
                compared += 1;
            }
        }
    }
    println!("flyball governor: {compared} numbers, worst {worst:.1e}");
    assert_eq!(compared, 808);
    assert!(worst < 2e-9, "{worst:e}");
}
