//! What records can determine, before anything is fitted.

use super::problem::Problem;
use super::search::names;
use springpot::identification::{Settings, at_start};
use springpot_scenario::Fitting;
use std::sync::atomic::AtomicBool;

/// What is known at the start values.
#[derive(Debug, Clone)]
pub struct Ahead {
    /// Of each record: rows that count, and from where to where, s or rad/s.
    pub rows: Vec<(usize, [f64; 2])>,
    /// The expected standard deviation of each parameter; of columns without one it is taken from their distance to the model at the start.
    pub sd: Vec<f64>,
    /// Parameters that no column depends on.
    pub unseen: Vec<usize>,
    /// Combinations that cannot be determined, in words.
    pub undetermined: Vec<String>,
    /// Why nothing is known of the parameters: the model has no values at the start.
    pub failure: Option<String>,
    /// Names of the columns that are fitted.
    pub columns: Vec<String>,
}

/// Looks at a fit before it is begun.
///
/// # Errors
/// What keeps a record from being compared.
pub fn look(fitting: &Fitting) -> Result<Ahead, String> {
    let problem = Problem::new(fitting)?;
    let rows = problem.records.iter().map(|record| {
        let at = record.rows.iter().map(|row| record.data.at[*row]);
        (record.rows.len(), [at.clone().fold(f64::INFINITY, f64::min), at.fold(f64::NEG_INFINITY, f64::max)])
    });
    let mut ahead = Ahead {
        rows: rows.collect(),
        sd: Vec::new(),
        unseen: Vec::new(),
        undetermined: Vec::new(),
        failure: None,
        columns: names(&problem),
    };
    if problem.parameters.is_empty() {
        return Ok(ahead);
    }
    match at_start(&problem, &Settings::default(), &AtomicBool::new(false)) {
        Ok(fit) => {
            ahead.sd = (0..fit.values.len()).map(|j| fit.sd(j) / fit.widening).collect();
            ahead.unseen.clone_from(&fit.unseen);
            let name = |j: usize| problem.parameters[j].name.clone();
            ahead.undetermined = fit.undetermined.iter().map(|open| open.direction(name)).collect();
        }
        Err(error) => ahead.failure = Some(error.to_string()),
    }
    Ok(ahead)
}
