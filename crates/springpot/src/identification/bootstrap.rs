//! Intervals by drawing residuals anew.

use super::descent::descend;
use super::estimate::Residuals;
use super::fit::Fit;
use super::limits::settle;
use super::look::Look;
use super::parameter::Parameter;
use super::problem::{Failed, Problem, Rows, Series};
use crate::random::Random;
use std::sync::atomic::AtomicBool;

/// How residuals are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bootstrap {
    /// Of the random numbers; each replicate has its own, whatever the thread.
    pub seed: u64,
    /// Rows that are drawn together: 1, or more where residuals are correlated (H. R. Künsch, Ann. Statist. 17 (1989) 1217–1241).
    pub block: usize,
}

/// The values of replicate `k`: the fit of what the fit says with residuals drawn anew, about their mean and widened by √(n/(n − p))
/// (B. Efron, R. J. Tibshirani, An Introduction to the Bootstrap, 1993, 9). `None` where it cannot be evaluated, or was interrupted.
pub fn replicate(
    problem: &dyn Problem,
    fit: &Fit,
    bootstrap: Bootstrap,
    k: usize,
    stop: &AtomicBool,
) -> Option<Vec<f64>> {
    let look = Look { problem, scales: &fit.scales, rows: fit.rows, stop };
    let own = Residuals::new(&look, &fit.values)?.0;
    let widening = (fit.rows as f64 / fit.freedom()).sqrt();
    let mut random = Random::new(bootstrap.seed, k as u64 + 1);
    let shift: Vec<Vec<f64>> = own
        .iter()
        .map(|rows| {
            let mean = rows.iter().sum::<f64>() / rows.len().max(1) as f64;
            let block = bootstrap.block.clamp(1, rows.len().max(1));
            let mut drawn = Vec::with_capacity(rows.len() + block);
            while drawn.len() < rows.len() {
                let start = random.below(rows.len() - block + 1);
                drawn.extend(rows[start..start + block].iter().map(|r| widening * (r - mean)));
            }
            // model(p) less what was drawn: r(p) − r̂ + drawn.
            rows.iter().zip(drawn).map(|(own, drawn)| drawn - own).collect()
        })
        .collect();
    let drawn = Drawn { problem, shift };
    let look = Look { problem: &drawn, ..look };
    let reached = descend(&look, &fit.places, 200);
    let found = settle(&look, reached, 200);
    (!look.is_stopped() && found.cost.is_finite()).then(|| look.values(&found.places))
}

/// The interval that holds the middle `confidence` of the values of replicates, interpolated between them.
pub fn percentiles(mut values: Vec<f64>, confidence: f64) -> [f64; 2] {
    values.sort_unstable_by(f64::total_cmp);
    let at = |share: f64| {
        let place = share * (values.len() as f64 - 1.0);
        let below = place.floor() as usize;
        let above = (below + 1).min(values.len() - 1);
        values[below] + (place - below as f64) * (values[above] - values[below])
    };
    if values.is_empty() { [f64::NAN; 2] } else { [at(0.5 - 0.5 * confidence), at(0.5 + 0.5 * confidence)] }
}

/// A problem with a number added to each residual.
struct Drawn<'a> {
    problem: &'a dyn Problem,
    shift: Vec<Vec<f64>>,
}

impl Problem for Drawn<'_> {
    fn parameters(&self) -> &[Parameter] {
        self.problem.parameters()
    }

    fn series(&self) -> &[Series] {
        self.problem.series()
    }

    fn eliminated(&self) -> usize {
        self.problem.eliminated()
    }

    fn noise(&self) -> f64 {
        self.problem.noise()
    }

    fn rows(&self, values: &[f64], wanted: &[bool], take: &mut dyn FnMut(Rows<'_>)) -> Result<(), Failed> {
        let mut done = vec![0; self.shift.len()];
        let mut shifted = Vec::new();
        self.problem.rows(values, wanted, &mut |rows| {
            let start = done[rows.series];
            done[rows.series] += rows.residuals.len();
            shifted.clear();
            shifted.extend(rows.residuals.iter().zip(&self.shift[rows.series][start..]).map(|(r, shift)| r + shift));
            take(Rows { residuals: &shifted, ..rows });
        })
    }
}
