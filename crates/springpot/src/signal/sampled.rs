//! Samples as functions: straight lines, or a cubic spline.

use super::jet::Jet;

/// Why samples are not a function of time.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SampleError {
    /// As many times as values are needed.
    #[error("{times} times but {values} values")]
    LengthMismatch {
        /// Number of times.
        times: usize,
        /// Number of values.
        values: usize,
    },
    /// Fewer than two samples.
    #[error("{given} samples; at least two are needed")]
    TooFew {
        /// Number of samples.
        given: usize,
    },
    /// A time that is not later than the one before.
    #[error("the times must increase, but sample {index} at t = {time} follows one at t = {before}")]
    NotIncreasing {
        /// Index of the later sample, from 0.
        index: usize,
        /// Its time.
        time: f64,
        /// Time of the sample before.
        before: f64,
    },
    /// NaN or infinity.
    #[error("sample {index} is not finite: t = {time}, value {value}")]
    NotFinite {
        /// Index of the sample, from 0.
        index: usize,
        /// Its time.
        time: f64,
        /// Its value.
        value: f64,
    },
}

/// Piecewise polynomials through samples.
#[derive(Debug, Clone)]
pub(super) struct Samples {
    times: Vec<f64>,
    values: Vec<f64>,
    /// Second derivatives at the samples; empty for straight lines.
    bends: Vec<f64>,
    /// Whether the first value holds before and the last behind.
    held: bool,
}

impl Samples {
    /// Whether it goes through the same samples in the same way.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        let Self { times, values, bends, held } = self;
        let is_same = |own: &[f64], other: &[f64]| {
            own.len() == other.len() && own.iter().zip(other).all(|(own, other)| own.to_bits() == other.to_bits())
        };
        *held == other.held
            && is_same(times, &other.times)
            && is_same(values, &other.values)
            && is_same(bends, &other.bends)
    }

    pub(super) fn linear(times: &[f64], values: &[f64]) -> Result<Self, SampleError> {
        check(times, values)?;
        Ok(Self { times: times.to_vec(), values: values.to_vec(), bends: Vec::new(), held: false })
    }

    pub(super) fn spline(times: &[f64], values: &[f64]) -> Result<Self, SampleError> {
        check(times, values)?;
        Ok(Self { times: times.to_vec(), values: values.to_vec(), bends: not_a_knot(times, values), held: false })
    }

    /// The same, held at its ends.
    pub(super) fn held(&self) -> Self {
        Self { held: true, ..self.clone() }
    }

    /// First and last time; `None` where it is held beyond them.
    pub(super) fn domain(&self) -> Option<(f64, f64)> {
        (!self.held).then(|| self.ends())
    }

    /// Where it begins and ends to be held, the first times of what follows.
    pub(super) fn kinks(&self) -> Vec<f64> {
        let (first, last) = self.ends();
        if self.held { vec![first, last] } else { Vec::new() }
    }

    fn ends(&self) -> (f64, f64) {
        (self.times[0], self.times[self.times.len() - 1])
    }

    pub(super) fn break_points(&self) -> &[f64] {
        let n = self.times.len();
        // The first and last two pieces of a spline are one polynomial each.
        let skipped = if self.bends.is_empty() { 1 } else { 2 };
        if n > 2 * skipped { &self.times[skipped..n - skipped] } else { &[] }
    }

    /// A bound of what rounding has made of the value at `t`.
    pub(super) fn rounding(&self, t: f64) -> f64 {
        let Jet { value, first, .. } = self.at(t);
        let i = self.times.partition_point(|&knot| knot <= t).saturating_sub(1).min(self.times.len() - 2);
        let beside = self.values[i].abs().max(self.values[i + 1].abs());
        f64::EPSILON * (value.abs().max(beside) + (first * t).abs())
    }

    pub(super) fn at(&self, t: f64) -> Jet {
        let last = self.times.len() - 2;
        if self.held {
            let (first, end) = self.ends();
            if t < first || t >= end {
                return Jet::constant(if t < first { self.values[0] } else { self.values[last + 1] });
            }
        }
        // A sample belongs to the piece on its right.
        let i = self.times.partition_point(|&knot| knot <= t).saturating_sub(1).min(last);
        let (t0, t1) = (self.times[i], self.times[i + 1]);
        let (y0, y1) = (self.values[i], self.values[i + 1]);
        let width = t1 - t0;
        let chord = (y1 - y0) / width;
        // From the nearer sample, so that both are met exactly.
        let from_right = t1 - t < t - t0;
        let (s, y) = if from_right { (t - t1, y1) } else { (t - t0, y0) };
        if self.bends.is_empty() {
            return Jet { value: y + s * chord, first: chord, second: 0.0 };
        }
        let (m0, m1) = (self.bends[i], self.bends[i + 1]);
        let third = (m1 - m0) / width;
        let (slope, bend) = if from_right {
            (chord + width * (m0 + 2.0 * m1) / 6.0, m1)
        } else {
            (chord - width * (2.0 * m0 + m1) / 6.0, m0)
        };
        Jet {
            value: y + s * (slope + s * (bend / 2.0 + s * third / 6.0)),
            first: slope + s * (bend + s * third / 2.0),
            second: bend + s * third,
        }
    }
}

