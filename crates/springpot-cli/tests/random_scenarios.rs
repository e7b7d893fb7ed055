//! Random scenarios through the whole engine, from text to rows: valid ones give finite rows and a closed energy balance,
//! absurd numbers an answer in little time.

use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestRng, TestRunner};
use springpot::driver::{Report, run as simulate};
use springpot::law::Catalog;
use springpot::system::{RunError, Settings};
use springpot_scenario::Scenario;
use std::cell::Cell;
use std::fmt::Write as _;
use std::sync::atomic::AtomicBool;

/// The energy balance must close to this share of the energy turned over.
const BALANCE: f64 = 1e-7;

/// One body and its joint.
#[derive(Debug, Clone)]
struct Body {
    /// Earlier body that carries it, as a share of how many there are; 1 and above: the body before it.
    parent: f64,
    kind: usize,
    axis: [f64; 3],
    origin: [f64; 3],
    com: [f64; 3],
    mass: f64,
    inertia: f64,
    damping: f64,
    /// Amplitude, angular velocity and phase of its motion.
    motion: [f64; 3],
}

/// One element from far away on the world to a body.
#[derive(Debug, Clone)]
struct Element {
    body: f64,
    from: [f64; 3],
    to: [f64; 3],
    law: usize,
    numbers: [f64; 4],
    alpha: f64,
    riemann_liouville: bool,
    stretch: f64,
    input: usize,
}

fn vector(size: f64) -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(-size..size)
}

fn body() -> impl Strategy<Value = Body> {
    let joint = (0.0..2.0, 0..5usize, vector(1.0).prop_filter("a direction", |a| a.iter().any(|x| x.abs() > 0.1)));
    let shape = (vector(0.3), vector(0.2), 0.1..5.0, 0.001..0.1, 0.0..0.5);
    let motion = (0.0..0.5, 0.0..30.0, 0.0..6.0).prop_map(|(a, w, p)| [a, w, p]);
    (joint, shape, motion).prop_map(|((parent, kind, axis), (origin, com, mass, inertia, damping), motion)| Body {
        parent,
        kind,
        axis,
        origin,
        com,
        mass,
        inertia,
        damping,
        motion,
    })
}

fn element() -> impl Strategy<Value = Element> {
    let points = (0.0..1.0, vector(3.0), vector(0.2));
    let law = (0..8usize, prop::array::uniform4(0.1..100.0), prop_oneof![0.0..1.0, Just(0.0), Just(1.0)]);
    let start = (any::<bool>(), prop_oneof![Just(1.0), 0.9..1.1], 0..3usize);
    (points, law, start).prop_map(|((body, from, to), (law, numbers, alpha), (riemann_liouville, stretch, input))| {
        Element {
            body,
            // Farther from the robot than it can reach.
            from: [from[0], from[1], if from[2] < 0.0 { from[2] - 6.0 } else { from[2] + 6.0 }],
            to,
            law,
            numbers,
            alpha,
            riemann_liouville,
            stretch,
            input,
        }
    })
}

fn scenario() -> impl Strategy<Value = (Vec<Body>, Vec<Element>)> {
    (prop::collection::vec(body(), 1..5), prop::collection::vec(element(), 1..4))
}

fn input(kind: usize, base: f64) -> String {
    match kind {
        0 => format!("{base}"),
        1 => format!("\"{base} + 0.2*{base}*sin(25*t)\""),
        _ => format!("\"{base}*(1 + 0.1*abs(sin(9*t)))\""),
    }
}

