//! Reports: what a run was and what came of it, and how two runs differ, as pages to read and to print.

mod compare;
mod curves;
mod elements;
mod files;
mod written;

pub use compare::comparison;
pub use written::quoted;

use crate::numbers::{brief, count, four, rough, short};
use crate::record::Sweep;
use crate::results::{Results, ResultsError};
use curves::{Asked, Drawn};
use springpot_report::page::{Block, Fact, Report, Section, Table};

/// Cases of a table.
const MOST_CASES: usize = 100;
/// Joints whose coordinates are drawn.
const MOST_JOINTS: usize = 8;

/// The report of a run.
///
/// # Errors
/// The results cannot be read.
pub fn report(results: &Results) -> Result<Report, ResultsError> {
    let record = &results.record;
    let drawn = Drawn::of(results, &standard(results))?;
    let mut sections = vec![Section { title: "In short".to_owned(), blocks: in_short(results) }];
    let mut add = |title: &str, blocks: Vec<Block>| {
        if !blocks.is_empty() {
            sections.push(Section { title: title.to_owned(), blocks });
        }
    };
    add("Figures", files::figures(results));
    add("Elements", elements::all(results, &drawn));
    add("Motion", motion(results, &drawn));
    add("Metrics", files::metrics(results).map(Block::Table).into_iter().collect());
    add("Events", files::events(results).map(Block::Table).into_iter().collect());
    add("Energy", energy(results, &drawn));
    add("Model", elements::model(results));
    add("Columns of the results", files::summary(results).map(Block::Table).into_iter().collect());
    add("How to reproduce it", files::reproduce(results));
    Ok(Report {
        title: record.title.clone().unwrap_or_else(|| results.name()),
        subject: format!("results in {}", results.name()),
        status: record.status.clone(),
        version: record.version().to_owned(),
        sections,
    })
}

/// What is drawn of every run, beside the figures of its scenario.
fn standard(results: &Results) -> Vec<Asked> {
    let mut asked = elements::figures(results);
    let coordinates: Vec<String> = results.names().filter(|name| name.starts_with("q.")).map(str::to_owned).collect();
    if !coordinates.is_empty() {
        let shown = coordinates.into_iter().take(MOST_JOINTS).collect();
        asked.push(Asked {
            title: "Coordinates of the joints".to_owned(),
            x: "t".to_owned(),
            y: shown,
            is_first: true,
        });
    }
    if results.names().any(|name| name == "gripper.error") {
        let y = vec!["gripper.error".to_owned()];
        asked.push(Asked {
            title: "Distance of the gripper from where it is to be".to_owned(),
            x: "t".to_owned(),
            y,
            is_first: false,
        });
    }
    let is_energy = |name: &&str| name.starts_with("energy.") && *name != "energy.residual";
    let energies: Vec<String> = results.names().filter(is_energy).map(str::to_owned).collect();
    if !energies.is_empty() {
        asked.push(Asked { title: "Energies of the robot".to_owned(), x: "t".to_owned(), y: energies, is_first: true });
    }
    asked
}

fn fact(name: &str, value: impl Into<String>) -> Fact {
    Fact { name: name.to_owned(), value: value.into() }
}

fn in_short(results: &Results) -> Vec<Block> {
    let facts = facts(results).into_iter().map(|(name, value)| fact(name, value)).collect();
    let mut blocks = vec![Block::Facts(facts)];
    let warnings = warnings(results);
    if !warnings.is_empty() {
        blocks.push(Block::Warnings(warnings));
    }
    blocks
}

/// Names and values that say how a run went.
fn facts(results: &Results) -> Vec<(&'static str, String)> {
    let record = &results.record;
    let rows =
        record.totals.rows.unwrap_or_else(|| record.cases.iter().map(|case| case.rows).fold(0, u64::saturating_add));
    let cases = match record.totals.cases_failed {
        0 => format!("{} of {} done", record.totals.cases_done, record.totals.cases_total),
        failed => format!("{} of {} done, {failed} failed", record.totals.cases_done, record.totals.cases_total),
    };
    let mut facts = vec![("cases", cases)];
    if let Some(end) = record.plan["time"]["end"].as_f64() {
        facts.push(("simulated time", format!("{} s", short(end))));
    }
    facts.push(("rows", rows.to_string()));
    facts.push(("columns", results.columns.len().to_string()));
    facts.push(("steps", record.totals.steps.to_string()));
    if let Some(rtol) = record.plan["solver"]["rtol"].as_f64() {
        facts.push(("tolerance rtol", short(rtol)));
    }
    facts.push(("energy balance", balance(results)));
    facts.push(("computing time", format!("{} s", rough(record.totals.wall_time))));
    facts
}

