//! A whole fit: starts, the best of them, bounds, and what the minimum says.

use super::descent::{Descent, End, descend};
use super::estimate::{Criteria, Residuals, covariance};
use super::limits::settle;
use super::look::{Look, Place};
use super::parameter::{Parameter, Side};
use super::problem::{Loss, Problem};
use super::starts;
use super::student::student_quantile;
use super::undetermined::{Undetermined, undetermined};
use std::sync::atomic::AtomicBool;

/// Costs that differ by less are one, as a share.
const SAME: f64 = 1e-6;
/// Rounds in which the scales of Huber's losses settle.
const ROUNDS: usize = 50;

/// How a fit goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Starts: first those of the parameters, then a Latin hypercube.
    pub starts: usize,
    /// Of its random numbers.
    pub seed: u64,
    /// Most steps of a descent.
    pub steps: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self { starts: 20, seed: 1, steps: 500 }
    }
}

/// How a fit ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// At a minimum.
    Converged,
    /// After too many steps, at the best so far.
    NotConverged,
    /// Because it was asked to, at the best so far.
    Interrupted,
}

/// Why there is no fit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FitError {
    /// Nothing is sought.
    #[error("there is no parameter")]
    NoParameter,
    /// A parameter that cannot be sought.
    #[error("the parameter {name}: {fault}")]
    Parameter {
        /// Which.
        name: String,
        /// What is wrong with it.
        fault: &'static str,
    },
    /// Fewer rows than parameters.
    #[error("{rows} rows for {parameters} parameters")]
    TooFewRows {
        /// Rows.
        rows: usize,
        /// Parameters.
        parameters: usize,
    },
    /// No start has residuals.
    #[error("no start can be evaluated: {0}")]
    Unstartable(String),
}

/// Where one start led; [`best`] takes those of all of them.
#[derive(Debug, Clone)]
pub struct Reached(Descent);

impl Reached {
    /// The cost there; infinite where the start has none.
    pub fn cost(&self) -> f64 {
        self.0.cost
    }

    /// Whether it is a minimum.
    pub fn is_converged(&self) -> bool {
        self.0.end == End::Converged
    }

    /// The values there.
    pub fn values(&self, parameters: &[Parameter]) -> Vec<f64> {
        parameters.iter().zip(&self.0.places).map(|(parameter, place)| place.value(parameter)).collect()
    }
}

/// A fit.
#[derive(Debug, Clone)]
pub struct Fit {
    /// How it ended.
    pub status: Status,
    /// The parameters, in their units.
    pub values: Vec<f64>,
    /// Which of them stand at a bound, to the bit, because the cost falls towards it.
    pub at_bound: Vec<Option<Side>>,
    /// Parameters that no residual depends on: their values are those of the start.
    pub unseen: Vec<usize>,
    /// Σ r², or of losses, with priors.
    pub cost: f64,
    /// Rows, those of priors not among them.
    pub rows: usize,
    /// Parameters that are estimated: neither at a bound nor unseen.
    pub parameters: usize,
    /// Linear unknowns that the problem has taken out.
    pub eliminated: usize,
    /// Covariance of all parameters, row by row; 0 beside what is not estimated, infinite or NaN beside what rows leave open.
    pub covariance: Vec<f64>,
    /// By what correlated residuals have widened standard deviations; 1 where they are not correlated.
    pub widening: f64,
    /// Of each series the standard deviation of its residuals.
    pub sigma: Vec<f64>,
    /// Of each series the correlation of its residuals with the next ones.
    pub lag1: Vec<f64>,
    /// What rows do not tell apart.
    pub undetermined: Vec<Undetermined>,
    /// Criteria to choose among laws.
    pub criteria: Criteria,
    /// Starts that were tried, and those that reached the same cost.
    pub starts: [usize; 2],
    /// Beyond which multiple Huber's losses bend.
    pub(super) scales: Vec<f64>,
    /// σ².
    pub(super) noise: f64,
    pub(super) places: Vec<Place>,
}

impl Fit {
    /// The standard deviation of a parameter, 0 for one that is not estimated; infinite where rows leave it open.
    pub fn sd(&self, j: usize) -> f64 {
        self.covariance[j * self.values.len() + j].sqrt()
    }

    /// The correlation of two parameters; NaN where one of them is not estimated.
    pub fn correlation(&self, i: usize, j: usize) -> f64 {
        self.covariance[i * self.values.len() + j] / (self.sd(i) * self.sd(j))
    }

    /// n − p.
    pub fn freedom(&self) -> f64 {
        self.rows as f64 - (self.parameters + self.eliminated) as f64
    }

