//! Metrics: numbers that say how good a run is, from its rows alone, so that later is the same.
//!
//! Rows whose field is empty are left out, as if there were none; only the last value is that of the last row, whatever it is. A metric
//! that has no value is NaN, which is an empty field.

mod later;
mod levels;
mod series;
mod settling;
mod swings;

pub use later::{LaterError, Recomputed, Source};
pub use series::Series;

use crate::table::{push_number, push_text};
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
    }
}

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
    push_text(text, metric.kind.unit(&column.unit));
    text.push('\n');
}
