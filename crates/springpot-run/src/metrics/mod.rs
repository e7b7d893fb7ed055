//! Metrics: numbers that say how good a run is, from its rows alone, so that later is the same.
//!
//! Rows whose field is empty are left out, as if there were none; only the last value is that of the last row, whatever it is. A metric
//! that has no value is NaN, which is an empty field.

mod errors;
mod later;
mod levels;
mod series;
mod settling;
mod slopes;
mod swings;

pub use later::{LaterError, Recomputed, Source};
pub use series::Series;
pub(crate) use series::is_within;

use crate::table::{push_number, push_text};
use errors::Integrand;
use springpot::table::Column;
use springpot_scenario::{Metric, MetricKind};

/// The value of a metric: `t`, s, and `values` are those of all rows of a case. NaN where there is none.
pub fn value(metric: &Metric, t: &[f64], values: &[f64]) -> f64 {
    let series = Series::new(t, values, metric.window);
    match metric.kind {
        MetricKind::Min => levels::min(&series),
        MetricKind::Max => levels::max(&series),
        MetricKind::Final => series.last(),
        MetricKind::PeakToPeak => levels::max(&series) - levels::min(&series),
        MetricKind::Mean => levels::mean(&series),
        MetricKind::Rms => levels::rms(&series),
        MetricKind::SettlingTime => settling::time(&series, metric),
        MetricKind::Overshoot => swings::overshoot(&series, metric),
        MetricKind::Frequency => swings::frequency(&series, metric),
        MetricKind::LogDecrement => swings::log_decrement(&series, metric),
        MetricKind::ResidualVibration => swings::residual(&series, metric),
        MetricKind::RiseTime => errors::rise_time(&series, metric),
        MetricKind::Iae => errors::integral(&series, metric, Integrand::Absolute),
        MetricKind::Ise => errors::integral(&series, metric, Integrand::Square),
        MetricKind::Itae => errors::integral(&series, metric, Integrand::Timed),
        MetricKind::Effort => errors::integral(&series, metric, Integrand::Effort),
    }
}

/// The derivatives of a metric where the values change by each of `changes`, row by row: exactly those of the number that [`value`] is, with the same
/// rows at its extremes and within its band. NaN where the metric is, where a row that it rests on has none, and where it bends (the `rms` of zeros).
/// Where an event ends the case the last row moves along the event, as `end` says.
pub fn gradient(metric: &Metric, (t, values): (&[f64], &[f64]), changes: &[&[f64]], end: Option<End<'_>>) -> Vec<f64> {
    let Some((slopes, rows)) = slopes_of(metric, t, values) else { return vec![f64::NAN; changes.len()] };
    let Some(End { along, later }) = end else {
        return changes.iter().map(|change| slopes.along(|k| change[rows[k]])).collect();
    };
    let (last, by_end) = (t.len() - 1, end_slope(metric, t, values));
    let of = |(p, change): (usize, &&[f64])| {
        // t itself changes as the end does.
        let at_end = if metric.of == TIME { later[p] } else { along[p] };
        let by_rows = slopes.along(|k| if rows[k] == last { at_end } else { change[rows[k]] });
        if by_end == 0.0 { by_rows } else { by_rows + by_end * later[p] }
    };
    changes.iter().enumerate().map(of).collect()
}

/// The column of the time.
const TIME: &str = "t";

/// How the last row of a case moves that an event ends, by each parameter.
#[derive(Debug, Clone, Copy)]
pub struct End<'a> {
    /// The value there, along the event.
    pub along: &'a [f64],
    /// Its time, s.
    pub later: &'a [f64],
}

/// Whether a metric hangs on the last row, by its value or by its time.
pub(crate) fn rests_on_end(metric: &Metric, t: &[f64], values: &[f64]) -> bool {
    let by_value = shares(metric, t, values).is_some_and(|shares| shares.iter().any(|(row, _)| row + 1 == t.len()));
    by_value || end_slope(metric, t, values) != 0.0
}

/// The step of the difference, in units of the last interval.
const END_STEP: f64 = 0.01;

/// ∂m/∂t of the last row, whose values stay: by differences of the number itself, in which the time stands as in a rational function.
fn end_slope(metric: &Metric, t: &[f64], values: &[f64]) -> f64 {
    let Some([before, last]) = t.last_chunk::<2>() else { return 0.0 };
    let step = END_STEP * (last - before);
    let mut moved = t.to_vec();
    let mut at = |by: f64| {
        moved[t.len() - 1] = last + by * step;
        value(metric, &moved, values)
    };
    if step <= 0.0 {
        return 0.0;
    }
    // Of the fourth order, and nothing where nothing changes.
    (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * step)
}

