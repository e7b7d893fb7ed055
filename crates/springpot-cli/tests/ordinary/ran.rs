//! One case, run to its end: what must hold of every ordinary run.

use springpot::driver::{Report, run};
use springpot::law::Catalog;
use springpot_scenario::{Cases, Plan, Scenario};
use std::sync::atomic::AtomicBool;

pub(crate) const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

pub(crate) fn cases(text: &str) -> Cases {
    let read = Scenario::parse(text, "ordinary.toml", ROOT).and_then(|scenario| scenario.cases(&Catalog::standard()));
    read.unwrap_or_else(|refusals| panic!("{refusals}\n{text}"))
}

/// Runs the only case of a text; what is wrong with it.
pub(crate) fn ran(text: &str) -> Result<Report, String> {
    ran_plan(&cases(text).plan(0).unwrap_or_else(|refusals| panic!("{refusals}\n{text}")))
}

/// Runs a case: it comes to its end, its rows are numbers, and its energy balance closes.
pub(crate) fn ran_plan(plan: &Plan) -> Result<Report, String> {
    let system = plan.system();
    let mut table = system.table();
    let (report, outcome) = run(&system, &plan.settings, &mut table, &AtomicBool::new(false));
    outcome.map_err(|error| error.to_string())?;
    if report.rows != plan.settings.rows.count() as u64 {
        return Err(format!("{} rows of {}", report.rows, plan.settings.rows.count()));
    }
    let (Some(residual), Some(turned_over)) = (report.energy_residual, report.energy_turned_over) else {
        return Ok(report);
    };
    let columns = table.columns();
    for row in table.rows() {
        if let Some(at) = row.iter().position(|value| !value.is_finite()) {
            return Err(format!("{} is {} at t = {} s", columns[at].name, row[at], row[0]));
        }
    }
    let allowed = 10.0 * plan.settings.rtol * turned_over + report.energy_rounding.unwrap_or(0.0);
    // What compares with NaN is false.
    match residual <= allowed {
        true => Ok(report),
        false => Err(format!("the balance misses {residual:e} J, and {allowed:e} J are allowed")),
    }
}

/// What is wrong with the things that were tried, all of it at once.
#[derive(Default)]
pub(crate) struct Tried {
    count: usize,
    wrong: Vec<String>,
}

impl Tried {
    pub(crate) fn one<T>(&mut self, what: &str, outcome: Result<T, String>) -> Option<T> {
        self.count += 1;
        outcome.map_err(|why| self.wrong.push(format!("{what}: {why}"))).ok()
    }

    /// Fails where anything was wrong, or where fewer things were tried than are known to be there.
    pub(crate) fn end(self, least: usize) {
        let Self { count, wrong } = self;
        assert!(wrong.is_empty(), "{} of {count} went wrong:\n{}", wrong.len(), wrong.join("\n"));
        assert!(count >= least, "{count} tried");
        println!("{count} tried");
    }
}
