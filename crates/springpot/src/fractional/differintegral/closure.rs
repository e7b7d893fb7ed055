//! Closures as Chebyshev polynomials on pieces as short as they must be.

use super::error::FunctionError;
use super::piecewise::{Joint, Piece, Piecewise};
use std::f64::consts::PI;
use std::ops::RangeInclusive;
use std::sync::LazyLock;

/// Degree of a piece.
const DEGREE: usize = 16;
const POINTS: usize = DEGREE + 1;

/// Pieces before any is divided, so that no feature wider than a fiftieth of the interval is overlooked.
const FIRST_PIECES: usize = 8;

/// More pieces than any function needs that polynomials can follow.
const MOST_PIECES: usize = 10_000;

impl Piecewise {
    /// The function `f` on an interval, to a relative accuracy of `rtol` on every piece; 1e-15 for functions in closed
    /// form, their own error for others.
    ///
    /// Chebyshev interpolation of degree 16 on pieces that are halved until their last coefficients are below `rtol`
    /// times the variation of f on the piece. Kinks, jumps and singularities like √t are closed in until they matter no
    /// more, at the start down to 10⁻²⁴ of the interval; what is left of them is in the error of
    /// [`Differintegral::at`](super::Differintegral::at); x'(0), which Caputo's definition asks for above order 1, is
    /// extrapolated where x starts like t^1.05. Where kinks and jumps are known, [`Self::then`] makes them
    /// exact.
    ///
    /// ```
    /// use springpot::fractional::{Definition, Piecewise};
    ///
    /// // D^½ √t = √π/2
    /// let root = Piecewise::of(|t| t.sqrt(), 0.0..=10.0, 1e-15)?;
    /// let d = root.derivative(0.5, Definition::Caputo)?;
    /// for t in [0.01, 1.0, 9.9] {
    ///     let y = d.at(t);
    ///     assert!((y.value - 0.5 * std::f64::consts::PI.sqrt()).abs() < 1e-10 && y.error < 1e-8);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// `Interval`, `Tolerance`, `NotFinite`; `Unresolved` where 10 000 pieces do not do, as for noise above `rtol`.
    pub fn of(f: impl Fn(f64) -> f64, interval: RangeInclusive<f64>, rtol: f64) -> Result<Self, FunctionError> {
        let (start, end) = (*interval.start(), *interval.end());
        if !(start < end && (end - start).is_finite()) {
            return Err(FunctionError::Interval { start, end });
        }
        if !(1e-15..=0.1).contains(&rtol) {
            return Err(FunctionError::Tolerance(rtol));
        }
        let at = |k: usize| start + (end - start) * k as f64 / FIRST_PIECES as f64;
        let mut open: Vec<(f64, f64)> = (0..FIRST_PIECES).rev().map(|k| (at(k), at(k + 1))).collect();
        open[0].1 = end;
        let mut pieces = Vec::new();
        while let Some((from, to)) = open.pop() {
            let shortest = (0.5f64.powi(80) * (end - start)).max(0.5f64.powi(44) * from.abs().max(to.abs()));
            let may_divide = to - from > shortest;
            match fitted(&f, from, to, rtol)? {
                Fit::Good(piece) => pieces.push(piece),
                Fit::Poor(_) if may_divide => {
                    let middle = from + 0.5 * (to - from);
                    open.extend([(middle, to), (from, middle)]);
                }
                Fit::Poor(chord) => pieces.push(chord),
            }
            if pieces.len() + open.len() > MOST_PIECES {
                return Err(FunctionError::Unresolved { pieces: pieces.len(), t: from, rtol });
            }
        }
        Ok(Self { pieces })
    }
}

/// Rounding that is taken for such, relative to the variation.
const PLATEAU: f64 = 1e-12;

enum Fit {
    Good(Piece),
    /// The chord, for want of better.
    Poor(Piece),
}

/// Where between the points of the interpolation the polynomial is compared with the function.
const PROBES: [f64; 2] = [0.297, 0.771];

