//! D^a of samples.

use super::along::march::KERNEL_TOLERANCE;
use super::along::{Along, Start};
use super::definition::Definition;
use super::error::DerivativeError;
use super::hermite::stencil::{Equal, first_point};
use super::hermite::{Form, Node};
use super::method::Method;
use super::order::Order;
use super::uniform::{self, Grid};
use crate::fractional::scheme::{Samples, Scheme};

/// D^a x at every sample for −2 ≤ a ≤ 2, lower terminal t = 0.
///
/// `samples.t` starts at 0 and increases strictly, in s; the result has the unit of x per s^a. Rows at t = 0 where D^a
/// x is infinite (Riemann–Liouville and Grünwald–Letnikov, 0 < a < 2 not an integer, x(0) ≠ 0, for a > 1 also x'(0) ≠
/// 0) are NaN; the test of x(0) is to the bit, that of x'(0) to the rounding of its differences. Values at order 1 and
/// 2 are the method's x' and x''. Rates that come with the samples serve `hermite` and some schemes.
///
/// On equal steps (see [`Samples::uniform_prefix`]) this takes O(N log N) operations, on any others O(N log T/h), the
/// latter with a kernel that errs by 1e-12. The transforms round row n to the largest terms of the first 2n rows (see
/// [`causal_convolution`](crate::fractional::scheme::causal_convolution)): a slow start keeps its digits, a row just before
/// a much larger one does not.
///
/// ```
/// use springpot::fractional::{Definition, Method, derivative, scheme::Samples};
///
/// let t: Vec<f64> = (0..=1000).map(|k| k as f64 * 0.002).collect();
/// let x: Vec<f64> = t.iter().map(|t| t * t).collect();
/// let samples = Samples { t: &t, x: &x, rate: None };
/// let y = derivative(&samples, 0.5, Definition::Caputo, Method::Spline)?;
/// // D^½ t² = Γ(3)/Γ(5/2) t^{3/2} = 8/(3√π) t^{3/2}
/// let exact = |t: f64| 8.0 / (3.0 * std::f64::consts::PI.sqrt()) * t.powf(1.5);
/// assert!(t.iter().zip(&y).all(|(t, y)| (y - exact(*t)).abs() < 1e-13));
/// # Ok::<(), springpot::fractional::DerivativeError>(())
/// ```
///
/// # Errors
/// `Order`, `TooShort`, `Samples` (lengths, numbers, times, what a scheme asks for), `Kernel`.
pub fn derivative(
    samples: &Samples,
    order: f64,
    definition: Definition,
    method: Method,
) -> Result<Vec<f64>, DerivativeError> {
    let split = Order::new(order)?;
    let (needed, found) = (method.min_rows(order), samples.t.len());
    if found < needed {
        return Err(DerivativeError::TooShort { method, needed, found });
    }
    let form = match method.form() {
        Ok(form) => form,
        Err(scheme) => return Ok(scheme.differentiate(samples, order, definition.kind())?),
    };
    // Lengths, numbers and times, of which no scheme asks less.
    samples.check(Scheme::L1, 0.5)?;
    let prefix = samples.uniform_prefix();
    // Streams know no common step, and arrays by the same name must give their numbers.
    let step = (prefix.rows == found && method != Method::Exponential).then_some(prefix.step);
    let nodes = Nodes::of(samples, form, step);
    let start = Start::new(&split, definition, &nodes.at(samples, 0), nodes.negligible_slope);
    let mut y = match step.filter(|_| !split.is_integer()) {
        Some(step) => {
            let scaled = |values: &[f64], factor: f64| -> Vec<f64> { values.iter().map(|v| v * factor).collect() };
            let (slope, bend) = (scaled(&nodes.slope, step), scaled(&nodes.bend, step * step));
            let grid = Grid { step, x: samples.x, slope: &slope, bend: &bend };
            let mut y = uniform::differintegral(form, &split, &grid);
            y.iter_mut().zip(samples.t).skip(1).for_each(|(y, t)| *y += start.share(*t));
            y
        }
        None => {
            let mut along = Along::new(split, form, start, nodes.at(samples, 0), KERNEL_TOLERANCE);
            let rest = (1..found).map(|row| along.row(nodes.at(samples, row), samples.t[found - 1]));
            std::iter::once(Ok(0.0)).chain(rest).collect::<Result<Vec<f64>, _>>()?
        }
    };
    y[0] = start.value;
    Ok(y)
}

/// Values with an estimate of their error.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimated {
    /// D^a x at every sample; NaN where it is infinite.
    pub values: Vec<f64>,
    /// Estimate of |error| at every sample; NaN throughout where there are too few rows to tell.
    pub error: Vec<f64>,
}

