//! Robots that move by themselves, as scenario texts, and their rows by column.

#[allow(dead_code, reason = "a share of it")]
#[path = "../run/run_support/robots.rs"]
mod robots;

pub(crate) use robots::{ARM, strut, thermoviscoelastic};

use springpot::law::Catalog;
use springpot::simulate::{Report, RunError, Settings, Stop, System, run as simulate};
use springpot_scenario::{Cases, Scenario};
use std::path::PathBuf;

/// Rows of one run.
#[derive(Debug)]
pub(crate) struct Run {
    pub(crate) names: Vec<String>,
    pub(crate) rows: Vec<Vec<f64>>,
    pub(crate) report: Report,
    pub(crate) error: Option<RunError>,
}

impl Run {
    pub(crate) fn column(&self, name: &str) -> Vec<f64> {
        let index = self.names.iter().position(|n| n == name);
        let index = index.unwrap_or_else(|| panic!("no column {name} among {:?}", self.names));
        self.rows.iter().map(|row| row[index]).collect()
    }

    /// Residual of the balance in units of the energy turned over.
    pub(crate) fn residual(&self) -> f64 {
        let turned_over = self.report.energy_turned_over.expect("a known ledger");
        self.report.energy_residual.expect("a known ledger") / turned_over
    }
}

/// The cases of a scenario text.
pub(crate) fn cases(text: &str) -> Cases {
    let scenario = Scenario::parse(text, "test.toml", scenarios().to_str().unwrap());
    let cases = scenario.and_then(|scenario| scenario.cases(&Catalog::standard()));
    cases.unwrap_or_else(|refusals| panic!("{refusals}\n{text}"))
}

/// The folder of the shipped scenarios.
pub(crate) fn scenarios() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../scenarios")
}

/// Runs a system; the run may fail.
pub(crate) fn run_system(system: &System, settings: &Settings) -> Run {
    let mut rows = Vec::new();
    let mut keep = |row: &[f64]| -> std::io::Result<()> {
        rows.push(row.to_vec());
        Ok(())
    };
    let (report, outcome) = simulate(system, settings, &mut keep, &Stop::new(false));
    let names = system.columns().into_iter().map(|column| column.name).collect();
    Run { names, rows, report, error: outcome.err() }
}

/// Runs one case; it may fail.
pub(crate) fn try_case(cases: &Cases, index: usize) -> Run {
    let plan = cases.plan(index).expect("a valid plan");
    run_system(&plan.system(), &plan.settings)
}

/// Runs a scenario with one case; it may fail.
pub(crate) fn try_run(text: &str) -> Run {
    try_case(&cases(text), 0)
}

/// Runs a scenario with one case to its end.
pub(crate) fn run(text: &str) -> Run {
    let run = try_run(text);
    assert!(run.error.is_none(), "{}\n{text}", run.error.unwrap());
    run
}

/// Runs a shipped scenario's case `index` after `overrides`.
pub(crate) fn shipped(name: &str, overrides: &[&str]) -> Cases {
    let mut scenario = Scenario::read(scenarios().join(name)).unwrap_or_else(|refusals| panic!("{refusals}"));
    for assignment in overrides {
        scenario.set(assignment).unwrap_or_else(|refusals| panic!("{refusals}"));
    }
    scenario.cases(&Catalog::standard()).unwrap_or_else(|refusals| panic!("{refusals}"))
}

/// Largest magnitude; infinite where one is NaN.
pub(crate) fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |m: f64, x| if x.is_nan() { f64::INFINITY } else { m.max(x.abs()) })
}

/// Largest difference of two columns.
pub(crate) fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    largest(a.iter().zip(b).map(|(a, b)| a - b))
}

/// A slider on the vertical axis with the element `e` to the world: its stroke is q. `law` is the rest of the element's table.
pub(crate) fn slider(mass: &str, gravity: f64, law: &str, start: &str) -> String {
    format!(
        r#"
[robot]
gravity = [0, 0, {gravity}]
[[robot.body]]
name = "slider"
joint = {{ name = "q", kind = "prismatic", axis = [0, 0, 1], origin = [0, 0, 8] }}
mass = {mass}
[[element]]
name = "e"
from = {{ body = "world", point = [0, 0, 0] }}
to = {{ body = "slider", point = [0, 0, 0] }}
rest_length = 8
{law}
[motion]
kind = "forward"
start = {start}
"#
    )
}

/// q(0) and v(0) of the slider.
pub(crate) fn state(x: &str, v: &str) -> String {
    format!("{{ q = {{ q = {x} }}, v = {{ q = {v} }} }}")
}

/// The arm falling with the thermoviscoelastic strut of the first paper; `motion` is the rest of its motion.
pub(crate) fn falling(alpha: f64, celsius: f64, derivative: &str, motion: &str) -> String {
    let strut = thermoviscoelastic(alpha, celsius, derivative);
    format!("{ARM}{strut}\n[motion]\nkind = \"forward\"\n{motion}\n")
}

/// Rows every `step` seconds.
pub(crate) fn every(end: f64, step: f64, rtol: f64) -> String {
    format!("\n[time]\nend = {end}\noutput_step = {step}\n[solver]\nrtol = {rtol:e}\n")
}

/// Rows at the given times, written as TOML.
pub(crate) fn at(end: &str, times: &str, rtol: f64) -> String {
    format!("\n[time]\nend = {end}\noutput_times = [{times}]\n[solver]\nrtol = {rtol:e}\n")
}