fn check(times: &[f64], values: &[f64]) -> Result<(), SampleError> {
    if times.len() != values.len() {
        return Err(SampleError::LengthMismatch { times: times.len(), values: values.len() });
    }
    if times.len() < 2 {
        return Err(SampleError::TooFew { given: times.len() });
    }
    if let Some(index) = (0..times.len()).find(|&i| !(times[i].is_finite() && values[i].is_finite())) {
        return Err(SampleError::NotFinite { index, time: times[index], value: values[index] });
    }
    match (1..times.len()).find(|&i| times[i] <= times[i - 1]) {
        Some(index) => Err(SampleError::NotIncreasing { index, time: times[index], before: times[index - 1] }),
        None => Ok(()),
    }
}

/// Second derivatives of the not-a-knot spline.
///
/// h_{i−1} m_{i−1} + 2(h_{i−1} + h_i) m_i + h_i m_{i+1} = 6(d_i − d_{i−1}) inside, d the slopes of the chords, with m_0 and
/// m_{n−1} replaced by what a continuous third derivative at the second and last but one sample makes of them:
/// m_0 = m_1 + (h_0/h_1)(m_1 − m_2). The system is diagonally dominant, so elimination needs no pivots.
fn not_a_knot(times: &[f64], values: &[f64]) -> Vec<f64> {
    let n = times.len();
    let h = |i: usize| times[i + 1] - times[i];
    let d = |i: usize| (values[i + 1] - values[i]) / h(i);
    match n {
        2 => return vec![0.0; 2],
        3 => return vec![2.0 * (d(1) - d(0)) / (times[2] - times[0]); 3],
        _ => {}
    }
    let mut bends = vec![0.0; n];
    let mut above = vec![0.0; n];
    for i in 1..n - 1 {
        let (before, after) = (h(i - 1), h(i));
        let (mut lower, mut diagonal, mut upper) = (before, 2.0 * (before + after), after);
        if i == 1 {
            diagonal += before + before * before / after;
            upper -= before * before / after;
            lower = 0.0;
        }
        if i == n - 2 {
            diagonal += after + after * after / before;
            lower -= after * after / before;
            upper = 0.0;
        }
        let pivot = diagonal - lower * above[i - 1];
        above[i] = upper / pivot;
        bends[i] = (6.0 * (d(i) - d(i - 1)) - lower * bends[i - 1]) / pivot;
    }
    for i in (1..n - 2).rev() {
        bends[i] -= above[i] * bends[i + 1];
    }
    bends[0] = bends[1] + h(0) / h(1) * (bends[1] - bends[2]);
    bends[n - 1] = bends[n - 2] + h(n - 2) / h(n - 3) * (bends[n - 2] - bends[n - 3]);
    bends
}