/// How much the value of each row counts in a metric: row and ∂m/∂y, a row that is there twice with the sum; `None` where the metric has no value.
pub(crate) fn shares(metric: &Metric, t: &[f64], values: &[f64]) -> Option<Vec<(usize, f64)>> {
    let (slopes, rows) = slopes_of(metric, t, values)?;
    Some(slopes.of_places().map(|(k, slope)| (rows[k], slope)).collect())
}

fn slopes_of(metric: &Metric, t: &[f64], values: &[f64]) -> Option<(slopes::Slopes, Vec<usize>)> {
    let series = Series::new(t, values, metric.window);
    let slopes = match metric.kind {
        MetricKind::Min => levels::min_slopes(&series),
        MetricKind::Max => levels::max_slopes(&series),
        MetricKind::Final => series.last_slopes(),
        MetricKind::PeakToPeak => levels::max_slopes(&series) - levels::min_slopes(&series),
        MetricKind::Mean => levels::mean_slopes(&series),
        MetricKind::Rms => levels::rms_slopes(&series),
        MetricKind::SettlingTime => settling::slopes(&series, metric),
        MetricKind::Overshoot => swings::overshoot_slopes(&series, metric),
        MetricKind::Frequency => swings::frequency_slopes(&series, metric),
        MetricKind::LogDecrement => swings::log_decrement_slopes(&series, metric),
        MetricKind::ResidualVibration => swings::residual_slopes(&series, metric),
        MetricKind::RiseTime => errors::rise_slopes(&series, metric),
        MetricKind::Iae => errors::integral_slopes(&series, metric, Integrand::Absolute),
        MetricKind::Ise => errors::integral_slopes(&series, metric, Integrand::Square),
        MetricKind::Itae => errors::integral_slopes(&series, metric, Integrand::Timed),
        MetricKind::Effort => errors::integral_slopes(&series, metric, Integrand::Effort),
    };
    value(metric, t, values).is_finite().then(|| (slopes, series::rows_of(t, values, metric.window)))
}

/// The columns of gradient.csv behind the swept parameters.
pub(crate) const GRADIENT_COLUMNS: [&str; 7] =
    ["metric", "value", "unit", "parameter", "derivative", "derivative_unit", "elasticity"];

/// The columns of metrics.csv behind the swept parameters.
pub(crate) const COLUMNS: [&str; 4] = ["metric", "column", "value", "unit"];

/// The line of a metric in metrics.csv; `lead` are the swept values, each with its comma, `column` the metric's column.
pub(crate) fn push_line(text: &mut String, lead: &str, metric: &Metric, column: &Column, value: f64) {
    text.push_str(lead);
    push_text(text, &metric.name);
    text.push(',');
    push_text(text, &metric.of);
    text.push(',');
    push_number(text, value);
    text.push(',');
    push_text(text, &metric.kind.unit(&column.unit));
    text.push('\n');
}

#[cfg(test)]
mod tests {
    use super::*;
    use springpot_scenario::Band;

    const KINDS: [MetricKind; MetricKind::ALL.len()] = MetricKind::ALL;

    fn metric(kind: MetricKind, band: Option<Band>, target: Option<f64>) -> Metric {
        Metric { name: "m".to_owned(), of: "y".to_owned(), kind, window: Some([0.05, 3.9]), band, target, levels: None }
    }

    /// Times that are not even, and a swing that dies away; every seventh row is empty.
    fn swing(phase: f64) -> (Vec<f64>, Vec<f64>) {
        let t: Vec<f64> = (0..97).map(|k| 0.04 * f64::from(k) + 0.012 * (1.7 * f64::from(k)).sin()).collect();
        let y = |(k, t): (usize, &f64)| {
            if k % 7 == 3 { f64::NAN } else { 1.0 - (-0.6 * t).exp() * (5.3 * t + phase).cos() }
        };
        let y = t.iter().enumerate().map(y).collect();
        (t, y)
    }

