//! The times of the rows.

use std::sync::Arc;

/// When rows are written.
#[derive(Debug, Clone, PartialEq)]
pub enum RowTimes {
    /// At k·step < end, k = 0, 1, …, and at the end.
    Step {
        /// Spacing, s.
        step: f64,
        /// End, s.
        end: f64,
    },
    /// At these times, ascending.
    Times(Arc<[f64]>),
}

impl RowTimes {
    /// Number of rows.
    pub fn count(&self) -> usize {
        match self {
            // A last multiple that differs from the end by rounding alone is the end.
            Self::Step { step, end } => (end / step * (1.0 - 1e-12)).ceil() as usize + 1,
            Self::Times(times) => times.len(),
        }
    }

    /// Time of row `index`, s.
    pub fn at(&self, index: usize) -> f64 {
        match self {
            Self::Step { step, end } => {
                if index + 1 == self.count() {
                    return *end;
                }
                multiple(index as u64, *step)
            }
            Self::Times(times) => times[index],
        }
    }

    /// All times.
    pub fn all(&self) -> Vec<f64> {
        (0..self.count()).map(|k| self.at(k)).collect()
    }
}

/// k·step. Where 1/step is whole, k/(1/step) is the decimal that the user means; k·step may be one bit off.
pub(crate) fn multiple(k: u64, step: f64) -> f64 {
    let per_second = (1.0 / step).round();
    if (per_second * step - 1.0).abs() < 1e-14 { k as f64 / per_second } else { k as f64 * step }
}

#[cfg(test)]
mod tests {
    use super::RowTimes;

    #[test]
    fn rows_end_at_the_end() {
        let rows = |step: f64, end: f64| RowTimes::Step { step, end }.all();
        assert_eq!(rows(0.1, 0.3), [0.0, 0.1, 0.2, 0.3]);
        assert_eq!(rows(0.25, 0.6), [0.0, 0.25, 0.5, 0.6]);
        assert_eq!(rows(2.0, 1.0), [0.0, 1.0]);
        let fine = rows(0.01, 10.0);
        assert_eq!(fine.len(), 1001);
        assert_eq!(fine[7], 0.07);
        // Halving the step keeps the common rows to the bit.
        let finer = rows(0.005, 10.0);
        assert!((0..=1000).all(|k| fine[k] == finer[2 * k]));
    }
}