    /// Value ± t·sd in the variable of the parameter's scale, brought back; only the value of one that is not estimated.
    pub fn wald(&self, parameter: &Parameter, j: usize, confidence: f64) -> [f64; 2] {
        let value = self.values[j];
        if self.at_bound[j].is_some() || self.unseen.contains(&j) {
            return [value; 2];
        }
        let reach = student_quantile(0.5 + 0.5 * confidence, self.freedom()) * self.sd(j) / parameter.slope(value);
        if reach.is_nan() {
            return parameter.bounds;
        }
        let u = parameter.variable(value);
        [parameter.value(u - reach), parameter.value(u + reach)]
    }
}

/// Checks a problem, and counts its rows.
pub(super) fn rows(problem: &dyn Problem) -> Result<usize, FitError> {
    let parameters = problem.parameters();
    if parameters.is_empty() {
        return Err(FitError::NoParameter);
    }
    for parameter in parameters {
        if let Some(fault) = parameter.fault() {
            return Err(FitError::Parameter { name: parameter.name.clone(), fault });
        }
    }
    Ok(parameters.len())
}

/// Downhill from the k-th start of `settings`: nothing but the problem, the settings and k has to do with where it comes to, so that starts
/// may be spread over threads.
///
/// # Errors
/// [`FitError::NoParameter`], [`FitError::Parameter`].
pub fn reach(problem: &dyn Problem, settings: &Settings, k: usize, stop: &AtomicBool) -> Result<Reached, FitError> {
    rows(problem)?;
    let parameters = problem.parameters();
    let starts = starts::starts(parameters, settings.starts, settings.seed);
    let start = &starts[k.min(starts.len() - 1)];
    let places: Vec<Place> =
        parameters.iter().zip(start).map(|(parameter, value)| Place::At(parameter.variable(*value))).collect();
    let scales = vec![f64::INFINITY; problem.series().len()];
    let look = Look { problem, scales: &scales, rows: 0, stop };
    Ok(Reached(descend(&look, &places, settings.steps)))
}

/// The fit from where the starts have led: the least cost among them, with what belongs at its bound put there.
///
/// # Errors
/// [`FitError`].
pub fn best(
    problem: &dyn Problem,
    settings: &Settings,
    reached: &[Reached],
    stop: &AtomicBool,
) -> Result<Fit, FitError> {
    rows(problem)?;
    let series = problem.series();
    let least = reached.iter().map(|one| &one.0).min_by(|a, b| a.cost.total_cmp(&b.cost));
    let start = least.filter(|least| least.end != End::Unstartable).cloned();
    let Some(mut at) = start else {
        let start = starts::starts(problem.parameters(), 1, settings.seed).swap_remove(0);
        let wanted = vec![false; start.len()];
        let why = problem
            .rows(&start, &wanted, &mut |_| {})
            .err()
            .map_or("a residual is not a finite number".into(), |e| e.0);
        return Err(FitError::Unstartable(why));
    };
    let mut scales = vec![f64::INFINITY; series.len()];
    let residuals = |at: &Descent, scales: &[f64]| {
        let look = Look { problem, scales, rows: 0, stop };
        Residuals::new(&look, &look.values(&at.places))
            .ok_or_else(|| FitError::Unstartable("the minimum cannot be evaluated again".into()))
    };
    let count = residuals(&at, &scales)?.count();
    let sought = at.places.len() + problem.eliminated();
    if count < sought {
        return Err(FitError::TooFewRows { rows: count, parameters: sought });
    }
    let agreeing = reached.iter().filter(|one| one.0.cost <= at.cost * (1.0 + SAME)).count();
    at = settle(&Look { problem, scales: &scales, rows: count, stop }, at, settings.steps);
    if series.iter().any(|series| series.loss != Loss::Squares) {
        for _ in 0..ROUNDS {
            let next = residuals(&at, &scales)?.scales();
            let is_settled = next.iter().zip(&scales).all(|(next, last)| (next - last).abs() <= 1e-9 * next);
            scales = next;
            let look = Look { problem, scales: &scales, rows: count, stop };
            at = settle(&look, descend(&look, &at.places, settings.steps), settings.steps);
            if is_settled || at.end == End::Interrupted {
                break;
            }
        }
    }
    let look = Look { problem, scales: &scales, rows: count, stop };
    let values = look.values(&at.places);
    summary(&look, at, [reached.len(), agreeing]).ok_or_else(|| undifferentiable("the minimum", problem, &values))
}

/// Says by which parameters there are no derivatives at these values.
fn undifferentiable(of: &str, problem: &dyn Problem, values: &[f64]) -> FitError {
    let (parameters, n) = (problem.parameters(), values.len());
    let mut is_missing = vec![false; n];
    let told = problem.rows(values, &vec![true; n], &mut |rows| {
        for line in rows.jacobian.chunks(n) {
            is_missing.iter_mut().zip(line).for_each(|(missing, slope)| *missing |= !slope.is_finite());
        }
    });
    let each = parameters.iter().zip(values).zip(is_missing).filter(|(_, missing)| *missing);
    let named: Vec<String> = each.map(|((own, value), _)| format!("{} = {value}", own.name)).collect();
    FitError::Unstartable(match told {
        Err(failed) => format!("{of} has no derivatives: {failed}"),
        Ok(()) if named.is_empty() => format!("{of} has no derivatives that are finite numbers"),
        Ok(()) => format!("{of} has no derivative by {}", named.join(" and ")),
    })
}

