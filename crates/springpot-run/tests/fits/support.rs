//! Records with noise of a seed, and what is fitted to them.

use springpot::Simulation;
use springpot::law::Catalog;
use springpot::observe::Quantity;
use springpot_run::fit::{Outcome, fit};
use springpot_scenario::Scenario;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use tempfile::TempDir;

/// Normally distributed numbers of a seed (splitmix64, Box–Muller).
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    pub(crate) fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn normal(&mut self) -> f64 {
        (-2.0 * (1.0 - self.share()).ln()).sqrt() * (std::f64::consts::TAU * self.share()).cos()
    }
}

/// A folder for the files of a fit.
pub(crate) struct Place(TempDir);

impl Place {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn write(&self, name: &str, text: &str) {
        fs::write(self.path().join(name), text).unwrap();
    }

    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }

    /// The fit of a scenario whose files lie here.
    pub(crate) fn fit(&self, text: &str) -> Outcome {
        let scenario = Scenario::parse(text, "a.toml", self.path()).unwrap_or_else(|refusals| panic!("{refusals}"));
        let fitting = scenario.fit(&Catalog::standard()).unwrap_or_else(|refusals| panic!("{refusals}"));
        fit(fitting, 1, &AtomicBool::new(false)).unwrap_or_else(|error| panic!("{error}"))
    }
}

/// Quantities of a run of a scenario, whose files lie at a place, at these times.
pub(crate) fn rows_of(place: &Place, text: &str, quantities: &[Quantity], times: &[f64]) -> Vec<Vec<f64>> {
    let scenario = Scenario::parse(text, "truth.toml", place.path()).unwrap_or_else(|refusals| panic!("{refusals}"));
    let cases = scenario.cases(&Catalog::standard()).unwrap_or_else(|refusals| panic!("{refusals}"));
    let plan = cases.plan(0).unwrap_or_else(|refusals| panic!("{refusals}"));
    let mut run = Simulation::new(plan.system(), plan.settings).unwrap();
    let row = |t: &f64| {
        while run.t() < *t {
            run.step().unwrap();
        }
        let at = run.interpolate(*t).unwrap();
        quantities.iter().map(|quantity| at.value(*quantity)).collect()
    };
    times.iter().map(row).collect()
}

/// A parameter that was found.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found {
    pub(crate) value: f64,
    pub(crate) sd: f64,
    pub(crate) interval: [f64; 2],
}

pub(crate) fn found(outcome: &Outcome, name: &str) -> Found {
    let parameters = &outcome.fitting.plan().parameters;
    let j = parameters.iter().position(|own| own.sought.name == name).unwrap_or_else(|| panic!("{name}"));
    Found { value: outcome.fit.values[j], sd: outcome.fit.sd(j), interval: outcome.intervals[j] }
}

/// All parameters that were found, by name.
pub(crate) fn all_found(outcome: &Outcome) -> Vec<(String, Found)> {
    let names = outcome.fitting.plan().parameters.iter().map(|own| own.sought.name.clone());
    names.map(|name| (name.clone(), found(outcome, &name))).collect()
}

/// An element, all of whose numbers are sought.
pub(crate) fn pad(law: &str, parameters: &[(&str, f64)]) -> String {
    let values: Vec<String> = parameters.iter().map(|(name, value)| format!("{name} = {value}")).collect();
    let mut text = format!("[[element]]\nname = \"pad\"\n{law}\nparameters = {{ {} }}\n", values.join(", "));
    for (name, _) in parameters {
        _ = write!(text, "[[parameter]]\nname = \"{name}\"\npath = \"element.pad.{name}\"\n");
    }
    text
}