/// As [`derivative`], with an estimate of the error in every row.
///
/// The same is done with every second and with every fourth sample; the ratio r of the largest differences is the rate
/// at which the method converges on this x, and the error is the difference to every second sample times r/(1 − r). So
/// kinks and noise, on which every method converges slowly, show themselves: r is then near 1. To this comes what the
/// rounding of x, of t and of the sums makes of D^a x, which near the last digits is all there is. It is an estimate, not
/// a bound: what happens between samples is unknown to it, and so are digits that samples lost before they came. The largest
/// estimate of a smooth x is between a tenth and a hundred times the largest error. It costs three quarters more, and asks
/// for nine rows.
///
/// # Errors
/// As [`derivative`].
pub fn derivative_with_error(
    samples: &Samples,
    order: f64,
    definition: Definition,
    method: Method,
) -> Result<Estimated, DerivativeError> {
    let values = derivative(samples, order, definition, method)?;
    let half = thinned(samples, 2);
    let quarter = thinned(samples, 4);
    if quarter.t.len() < method.min_rows(order).max(3) {
        let error = vec![f64::NAN; values.len()];
        return Ok(Estimated { values, error });
    }
    let coarse = derivative(&half.samples(), order, definition, method)?;
    let coarser = derivative(&quarter.samples(), order, definition, method)?;
    let distance = |fine: &[f64], coarse: &[f64]| -> Vec<f64> {
        coarse.iter().enumerate().map(|(k, c)| (fine[2 * k] - c).abs()).collect()
    };
    let (first, second) = (distance(&values, &coarse), distance(&coarse, &coarser));
    let largest = |d: &[f64]| d.iter().copied().fold(0.0, f64::max);
    // Below this a method does not converge, and nothing can be concluded but that.
    const SLOWEST: f64 = 0.9;
    let ratio = match largest(&second) {
        0.0 => SLOWEST,
        second => (largest(&first) / second).min(SLOWEST),
    };
    let factor = ratio / (1.0 - ratio);
    // A row between two that were compared takes the worse of them.
    let worst = |row: usize| -> f64 {
        let (low, high) = ((row / 2).min(first.len() - 1), row.div_ceil(2).min(first.len() - 1));
        first[low].max(first[high])
    };
    let in_sums = match method.form() {
        // Of exponentials, in sums that do not cancel.
        Ok(_) if order.fract() != 0.0 && (method == Method::Exponential || !is_uniform(samples)) => {
            0.1 * KERNEL_TOLERANCE
        }
        _ => SUMS * f64::EPSILON,
    };
    let rounding = rounding(samples, order, &values, in_sums);
    let rows = values.iter().zip(&rounding).enumerate();
    let error = rows.map(|(row, (v, rounding))| if v.is_nan() { v.abs() } else { factor * worst(row) + rounding });
    let error = error.collect();
    Ok(Estimated { values, error })
}

fn is_uniform(samples: &Samples) -> bool {
    samples.uniform_prefix().rows == samples.t.len()
}

/// What rounding may make of D^a x at every sample: ε(|x| + |t x'|)/h^a from x and t next to it for a ≥ 0, and of the
/// sums this share of the largest value so far.
fn rounding(samples: &Samples, order: f64, values: &[f64], in_sums: f64) -> Vec<f64> {
    const NEAR: usize = 3;
    let noise = if order < 0.0 { 0.0 } else { NOISE * f64::EPSILON };
    let Samples { t, x, .. } = *samples;
    let last = t.len() - 1;
    let step = |row: usize| t[row + 1] - t[row];
    // x moves by this where t is rounded.
    let moved = |row: usize| {
        if order <= 0.0 {
            return 0.0;
        }
        let before = row.saturating_sub(1);
        (x[before + 1] - x[before]).abs() / step(before) * t[row].abs()
    };
    let mut largest = 0.0f64;
    let rows = values.iter().enumerate().map(|(row, value)| {
        let near = row.saturating_sub(NEAR)..=(row + NEAR).min(last);
        let size = near.clone().map(|row| x[row].abs() + moved(row)).fold(0.0, f64::max);
        let shortest = near.map(|row| step(row.min(last - 1))).fold(f64::INFINITY, f64::min);
        largest = largest.max(if value.is_nan() { 0.0 } else { value.abs() });
        noise * size * shortest.powf(-order) + in_sums * largest
    });
    rows.collect()
}

/// Roundings of x that differences of neighbours make of one, and roundings of sums.
const NOISE: f64 = 2.0;
const SUMS: f64 = 16.0;

/// Every so many samples.
struct Thinned {
    t: Vec<f64>,
    x: Vec<f64>,
    rate: Option<Vec<f64>>,
}

fn thinned(samples: &Samples, every: usize) -> Thinned {
    let thin = |values: &[f64]| values.iter().step_by(every).copied().collect();
    Thinned { t: thin(samples.t), x: thin(samples.x), rate: samples.rate.map(thin) }
}

impl Thinned {
    fn samples(&self) -> Samples<'_> {
        Samples { t: &self.t, x: &self.x, rate: self.rate.as_deref() }
    }
}

/// x' and x'' at all samples.
pub(super) struct Nodes {
    slope: Vec<f64>,
    bend: Vec<f64>,
    negligible_slope: f64,
}

impl Nodes {
    /// `step` where all are known to be equal.
    pub(super) fn of(samples: &Samples, form: Form, step: Option<f64>) -> Self {
        let Samples { t, x, rate } = *samples;
        let rows = t.len();
        let equal = Equal::new(form.points().min(rows));
        let width = equal.width();
        let (mut slope, mut bend) = (Vec::with_capacity(rows), Vec::with_capacity(rows));
        for row in 0..rows {
            let first = first_point(row, width, rows);
            let (t, x, at) = (&t[first..first + width], &x[first..first + width], row - first);
            let [v, w] = match step {
                Some(step) => equal.derivatives(step, x, at),
                None => equal.derivatives_at(t, x, at),
            };
            slope.push(v);
            bend.push(w);
        }
        let given = rate.filter(|_| form == Form::Cubic);
        if let Some(rate) = given {
            slope.copy_from_slice(rate);
        }
        let negligible_slope = if given.is_some() { 0.0 } else { negligible_slope(&t[..width], &x[..width]) };
        Self { slope, bend, negligible_slope }
    }

    pub(super) fn at(&self, samples: &Samples, row: usize) -> Node {
        Node { t: samples.t[row], x: samples.x[row], slope: self.slope[row], bend: self.bend[row] }
    }
}

/// What rounding may leave of x'(0) = 0 in differences of the first samples.
pub(super) fn negligible_slope(t: &[f64], x: &[f64]) -> f64 {
    let largest = x.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    64.0 * f64::EPSILON * largest / (t[1] - t[0])
}
