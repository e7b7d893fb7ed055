//! Downhill from one start: Levenberg and Marquardt's method.
//!
//! Steps solve min ‖J h + r‖² + μ‖D h‖² by the triangle of [J; √μ D], never by JᵀJ (J. J. Moré, Lecture Notes in Mathematics 630 (1978)
//! 105–116), D the largest norms that the columns have had, μ by the ratio of gained and promised cost (H. B. Nielsen, IMM-REP-1999-05).
//! Bounds that u reaches are an active set: a variable stands on its bound while the gradient presses it there, and steps are cut at
//! bounds, with the rest solved anew.

use super::look::{Look, Place};
use super::parameter::Scale;
use crate::linalg::Triangle;

/// The longest step in a logarithm.
const LONGEST: f64 = 5.0;
/// Steps that are shorter, in logarithms or shares of a value, are none.
const STILL: f64 = 1e-11;
/// Promises below this share of the cost are lost in its rounding: what counts then is that steps become shorter.
const ROUNDING: f64 = 1e-11;
/// The cosine of r with every column at a minimum.
const LEVEL: f64 = 1e-6;
const LEAST_DAMPING: f64 = 1e-16;
const MOST_DAMPING: f64 = 1e16;

/// How a descent ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    Converged,
    /// Too many steps.
    Exhausted,
    Interrupted,
    /// There are no residuals at its start.
    Unstartable,
}

/// Where a descent came to.
#[derive(Debug, Clone)]
pub(super) struct Descent {
    pub(super) places: Vec<Place>,
    pub(super) cost: f64,
    pub(super) end: End,
}

/// Downhill from `places`, what is held staying there.
pub(super) fn descend(look: &Look<'_>, places: &[Place], most: usize) -> Descent {
    let n = places.len();
    let mut places = places.to_vec();
    let mut cost = look.cost(&look.values(&places));
    let mut largest = vec![0.0_f64; n];
    let (mut damping, mut growth) = (1e-3, 2.0);
    let mut last_step = f64::INFINITY;
    // What is promised below the noise is not seen, however short the steps that fail.
    let noise = ROUNDING.max(look.problem.noise());
    let done = |places, cost, end| Descent { places, cost, end };
    if !cost.is_finite() {
        return done(places, cost, End::Unstartable);
    }
    let wanted: Vec<bool> = places.iter().map(|place| matches!(place, Place::At(_))).collect();
    for _ in 0..most {
        if look.is_stopped() {
            return done(places, cost, End::Interrupted);
        }
        if cost == 0.0 {
            return done(places, cost, End::Converged);
        }
        // A cost without derivatives is not left.
        let Some(triangle) = look.triangle(&places, &wanted) else { return done(places, cost, End::Exhausted) };
        let step = Step::new(look, &places, &triangle, &mut largest);
        let is_level = step.cosine(cost) <= LEVEL;
        loop {
            if look.is_stopped() {
                return done(places, cost, End::Interrupted);
            }
            let h = step.solve(damping);
            let length = step.length(&h);
            let promised = step.promise(&h);
            let tried: Vec<Place> =
                places.iter().zip(&h).enumerate().map(|(j, (place, h))| step.moved(j, *place, *h)).collect();
            let tried_cost = look.cost(&look.values(&tried));
            if length <= STILL && (damping <= 1.0 || is_level) {
                let (places, cost) = if tried_cost < cost { (tried, tried_cost) } else { (places, cost) };
                return done(places, cost, End::Converged);
            }
            if promised <= noise * cost && (damping <= 1.0 || noise > ROUNDING) {
                if length >= last_step || noise > ROUNDING || tried_cost > cost * (1.0 + 2.0 * ROUNDING) {
                    return done(places, cost, End::Converged);
                }
                (places, cost, last_step) = (tried, tried_cost.min(cost), length);
                damping = (damping * 0.1).max(LEAST_DAMPING);
                break;
            }
            let gain = (cost - tried_cost) / promised;
            if gain > 0.0 && gain.is_finite() {
                (places, cost) = (tried, tried_cost);
                damping = (damping * (1.0 - (2.0 * gain - 1.0).powi(3)).max(0.1)).max(LEAST_DAMPING);
                growth = 2.0;
                break;
            }
            damping *= growth;
            growth *= 2.0;
            if damping > MOST_DAMPING {
                return done(places, cost, if is_level { End::Converged } else { End::Exhausted });
            }
        }
    }
    done(places, cost, End::Exhausted)
}

/// One linear problem.
struct Step<'a> {
    look: &'a Look<'a>,
    triangle: &'a Triangle,
    /// D.
    scales: &'a [f64],
    at: Vec<f64>,
    /// What may move.
    free: Vec<bool>,
}