/// What rows say of the parameters at the first start, as if the least cost were there.
///
/// # Errors
/// [`FitError`].
pub fn at_start(problem: &dyn Problem, settings: &Settings, stop: &AtomicBool) -> Result<Fit, FitError> {
    rows(problem)?;
    let start = starts::starts(problem.parameters(), 1, settings.seed).swap_remove(0);
    let place = |(parameter, value): (&Parameter, &f64)| Place::At(parameter.variable(*value));
    let places: Vec<Place> = problem.parameters().iter().zip(&start).map(place).collect();
    let scales = vec![f64::INFINITY; problem.series().len()];
    let unstartable = || {
        let told = problem.rows(&start, &vec![false; start.len()], &mut |_| {}).err();
        told.map_or_else(|| undifferentiable("the start", problem, &start), |error| FitError::Unstartable(error.0))
    };
    let look = Look { problem, scales: &scales, rows: 0, stop };
    let count = Residuals::new(&look, &start).ok_or_else(unstartable)?.count();
    let look = Look { rows: count, ..look };
    let at = Descent { cost: look.cost(&start), places, end: End::Converged };
    summary(&look, at, [1, 1]).ok_or_else(unstartable)
}

/// What a minimum says.
fn summary(look: &Look<'_>, at: Descent, starts: [usize; 2]) -> Option<Fit> {
    let n = at.places.len();
    let values = look.values(&at.places);
    let residuals = Residuals::new(look, &values)?;
    let moving: Vec<bool> = at.places.iter().map(|place| matches!(place, Place::At(_))).collect();
    let triangle = look.by_values(&values, &moving)?;
    let unseen: Vec<usize> = (0..n).filter(|j| moving[*j] && triangle.norm(*j) == 0.0).collect();
    let at_bound: Vec<Option<Side>> = (0..n)
        .map(|j| match at.places[j] {
            Place::Bound(side) => Some(side),
            Place::At(u) if !unseen.contains(&j) => {
                let [low, high] = look.parameters()[j].ends();
                let gradient = triangle.product(j, n);
                match gradient {
                    _ if u <= low && gradient > 0.0 => Some(Side::Lower),
                    _ if u >= high && gradient < 0.0 => Some(Side::Upper),
                    _ => None,
                }
            }
            _ => None,
        })
        .collect();
    let columns: Vec<usize> = (0..n).filter(|j| moving[*j] && at_bound[*j].is_none() && !unseen.contains(j)).collect();
    let m = columns.len();
    let freedom = look.freedom(m);
    let is_estimated = look.problem.series().iter().any(|series| !series.has_sd);
    let noise = if is_estimated { at.cost / freedom } else { 1.0 };
    let (part, triangle) = covariance(look, &at.places, &columns, &residuals, noise)?;
    let widening = residuals.widening();
    let mut whole = vec![0.0; n * n];
    for (i, &row) in columns.iter().enumerate() {
        for (j, &column) in columns.iter().enumerate() {
            whole[row * n + column] = widening * widening * part[i * m + j];
        }
    }
    let share = freedom / look.rows as f64;
    let sigma = |rows: &Vec<f64>| (rows.iter().map(|r| r * r).sum::<f64>() / (rows.len() as f64 * share)).sqrt();
    Some(Fit {
        status: match at.end {
            End::Converged => Status::Converged,
            End::Interrupted => Status::Interrupted,
            End::Exhausted | End::Unstartable => Status::NotConverged,
        },
        undetermined: undetermined(&triangle, &columns, &values, widening * widening * noise),
        sigma: residuals.0.iter().map(sigma).collect(),
        lag1: residuals.lag1(),
        criteria: Criteria::new(at.cost, look.rows, m + look.problem.eliminated()),
        cost: at.cost,
        rows: look.rows,
        parameters: m,
        eliminated: look.problem.eliminated(),
        covariance: whole,
        widening,
        values,
        at_bound,
        unseen,
        starts,
        scales: look.scales.to_vec(),
        noise,
        places: at.places,
    })
}

/// The least cost from all starts of `settings`, one after the other. Interrupted, it gives the best so far.
///
/// # Errors
/// [`FitError`].
pub fn fit(problem: &dyn Problem, settings: &Settings, stop: &AtomicBool) -> Result<Fit, FitError> {
    let mut reached = Vec::new();
    for k in 0..settings.starts.max(1) {
        reached.push(reach(problem, settings, k, stop)?);
        if stop.load(std::sync::atomic::Ordering::Relaxed) {
            break;
        }
    }
    best(problem, settings, &reached, stop)
}
