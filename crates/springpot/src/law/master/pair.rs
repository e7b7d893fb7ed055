//! How far the curve at one temperature is shifted against that at the next one.

use super::{Curve, MasterError};
use crate::identification::{Failed, Parameter, Problem, Rows, Scale, Series, Settings, fit};
use std::f64::consts::LN_10;
use std::sync::atomic::AtomicBool;

/// Steps of the first search, decades.
const GRID: f64 = 0.02;
/// Fewest rows of either that lie among those of the other.
const FEWEST: usize = 4;
/// Highest degree of the polynomial through both.
const HIGHEST: usize = 7;
/// Scatter of ln E below which curves count as exact.
const EXACT: f64 = 1e-9;
/// Rounds in which the weights settle.
const ROUNDS: usize = 8;
/// How far the least squares may lead from the first search, decades.
const NEAR: f64 = 0.5;
/// Standard deviation of a shift that says nothing, decades.
const FLAT: f64 = 5.0;
/// Levels of ln E' this far apart are not one.
const APART: f64 = 0.05;

/// The shift of the warmer curve onto the colder one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Step {
    /// log₁₀(a_warmer/a_colder).
    pub(super) log_a: f64,
    pub(super) sd: f64,
    /// log₁₀(b_warmer/b_colder).
    pub(super) log_b: f64,
    pub(super) sd_b: f64,
    /// Of E' and E'' about the common polynomial, as shares of |E*|.
    pub(super) scatter: [f64; 2],
}

/// Two neighbours.
pub(super) struct Pair<'a> {
    colder: &'a Curve,
    warmer: &'a Curve,
    vertical: bool,
}

impl<'a> Pair<'a> {
    pub(super) fn new(colder: &'a Curve, warmer: &'a Curve, vertical: bool) -> Self {
        Self { colder, warmer, vertical }
    }

    /// The shift: the best on a grid, then the least squares with a common polynomial of the degree that BIC prefers. A vertical shift begins
    /// with none: where both curves are powers of the frequency, nothing tells it from the other one.
    pub(super) fn step(&self) -> Result<Step, MasterError> {
        let (colder, warmer) = (self.colder.temperature, self.warmer.temperature);
        let near = self.coarse(false).and_then(|start| self.refined(start));
        if let Some(step) = near {
            return Ok(step);
        }
        let start = self.coarse(self.vertical).ok_or(MasterError::NoOverlap { colder, warmer })?;
        self.refined(start).ok_or(MasterError::Flat { colder, warmer })
    }

    /// The least squares from near the shift and the vertical one; `None` where they say nothing.
    fn refined(&self, start: [f64; 2]) -> Option<Step> {
        let mut best: Option<(Step, f64)> = None;
        let mut worse = 0;
        for degree in 1..=HIGHEST {
            let Some(found) = Common::new(self, start, degree).and_then(Common::settled) else { continue };
            if best.is_none_or(|(_, least)| found.1 < least) {
                (best, worse) = (Some(found), 0);
            } else {
                worse += 1;
            }
            // Even and odd terms may come one after the other.
            if worse == 2 {
                break;
            }
        }
        best.map(|(step, _)| step).filter(|step| step.sd < FLAT)
    }

    /// The shift on the grid with the least geometric mean of both moduli's mean squares; `None` where nothing overlaps.
    fn coarse(&self, vertical: bool) -> Option<[f64; 2]> {
        let ends = |curve: &Curve| [curve.points[0][0], curve.points[curve.points.len() - 1][0]];
        let ([a, b], [c, d]) = (ends(self.colder), ends(self.warmer));
        let count = ((b - a + d - c) / GRID).ceil() as usize;
        let tried = (0..=count).map(|k| a - d + GRID * k as f64);
        let all: Vec<(f64, [f64; 2])> = tried
            .filter_map(|shift| {
                let (squares, rise) = self.apart(shift, vertical)?;
                let likelihood: f64 = weighed(squares).iter().map(|square| (square + EXACT * EXACT).ln()).sum();
                Some((likelihood, [shift, rise]))
            })
            .collect();
        let (_, found) = all.iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
        let is_at_end = found[0] == all[0].1[0] || found[0] == all[all.len() - 1].1[0];
        // Storage rises with the frequency: without a level in common there is nothing to lay on one another.
        let is_apart = !vertical && self.gap() > APART;
        if is_at_end || is_apart { None } else { Some(*found) }
    }

