//! Samples of a function and the shape of their grid.

use super::error::SchemeError;
use super::named::Scheme;

/// Samples of x(t) at increasing times, the first at t = 0.
///
/// The rate x', where it is known, serves the expansions (moments by cubic Hermite interpolation; without it,
/// five-point differences stand in). The others take x'(0) from it at order 1 and above, else a one-sided difference.
#[derive(Debug, Clone, Copy)]
pub struct Samples<'a> {
    /// Times, s; t\[0\] = 0, strictly increasing.
    pub t: &'a [f64],
    /// Values at these times.
    pub x: &'a [f64],
    /// Rates x' at these times.
    pub rate: Option<&'a [f64]>,
}

/// The leading rows of a grid that lie at k·step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UniformPrefix {
    /// Their common step, s.
    pub step: f64,
    /// Number of rows, row 0 included: 2 or more.
    pub rows: usize,
}

impl Samples<'_> {
    /// Checks lengths, numbers and times for the derivative of this order by this scheme.
    ///
    /// # Errors
    /// `Length`, `TooShort` (fewer than [`Scheme::min_rows`]), `NotFinite`, `Start`, `NotIncreasing`.
    pub fn check(&self, scheme: Scheme, order: f64) -> Result<(), SchemeError> {
        let rows = self.t.len();
        let columns = [("t", Some(self.t)), ("x", Some(self.x)), ("rate", self.rate)];
        for (column, values) in columns.iter().filter_map(|(name, values)| values.map(|v| (*name, v))) {
            if values.len() != rows {
                return Err(SchemeError::Length { column, expected: rows, found: values.len() });
            }
        }
        let needed = scheme.min_rows(order);
        if rows < needed {
            return Err(SchemeError::TooShort { scheme, needed, found: rows });
        }
        for (column, values) in columns.iter().filter_map(|(name, values)| values.map(|v| (*name, v))) {
            if let Some(row) = values.iter().position(|v| !v.is_finite()) {
                return Err(SchemeError::NotFinite { column, row, value: values[row] });
            }
        }
        if self.t[0] != 0.0 {
            return Err(SchemeError::Start(self.t[0]));
        }
        if let Some(row) = (1..rows).find(|&k| self.t[k] <= self.t[k - 1]) {
            return Err(SchemeError::NotIncreasing { row, t: self.t[row], previous: self.t[row - 1] });
        }
        Ok(())
    }

    /// The longest uniform start of a checked grid.
    ///
    /// Uniform to rounding: every step is the first to 1e-9 of itself plus what rounding t leaves, and no row drifts
    /// from k·step by more than 1e-6 of a step.
    pub fn uniform_prefix(&self) -> UniformPrefix {
        let t = self.t;
        let first = t[1];
        let irregular = |k: usize| (t[k] - t[k - 1] - first).abs() > 1e-9 * first + 4.0 * f64::EPSILON * t[k];
        let rows = (2..t.len()).find(|&k| irregular(k)).unwrap_or(t.len());
        let step = t[rows - 1] / (rows - 1) as f64;
        let rows = (2..rows).find(|&k| (t[k] - k as f64 * step).abs() > 1e-6 * step).unwrap_or(rows);
        UniformPrefix { step: t[rows - 1] / (rows - 1) as f64, rows }
    }
}
