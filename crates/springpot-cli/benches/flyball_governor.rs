//! Ten seconds of the stiff flyball governor by Springpot and by MuJoCo (`benches/peers/flyball_governor.py`; an interpreter with mujoco by the
//! variable PYTHON), in turn. The error is the largest of the slider's place at the 101 times of the reference.

#[path = "comparison/median.rs"]
mod median;

use median::median;
use springpot::driver::run;
use springpot::law::Catalog;
use springpot::system::{RowTimes, Settings, Stop, System};
use springpot_scenario::Scenario;
use std::io::Write;
use std::process::{Command, Stdio};
use std::time::Instant;

const ROUNDS: usize = 5;
const TOLERANCES: [f64; 4] = [1e-3, 1e-5, 1e-7, 1e-9];
const STEPS: [(&str, f64); 4] = [("implicitfast", 1e-4), ("implicit", 1e-4), ("implicit", 1e-5), ("RK4", 1e-5)];

/// Where the slider is at its times.
struct Reference {
    t: Vec<f64>,
    s: Vec<f64>,
}

fn reference() -> Reference {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/multibody/flyball_governor.json");
    let text = std::fs::read_to_string(file).expect("the reference is there");
    let json: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    let array = |key: &str| json[key].as_array().expect("an array").clone();
    Reference { t: array("t").iter().map(number).collect(), s: array("q").iter().map(|q| number(&q[1])).collect() }
}

/// Seconds and the error.
fn springpot(system: &System, settings: &Settings, rtol: f64, reference: &Reference) -> (f64, f64) {
    let settings = Settings { rtol, memory_rtol: 0.01 * rtol, ..settings.clone() };
    let mut table = system.table();
    let begun = Instant::now();
    run(system, &settings, &mut table, &Stop::new(false)).1.expect("a run");
    let seconds = begun.elapsed().as_secs_f64();
    let places = table.column("q.s").expect("the slider");
    (seconds, places.iter().zip(&reference.s).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max))
}

/// The same of each run of MuJoCo; none where it is not found.
fn mujoco(reference: &Reference) -> Option<Vec<(f64, f64)>> {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../../benches/peers/flyball_governor.py");
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".into());
    let mut child = Command::new(python).arg(script).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().ok()?;
    let asked = serde_json::json!({ "runs": STEPS, "t": reference.t, "s": reference.s });
    writeln!(child.stdin.take()?, "{asked}").ok()?;
    let output = String::from_utf8(child.wait_with_output().ok()?.stdout).ok()?;
    let numbers = |line: &str| {
        let mut words = line.split(' ').skip(2).map(|word| word.parse().ok());
        Some((words.next()??, words.next()??))
    };
    output.lines().map(numbers).collect::<Option<Vec<_>>>().filter(|runs| runs.len() == STEPS.len())
}

fn main() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/flyball_governor.toml");
    let scenario = Scenario::read(std::path::Path::new(file)).expect("the scenario is there");
    let plan = scenario.cases(&Catalog::standard()).and_then(|cases| cases.plan(0)).expect("the scenario is right");
    let (system, reference) = (plan.system(), reference());
    let settings = Settings { rows: RowTimes::Times(reference.t.as_slice().into()), ..plan.settings.clone() };
    let (mut ours, mut theirs) = (vec![Vec::new(); TOLERANCES.len()], vec![Vec::new(); STEPS.len()]);
    for _ in 0..ROUNDS {
        for (rtol, own) in TOLERANCES.iter().zip(&mut ours) {
            own.push(springpot(&system, &settings, *rtol, &reference));
        }
        let Some(runs) = mujoco(&reference) else {
            println!("no python3 with mujoco: Springpot alone");
            break;
        };
        runs.into_iter().zip(&mut theirs).for_each(|(run, own)| own.push(run));
    }
    let tell = |name: String, runs: &[(f64, f64)]| {
        if let Some((_, error)) = runs.first() {
            let seconds = median(runs.iter().map(|(seconds, _)| *seconds).collect());
            println!("{name:30} {:10.1} ms, error {error:.1e} m", 1e3 * seconds);
        }
    };
    TOLERANCES.iter().zip(&ours).for_each(|(rtol, runs)| tell(format!("Springpot, rtol {rtol:.0e}"), runs));
    STEPS.iter().zip(&theirs).for_each(|((name, step), runs)| tell(format!("MuJoCo, {name}, {step:.0e} s"), runs));
}