    /// What lies between the levels of ln E' of the two curves; negative where they have some in common.
    fn gap(&self) -> f64 {
        let [[low, high], [least, most]] = [self.colder, self.warmer].map(|curve| {
            let levels = curve.points.iter().map(|point| point[1]);
            levels.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], level| [level.min(low), level.max(high)])
        });
        (least - high).max(low - most)
    }

    /// Mean squares of E' and E'' as shares of |E*| between the curves where both have rows, the vertical shift that makes them least.
    fn apart(&self, shift: f64, vertical: bool) -> Option<([f64; 2], f64)> {
        let mut differences = Vec::new();
        for [x, storage, loss] in &self.warmer.points {
            if let Some([a, b]) = between(&self.colder.points, x + shift) {
                differences.push(([storage - a, loss - b], parts(*storage, *loss)));
            }
        }
        for [x, storage, loss] in &self.colder.points {
            if let Some([a, b]) = between(&self.warmer.points, x - shift) {
                differences.push(([a - storage, b - loss], parts(*storage, *loss)));
            }
        }
        if differences.len() < FEWEST {
            return None;
        }
        let count = differences.len() as f64;
        let rise = match vertical {
            true => -differences.iter().map(|([a, b], w)| a * w[0].powi(2) + b * w[1].powi(2)).sum::<f64>() / count,
            false => 0.0,
        };
        let square = |m: usize| differences.iter().map(|(d, w)| (w[m] * (d[m] + rise)).powi(2)).sum::<f64>() / count;
        Some(([square(0), square(1)], rise))
    }
}

/// E'/|E*| and E''/|E*|, by which differences of the logarithms become shares of |E*|: what is measured is a magnitude and a small phase, whose
/// error makes a small loss uncertain and leaves the storage alone.
fn parts(storage: f64, loss: f64) -> [f64; 2] {
    let tangent = (loss - storage).exp();
    let cosine = 1.0 / tangent.hypot(1.0);
    [cosine, tangent * cosine]
}

/// Mean squares by which both parts are weighed: each by its own, but the loss never more than the storage.
fn weighed([storage, loss]: [f64; 2]) -> [f64; 2] {
    if loss >= storage { [storage, loss] } else { [0.5 * (storage + loss); 2] }
}

/// ln E' and ln E'' between rows, by the cubic through the four about x; `None` beyond the rows.
fn between(points: &[[f64; 3]], x: f64) -> Option<[f64; 2]> {
    let after = points.partition_point(|point| point[0] < x);
    if after == points.len() || (after == 0 && points[0][0] > x) {
        return None;
    }
    let mut near: Vec<&[f64; 3]> = points[after.saturating_sub(2)..(after + 2).min(points.len())].iter().collect();
    near.dedup_by(|a, b| a[0] - b[0] < 1e-9);
    let mut found = [0.0; 2];
    for (i, point) in near.iter().enumerate() {
        let others = near.iter().enumerate().filter(|(j, _)| *j != i);
        let weight: f64 = others.map(|(_, other)| (x - other[0]) / (point[0] - other[0])).product();
        found[0] += weight * point[1];
        found[1] += weight * point[2];
    }
    Some(found)
}

/// Both curves where they overlap, a polynomial through both, and the shift as one more unknown.
struct Common {
    parameters: Vec<Parameter>,
    series: Vec<Series>,
    /// log₁₀ f, ln E', ln E'', and whether it is of the warmer curve.
    points: Vec<([f64; 3], bool)>,
    middle: f64,
    half: f64,
    degree: usize,
    vertical: bool,
    sigma: [f64; 2],
}