/// The scenario as a file.
fn text(bodies: &[Body], elements: &[Element]) -> String {
    let mut text = "title = \"random\"\n[robot]\n".to_owned();
    let mut joints = Vec::new();
    for (k, body) in bodies.iter().enumerate() {
        let kind = ["revolute", "prismatic", "floating", "fixed", "continuous"][body.kind];
        let parent = if k == 0 { None } else { Some((body.parent * k as f64) as usize).filter(|p| *p < k) };
        let Body { axis, origin, com, mass, inertia, damping, .. } = body;
        let _ = writeln!(text, "[[robot.body]]\nname = \"b{k}\"");
        if let Some(parent) = parent {
            let _ = writeln!(text, "parent = \"b{parent}\"");
        }
        let has_axis = !matches!(kind, "fixed" | "floating");
        let moving = if has_axis { format!(", axis = {axis:?}, damping = {damping}") } else { String::new() };
        let _ = writeln!(text, "joint = {{ name = \"j{k}\", kind = \"{kind}\", origin = {origin:?}{moving} }}");
        let _ = writeln!(text, "mass = {mass}\ncom = {com:?}");
        let _ = writeln!(text, "inertia = {{ xx = {inertia}, yy = {inertia}, zz = {inertia} }}");
        let [amplitude, omega, phase] = body.motion;
        let wave = format!("\"{amplitude}*sin({omega}*t + {phase})\"");
        match kind {
            "fixed" => {}
            "floating" => {
                joints.push(format!("j{k} = {{ y = {wave}, z = {amplitude}, rpy = [{wave}, {phase}, {wave}] }}"))
            }
            _ => joints.push(format!("j{k} = {wave}")),
        }
    }
    for (k, element) in elements.iter().enumerate() {
        let Element { from, to, numbers: [a, b, c, d], alpha, .. } = element;
        let body = (element.body * bodies.len() as f64) as usize;
        let length = from.iter().map(|x| x * x).sum::<f64>().sqrt() * element.stretch;
        let (law, parameters, inputs) = match element.law {
            0 => ("spring", format!("k = {a}"), String::new()),
            1 => ("dashpot", format!("c = {a}"), String::new()),
            2 => ("springpot", format!("c = {a}, alpha = {alpha}"), String::new()),
            3 => ("kelvin-voigt", format!("k = {a}, c = {b}"), String::new()),
            4 => ("fractional-kelvin-voigt", format!("k = {a}, c = {b}, alpha = {alpha}"), String::new()),
            5 => (
                "thermoviscoelastic",
                format!("E_c = {a}, E_kv = {b}, E_d = {c}, alpha = {alpha}, a_kv = {}", d * 1e-5),
                format!("T = {}", input(element.input, 300.0)),
            ),
            6 => (
                "piezo-kelvin-voigt",
                format!("E_c = {a}, E_pz = {b}, E_d = {c}, alpha = {alpha}, alpha_pz = {}", d * 1e-5),
                format!("U = {}", input(element.input, 50.0)),
            ),
            _ => (
                "magnetorheological",
                format!("E_c = {a}, mu_0 = {b}, mu = {c}, alpha = {alpha}"),
                format!("u = {}", input(element.input, 1.0)),
            ),
        };
        let _ = writeln!(text, "[[element]]\nname = \"e{k}\"\nfrom = {{ body = \"world\", point = {from:?} }}");
        let _ = writeln!(text, "to = {{ body = \"b{body}\", point = {to:?} }}\nrest_length = {length}");
        let _ = writeln!(text, "law = \"{law}\"\nparameters = {{ {parameters} }}\ninputs = {{ {inputs} }}");
        if element.riemann_liouville {
            let _ = writeln!(text, "derivative = \"riemann-liouville\"");
        }
    }
    let _ = writeln!(text, "[motion]\nkind = \"prescribed\"\njoints = {{ {} }}", joints.join(", "));
    text.push_str("[time]\nend = 0.2\noutput_step = 0.03\n");
    text
}

/// What a run gave.
struct Ran {
    columns: Vec<String>,
    rows: Vec<Vec<f64>>,
    report: Report,
    outcome: Result<(), RunError>,
}

/// Runs the first case of a text, in no more steps than `limit`; the text of the refusals where it has any.
fn run(text: &str, limit: Option<u64>) -> Result<Ran, String> {
    let cases = Scenario::parse(text, "random.toml", "").and_then(|scenario| scenario.cases(&Catalog::standard()));
    let plan = cases.and_then(|cases| cases.plan(0)).map_err(|refusals| refusals.to_string())?;
    if plan.settings.rows.count() > 1_000 {
        return Err("too many rows for a test".into());
    }
    let system = plan.system();
    let settings = Settings { max_steps: limit.or(plan.settings.max_steps), ..plan.settings.clone() };
    let mut table = system.table();
    let (report, outcome) = simulate(&system, &settings, &mut table, &AtomicBool::new(false));
    let columns = table.columns().iter().map(|column| column.name.clone()).collect();
    let rows = table.rows().map(<[f64]>::to_vec).collect();
    Ok(Ran { columns, rows, report, outcome })
}

/// What a singular start leaves empty: in the first row, and in all.
fn may_be_empty(column: &str, first: bool) -> bool {
    let last = column.rsplit('.').next().unwrap_or("");
    let at_first = column.starts_with("tau.") || column.contains(".Q.") || matches!(last, "derivative" | "force");
    (first && at_first) || matches!(last, "stored" | "dissipated" | "input" | "residual")
}

fn runner(cases: u32, seed: u8) -> TestRunner {
    let config = Config { cases, failure_persistence: None, max_shrink_iters: 200, ..Config::default() };
    TestRunner::new_with_rng(config, TestRng::from_seed(RngAlgorithm::ChaCha, &[seed; 32]))
}