impl<'a> Step<'a> {
    fn new(look: &'a Look<'a>, places: &[Place], triangle: &'a Triangle, scales: &'a mut [f64]) -> Self {
        let n = places.len();
        let at: Vec<f64> = places.iter().map(|place| if let Place::At(u) = place { *u } else { f64::NAN }).collect();
        scales.iter_mut().enumerate().for_each(|(j, scale)| *scale = scale.max(triangle.norm(j)));
        let free = (0..n)
            .map(|j| {
                let [low, high] = look.parameters()[j].ends();
                let gradient = triangle.product(j, n);
                let presses = at[j] <= low && gradient > 0.0 || at[j] >= high && gradient < 0.0;
                !at[j].is_nan() && triangle.norm(j) > 0.0 && !presses
            })
            .collect();
        Self { look, triangle, scales, at, free }
    }

    /// The largest cosine of r and a column that may move.
    fn cosine(&self, cost: f64) -> f64 {
        let n = self.at.len();
        let cosine = |j: usize| (self.triangle.product(j, n) / (self.triangle.norm(j) * cost.sqrt())).abs();
        (0..n).filter(|j| self.free[*j]).map(cosine).fold(0.0, f64::max)
    }

    /// h within the bounds.
    fn solve(&self, damping: f64) -> Vec<f64> {
        let n = self.at.len();
        let mut h = vec![0.0; n];
        let mut free: Vec<usize> = (0..n).filter(|j| self.free[*j]).collect();
        while !free.is_empty() {
            let solved = self.linear(&free, &h, damping);
            let ends = |j: usize| self.look.parameters()[j].ends();
            let beyond: Vec<usize> = (0..free.len())
                .filter(|&k| {
                    let (u, [low, high]) = (self.at[free[k]] + solved[k], ends(free[k]));
                    u < low || u > high
                })
                .collect();
            free.iter().zip(&solved).for_each(|(j, step)| h[*j] = *step);
            if beyond.is_empty() {
                break;
            }
            for k in beyond.iter().rev() {
                let j = free.remove(*k);
                let [low, high] = ends(j);
                h[j] = (self.at[j] + h[j]).clamp(low, high) - self.at[j];
            }
        }
        let longest = (0..n).filter(|j| self.is_logarithm(*j)).map(|j| h[j].abs()).fold(0.0, f64::max);
        let share = if longest > LONGEST { LONGEST / longest } else { 1.0 };
        h.iter_mut().for_each(|h| *h *= share);
        h
    }

    /// The damped step of `free` with that of the others given.
    fn linear(&self, free: &[usize], given: &[f64], damping: f64) -> Vec<f64> {
        let (n, m) = (self.at.len(), free.len());
        let mut moves = vec![false; n];
        free.iter().for_each(|j| moves[*j] = true);
        let mut small = Triangle::new(m + 1);
        let mut rows = Vec::with_capacity((n + m + 1) * (m + 1));
        for i in 0..n {
            let fixed: f64 = (0..n).filter(|j| !moves[*j]).map(|j| self.triangle.at(i, j) * given[j]).sum();
            rows.extend(free.iter().map(|j| self.triangle.at(i, *j)));
            rows.push(-self.triangle.at(i, n) - fixed);
        }
        for (k, j) in free.iter().enumerate() {
            let start = rows.len();
            rows.resize(start + m + 1, 0.0);
            rows[start + k] = damping.sqrt() * self.scales[*j];
        }
        small.absorb(&mut rows);
        let mut h: Vec<f64> = (0..m).map(|i| small.at(i, m)).collect();
        small.solve(&mut h);
        h
    }

    /// Where a step leads; to the bit onto a bound at which it was cut.
    fn moved(&self, j: usize, place: Place, h: f64) -> Place {
        let Place::At(u) = place else { return place };
        let end = self.look.parameters()[j].ends().into_iter().find(|end| h == end - u);
        Place::At(end.unwrap_or(u + h))
    }

    fn is_logarithm(&self, j: usize) -> bool {
        self.look.parameters()[j].scale != Scale::Linear
    }

    /// The longest part of a step, in logarithms or shares of a value.
    fn length(&self, h: &[f64]) -> f64 {
        let size = |j: usize| match self.is_logarithm(j) {
            true => 1.0,
            false => self.at[j].abs() + 1e-3 * self.look.parameters()[j].typical,
        };
        (0..h.len()).filter(|j| self.free[*j]).map(|j| h[j].abs() / size(j)).fold(0.0, f64::max)
    }

    /// What the linear problem says that the cost falls by.
    fn promise(&self, h: &[f64]) -> f64 {
        let n = h.len();
        let along = |i: usize| (i..n).map(|j| self.triangle.at(i, j) * h[j]).sum::<f64>();
        (0..n).map(|i| -along(i) * (along(i) + 2.0 * self.triangle.at(i, n))).sum()
    }
}