    #[test]
    fn gradients_are_those_of_the_numbers() {
        for (phase, kind) in [0.0, 0.7, 2.0].into_iter().flat_map(|phase| KINDS.map(|kind| (phase, kind))) {
            let (t, y) = swing(phase);
            let change: Vec<f64> = t.iter().map(|t| (3.1 * t).sin() + 0.4 * t - 0.3).collect();
            for (band, target) in [
                (None, None),
                (Some(Band::Share(0.1)), None),
                (Some(Band::Share(0.1)), Some(0.99)),
                (Some(Band::Width(0.12)), Some(1.0)),
            ] {
                let metric = metric(kind, band, target);
                let found = gradient(&metric, (&t, &y), &[&change], None)[0];
                let at = |step: f64| {
                    let moved: Vec<f64> = y.iter().zip(&change).map(|(y, change)| y + step * change).collect();
                    value(&metric, &t, &moved)
                };
                if at(0.0).is_nan() {
                    assert!(found.is_nan());
                    continue;
                }
                let step = 1e-6;
                let truth = (8.0 * (at(step) - at(-step)) - (at(2.0 * step) - at(-2.0 * step))) / (12.0 * step);
                let size = truth.abs().max(at(0.0).abs());
                assert!((found - truth).abs() < 1e-7 * size, "{kind:?} {band:?} {target:?}: {found} for {truth}");
                assert!(size > 0.0, "{kind:?} of a swing is not 0");
            }
        }
    }

    /// y(t; p) = sin(3t + p) until t* = 2 + p/2: all rows but the last stay where they are.
    #[test]
    fn gradients_know_that_the_end_moves() {
        for kind in KINDS {
            let of = |p: f64| {
                let end = 2.0 + 0.5 * p;
                let t: Vec<f64> = (0..40).map(|k| 0.05 * f64::from(k)).chain([end]).collect();
                let y: Vec<f64> = t.iter().map(|t| (3.0 * t + p).sin() + 1.5).collect();
                (t, y)
            };
            let (t, y) = of(0.0);
            let change: Vec<f64> = t.iter().map(|t| (3.0 * t).cos()).collect();
            let end = End { along: &[(3.0 * 2.0f64).cos() * 2.5], later: &[0.5] };
            let metric = Metric { window: None, ..metric(kind, Some(Band::Share(0.1)), Some(1.5)) };
            let found = gradient(&metric, (&t, &y), &[&change], Some(end))[0];
            let at = |p: f64| {
                let (t, y) = of(p);
                value(&metric, &t, &y)
            };
            if at(0.0).is_nan() {
                continue;
            }
            let step = 1e-5;
            let truth = (8.0 * (at(step) - at(-step)) - (at(2.0 * step) - at(-2.0 * step))) / (12.0 * step);
            assert!((found - truth).abs() < 1e-7 * (1.0 + truth.abs()), "{kind:?}: {found} for {truth}");
        }
        let time = Metric { of: "t".to_owned(), window: None, ..metric(MetricKind::Final, None, None) };
        let t = [0.0, 1.0, 1.7];
        let end = End { along: &[0.0], later: &[0.5] };
        assert_eq!(gradient(&time, (&t, &t), &[&[0.0; 3]], Some(end)), [0.5]);
        assert!(rests_on_end(&time, &t, &t));
    }

    #[test]
    fn gradients_are_empty_where_there_is_none() {
        let (t, y) = swing(0.0);
        // A row without a derivative matters where the metric rests on it, and only there.
        let mut change = vec![1.0; t.len()];
        let largest =
            (0..t.len()).filter(|k| t[*k] > 0.05 && y[*k].is_finite()).max_by(|a, b| y[*a].total_cmp(&y[*b])).unwrap();
        change[largest] = f64::NAN;
        let of = |kind| gradient(&metric(kind, None, None), (&t, &y), &[&change], None)[0];
        assert!(of(MetricKind::Max).is_nan() && of(MetricKind::Mean).is_nan());
        assert_eq!((of(MetricKind::Min), of(MetricKind::Final)), (1.0, 1.0));
        // What has no value has no gradient, and the rms of zeros bends.
        let still = vec![0.0; t.len()];
        let ones = vec![1.0; t.len()];
        for kind in [MetricKind::Frequency, MetricKind::LogDecrement, MetricKind::Rms] {
            assert!(gradient(&metric(kind, None, None), (&t, &still), &[&ones], None)[0].is_nan(), "{kind:?}");
        }
        assert_eq!(gradient(&metric(MetricKind::Rms, None, None), (&t, &still), &[&still], None), [0.0]);
    }
}
