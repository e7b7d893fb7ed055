//! A problem looked at in the variables u: cost, and the triangle of its residuals.

use super::parameter::{Parameter, Side};
use super::problem::{Loss, Problem, Rows};
use crate::linalg::Triangle;
use std::sync::atomic::{AtomicBool, Ordering};

/// Where a parameter is: at u, or at a bound that u does not reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Place {
    At(f64),
    Bound(Side),
    /// Held at a value, for profiles.
    Held(f64),
}

impl Place {
    pub(super) fn value(self, parameter: &Parameter) -> f64 {
        match self {
            Self::At(u) => parameter.value(u),
            Self::Bound(side) => parameter.bound(side),
            Self::Held(value) => value,
        }
    }
}

/// The problem, its losses with their scales, and who may interrupt.
#[derive(Clone, Copy)]
pub(super) struct Look<'a> {
    pub(super) problem: &'a dyn Problem,
    /// Of each series the standard deviation beyond a multiple of which Huber's loss bends.
    pub(super) scales: &'a [f64],
    /// Rows of all series.
    pub(super) rows: usize,
    pub(super) stop: &'a AtomicBool,
}

impl<'a> Look<'a> {
    pub(super) fn parameters(&self) -> &'a [Parameter] {
        self.problem.parameters()
    }

    pub(super) fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// The values at these places.
    pub(super) fn values(&self, places: &[Place]) -> Vec<f64> {
        self.parameters().iter().zip(places).map(|(parameter, place)| place.value(parameter)).collect()
    }

    /// The sum of squares, with losses and priors; infinite where there is none.
    pub(super) fn cost(&self, values: &[f64]) -> f64 {
        let mut cost = 0.0;
        let wanted = vec![false; values.len()];
        let all = self.problem.rows(values, &wanted, &mut |rows: Rows<'_>| {
            let loss = self.loss(rows.series);
            cost += rows.residuals.iter().map(|r| loss.bent(*r).0.powi(2)).sum::<f64>();
        });
        cost += self.priors(values).map(|(_, value, _)| value * value).sum::<f64>();
        if all.is_ok() && cost.is_finite() { cost } else { f64::INFINITY }
    }

    /// The triangle of [J | r], J by u and by the values of what stands at a bound or is held; `None` where there is none.
    pub(super) fn triangle(&self, places: &[Place], wanted: &[bool]) -> Option<Triangle> {
        let values = self.values(places);
        let slopes: Vec<f64> = self
            .parameters()
            .iter()
            .zip(places.iter().zip(&values))
            .map(
                |(parameter, (place, value))| if matches!(place, Place::At(_)) { parameter.slope(*value) } else { 1.0 },
            )
            .collect();
        self.gathered(&values, wanted, &slopes, |series, r| self.loss(series).bent(r))
    }

    /// The triangle of [J | r] at values, the columns times `slopes`, each row as `bend` makes r and its derivative of it.
    pub(super) fn gathered(
        &self,
        values: &[f64],
        wanted: &[bool],
        slopes: &[f64],
        bend: impl Fn(usize, f64) -> (f64, f64),
    ) -> Option<Triangle> {
        let n = values.len();
        let mut triangle = Triangle::new(n + 1);
        let (mut block, mut is_finite) = (Vec::new(), true);
        let all = self.problem.rows(values, wanted, &mut |rows: Rows<'_>| {
            for (residuals, lines) in rows.residuals.chunks(BLOCK).zip(rows.jacobian.chunks(BLOCK * n)) {
                block.clear();
                for (r, line) in residuals.iter().zip(lines.chunks(n)) {
                    let (own, factor) = bend(rows.series, *r);
                    let entry = |j: usize| if wanted[j] { factor * line[j] * slopes[j] } else { 0.0 };
                    block.extend((0..n).map(entry));
                    block.push(own);
                }
                is_finite &= block.iter().all(|entry: &f64| entry.is_finite());
                triangle.absorb(&mut block);
            }
        });
        for (j, value, by) in self.priors(values) {
            block.clear();
            block.resize(n + 1, 0.0);
            block[j] = if wanted[j] { by * slopes[j] } else { 0.0 };
            block[n] = value;
            triangle.absorb(&mut block);
        }
        (all.is_ok() && is_finite).then_some(triangle)
    }

    /// The triangle by the values themselves.
    pub(super) fn by_values(&self, values: &[f64], wanted: &[bool]) -> Option<Triangle> {
        self.gathered(values, wanted, &vec![1.0; values.len()], |series, r| self.loss(series).bent(r))
    }

    /// As [`Self::by_values`], with the derivatives of each series times a factor, and no residuals.
    pub(super) fn weighted(&self, values: &[f64], wanted: &[bool], factor: impl Fn(usize) -> f64) -> Option<Triangle> {
        self.gathered(values, wanted, &vec![1.0; values.len()], |series, _| (0.0, factor(series)))
    }

    /// Rows less parameters.
    pub(super) fn freedom(&self, parameters: usize) -> f64 {
        self.rows as f64 - (parameters + self.problem.eliminated()) as f64
    }

    pub(super) fn loss(&self, series: usize) -> Bending {
        match self.problem.series()[series].loss {
            Loss::Squares => Bending(f64::INFINITY),
            Loss::Huber(k) => Bending(k * self.scales[series]),
        }
    }

    /// Residuals of priors: parameter, value, derivative.
    fn priors(&self, values: &[f64]) -> impl Iterator<Item = (usize, f64, f64)> {
        let priors = self.parameters().iter().zip(values).enumerate();
        priors.filter_map(|(j, (parameter, value))| {
            parameter.prior.map(|prior| (j, (value - prior.mean) / prior.sd, 1.0 / prior.sd))
        })
    }
}

/// Rows that are reflected at a time.
const BLOCK: usize = 64;

/// Huber's loss as the square of a bent residual; the limit is infinite where the loss is the square itself.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bending(f64);

impl Bending {
    /// The bent residual, whose square is the loss, and its derivative.
    pub(super) fn bent(&self, r: f64) -> (f64, f64) {
        let limit = self.0;
        if r.abs() <= limit {
            return (r, 1.0);
        }
        let bent = (limit * (2.0 * r.abs() - limit)).sqrt();
        (bent.copysign(r), limit / bent)
    }

    /// Half the derivative of the loss: r, or the limit.
    pub(super) fn influence(&self, r: f64) -> f64 {
        r.clamp(-self.0, self.0)
    }

    pub(super) fn is_inside(&self, r: f64) -> bool {
        r.abs() <= self.0
    }
}