fn valid_scenarios(cases: u32) {
    let (known, worst) = (Cell::new(0), Cell::new(0.0f64));
    let outcome = runner(cases, 3).run(&scenario(), |(mut bodies, elements)| {
        // At least one joint moves.
        bodies[0].kind = bodies[0].kind.min(2);
        let text = text(&bodies, &elements);
        let fail = |why: String| TestCaseError::fail(format!("{why}\n{text}"));
        let Ran { columns, rows, report, outcome } = run(&text, None).map_err(fail)?;
        outcome.map_err(|error| fail(error.to_string()))?;
        prop_assert_eq!(rows.len(), 8);
        let singular = report.energy_residual.is_none();
        for (k, row) in rows.iter().enumerate() {
            prop_assert_eq!(row.len(), columns.len());
            for (value, column) in row.iter().zip(&columns) {
                let fine = value.is_finite() || (singular && value.is_nan() && may_be_empty(column, k == 0));
                prop_assert!(fine, "{} is {} in row {}\n{}", column, value, k, &text);
            }
        }
        if let Some((residual, turned_over)) = report.energy_residual.zip(report.energy_turned_over) {
            known.set(known.get() + 1);
            prop_assert!(residual <= BALANCE * turned_over, "{} of {} J\n{}", residual, turned_over, &text);
            if turned_over > 0.0 {
                worst.set(worst.get().max(residual / turned_over));
            }
        }
        Ok(())
    });
    outcome.unwrap_or_else(|error| panic!("{error}"));
    assert!(known.get() > cases / 4 && known.get() < cases, "{} of {cases} ledgers known", known.get());
    println!("largest energy residual {:.1e} of the energy turned over", worst.get());
}

#[test]
fn valid_scenarios_run_with_finite_rows_and_a_closed_balance() {
    valid_scenarios(300);
}

#[test]
#[ignore = "ten thousand runs"]
fn ten_thousand_valid_scenarios_run() {
    valid_scenarios(10_000);
}

/// What a number of a file may be replaced by.
const ABSURD: [&str; 24] = [
    "0",
    "-0.0",
    "1",
    "-1",
    "1e-300",
    "-1e-300",
    "5e-324",
    "1e300",
    "-1e300",
    "1.7e308",
    "1e-15",
    "1e15",
    "1e-9",
    "1e9",
    "3.0",
    "0.5",
    "\"1e9*t\"",
    "\"t^2\"",
    "\"1/(t + 1)\"",
    "\"sqrt(t)\"",
    "\"sign(t - 0.1)\"",
    "\"1e-200*sin(1e3*t)\"",
    "\"abs(t - 0.1)\"",
    "\"exp(500*t)\"",
];

/// A robot that follows a gripper path, short.
fn on_a_path() -> String {
    let text = include_str!("../../../scenarios/piezo_order.toml");
    let end = text.find("[[sweep]]").expect("a sweep");
    let text =
        text[..end].replace("end = \"10 s\"", "end = 0.2").replace("output_step = \"10 ms\"", "output_step = 0.03");
    assert!(text.contains("end = 0.2\n") && text.contains("kind = \"gripper-path\""));
    text
}

/// The stretches of a text that are plain numbers.
fn numbers(text: &str) -> Vec<std::ops::Range<usize>> {
    let bytes = text.as_bytes();
    let mut found = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let is_part = |b: &u8| b.is_ascii_digit() || matches!(b, b'.' | b'-' | b'e');
        let end = at + bytes[at..].iter().take_while(|b| is_part(b)).count();
        let stands_alone = at > 0 && matches!(bytes[at - 1], b' ' | b'[');
        if end > at && stands_alone && text[at..end].parse::<f64>().is_ok() {
            found.push(at..end);
        }
        at = end.max(at) + 1;
    }
    found
}

fn absurd_scenarios(cases: u32) {
    let edits = prop::collection::vec((0.0..1.0, 0..ABSURD.len()), 1..4);
    let base = prop_oneof![3 => scenario().prop_map(Some), 1 => Just(None)];
    let ran = Cell::new(0);
    let outcome = runner(cases, 5).run(&(base, edits), |(base, edits)| {
        let mut text = match base {
            Some((mut bodies, elements)) => {
                bodies[0].kind = bodies[0].kind.min(2);
                text(&bodies, &elements)
            }
            None => on_a_path(),
        };
        for (at, piece) in edits {
            let numbers = numbers(&text);
            text.replace_range(numbers[(at * numbers.len() as f64) as usize].clone(), ABSURD[piece]);
        }
        if let Ok(Ran { rows, report, .. }) = run(&text, Some(300)) {
            ran.set(ran.get() + 1);
            prop_assert_eq!(rows.len() as u64, report.rows);
            prop_assert_eq!(rows.last().map(|row| row[0]), report.t_reached);
            prop_assert!(rows.iter().all(|row| row[0].is_finite()), "{}", &text);
            prop_assert!(report.energy_residual.is_none_or(|residual| residual.is_finite()));
        }
        Ok(())
    });
    outcome.unwrap_or_else(|error| panic!("{error}"));
    assert!(ran.get() > cases / 5 && ran.get() < cases, "{} of {cases} ran", ran.get());
}

#[test]
fn absurd_numbers_never_panic() {
    absurd_scenarios(500);
}

#[test]
#[ignore = "ten thousand runs"]
fn ten_thousand_absurd_scenarios_never_panic() {
    absurd_scenarios(10_000);
}