impl Common {
    /// `None` where there are too few rows for that degree.
    fn new(pair: &Pair<'_>, [shift, rise]: [f64; 2], degree: usize) -> Option<Self> {
        let (cold, warm) = (&pair.colder.points, &pair.warmer.points);
        let low = cold[0][0].max(warm[0][0] + shift);
        let high = cold[cold.len() - 1][0].min(warm[warm.len() - 1][0] + shift);
        // One row beyond: the polynomial is held at the ends of the overlap.
        let margin =
            [cold, warm].map(|points| (points[points.len() - 1][0] - points[0][0]) / (points.len() - 1) as f64);
        let margin = 1.01 * margin[0].max(margin[1]);
        let inside = |x: f64| x >= low - margin && x <= high + margin;
        let points: Vec<([f64; 3], bool)> = (cold.iter().map(|point| (*point, false)))
            .chain(warm.iter().map(|point| (*point, true)))
            .filter(|(point, is_warm)| inside(point[0] + if *is_warm { shift } else { 0.0 }))
            .collect();
        let unknowns = 1 + usize::from(pair.vertical) + 2 * (degree + 1);
        // Scatter is estimated, and no curve alone may carry the polynomial.
        if 2 * points.len() < unknowns + 3 || points.len() < 2 * (degree + 1) {
            return None;
        }
        let near = [shift - NEAR, shift + NEAR];
        let mut parameters =
            vec![Parameter { scale: Scale::Linear, typical: 1.0, ..Parameter::new("shift", shift, near) }];
        if pair.vertical {
            parameters.push(Parameter { typical: 1.0, ..Parameter::free("rise", rise) });
        }
        for m in 1..3 {
            let mean = points.iter().map(|(point, _)| point[m]).sum::<f64>() / points.len() as f64;
            let start = |k: usize| if k == 0 { mean } else { 0.0 };
            parameters.extend((0..=degree).map(|k| Parameter { typical: 1.0, ..Parameter::free("term", start(k)) }));
        }
        let series = ["storage", "loss"].map(Series::new).to_vec();
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low) + margin);
        Some(Self { parameters, series, points, middle, half, degree, vertical: pair.vertical, sigma: [1.0; 2] })
    }

    /// The step with weights that have settled, and its BIC.
    fn settled(mut self) -> Option<(Step, f64)> {
        let settings = Settings { starts: 1, seed: 1, steps: 100 };
        let count = self.points.len() as f64;
        let p = self.parameters.len();
        let mut found = None;
        for _ in 0..ROUNDS {
            let fitted = fit(&self, &settings, &AtomicBool::new(false)).ok()?;
            // σ of each modulus: its share of the freedom is that of its rows.
            let own: [f64; 2] = std::array::from_fn(|m| (fitted.sigma[m] * self.sigma[m]).powi(2));
            let next = weighed(own).map(|square| square.sqrt().max(EXACT));
            let is_settled = (0..2).all(|m| (next[m] / self.sigma[m] - 1.0).abs() < 1e-2);
            self.sigma = next;
            self.parameters
                .iter_mut()
                .zip(&fitted.values)
                .for_each(|(parameter, value)| parameter.start = vec![*value]);
            found = Some(fitted);
            if is_settled {
                break;
            }
        }
        let fitted = found.filter(|found| found.at_bound[0].is_none() && found.unseen.is_empty())?;
        let freedom = fitted.freedom() / fitted.rows as f64;
        let likelihood: f64 = self.sigma.iter().map(|sigma| count * (sigma * sigma * freedom).ln()).sum();
        let bic = likelihood + (p + 2) as f64 * (2.0 * count).ln();
        let [log_b, sd_b] = match self.vertical {
            true => [fitted.values[1] / LN_10, fitted.sd(1) / LN_10],
            false => [0.0, 0.0],
        };
        Some((Step { log_a: fitted.values[0], sd: fitted.sd(0), log_b, sd_b, scatter: self.sigma }, bic))
    }
}

impl Problem for Common {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn series(&self) -> &[Series] {
        &self.series
    }

    fn rows(&self, values: &[f64], _: &[bool], take: &mut dyn FnMut(Rows<'_>)) -> Result<(), Failed> {
        let first = 1 + usize::from(self.vertical);
        let terms = self.degree + 1;
        for m in 0..2 {
            let own = first + m * terms;
            for (point, is_warm) in &self.points {
                let weight = parts(point[1], point[2])[m] / self.sigma[m];
                let z = (point[0] + if *is_warm { values[0] } else { 0.0 } - self.middle) / self.half;
                let mut line = vec![0.0; values.len()];
                // Chebyshev polynomials and their derivatives, by their recurrences.
                let (mut t, mut u) = ([1.0, z], [0.0, 1.0]);
                let (mut value, mut slope) = (0.0, 0.0);
                for k in 0..terms {
                    line[own + k] = weight * t[0];
                    value += values[own + k] * t[0];
                    slope += values[own + k] * u[0];
                    (t, u) = ([t[1], 2.0 * z * t[1] - t[0]], [u[1], 2.0 * t[1] + 2.0 * z * u[1] - u[0]]);
                }
                let mut goal = point[1 + m];
                if *is_warm {
                    line[0] = weight * slope / self.half;
                    if self.vertical {
                        goal += values[1];
                        line[1] = -weight;
                    }
                }
                take(Rows { series: m, residuals: &[weight * (value - goal)], jacobian: &line });
            }
        }
        Ok(())
    }
}
