//! Smallest, largest and root-mean-square value of a column.

use serde::{Deserialize, Serialize};

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

#[cfg(test)]
mod tests {
    use super::Statistics;

    #[test]
    fn skips_empty_fields() {
        let mut statistics = Statistics::default();
        assert!(statistics.rms().is_nan() && statistics.min.is_nan());
        [3.0, f64::NAN, -4.0].into_iter().for_each(|value| statistics.add(value));
        assert_eq!((statistics.min, statistics.max), (-4.0, 3.0));
        assert_eq!(statistics.rms(), 12.5f64.sqrt());
    }
}
