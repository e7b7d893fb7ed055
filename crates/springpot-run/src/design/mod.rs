//! A scenario whose parameters are moved until a metric is as small, or as large, as constraints let it be.

mod outcome;
mod problem;

pub use outcome::{Designed, Reached, Tried};

use problem::{Evaluated, Problem};
use springpot::law::Catalog;
use springpot::optimisation::{Descent, Settings, Status, descend, hypercube};
use springpot::system::Stop;
use springpot_scenario::{Refusals, Scenario};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Runs of one start at most.
const MOST: usize = 100;

/// A constraint that is broken by less than this share of its limit holds.
const HOLDS: f64 = 1e-6;

/// What one start led to.
struct Start {
    descent: Descent,
    tried: Vec<Tried>,
}

/// Designs a scenario; `jobs` starts at a time, with `starts` in place of those of the file.
///
/// # Errors
/// What [`Scenario::for_design`] refuses.
pub fn design(
    scenario: &Scenario,
    catalog: &Catalog,
    (starts, jobs): (Option<usize>, usize),
    stop: &Stop,
) -> Result<Designed, Refusals> {
    let (differentiated, plan) = scenario.for_design(catalog)?;
    let problem = Problem::new([scenario, &differentiated], catalog, &plan, stop);
    let file: Vec<f64> = problem.parameters().iter().map(|parameter| parameter.value).collect();
    let before = problem.evaluate(&file);
    let count = starts.unwrap_or(problem.plan().starts);
    let begin = begin(&problem, count);
    let (next, found) = (AtomicUsize::new(0), Mutex::new((0..begin.len()).map(|_| None).collect::<Vec<_>>()));
    let work = || {
        while !stop.load(Ordering::Relaxed) {
            let k = next.fetch_add(1, Ordering::Relaxed);
            let Some(x) = begin.get(k) else { break };
            let known = before.as_ref().map(|before| (&file[..], before));
            let start = go_down(&problem, (k, x), known);
            found.lock().unwrap_or_else(PoisonError::into_inner)[k] = Some(start);
        }
    };
    std::thread::scope(|scope| {
        let spawn = |_| std::thread::Builder::new().spawn_scoped(scope, work).ok();
        let others: Vec<_> = (1..jobs.min(begin.len())).map_while(spawn).collect();
        work();
        others.into_iter().for_each(|other| other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
    });
    let found = found.into_inner().unwrap_or_else(PoisonError::into_inner);
    let interrupted = stop.load(Ordering::Relaxed);
    Ok(Designed::of(&problem, before.as_ref(), found.into_iter().flatten().collect(), interrupted))
}

/// Where the search begins: as the parameters say, then a Latin hypercube.
fn begin(problem: &Problem<'_>, count: usize) -> Vec<Vec<f64>> {
    let parameters = problem.parameters();
    let given = parameters.iter().map(|parameter| parameter.starts.len()).max().unwrap_or(0).max(1).min(count.max(1));
    let own = |k: usize| {
        let value = |starts: &Vec<f64>, value: f64| match starts.len() {
            0 => value,
            count => starts[k.min(count - 1)],
        };
        let values: Vec<f64> = parameters.iter().map(|parameter| value(&parameter.starts, parameter.value)).collect();
        problem.variables(&values)
    };
    let spread = hypercube(parameters.len(), count.saturating_sub(given), problem.plan().seed);
    (0..given).map(own).chain(spread).collect()
}

/// From one start down.
fn go_down(problem: &Problem<'_>, (number, x): (usize, &[f64]), known: Option<(&[f64], &Evaluated)>) -> Start {
    let (mut tried, mut scales) = (Vec::new(), None);
    let mut at = |x: &[f64]| {
        let values = problem.values(x);
        let found = match known {
            Some((own, before)) if own == values => Some(before.clone()),
            _ => problem.evaluate(&values),
        };
        tried.push(Tried::of(problem, number, &values, found.as_ref()));
        let found = found?;
        let scales = scales.get_or_insert_with(|| problem.scales(&found, x));
        Some(problem.scaled(&found, x, scales))
    };
    let small = |x: &[f64], d: &[f64]| problem.is_small(x, d);
    let mut descent = descend(x, &Settings { most: MOST }, &mut at, &small);
    if let Some(scales) = scales {
        scales.undo(&mut descent.multipliers, problem.plan().constraints.len());
    }
    if descent.status == Status::Infeasible && descent.value.as_ref().is_some_and(|value| value.broken() <= HOLDS) {
        descent.status = Status::Stalled;
    }
    Start { descent, tried }
}
