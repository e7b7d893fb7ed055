//! The search: starts over threads, runs over a growing horizon, laws one after the other, intervals.

use super::admissible;
use super::momentum;
use super::outcome::{Outcome, Status, score};
use super::problem::Problem;
use springpot::identification::{
    Bootstrap, Fit, FitError as Refused, Parameter, Problem as _, Reached, Settings, Side, best, percentiles, profile,
    reach, replicate, rise,
};
use springpot_scenario::{FitSettings, Fitting, Intervals, Refusals};
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Shares of the span of runs over which a start is fitted one after the other: from far away a whole run leads into a wrong valley.
const HORIZONS: [f64; 4] = [0.15, 0.3, 0.6, 1.0];
/// Most steps of a descent over a part.
const STEPS_OF_A_PART: usize = 30;
const STEPS: usize = 200;
/// Points of a profile that is drawn.
const POINTS: usize = 13;
/// Starts of runs and strokes that are tried together.
const BATCH: usize = 2;
/// Costs that differ by less are one, as a share.
const SAME: f64 = 1e-6;
/// As of minima at a bound that a logarithm only drifts towards.
const NEARLY: f64 = 1e-4;
/// The square of a relative residual that is rounding.
const EXACT: f64 = 1e-20;
/// Rounds of starts about the least minimum.
const ROUNDS: u64 = 4;
/// Samples of a long stroke from which the search begins.
const FEW: usize = 500;
/// Starts of strokes that have come to one minimum, after which no more are tried.
const AGREEING: usize = 3;
/// Criteria of laws that differ by less are one.
const ALIKE: f64 = 0.01;
/// Lag-1 correlations that widen.
const CORRELATED: f64 = 0.3;

