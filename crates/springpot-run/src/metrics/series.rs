//! The rows that a metric is taken from.

use super::slopes::Slopes;
use springpot_scenario::{Band, Metric};

/// Rows of a case with t in a window.
#[derive(Debug)]
pub struct Series {
    /// Where it begins, s.
    start: f64,
    /// Times, s, and values of the rows that have one.
    t: Vec<f64>,
    y: Vec<f64>,
    /// Value of the last row; NaN where it is empty, or there is no row.
    last: f64,
}

impl Series {
    /// The rows with t in `window`, the rounding of its ends aside; all of them without.
    pub fn new(t: &[f64], values: &[f64], window: Option<[f64; 2]>) -> Self {
        let rows = || t.iter().zip(values).filter(|(t, _)| window.is_none_or(|window| is_within(window, **t)));
        let start = window.map(|[from, _]| from).or(t.first().copied()).unwrap_or(f64::NAN);
        let last = rows().next_back().map_or(f64::NAN, |(_, y)| *y);
        let (t, y) = rows().filter(|(_, y)| y.is_finite()).unzip();
        Self { start, t, y, last }
    }

    /// Where it begins: at the window's first time, or at the first row.
    pub(super) fn start(&self) -> f64 {
        self.start
    }

    pub(super) fn t(&self) -> &[f64] {
        &self.t
    }

    pub(super) fn y(&self) -> &[f64] {
        &self.y
    }

    pub(super) fn last(&self) -> f64 {
        self.last
    }

    pub(super) fn last_slopes(&self) -> Slopes {
        self.y.len().checked_sub(1).map_or_else(Slopes::default, Slopes::of_row)
    }

    /// Where the column is to go: as written, or the last value that there is; NaN without any.
    pub(super) fn target(&self, metric: &Metric) -> f64 {
        metric.target.or(self.y.last().copied()).unwrap_or(f64::NAN)
    }

    /// |y_0 − target|: how far the first value is from there.
    pub(super) fn way(&self, metric: &Metric) -> f64 {
        self.y.first().map_or(f64::NAN, |first| (first - self.target(metric)).abs())
    }

    pub(super) fn target_slopes(&self, metric: &Metric) -> Slopes {
        if metric.target.is_some() { Slopes::default() } else { self.last_slopes() }
    }

    pub(super) fn way_slopes(&self, metric: &Metric) -> Slopes {
        let Some(first) = self.y.first() else { return Slopes::default() };
        (Slopes::of_row(0) - self.target_slopes(metric)) * (first - self.target(metric)).signum()
    }

    /// The band, in the unit of the column, where the metric says one.
    pub(super) fn band(&self, metric: &Metric) -> Option<f64> {
        metric.band.map(|band| match band {
            Band::Width(width) => width,
            Band::Share(share) => share * self.way(metric),
        })
    }
}

/// Which rows of a case the values of its [`Series`] are.
pub(super) fn rows_of(t: &[f64], values: &[f64], window: Option<[f64; 2]>) -> Vec<usize> {
    let is_one = |k: &usize| values[*k].is_finite() && window.is_none_or(|window| is_within(window, t[*k]));
    (0..t.len().min(values.len())).filter(is_one).collect()
}

/// Whether a time is in a window, its rounding aside.
pub(crate) fn is_within([from, to]: [f64; 2], t: f64) -> bool {
    let slack = 1e-9 * (to - from);
    t >= from - slack && t <= to + slack
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_hold_both_ends_and_empty_fields_are_left_out() {
        let t: Vec<f64> = (0..11).map(|k| f64::from(k) * 0.1).collect();
        let mut y = t.clone();
        y[2] = f64::NAN;
        let series = Series::new(&t, &y, Some([0.2, 0.7]));
        assert_eq!((series.start(), series.t().len(), series.last()), (0.2, 5, t[7]));
        assert_eq!(Series::new(&t, &y, None).y().len(), 10);
        y[10] = f64::NAN;
        assert!(Series::new(&t, &y, None).last().is_nan());
        assert!(Series::new(&t, &y, Some([3.0, 4.0])).y().is_empty());
    }
}
