//! Smallest, largest and root-mean-square value of a column.

use serde::{Deserialize, Serialize};
use springpot_scenario::Statistic;

/// Running statistics over rows; empty fields do not count.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Statistics {
    /// Smallest value; NaN without any.
    pub min: f64,
    /// Largest value; NaN without any.
    pub max: f64,
    sum_of_squares: f64,
    count: u64,
}

impl Default for Statistics {
    fn default() -> Self {
        Self { min: f64::NAN, max: f64::NAN, sum_of_squares: 0.0, count: 0 }
    }
}

impl Statistics {
    /// Takes one more value.
    pub fn add(&mut self, value: f64) {
        if !value.is_finite() {
            return;
        }
        self.min = self.min.min(value);
        self.max = self.max.max(value);
        self.sum_of_squares += value * value;
        self.count += 1;
    }

    /// Root mean square over the rows; NaN without any.
    pub fn rms(&self) -> f64 {
        (self.sum_of_squares / self.count as f64).sqrt()
    }
}

/// Running statistics of the rows that a figure draws.
#[derive(Debug, Clone, Copy, Default)]
pub struct Totals {
    /// Smallest, largest and root-mean-square value.
    pub statistics: Statistics,
    sum: f64,
    last: Option<f64>,
}

impl Totals {
    /// Takes one more value.
    pub fn add(&mut self, value: f64) {
        self.statistics.add(value);
        self.last = Some(value);
        if value.is_finite() {
            self.sum += value;
        }
    }

    /// That statistic; NaN without any row.
    pub fn value(&self, statistic: Statistic) -> f64 {
        match statistic {
            Statistic::Min => self.statistics.min,
            Statistic::Max => self.statistics.max,
            Statistic::Rms => self.statistics.rms(),
            Statistic::Mean => self.mean(),
            Statistic::Final => self.last(),
        }
    }

    /// Mean over the rows; NaN without any.
    pub fn mean(&self) -> f64 {
        self.sum / self.statistics.count as f64
    }

    /// Value of the last row; NaN without any, or where it is empty.
    pub fn last(&self) -> f64 {
        self.last.unwrap_or(f64::NAN)
    }
}

#[cfg(test)]
mod tests {
    use super::{Statistics, Totals};

    #[test]
    fn skips_empty_fields() {
        let mut statistics = Statistics::default();
        assert!(statistics.rms().is_nan() && statistics.min.is_nan());
        [3.0, f64::NAN, -4.0].into_iter().for_each(|value| statistics.add(value));
        assert_eq!((statistics.min, statistics.max), (-4.0, 3.0));
        assert_eq!(statistics.rms(), 12.5f64.sqrt());
    }

    #[test]
    fn totals_tell_mean_and_last() {
        let mut totals = Totals::default();
        assert!(totals.mean().is_nan() && totals.last().is_nan());
        [1.0, f64::NAN, 5.0].into_iter().for_each(|value| totals.add(value));
        assert_eq!((totals.mean(), totals.last(), totals.statistics.max), (3.0, 5.0, 5.0));
        totals.add(f64::NAN);
        assert!(totals.last().is_nan());
    }
}
