//! Settling time.

use super::series::Series;
use super::slopes::Slopes;
use springpot_scenario::{Band, Metric};

/// The band of those that say none, as a share of |y_0 − target|.
const BAND: f64 = 0.02;

/// Time from the start of the window to the straight-line entry into the band |y − target| ≤ band after the last row outside of it; 0
/// where no row is outside, NaN where the last one is.
pub(super) fn time(series: &Series, metric: &Metric) -> f64 {
    let (t, y) = (series.t(), series.y());
    let Some((out, edge)) = entry(series, metric) else { return if y.is_empty() { f64::NAN } else { 0.0 } };
    let Some(&inside) = y.get(out + 1) else { return f64::NAN };
    let share = ((y[out] - edge) / (y[out] - inside)).clamp(0.0, 1.0);
    t[out] + share * (t[out + 1] - t[out]) - series.start()
}

/// The last row outside, and the edge that is then passed; `None` where no row is.
fn entry(series: &Series, metric: &Metric) -> Option<(usize, f64)> {
    let (y, target) = (series.y(), series.target(metric));
    let band = series.band(metric).unwrap_or_else(|| BAND * series.way(metric));
    let out = y.iter().rposition(|y| (y - target).abs() > band)?;
    Some((out, target + band.copysign(y[out] - target)))
}

/// The line between the two rows and the edge move.
pub(super) fn slopes(series: &Series, metric: &Metric) -> Slopes {
    let (t, y) = (series.t(), series.y());
    let Some((out, edge)) = entry(series, metric) else { return Slopes::default() };
    let Some(&inside) = y.get(out + 1) else { return Slopes::default() };
    let share_of_way = match metric.band {
        None => BAND,
        Some(Band::Share(share)) => share,
        Some(Band::Width(_)) => 0.0,
    };
    let side = (y[out] - series.target(metric)).signum();
    let edge_slopes = series.target_slopes(metric) + series.way_slopes(metric) * (share_of_way * side);
    let (drop, share) = (y[out] - inside, (y[out] - edge) / (y[out] - inside));
    let fall = Slopes::of_row(out) - Slopes::of_row(out + 1);
    (Slopes::of_row(out) - edge_slopes - fall * share) * ((t[out + 1] - t[out]) / drop)
}

#[cfg(test)]
mod tests {
    use super::*;
    use springpot_scenario::MetricKind;

    fn metric(band: Option<Band>, target: Option<f64>) -> Metric {
        let (name, of) = ("settle".to_owned(), "y".to_owned());
        Metric { name, of, kind: MetricKind::SettlingTime, window: None, band, target, levels: None }
    }

    #[test]
    fn broken_lines_settle_where_they_enter() {
        let t = [0.0, 1.0, 2.0, 3.0, 4.0];
        let y = [0.0, 2.0, 0.5, 1.25, 1.0];
        let settle = |band, target, window| time(&Series::new(&t, &y, window), &metric(band, target));
        // Into 1 ± 0.25 from 0.5 at t = 2: at 0.75, a third of the way to the next row.
        assert_eq!(settle(Some(Band::Width(0.25)), Some(1.0), None), 2.0 + 1.0 / 3.0);
        // The last row is the target.
        assert_eq!(settle(Some(Band::Width(0.25)), None, None), 2.0 + 1.0 / 3.0);
        assert_eq!(settle(Some(Band::Width(0.25)), None, Some([0.5, 4.0])), 2.0 + 1.0 / 3.0 - 0.5);
        // 50 % of |0 − 1|: from above, out at t = 1.
        assert_eq!(settle(Some(Band::Share(0.5)), None, None), 1.0 + 1.0 / 3.0);
        assert_eq!(settle(Some(Band::Width(5.0)), None, None), 0.0);
        assert!(settle(Some(Band::Width(0.25)), Some(2.0), None).is_nan(), "it never settles there");
        // 2 % of |0 − 1| where nothing is said: 1.02 is entered from 1.25.
        assert!((settle(None, None, None) - (3.0 + 0.23 / 0.25)).abs() < 1e-14);
        assert!(time(&Series::new(&[], &[], None), &metric(None, None)).is_nan());
    }

    #[test]
    fn a_lag_settles_when_it_is_said_to() {
        // y = 1 − e^−t is within 2 % of 1 from ln 50 on; the chord of rows 1 ms apart is off by 1e-7.
        let t: Vec<f64> = (0..=20_000).map(|k| f64::from(k) * 1e-3).collect();
        let y: Vec<f64> = t.iter().map(|t| -(-t).exp_m1()).collect();
        let settled = time(&Series::new(&t, &y, None), &metric(Some(Band::Share(0.02)), Some(1.0)));
        assert!((settled - 50f64.ln()).abs() < 2e-7, "{settled}");
    }
}
