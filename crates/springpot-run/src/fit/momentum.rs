//! A first guess for robots: the equations of motion along the measured motion, without integrating it.
//!
//! With the measured coordinates in place of the motion, the forces that the free joints lack follow at once for any values of the parameters. Weighted by
//! φ = (1 − s²)³ over windows of rows, ∫φ(M a + b − Q) dt = −∫φ̇ M v dt + ∫φ(b − Ṁ v − Q) dt: the balance of momentum, in which the noise of accelerations
//! is gone. It is linear in stiffnesses, masses and dampings, and no guess is so far off that a motion runs away from the measured one.

use super::problem::Problem;
use super::track::Track;
use springpot::identification::{self, Failed, Parameter, Rows, Series, Settings, reach};
use springpot_scenario::DataKind;
use std::sync::atomic::{AtomicBool, Ordering};

/// Changes of the cost that do not matter to a guess, as a share.
const NOISE: f64 = 1e-3;
/// Fits, each with the scatter of the one before as the size of its residuals.
const PASSES: usize = 2;
const STEPS: usize = 60;

/// Values that the equations of motion ask for, beginning at those of `start`; `None` where no record tells how all free joints move.
pub(super) fn guess(problem: &Problem<'_>, start: &[f64], stop: &AtomicBool) -> Option<Vec<f64>> {
    let mut balance = Balance::new(problem, start)?;
    let mut values = start.to_vec();
    for _ in 0..PASSES {
        if stop.load(Ordering::Relaxed) || !balance.measure(&values) {
            return None;
        }
        balance.parameters.iter_mut().zip(&values).for_each(|(own, value)| own.start = vec![*value]);
        let settings = Settings { starts: 1, steps: STEPS, ..Settings::default() };
        let reached = reach(&balance, &settings, 0, stop).ok().filter(|reached| reached.cost().is_finite())?;
        values = reached.values(&balance.parameters);
    }
    balance.tracks.iter().try_for_each(|track| track.begin(&balance.parameters, &mut values).ok()).map(|()| values)
}

/// The equations of motion, and what else was measured, over windows of all records that tell how their robots move.
struct Balance<'a> {
    parameters: Vec<Parameter>,
    series: Vec<Series>,
    /// What residuals of each series are measured by.
    sizes: Vec<f64>,
    tracks: Vec<Track<'a>>,
}

impl<'a> Balance<'a> {
    fn new(problem: &'a Problem<'a>, start: &[f64]) -> Option<Self> {
        let runs = problem.records.iter().filter(|record| record.data.is_fitted && record.data.kind == DataKind::Run);
        let mut tracks: Vec<Track<'a>> = Vec::new();
        for record in runs {
            let first = tracks.last().map_or(0, |last| last.first + last.count());
            tracks.extend(Track::new(record, first, start));
        }
        let count = tracks.last().map(|last| last.first + last.count())?;
        let series = (0..count).map(|k| Series::new(k.to_string())).collect();
        Some(Self { parameters: problem.parameters.clone(), series, sizes: vec![1.0; count], tracks })
    }

    /// Takes the scatter at these values for the sizes of residuals; whether there is any.
    fn measure(&mut self, values: &[f64]) -> bool {
        self.sizes.fill(1.0);
        let mut sums = vec![(0.0, 0usize); self.series.len()];
        let told = identification::Problem::rows(self, values, &vec![false; values.len()], &mut |own| {
            let (sum, rows) = &mut sums[own.series];
            *sum += own.residuals.iter().map(|r| r * r).sum::<f64>();
            *rows += own.residuals.len();
        });
        self.sizes = sums.into_iter().map(|(sum, rows)| (sum / rows as f64).sqrt().max(f64::MIN_POSITIVE)).collect();
        told.is_ok() && self.sizes.iter().all(|size| size.is_finite())
    }
}

impl identification::Problem for Balance<'_> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn series(&self) -> &[Series] {
        &self.series
    }

    fn noise(&self) -> f64 {
        NOISE
    }

    fn rows(&self, values: &[f64], wanted: &[bool], take: &mut dyn FnMut(Rows<'_>)) -> Result<(), Failed> {
        let n = values.len();
        for track in &self.tracks {
            let along = track.along(values, wanted)?;
            for k in 0..track.count() {
                let size = self.sizes[track.first + k];
                let mut residuals = Vec::with_capacity(track.windows.len());
                let mut jacobian =
                    Vec::with_capacity(if along.slopes.is_empty() { 0 } else { track.windows.len() * n });
                for (first, weights) in &track.windows {
                    let rows = || weights.iter().enumerate().map(|(i, weight)| (weight / size, first + i));
                    residuals.push(rows().map(|(weight, row)| weight * along.gaps[k][row]).sum::<f64>());
                    if let Some(slopes) = along.slopes.get(k) {
                        let sum = |p: usize| rows().map(|(weight, row)| weight * slopes[row * n + p]).sum::<f64>();
                        jacobian.extend((0..n).map(sum));
                    }
                }
                take(Rows { series: track.first + k, residuals: &residuals, jacobian: &jacobian });
            }
        }
        Ok(())
    }
}