/// Why there is no fit.
#[derive(Debug, thiserror::Error)]
pub enum FitError {
    /// The scenario is refused.
    #[error(transparent)]
    Refused(#[from] Refusals),
    /// What is asked for cannot be.
    #[error("{0}")]
    Unfit(String),
    /// No start could be evaluated.
    #[error("no start can be evaluated: {0}")]
    Unstartable(String),
}

/// Fits; interrupted by `stop`, it gives the best so far. `jobs` threads take part, whose number changes no bit.
///
/// # Errors
/// [`FitError`].
pub fn fit(fitting: Fitting, jobs: usize, stop: &AtomicBool) -> Result<Outcome, FitError> {
    let laws = fitting.plan().settings.laws.clone();
    if laws.is_empty() {
        return one(fitting, jobs, stop);
    }
    let mut found: Vec<(String, Outcome)> = Vec::new();
    let mut failures = Vec::new();
    for law in laws {
        match one(fitting.with_law(&law)?, jobs, stop) {
            Ok(outcome) => found.push((law, outcome)),
            Err(FitError::Unstartable(why)) => failures.push(format!("{law}: no start can be evaluated: {why}")),
            Err(other) => return Err(other),
        }
    }
    let scores: Vec<_> = found
        .iter()
        .map(|(law, outcome)| {
            let fit = &outcome.fit;
            (law.clone(), fit.cost, fit.parameters + fit.eliminated, [fit.criteria.aicc, fit.criteria.bic])
        })
        .collect();
    // A law that ends as another one, its further numbers at their bounds, is that one.
    let bic = |(_, outcome): &(String, Outcome)| outcome.fit.criteria.bic;
    let least = found.iter().map(bic).fold(f64::INFINITY, f64::min);
    let alike = found.into_iter().filter(|one| bic(one) <= least + ALIKE);
    let Some((law, mut outcome)) = alike.min_by_key(|(_, outcome)| outcome.fit.values.len()) else {
        return Err(FitError::Unstartable(failures.join("; ")));
    };
    outcome.laws = scores;
    outcome.chosen = Some(law);
    outcome.warnings.extend(failures);
    Ok(outcome)
}

/// Calls `work` for 0 … count − 1 on so many threads; what they give, in order, as far as it came before `stop`.
fn spread<T: Send>(count: usize, jobs: usize, stop: &AtomicBool, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let (next, done) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let run = || {
        loop {
            let k = next.fetch_add(1, Ordering::Relaxed);
            if k >= count || k > 0 && stop.load(Ordering::Relaxed) {
                return;
            }
            let own = work(k);
            done.lock().unwrap_or_else(PoisonError::into_inner).push((k, own));
        }
    };
    std::thread::scope(|scope| {
        let others: Vec<_> =
            (1..jobs.min(count)).map_while(|_| std::thread::Builder::new().spawn_scoped(scope, run).ok()).collect();
        run();
        others.into_iter().for_each(|other| other.join().unwrap_or_else(|panic| resume_unwind(panic)));
    });
    let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    done.sort_by_key(|(k, _)| *k);
    done.into_iter().map(|(_, own)| own).collect()
}

/// Where the k-th start leads. Of runs first from what the equations of motion say of it, where records tell how robots move; the first start as it is
/// too, and over growing parts of the records where that leads lower.
fn led(problem: &Problem<'_>, settings: &Settings, k: usize, stop: &AtomicBool) -> Result<Reached, Refused> {
    if !problem.has_runs() {
        return reach(problem, settings, k, stop);
    }
    let Ok(mut inside) = Problem::new(problem.records[0].fitting) else { return reach(problem, settings, k, stop) };
    admissible::narrow(&mut inside);
    let start = reach(&inside, &Settings { steps: 0, ..*settings }, k, stop)?.values(&inside.parameters);
    let guessed = match momentum::guess(&inside, &start, stop) {
        Some(values) => Some(from(&mut inside, problem, (&values, settings.steps), stop)?),
        None => None,
    };
    let guessed = guessed.filter(|reached| reached.cost().is_finite());
    let is_enough = |own: &&Reached| k == 1 && own.is_converged() || problem.is_explained(own.cost());
    if let Some(guessed) = guessed.as_ref().filter(is_enough) {
        return Ok(guessed.clone());
    }
    let direct = (k == 0).then(|| from(&mut inside, problem, (&start, settings.steps), stop)).transpose()?;
    let is_least = |(own, direct): (&Reached, &Reached)| own.cost() <= direct.cost() * (1.0 + NEARLY);
    let is_sure = settings.starts == 1 || guessed.as_ref().zip(direct.as_ref()).is_some_and(is_least);
    let grown = if is_sure { None } else { grown(&mut inside, problem, (&start, settings.steps), stop)? };
    let found = [direct, guessed, grown].into_iter().flatten().min_by(|a, b| a.cost().total_cmp(&b.cost()));
    found.map_or_else(|| reach(problem, &Settings { steps: 0, ..*settings }, k, stop), Ok)
}

/// Where these values lead in so many steps, over the part of the records of `part`, within the bounds of `problem`.
fn from(
    part: &mut Problem<'_>,
    problem: &Problem<'_>,
    (values, steps): (&[f64], usize),
    stop: &AtomicBool,
) -> Result<Reached, Refused> {
    part.parameters.clone_from(&problem.parameters);
    part.parameters.iter_mut().zip(values).for_each(|(parameter, value)| parameter.start = vec![*value]);
    reach(part, &Settings { starts: 1, steps, ..Settings::default() }, 0, stop)
}

/// Where these values lead over growing parts of the records.
fn grown(
    part: &mut Problem<'_>,
    problem: &Problem<'_>,
    (start, most): (&[f64], usize),
    stop: &AtomicBool,
) -> Result<Option<Reached>, Refused> {
    let mut values = start.to_vec();
    for horizon in HORIZONS {
        part.horizon = horizon;
        let steps = if horizon < 1.0 { STEPS_OF_A_PART } else { most };
        let reached = from(part, problem, (&values, steps), stop)?;
        if horizon >= 1.0 {
            return Ok(Some(reached));
        }
        if !reached.cost().is_finite() || stop.load(Ordering::Relaxed) {
            break;
        }
        values = reached.values(&part.parameters);
    }
    part.horizon = 1.0;
    Ok(None)
}

/// Where all starts lead. Of runs, which are dear, no more are tried once two have come to the least cost; of strokes, once three have.
fn reached(
    problem: &Problem<'_>,
    settings: &Settings,
    jobs: usize,
    stop: &AtomicBool,
) -> Result<Vec<Reached>, Refused> {
    let enough = match (problem.has_runs(), problem.takes_steps()) {
        (true, _) => 2,
        (false, true) => AGREEING,
        _ => usize::MAX,
    };
    let batch = if problem.takes_steps() { BATCH } else { settings.starts.max(1) };
    let mut all: Vec<Reached> = Vec::new();
    while all.len() < settings.starts.max(1) {
        let first = all.len();
        let count = batch.min(settings.starts.max(1) - first);
        let found = spread(count, jobs, stop, |k| led(problem, settings, first + k, stop));
        let came = found.len();
        all.extend(found.into_iter().collect::<Result<Vec<_>, _>>()?);
        let least = all.iter().map(Reached::cost).fold(f64::INFINITY, f64::min);
        let agreeing = all.iter().filter(|one| one.cost() <= least * (1.0 + NEARLY)).count();
        if came < count || stop.load(Ordering::Relaxed) || agreeing >= enough {
            break;
        }
    }
    Ok(all)
}

/// The least of the minima about a minimum too: where residuals cost nothing, as many starts about it, until none leads lower. Of the starts told those
/// count that came to the least of all.
fn about(
    problem: &Problem<'_>,
    (settings, reached): (&Settings, &[Reached]),
    mut found: Fit,
    jobs: usize,
    stop: &AtomicBool,
) -> Result<Fit, Refused> {
    let fitting = problem.records[0].fitting;
    // Rows that the law meets to rounding leave nothing to be compared.
    let exact = EXACT * found.rows as f64;
    for round in 1..=ROUNDS {
        if stop.load(Ordering::Relaxed) {
            break;
        }
        let Ok(mut near) = Problem::new(fitting) else { break };
        for (parameter, value) in near.parameters.iter_mut().zip(&found.values) {
            // From a bound there is nothing to spread: from where the parameter began.
            let is_inside = parameter.bounds.iter().all(|bound| bound != value);
            parameter.start = vec![if is_inside { *value } else { parameter.start[0] }];
        }
        let settings = Settings { seed: settings.seed.wrapping_add(round), starts: settings.starts + 1, ..*settings };
        let others = spread(settings.starts - 1, jobs, stop, |k| reach(&near, &settings, k + 1, stop));
        let others = others.into_iter().collect::<Result<Vec<_>, _>>()?;
        let least = others.iter().map(Reached::cost).fold(f64::INFINITY, f64::min);
        if least >= found.cost * (1.0 - SAME) || found.cost <= exact {
            break;
        }
        found = best(problem, &settings, &others, stop)?;
    }
    let least = reached.iter().filter(|one| one.cost() <= found.cost * (1.0 + NEARLY) + exact).count();
    found.starts = [reached.len(), least];
    Ok(found)
}

/// The fit of all rows. Long strokes are first fitted by a part of their samples from all starts, and then from the best of these.
fn found(problem: &Problem<'_>, settings: &Settings, jobs: usize, stop: &AtomicBool) -> Result<Fit, Refused> {
    if !problem.has_long_strokes(2 * FEW) || settings.starts == 1 {
        let reached = reached(problem, settings, jobs, stop)?;
        let found = best(problem, settings, &reached, stop)?;
        return if settings.starts == 1 || problem.takes_steps() {
            Ok(found)
        } else {
            about(problem, (settings, &reached), found, jobs, stop)
        };
    }
    let fitting = problem.records[0].fitting;
    let Ok(coarse) = Problem::thinned(fitting, FEW) else { return best(problem, settings, &[], stop) };
    let reached = reached(&coarse, settings, jobs, stop)?;
    let near = best(&coarse, settings, &reached, stop)?;
    let Ok(mut whole) = Problem::new(fitting) else { return Ok(near) };
    let inside = |(parameter, value): (&mut Parameter, &f64)| {
        // What the part has at its bound may be inside.
        let [low, high] = parameter.bounds;
        let room = 1e-3 * (high - low).min(parameter.typical);
        parameter.start = vec![value.max(low + room).min(high - room)];
    };
    whole.parameters.iter_mut().zip(&near.values).for_each(inside);
    let last = reach(&whole, &Settings { starts: 1, ..*settings }, 0, stop)?;
    let mut whole = best(problem, settings, &[last], stop)?;
    whole.starts = near.starts;
    Ok(whole)
}

/// One fit.
fn one(fitting: Fitting, jobs: usize, stop: &AtomicBool) -> Result<Outcome, FitError> {
    let FitSettings { starts, seed, confidence, intervals: wanted, .. } = fitting.plan().settings.clone();
    let (fit, intervals, profiles, records, series, warnings) = {
        let problem = Problem::new(&fitting).map_err(FitError::Unfit)?;
        refuse_unseen(&problem)?;
        let settings = Settings { starts, seed, steps: STEPS };
        let found = found(&problem, &settings, jobs, stop).map_err(unfit)?;
        // Where another number came to its bound, what belongs to it may be out of sight.
        if !found.unseen.is_empty() && found.at_bound.iter().all(Option::is_none) {
            return Err(no_data_see(&problem, &found.unseen));
        }
        let intervals = intervals(&problem, &found, (wanted, confidence, seed), jobs, stop);
        let profiles = profiles(&problem, &found, (wanted, &intervals), jobs, stop);
        let mut warnings = warnings(&problem, &found);
        let records: Vec<_> = (0..problem.records.len())
            .map(|k| {
                score(&problem, k, &found.values).unwrap_or_else(|| {
                    warnings.push(format!(
                        "data {:?} cannot be predicted with what was found",
                        problem.records[k].data.name
                    ));
                    super::outcome::RecordScore { rows: Vec::new(), columns: Vec::new(), cost: f64::NAN }
                })
            })
            .collect();
        (found, intervals, profiles, records, names(&problem), warnings)
    };
    let status = if stop.load(Ordering::Relaxed) { Status::Interrupted } else { fit.status.into() };
    Ok(Outcome { status, fitting, fit, intervals, profiles, records, series, laws: Vec::new(), chosen: None, warnings })
}

fn unfit(error: Refused) -> FitError {
    match error {
        Refused::Unstartable(why) => FitError::Unstartable(why),
        other => FitError::Unfit(other.to_string()),
    }
}

fn no_data_see(problem: &Problem<'_>, unseen: &[usize]) -> FitError {
    let names: Vec<&str> = unseen.iter().map(|at| problem.parameters[*at].name.as_str()).collect();
    let list = springpot_scenario::list(names.iter().copied());
    FitError::Unfit(format!("no data depend on {list}: leave out what no column follows from"))
}

/// Refuses parameters that no row depends on where the search begins.
fn refuse_unseen(problem: &Problem<'_>) -> Result<(), FitError> {
    let start: Vec<f64> = problem.parameters.iter().map(|one| one.start[0]).collect();
    let n = start.len();
    let mut seen = vec![false; n];
    let looked = problem.rows(&start, &vec![true; n], &mut |rows| {
        for line in rows.jacobian.chunks(n) {
            line.iter().zip(&mut seen).for_each(|(x, seen)| *seen |= *x != 0.0);
        }
    });
    // Where it cannot begin at all, that is told.
    let unseen: Vec<usize> = (0..n).filter(|j| !seen[*j] && problem.parameters[*j].prior.is_none()).collect();
    if looked.is_err() || unseen.is_empty() { Ok(()) } else { Err(no_data_see(problem, &unseen)) }
}

/// Names of the series: those of the columns where no two records have one of that name.
pub(super) fn names(problem: &Problem<'_>) -> Vec<String> {
    let fitted = || problem.records.iter().filter(|record| record.data.is_fitted);
    let all: Vec<(&str, &str)> = fitted()
        .flat_map(|record| record.data.columns.iter().map(|column| (&*record.data.name, &*column.name)))
        .collect();
    let is_alone = |name: &str| all.iter().filter(|(_, own)| *own == name).count() == 1;
    all.iter().map(|(data, name)| if is_alone(name) { (*name).to_owned() } else { format!("{data}.{name}") }).collect()
}

fn intervals(
    problem: &Problem<'_>,
    fit: &Fit,
    (wanted, confidence, seed): (Intervals, f64, u64),
    jobs: usize,
    stop: &AtomicBool,
) -> Vec<[f64; 2]> {
    let n = fit.values.len();
    let wald = |j: usize| fit.wald(&problem.parameters[j], j, confidence);
    let by_cost: Vec<usize> = (0..n).filter(|j| wanted == Intervals::Profile || fit.at_bound[*j].is_some()).collect();
    let profiled = spread(by_cost.len(), jobs, stop, |k| profile(problem, fit, by_cost[k], confidence, stop));
    let mut all: Vec<[f64; 2]> = (0..n).map(wald).collect();
    for (j, found) in by_cost.iter().zip(profiled) {
        if let Some(found) = found {
            all[*j] = found;
        } else if let Some(side) = fit.at_bound[*j] {
            let bounds = problem.parameters[*j].bounds;
            all[*j] = if side == Side::Lower { [fit.values[*j], bounds[1]] } else { [bounds[0], fit.values[*j]] };
        }
    }
    if let Intervals::Bootstrap(count) = wanted {
        // Rows that follow one another stay together as long as they are alike.
        let most = fit.lag1.iter().fold(0.0_f64, |most, rho| most.max(*rho));
        let rows = fit.rows / problem.series.len().max(1);
        let block = if most > CORRELATED { ((1.0 + most) / (1.0 - most)).ceil() as usize * 2 } else { 1 };
        let bootstrap = Bootstrap { seed, block: block.clamp(1, (rows / 4).max(1)) };
        let drawn = spread(count, jobs, stop, |k| replicate(problem, fit, bootstrap, k, stop));
        let drawn: Vec<Vec<f64>> = drawn.into_iter().flatten().collect();
        if drawn.len() >= count / 2 {
            for j in (0..n).filter(|j| fit.at_bound[*j].is_none()) {
                all[j] = percentiles(drawn.iter().map(|values| values[j]).collect(), confidence);
            }
        }
    }
    all
}

/// Points of the profiles about their intervals.
fn profiles(
    problem: &Problem<'_>,
    fit: &Fit,
    (wanted, intervals): (Intervals, &[[f64; 2]]),
    jobs: usize,
    stop: &AtomicBool,
) -> Vec<(usize, Vec<[f64; 2]>)> {
    if wanted != Intervals::Profile {
        return Vec::new();
    }
    let finite = |j: &usize| intervals[*j].iter().all(|end| end.is_finite()) && intervals[*j][0] < intervals[*j][1];
    let drawn: Vec<usize> = (0..fit.values.len()).filter(finite).collect();
    let points = spread(drawn.len() * POINTS, jobs, stop, |at| {
        let (j, k) = (drawn[at / POINTS], at % POINTS);
        let [low, high] = intervals[j];
        let value = low + (high - low) * k as f64 / (POINTS - 1) as f64;
        (j, rise(problem, fit, j, value, stop).map(|rise| [value, rise]))
    });
    let own = |j: usize| points.iter().filter(|(of, _)| *of == j).filter_map(|(_, point)| *point).collect();
    drawn.iter().map(|j| (*j, own(*j))).collect()
}

/// What a reader should know of the fit.
fn warnings(problem: &Problem<'_>, fit: &Fit) -> Vec<String> {
    let mut all = Vec::new();
    if fit.widening > 1.0 {
        let (at, rho) =
            fit.lag1.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).map_or((0, 0.0), |(at, rho)| (at, *rho));
        let name = &names(problem)[at];
        all.push(format!(
            "residuals of {name} follow one another (lag-1 correlation {rho:.2}): every sd is {:.2} times what independent rows would give; the model \
             does not describe the rows to their noise",
            fit.widening
        ));
    }
    for at in &fit.unseen {
        let name = &problem.parameters[*at].name;
        all.push(format!("no data depend on {name} where the fit has ended: its value says nothing"));
    }
    let [tried, reached] = fit.starts;
    if tried >= 4 && reached * 4 < tried {
        all.push(format!(
            "{reached} of {tried} starts reached the least cost: more `starts` or `bounds` make it surer"
        ));
    }
    for record in problem.records.iter().filter(|record| record.data.skipped > 0) {
        let rows = crate::numbers::count(record.data.skipped, "row", "rows");
        all.push(format!("data {:?}: {rows} without all cells left out", record.data.name));
    }
    all
}
