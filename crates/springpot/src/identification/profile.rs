//! Intervals by the cost itself: where the least cost of the others has risen by t² variances.

use super::descent::descend;
use super::fit::Fit;
use super::look::{Look, Place};
use super::parameter::{Parameter, Side};
use super::problem::Problem;
use super::student::student_quantile;
use std::sync::atomic::AtomicBool;

const STEPS: usize = 60;
/// Relative accuracy of t at the ends.
const EXACT: f64 = 1e-6;

/// One parameter held at values, the others at their best.
struct Profile<'a> {
    look: Look<'a>,
    fit: &'a Fit,
    j: usize,
    steps: usize,
}

/// The interval of parameter `j`, both ends at `confidence`; of one at a bound, the bound and its one-sided limit. An end to which the cost
/// never rises so far is the bound, or infinite. `None` for a parameter that is not estimated, or where it was interrupted.
pub fn profile(problem: &dyn Problem, fit: &Fit, j: usize, confidence: f64, stop: &AtomicBool) -> Option<[f64; 2]> {
    if fit.unseen.contains(&j) || fit.freedom() <= 0.0 {
        return None;
    }
    let look = Look { problem, scales: &fit.scales, rows: fit.rows, stop };
    let profile = Profile { look, fit, j, steps: 200 };
    let value = fit.values[j];
    let interval = match fit.at_bound[j] {
        Some(side) => {
            let t = student_quantile(confidence, fit.freedom());
            let limit = profile.end(if side == Side::Lower { Side::Upper } else { Side::Lower }, t);
            if side == Side::Lower { [value, limit] } else { [limit, value] }
        }
        None => {
            let t = student_quantile(0.5 + 0.5 * confidence, fit.freedom());
            [profile.end(Side::Lower, t), profile.end(Side::Upper, t)]
        }
    };
    (!look.is_stopped()).then_some(interval)
}

/// √ of what the least cost of the others has risen by, in variances widened as the standard deviations are, with parameter `j` held at a value:
/// |value − minimum|/sd where the cost is a parabola. `None` for a parameter that is not estimated, or where it was interrupted.
pub fn rise(problem: &dyn Problem, fit: &Fit, j: usize, value: f64, stop: &AtomicBool) -> Option<f64> {
    if fit.unseen.contains(&j) || fit.freedom() <= 0.0 {
        return None;
    }
    let look = Look { problem, scales: &fit.scales, rows: fit.rows, stop };
    let rise = Profile { look, fit, j, steps: 200 }.rise(value);
    (!look.is_stopped() && rise.is_finite()).then_some(rise)
}

impl Profile<'_> {
    fn parameter(&self) -> &Parameter {
        &self.look.parameters()[self.j]
    }

    /// √ of what the least cost has risen by, in variances widened as the standard deviations are, with the parameter at a value.
    fn rise(&self, value: f64) -> f64 {
        let mut places = self.fit.places.clone();
        places[self.j] = Place::Held(value);
        let cost = descend(&self.look, &places, self.steps).cost;
        ((cost - self.fit.cost).max(0.0) / self.fit.noise).sqrt() / self.fit.widening
    }

    /// Where the rise is t on that side.
    fn end(&self, side: Side, t: f64) -> f64 {
        let (parameter, value) = (self.parameter(), self.fit.values[self.j]);
        let bound = parameter.bound(side);
        let sign = if side == Side::Lower { -1.0 } else { 1.0 };
        let is_at_bound = self.fit.at_bound[self.j].is_some();
        // At a bound that u does not reach the values themselves are the variable.
        let (to_value, first): (Box<dyn Fn(f64) -> f64>, f64) = if is_at_bound {
            let room = (bound - value).abs();
            let size = if parameter.typical.is_finite() { 1e-3 * parameter.typical } else { 1e-3 };
            (
                Box::new(move |w| (value + sign * w).clamp(parameter.bounds[0], parameter.bounds[1])),
                size.min(0.5 * room),
            )
        } else {
            let (u, sd) = (parameter.variable(value), self.fit.sd(self.j) / parameter.slope(value));
            let reach = t * if sd > 0.0 && sd.is_finite() { sd.min(3.0) } else { 1.0 };
            (Box::new(move |w| parameter.value(u + sign * w)), reach)
        };
        // Where the bound itself is not excluded, it is the end.
        if bound.is_finite() && self.rise(bound) <= t {
            return bound;
        }
        let (mut low, mut below, mut high) = (0.0, -t, first);
        let mut above = self.rise(to_value(high)) - t;
        for _ in 0..STEPS {
            if above >= 0.0 || self.look.is_stopped() {
                break;
            }
            (low, below) = (high, above);
            high *= 2.0;
            above = self.rise(to_value(high)) - t;
        }
        if above < 0.0 {
            return bound;
        }
        // False position, an end that stays halved.
        for _ in 0..STEPS {
            if self.look.is_stopped() {
                break;
            }
            // The rise jumps where others cannot follow: then halves.
            let next =
                if above.is_finite() { low - below * (high - low) / (above - below) } else { 0.5 * (low + high) };
            let at = self.rise(to_value(next)) - t;
            if at.abs() <= EXACT * t || (high - low).abs() <= 1e-9 * high {
                return to_value(next);
            }
            if at < 0.0 {
                (low, below) = (next, at);
                above *= 0.5;
            } else {
                (high, above) = (next, at);
                below *= 0.5;
            }
        }
        to_value(high)
    }
}
