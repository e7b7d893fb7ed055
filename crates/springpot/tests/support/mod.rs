//! What the tests of whole runs share: scenarios from texts and files, their rows by column name, and an independent truth.

#![allow(dead_code, reason = "each binary uses its share")]

pub(crate) mod forward;
pub(crate) mod oracle;
pub(crate) mod robots;
pub(crate) mod truth;

use springpot::driver::{Report, run as simulate};
use springpot::law::Catalog;
use springpot::observe::Table;
use springpot::system::{RunError, Settings, Stop, System};
use springpot_scenario::{Cases, Scenario};
use std::path::PathBuf;

/// Rows of one run, by column.
#[derive(Debug)]
pub(crate) struct Run {
    pub(crate) table: Table,
    pub(crate) names: Vec<String>,
    pub(crate) rows: Vec<Vec<f64>>,
    pub(crate) report: Report,
    pub(crate) error: Option<RunError>,
}

impl Run {
    pub(crate) fn column(&self, name: &str) -> Vec<f64> {
        self.table.column(name).unwrap_or_else(|| panic!("no column {name} among {:?}", self.names))
    }

    pub(crate) fn t(&self) -> Vec<f64> {
        self.column("t")
    }

    /// What follows `v.` in the columns of the velocities, in order: the names of joints of one degree.
    pub(crate) fn joints(&self) -> Vec<String> {
        self.names.iter().filter_map(|name| name.strip_prefix("v.")).map(str::to_owned).collect()
    }

    /// Inner steps tried.
    pub(crate) fn effort(&self) -> u64 {
        self.report.steps + self.report.rejected_steps
    }

    /// Residual of the balance in units of the energy turned over.
    pub(crate) fn residual(&self) -> f64 {
        let turned_over = self.report.energy_turned_over.expect("a known ledger");
        self.report.energy_residual.expect("a known ledger") / turned_over
    }
}

/// The cases of a scenario text; files that it names are among the shipped scenarios.
pub(crate) fn cases(text: &str) -> Cases {
    let scenario =
        Scenario::parse(text, "test.toml", scenarios()).and_then(|scenario| scenario.cases(&Catalog::standard()));
    scenario.unwrap_or_else(|refusals| panic!("{refusals}\n{text}"))
}

/// The system of a scenario with one case.
pub(crate) fn system(text: &str) -> System {
    cases(text).plan(0).expect("a valid plan").system()
}

/// Runs a system; the run may fail.
pub(crate) fn run_system(system: &System, settings: &Settings) -> Run {
    let mut table = system.table();
    let (report, outcome) = simulate(system, settings, &mut table, &Stop::new(false));
    let names = table.columns().iter().map(|column| column.name.clone()).collect();
    let rows = table.rows().map(<[f64]>::to_vec).collect();
    Run { table, names, rows, report, error: outcome.err() }
}

/// Runs one case; it may fail.
pub(crate) fn run_case(cases: &Cases, index: usize) -> Run {
    let plan = cases.plan(index).expect("a valid plan");
    run_system(&plan.system(), &plan.settings)
}

/// Runs a scenario with one case; it may fail.
pub(crate) fn try_run(text: &str) -> Run {
    run_case(&cases(text), 0)
}

/// Runs a scenario with one case to its end.
pub(crate) fn run(text: &str) -> Run {
    let run = try_run(text);
    assert!(run.error.is_none(), "{}\n{text}", run.error.unwrap());
    run
}

/// The folder of the shipped scenarios.
pub(crate) fn scenarios() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../scenarios")
}

/// A shipped scenario with `--set` overrides.
pub(crate) fn shipped(name: &str, overrides: &[&str]) -> Cases {
    let mut scenario = Scenario::read(scenarios().join(name)).unwrap_or_else(|refusals| panic!("{refusals}"));
    for assignment in overrides {
        scenario.set(assignment).unwrap_or_else(|refusals| panic!("{refusals}"));
    }
    scenario.cases(&Catalog::standard()).unwrap_or_else(|refusals| panic!("{refusals}"))
}

/// Largest magnitude; NaN entries are skipped.
pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().filter(|x| !x.is_nan()).fold(0.0, |m, x| m.max(x.abs()))
}

/// Largest difference of two curves in units of the largest magnitude of the first.
pub(crate) fn relative_difference(reference: &[f64], values: &[f64]) -> f64 {
    assert_eq!(reference.len(), values.len());
    let error = reference.iter().zip(values).map(|(a, b)| (a - b).abs());
    error.fold(0.0, |m: f64, e| if e.is_nan() { f64::INFINITY } else { m.max(e) }) / largest(reference)
}
