//! Extremes and means.

use super::series::Series;
use super::slopes::Slopes;

/// Smallest value; NaN without any.
pub(super) fn min(series: &Series) -> f64 {
    series.y().iter().copied().fold(f64::NAN, f64::min)
}

/// Of the first row that has it.
pub(super) fn min_slopes(series: &Series) -> Slopes {
    row_with(series, min(series))
}

/// Of the first row that has it.
pub(super) fn max_slopes(series: &Series) -> Slopes {
    row_with(series, max(series))
}

fn row_with(series: &Series, value: f64) -> Slopes {
    series.y().iter().position(|y| *y == value).map_or_else(Slopes::default, Slopes::of_row)
}

/// Largest value; NaN without any.
pub(super) fn max(series: &Series) -> f64 {
    series.y().iter().copied().fold(f64::NAN, f64::max)
}

/// ∫y dt/(t_N − t_1) by the trapezoid rule; the value itself of a single row.
pub(super) fn mean(series: &Series) -> f64 {
    over_time(series, |y| y)
}

/// √(∫y² dt/(t_N − t_1)) by the trapezoid rule.
pub(super) fn rms(series: &Series) -> f64 {
    over_time(series, |y| y * y).sqrt()
}

pub(super) fn mean_slopes(series: &Series) -> Slopes {
    Slopes::of_rows(shares(series).enumerate())
}

/// Σ w y δy/rms: where all rows are 0 it bends.
pub(super) fn rms_slopes(series: &Series) -> Slopes {
    let rms = rms(series);
    Slopes::of_rows(shares(series).zip(series.y()).map(|(weight, y)| weight * y / rms).enumerate())
}

/// The weights of the trapezoid rule over (t_N − t_1).
fn shares(series: &Series) -> impl Iterator<Item = f64> {
    let t = series.t();
    let last = t.len().saturating_sub(1);
    weights(t).map(move |weight| if last == 0 { 1.0 } else { weight / (t[last] - t[0]) })
}

/// The weights of the trapezoid rule, s; 0 of a single row.
pub(super) fn weights(t: &[f64]) -> impl Iterator<Item = f64> {
    let last = t.len().saturating_sub(1);
    (0..t.len()).map(move |k| 0.5 * (t[(k + 1).min(last)] - t[k.saturating_sub(1)]))
}

fn over_time(series: &Series, of: impl Fn(f64) -> f64) -> f64 {
    let (t, y) = (series.t(), series.y());
    let ([first, .., last], values) = (t, y) else { return y.first().map_or(f64::NAN, |y| of(*y)) };
    let pairs = t.windows(2).zip(values.windows(2));
    let area: f64 = pairs.map(|(t, y)| 0.5 * (t[1] - t[0]) * (of(y[0]) + of(y[1]))).sum();
    area / (last - first)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_have_their_own_means_on_any_rows() {
        // y = 3 − 2t on uneven rows: the mean is that of its ends; ∫y² by the trapezoid rule is that of the chords of y².
        let t = [0.0, 0.1, 0.5, 0.6, 2.0];
        let y = t.map(|t| 3.0 - 2.0 * t);
        let series = Series::new(&t, &y, None);
        assert!((mean(&series) - 1.0).abs() < 1e-15);
        assert_eq!((min(&series), max(&series), series.last()), (-1.0, 3.0, -1.0));
        let one = Series::new(&[4.0], &[-7.0], None);
        assert_eq!((mean(&one), rms(&one)), (-7.0, 7.0));
        let none = Series::new(&[], &[], None);
        assert!([mean, rms, min, max].iter().all(|of| of(&none).is_nan()));
    }

    #[test]
    fn a_sine_over_whole_periods() {
        // The trapezoid rule is exact for it on even rows.
        let t: Vec<f64> = (0..=1000).map(|k| f64::from(k) * 1e-3).collect();
        let y: Vec<f64> = t.iter().map(|t| 2.0 + 3.0 * (std::f64::consts::TAU * 5.0 * t).sin()).collect();
        let series = Series::new(&t, &y, None);
        assert!((mean(&series) - 2.0).abs() < 1e-13);
        assert!((rms(&series) - 8.5f64.sqrt()).abs() < 1e-13);
        // Its last row does not count twice: an empty field in between joins its neighbours by a line.
        let mut holed = y.clone();
        holed[500] = f64::NAN;
        assert!((mean(&Series::new(&t, &holed, None)) - 2.0).abs() < 1e-5);
    }
}