/// The worst case's residual beside the energy that it turned over.
fn balance(results: &Results) -> String {
    let record = &results.record;
    match (record.totals.energy_residual, record.totals.energy_turned_over) {
        (Some(residual), Some(turned)) => format!("closes to {} J of {} J", rough(residual.abs()), four(turned)),
        _ => record.totals.ledger.clone().unwrap_or_else(|| "unknown".to_owned()),
    }
}

/// All that a reader must not miss: warnings, failed cases, limits that joints pass.
fn warnings(results: &Results) -> Vec<String> {
    let record = &results.record;
    let failed = record.cases.iter().filter_map(|case| {
        let name = results.record.case_name(case);
        let at = case.t_reached.map_or(String::new(), |t| format!(" (rows up to t = {} s)", short(t)));
        let lead = if name.is_empty() { String::new() } else { format!("{name}: ") };
        Some(format!("{lead}{}{at}", case.error.as_ref()?))
    });
    let limits = record.totals.limits.iter().map(written::limit);
    let mut all: Vec<String> = record.warnings.iter().cloned().chain(failed).chain(limits).collect();
    if let Some(more @ 1..) = all.len().checked_sub(MOST_CASES) {
        all.truncate(MOST_CASES);
        all.push(format!("and {}; run.json says which", count(more, "more warning", "more warnings")));
    }
    all
}

fn motion(results: &Results, drawn: &Drawn) -> Vec<Block> {
    let plan = &results.record.plan;
    let mut table = Table::new("", &["key", "value"]);
    table.rows = written::flat(&plan["motion"]);
    let mut blocks = Vec::new();
    if !table.rows.is_empty() {
        blocks.push(Block::Table(table));
    }
    let figures = drawn.titled(&["Coordinates of the joints", "Distance of the gripper from where it is to be"]);
    if !figures.is_empty() {
        blocks.push(Block::Figures(figures));
    }
    blocks
}

/// The balance case by case.
fn energy(results: &Results, drawn: &Drawn) -> Vec<Block> {
    let record = &results.record;
    let mut table = Table::new(
        "Balance",
        &["case", "#residual, J", "#turned over, J", "#reached, s", "#steps", "#computing time, s"],
    );
    let number = |value: Option<f64>, text: fn(f64) -> String| value.map_or_else(|| "–".to_owned(), text);
    for case in record.cases.iter().take(MOST_CASES) {
        let name = results.record.case_name(case);
        table.rows.push(vec![
            if name.is_empty() { "the only one".to_owned() } else { name },
            number(case.energy_residual, rough),
            number(case.energy_turned_over, brief),
            number(case.t_reached, short),
            case.steps.to_string(),
            rough(case.wall_time),
        ]);
    }
    if record.totals.cases_total > table.rows.len() {
        table.note = Some(format!("The first {} of {} cases.", table.rows.len(), record.totals.cases_total));
    }
    let words = "The residual is the largest difference, over a run, between the work that went into the robot and what became of it: kinetic and potential \
        energy, what elements store, what they and the joints dissipate. Energy that has been turned over is what it is measured by.";
    let mut blocks = vec![Block::Text(words.to_owned()), Block::Table(table)];
    let figures = drawn.titled(&["Energies of the robot"]);
    if !figures.is_empty() {
        blocks.push(Block::Figures(figures));
    }
    blocks
}

/// Values of a sweep for a reader, each parameter by its last name.
fn swept(results: &Results) -> Vec<(String, Vec<String>)> {
    results.record.sweeps.iter().map(Sweep::words).collect()
}
