//! Integrals of an error, and the time that a rise takes.

use super::levels::weights;
use super::series::Series;
use super::slopes::Slopes;
use springpot_scenario::Metric;

/// Levels of a rise time that says none.
const LEVELS: [f64; 2] = [0.1, 0.9];

/// What is integrated.
#[derive(Debug, Clone, Copy)]
pub(super) enum Integrand {
    /// |y − target|.
    Absolute,
    /// (y − target)².
    Square,
    /// (t − t_0)·|y − target|.
    Timed,
    /// |y|.
    Effort,
}

impl Integrand {
    /// Its value and its derivative by y at row `k`.
    fn at(self, series: &Series, target: f64, k: usize) -> [f64; 2] {
        let (t, y) = (series.t()[k], series.y()[k]);
        let e = y - target;
        let sign = |x: f64| if x == 0.0 { 0.0 } else { x.signum() };
        match self {
            Self::Absolute => [e.abs(), sign(e)],
            Self::Square => [e * e, 2.0 * e],
            Self::Timed => [(t - series.start()) * e.abs(), (t - series.start()) * sign(e)],
            Self::Effort => [y.abs(), sign(y)],
        }
    }
}

/// ∫ dt by the trapezoid rule; 0 of a single row, NaN without any.
pub(super) fn integral(series: &Series, metric: &Metric, integrand: Integrand) -> f64 {
    if series.y().is_empty() {
        return f64::NAN;
    }
    let target = series.target(metric);
    weights(series.t()).enumerate().map(|(k, weight)| weight * integrand.at(series, target, k)[0]).sum()
}

/// The target moves with the last row where none is said.
pub(super) fn integral_slopes(series: &Series, metric: &Metric, integrand: Integrand) -> Slopes {
    let target = series.target(metric);
    let slopes: Vec<f64> =
        weights(series.t()).enumerate().map(|(k, weight)| weight * integrand.at(series, target, k)[1]).collect();
    let whole: f64 = slopes.iter().sum();
    let own = Slopes::of_rows(slopes.into_iter().enumerate());
    match integrand {
        Integrand::Effort => own,
        _ => own - series.target_slopes(metric) * whole,
    }
}

/// Time from where the straight lines between rows first reach the lower level of the way from the first row to the target to where they first reach the
/// upper one; NaN where they do not, or there is no way.
pub(super) fn rise_time(series: &Series, metric: &Metric) -> f64 {
    let [from, to] =
        metric.levels.unwrap_or(LEVELS).map(|level| passage(series, metric, level).map(|passage| passage.t));
    from.zip(to).map_or(f64::NAN, |(from, to)| to - from)
}

pub(super) fn rise_slopes(series: &Series, metric: &Metric) -> Slopes {
    let [from, to] = metric.levels.unwrap_or(LEVELS).map(|level| {
        let slopes = |passage: Passage| {
            let edge = Slopes::of_row(0) * (1.0 - level) + series.target_slopes(metric) * level;
            let Passage { row: 0, .. } = passage else {
                let (t, y) = (series.t(), series.y());
                let [before, behind] = [passage.row - 1, passage.row];
                let moved =
                    edge - Slopes::of_row(before) * (1.0 - passage.share) - Slopes::of_row(behind) * passage.share;
                return moved * ((t[behind] - t[before]) / (y[behind] - y[before]));
            };
            Slopes::default()
        };
        passage(series, metric, level).map_or_else(Slopes::default, slopes)
    });
    to - from
}

/// Where a level is first reached.
struct Passage {
    t: f64,
    /// The first row that is there.
    row: usize,
    /// How far the line from the row before has come.
    share: f64,
}

fn passage(series: &Series, metric: &Metric, level: f64) -> Option<Passage> {
    let (t, y) = (series.t(), series.y());
    let first = *y.first()?;
    let way = series.target(metric) - first;
    let edge = first + level * way;
    let row = y.iter().position(|y| (y - edge) * way.signum() >= 0.0).filter(|_| way != 0.0 && way.is_finite())?;
    if row == 0 {
        return Some(Passage { t: t[0], row, share: 0.0 });
    }
    let share = (edge - y[row - 1]) / (y[row] - y[row - 1]);
    Some(Passage { t: t[row - 1] + share * (t[row] - t[row - 1]), row, share })
}

#[cfg(test)]
mod tests {
    use super::*;
    use springpot_scenario::MetricKind;

    fn metric(target: Option<f64>, levels: Option<[f64; 2]>) -> Metric {
        let (name, of) = ("m".to_owned(), "y".to_owned());
        Metric { name, of, kind: MetricKind::RiseTime, window: None, band: None, target, levels }
    }

    #[test]
    fn broken_lines_have_their_own_errors() {
        let (t, y) = ([0.0, 1.0, 2.0, 4.0], [0.0, 2.0, 1.0, 1.0]);
        let series = Series::new(&t, &y, None);
        let of = |integrand| integral(&series, &metric(None, None), integrand);
        assert_eq!(of(Integrand::Absolute), 1.0 + 0.5);
        assert_eq!(of(Integrand::Square), 1.0 + 0.5);
        assert_eq!(of(Integrand::Timed), 0.5 + 0.5);
        assert_eq!(of(Integrand::Effort), 1.0 + 1.5 + 2.0);
        let late = Series::new(&t, &y, Some([1.0, 4.0]));
        assert_eq!(integral(&late, &metric(Some(1.0), None), Integrand::Timed), 0.0);
        assert_eq!(integral(&Series::new(&[1.0], &[3.0], None), &metric(None, None), Integrand::Effort), 0.0);
        assert!(integral(&Series::new(&[], &[], None), &metric(None, None), Integrand::Effort).is_nan());
        // From 0.1 to 0.9 on the first line, whose slope is 2.
        assert!((rise_time(&series, &metric(None, None)) - 0.4).abs() < 1e-15);
        assert!((rise_time(&series, &metric(Some(-4.0), None))).is_nan());
        assert_eq!(rise_time(&series, &metric(Some(2.0), Some([0.0, 1.0]))), 1.0);
        assert!(rise_time(&series, &metric(Some(0.0), None)).is_nan(), "no way");
    }

    /// y = 1 − e^−t rises from 10 % to 90 % in ln 9; its errors are 1, ½ and 1.
    #[test]
    fn a_lag_rises_when_it_is_said_to() {
        let t: Vec<f64> = (0..=40_000).map(|k| f64::from(k) * 1e-3).collect();
        let y: Vec<f64> = t.iter().map(|t| -(-t).exp_m1()).collect();
        let (series, metric) = (Series::new(&t, &y, None), metric(Some(1.0), None));
        assert!((rise_time(&series, &metric) - 9.0f64.ln()).abs() < 2e-7);
        for (integrand, wanted) in [(Integrand::Absolute, 1.0), (Integrand::Square, 0.5), (Integrand::Timed, 1.0)] {
            assert!((integral(&series, &metric, integrand) - wanted).abs() < 2e-7, "{integrand:?}");
        }
    }
}