fn fitted(f: &impl Fn(f64) -> f64, from: f64, to: f64, rtol: f64) -> Result<Fit, FunctionError> {
    let width = to - from;
    let sample = |theta: f64| {
        let t = if theta == 1.0 { to } else { from + theta * width };
        let value = f(t);
        if value.is_finite() { Ok(value) } else { Err(FunctionError::NotFinite { t, value }) }
    };
    let tables = &*TABLES;
    let mut values = [0.0; POINTS];
    for (value, theta) in values.iter_mut().zip(&tables.points) {
        *value = sample(*theta)?;
    }
    let product = |matrix: &[[f64; POINTS]; POINTS], vector: &[f64; POINTS]| -> [f64; POINTS] {
        std::array::from_fn(|i| matrix[i].iter().zip(vector).map(|(m, v)| m * v).sum())
    };
    let chebyshev = product(&tables.to_chebyshev, &values);
    let x = product(&tables.to_powers, &chebyshev);

    let largest = values.iter().map(|v| v.abs()).fold(0.0, f64::max);
    let spread = |fold: fn(f64, f64) -> f64, first: f64| values.iter().copied().fold(first, fold);
    let variation = spread(f64::max, f64::NEG_INFINITY) - spread(f64::min, f64::INFINITY);
    // The times themselves are rounded, by what the variation makes of it.
    let rounding = 8.0 * f64::EPSILON * (largest + variation * from.abs().max(to.abs()) / width);
    let allowed = (rtol * variation).max(rounding);
    let largest_of = |k: std::ops::Range<usize>| chebyshev[k].iter().map(|c| c.abs()).fold(0.0, f64::max);
    let (before, tail) = (largest_of(DEGREE - 7..DEGREE - 3), largest_of(DEGREE - 3..POINTS));
    // Coefficients that are small and do not decay are rounding inside f, which shorter pieces only make more of.
    let allowed = if tail > 0.1 * before { allowed.max(PLATEAU * variation) } else { allowed };
    let mut miss = tail.max(4.0 * f64::EPSILON * largest);
    for theta in PROBES {
        let there = x.iter().rev().fold(0.0, |sum, c| sum * theta + c);
        miss = miss.max((there - sample(theta)?).abs());
    }
    if tail <= allowed && miss <= 8.0 * allowed {
        return Ok(Fit::Good(Piece { start: from, width, x: x.to_vec(), miss, joint: Joint::Fitted }));
    }
    let (left, right) = (values[DEGREE], values[0]);
    let chord = |theta: f64| left + theta * (right - left);
    let miss = values.iter().zip(&tables.points).map(|(v, theta)| (v - chord(*theta)).abs()).fold(0.0, f64::max);
    Ok(Fit::Poor(Piece { start: from, width, x: vec![left, right - left], miss, joint: Joint::Fitted }))
}

/// What does not depend on the piece.
struct Tables {
    /// θ_i = (1 + cos πi/n)/2: from 1 down to 0.
    points: [f64; POINTS],
    /// Values to coefficients of T_k(2θ−1).
    to_chebyshev: [[f64; POINTS]; POINTS],
    /// These to coefficients of θ^p; integers, exact.
    to_powers: [[f64; POINTS]; POINTS],
}

static TABLES: LazyLock<Tables> = LazyLock::new(|| {
    let n = DEGREE as f64;
    let points = std::array::from_fn(|i| {
        // The square of a cosine keeps θ accurate near 0.
        let half = (0.5 * PI * i as f64 / n).cos();
        if i == DEGREE { 0.0 } else { half * half }
    });
    let end = |i: usize| if i == 0 || i == DEGREE { 0.5 } else { 1.0 };
    let to_chebyshev = std::array::from_fn(|k| {
        std::array::from_fn(|i| {
            // Reduced to one turn, so that the cosine is accurate.
            let angle = (i * k) % (2 * DEGREE);
            2.0 / n * end(i) * end(k) * (PI * angle as f64 / n).cos()
        })
    });
    let mut to_powers = [[0.0; POINTS]; POINTS];
    let (mut before, mut polynomial) = ([0.0; POINTS], [0.0; POINTS]);
    polynomial[0] = 1.0;
    for k in 0..POINTS {
        for (row, c) in to_powers.iter_mut().zip(polynomial) {
            row[k] = c;
        }
        // T_{k+1} = 2(2θ−1) T_k − T_{k−1}, T_1 = 2θ−1.
        let factor = if k == 0 { 1.0 } else { 2.0 };
        let next = std::array::from_fn(|p| {
            let raised = if p > 0 { 2.0 * polynomial[p - 1] } else { 0.0 };
            factor * (raised - polynomial[p]) - before[p]
        });
        before = polynomial;
        polynomial = next;
    }
    Tables { points, to_chebyshev, to_powers }
});
