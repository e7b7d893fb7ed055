//! Turning points, and what they say of a vibration.
//!
//! A swing is what lies between two turning points that follow one another; only those above a band are any, so that noise makes none. N turning
//! points at τ_1 … τ_N have N − 1 swings S_1 … S_{N−1}.

use super::series::Series;
use super::slopes::Slopes;
use springpot_scenario::Metric;

/// The band of those that say none, as a share of the range.
const BAND: f64 = 1e-3;

/// A row at which the column turns, refined by the parabola through it and its neighbours.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Turn {
    t: f64,
    y: f64,
    /// The row.
    row: usize,
}

/// The largest excess over the target, at a row or a turning point, as a fraction of |target − y_0|; 0 where it stays on its side, NaN where it
/// begins there.
pub(super) fn overshoot(series: &Series, metric: &Metric) -> f64 {
    let (way, target) = (series.way(metric), series.target(metric));
    let Some(first) = series.y().first().filter(|_| way > 0.0) else { return f64::NAN };
    let past = |y: f64| (y - target) * (target - first).signum();
    let turns = turns(series, metric).into_iter().map(|turn| turn.y);
    series.y().iter().copied().chain(turns).map(past).fold(0.0, f64::max) / way
}

/// Of the row or turning point that is furthest past, and of the way.
pub(super) fn overshoot_slopes(series: &Series, metric: &Metric) -> Slopes {
    let (way, target) = (series.way(metric), series.target(metric));
    let Some(first) = series.y().first().filter(|_| way > 0.0) else { return Slopes::default() };
    let side = (target - first).signum();
    let past = |y: f64| (y - target) * side;
    let largest = overshoot(series, metric) * way;
    if largest <= 0.0 {
        return Slopes::default();
    }
    let turns = turns(series, metric);
    let turn = turns.iter().max_by(|one, other| past(one.y).total_cmp(&past(other.y)));
    let rows = series.y().iter().enumerate();
    let row = rows.max_by(|(_, one), (_, other)| past(**one).total_cmp(&past(**other))).map(|(row, y)| (row, *y));
    let furthest = match (turn, row) {
        (Some(turn), Some((_, y))) if past(turn.y) >= past(y) => value_slopes(series, turn),
        (_, Some((row, _))) => Slopes::of_row(row),
        (_, None) => Slopes::default(),
    };
    let excess = (furthest - series.target_slopes(metric)) * side;
    (excess - series.way_slopes(metric) * (largest / way)) * (1.0 / way)
}

/// (N − 1)/(2(τ_N − τ_1)), Hz; NaN below two turning points.
pub(super) fn frequency(series: &Series, metric: &Metric) -> f64 {
    let turns = turns(series, metric);
    let [first, .., last] = &turns[..] else { return f64::NAN };
    (turns.len() - 1) as f64 / (2.0 * (last.t - first.t))
}

pub(super) fn frequency_slopes(series: &Series, metric: &Metric) -> Slopes {
    let turns = turns(series, metric);
    let [first, .., last] = &turns[..] else { return Slopes::default() };
    let over = (turns.len() - 1) as f64 / (2.0 * (last.t - first.t).powi(2));
    (time_slopes(series, first) - time_slopes(series, last)) * over
}

/// 2 ln(S_1/S_{N−1})/(N − 2); NaN below three turning points.
pub(super) fn log_decrement(series: &Series, metric: &Metric) -> f64 {
    let swings = swings(&turns(series, metric));
    let [first, .., last] = &swings[..] else { return f64::NAN };
    2.0 * (first / last).ln() / (swings.len() - 1) as f64
}

pub(super) fn log_decrement_slopes(series: &Series, metric: &Metric) -> Slopes {
    let turns = turns(series, metric);
    let Some(last) = turns.len().checked_sub(1).filter(|last| *last > 1) else { return Slopes::default() };
    let [first, end] = [0, last - 1].map(|k| of_log(series, &turns[k], &turns[k + 1]));
    (first - end) * (2.0 / (last - 1) as f64)
}

/// Of ln S between two turning points.
fn of_log(series: &Series, from: &Turn, to: &Turn) -> Slopes {
    (value_slopes(series, to) - value_slopes(series, from)) * (1.0 / (to.y - from.y))
}

/// Of the first swing that is the largest.
pub(super) fn residual_slopes(series: &Series, metric: &Metric) -> Slopes {
    let turns = turns(series, metric);
    let swings = swings(&turns);
    let largest = swings.iter().copied().fold(0.0, f64::max);
    let Some(k) = swings.iter().position(|swing| *swing == largest) else { return Slopes::default() };
    let rises = (turns[k + 1].y - turns[k].y).signum();
    (value_slopes(series, &turns[k + 1]) - value_slopes(series, &turns[k])) * (0.5 * rises)
}

/// ½ max S; 0 where nothing swings, NaN where there is nothing.
pub(super) fn residual(series: &Series, metric: &Metric) -> f64 {
    let none = if series.y().is_empty() { f64::NAN } else { 0.0 };
    0.5 * swings(&turns(series, metric)).into_iter().fold(none, f64::max)
}

fn swings(turns: &[Turn]) -> Vec<f64> {
    turns.windows(2).map(|pair| (pair[1].y - pair[0].y).abs()).collect()
}

/// The turning points: rows from and to which the column runs by more than the band; neither the first nor the last one.
fn turns(series: &Series, metric: &Metric) -> Vec<Turn> {
    let y = series.y();
    let (low, high) = y.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(*y), high.max(*y)));
    let band = series.band(metric).unwrap_or(BAND * (high - low));
    let mut turns = Vec::new();
    // Before the first swing: the lowest and the highest row. After that: where the swing at hand stands, and which way it goes.
    let (mut lowest, mut highest) = (0, 0);
    let mut swing: Option<(usize, f64)> = None;
    for (k, &value) in y.iter().enumerate() {
        match &mut swing {
            None => {
                (lowest, highest) =
                    (if value < y[lowest] { k } else { lowest }, if value > y[highest] { k } else { highest });
                if value - y[lowest] > band {
                    swing = Some((k, 1.0));
                } else if y[highest] - value > band {
                    swing = Some((k, -1.0));
                }
            }
            Some((crest, way)) if (value - y[*crest]) * *way > 0.0 => *crest = k,
            Some((crest, way)) if (y[*crest] - value) * *way > band => {
                turns.push(refined(series, *crest));
                (*crest, *way) = (k, -*way);
            }
            Some(_) => {}
        }
    }
    turns
}

/// The vertex of the parabola through a turning row and its neighbours; of rows that stay the middle one.
fn refined(series: &Series, crest: usize) -> Turn {
    let y = series.y();
    let same = y[crest..].iter().take_while(|other| **other == y[crest]).count();
    let k = crest + (same - 1) / 2;
    let plain = Turn { t: series.t()[k], y: y[k], row: k };
    Parabola::at(series, k).map_or(plain, |Parabola { slope, shift, .. }| Turn {
        t: plain.t + shift,
        y: plain.y + 0.5 * slope * shift,
        ..plain
    })
}

/// y_k + slope τ + curvature τ² through a row and its neighbours, whose vertex is at τ = shift.
struct Parabola {
    slope: f64,
    curvature: f64,
    shift: f64,
    /// Times to the neighbours.
    before: f64,
    after: f64,
}

impl Parabola {
    /// `None` where it has no vertex between the neighbours.
    fn at(series: &Series, k: usize) -> Option<Self> {
        let (t, y) = (series.t(), series.y());
        let ([before, after], [to, from]) = ([t[k] - t[k - 1], t[k + 1] - t[k]], [y[k] - y[k - 1], y[k + 1] - y[k]]);
        // Slopes of the chords; their difference is the curvature.
        let [rise, fall] = [to / before, from / after];
        let curvature = (fall - rise) / (before + after);
        let slope = (rise * after + fall * before) / (before + after);
        let shift = -0.5 * slope / curvature;
        let is_between = curvature != 0.0 && shift.is_finite() && shift >= -before && shift <= after;
        is_between.then_some(Self { slope, curvature, shift, before, after })
    }

    /// What slope and curvature change by with the three rows.
    fn slopes(&self, k: usize) -> [Slopes; 2] {
        let Self { before, after, .. } = *self;
        let rise = (Slopes::of_row(k) - Slopes::of_row(k - 1)) * (1.0 / before);
        let fall = (Slopes::of_row(k + 1) - Slopes::of_row(k)) * (1.0 / after);
        let over = 1.0 / (before + after);
        [(rise.clone() * after + fall.clone() * before) * over, (fall - rise) * over]
    }
}

/// Of the value of a turning point: that of the parabola where its vertex is.
fn value_slopes(series: &Series, turn: &Turn) -> Slopes {
    let own = Slopes::of_row(turn.row);
    let Some(parabola) = Parabola::at(series, turn.row) else { return own };
    let [slope, curvature] = parabola.slopes(turn.row);
    own + slope * parabola.shift + curvature * parabola.shift.powi(2)
}

/// Of the time of a turning point; that of a row stays.
fn time_slopes(series: &Series, turn: &Turn) -> Slopes {
    let Some(parabola) = Parabola::at(series, turn.row) else { return Slopes::default() };
    let [slope, curvature] = parabola.slopes(turn.row);
    (slope + curvature * (2.0 * parabola.shift)) * (-0.5 / parabola.curvature)
}

#[cfg(test)]
mod tests {
    use super::*;
    use springpot_scenario::{Band, MetricKind};
    use std::f64::consts::PI;

    fn metric(band: Option<Band>, target: Option<f64>) -> Metric {
        let (name, of) = ("swing".to_owned(), "y".to_owned());
        Metric { name, of, kind: MetricKind::Frequency, window: None, band, target, levels: None }
    }

    /// Rows of a function on [0, end], `per_second` a second.
    fn rows(end: f64, per_second: f64, y: impl Fn(f64) -> f64) -> Series {
        let t: Vec<f64> = (0..=(end * per_second) as usize).map(|k| k as f64 / per_second).collect();
        let y: Vec<f64> = t.iter().map(|t| y(*t)).collect();
        Series::new(&t, &y, None)
    }

    #[test]
    fn a_decaying_sine_has_its_frequency_and_decrement() {
        let (zeta, natural) = (0.03, 2.0 * PI * 1.7);
        let damped = natural * (1.0f64 - zeta * zeta).sqrt();
        let series = rows(6.0, 500.0, |t| 0.2 + 1e-3 * (-zeta * natural * t).exp() * (damped * t).sin());
        let plain = metric(None, None);
        let (f, decrement) = (frequency(&series, &plain), log_decrement(&series, &plain));
        assert!((f / (damped / (2.0 * PI)) - 1.0).abs() < 1e-5, "{f}");
        assert!((decrement / (2.0 * PI * zeta * natural / damped) - 1.0).abs() < 1e-4, "{decrement}");
        // Its first crest and trough, at tan(ω_d t) = ω_d/(ζω).
        let first = (damped / (zeta * natural)).atan() / damped;
        let crest = |t: f64| 1e-3 * (-zeta * natural * t).exp() * (damped * t).sin();
        let half = 0.5 * (crest(first) - crest(first + PI / damped));
        assert!((residual(&series, &plain) / half - 1.0).abs() < 1e-6);
    }

    #[test]
    fn the_parabola_makes_the_times_of_crests_third_order() {
        // Of the value, the error of the parabola falls with the fourth power of the spacing.
        let error = |per_second: f64| {
            let series = rows(3.0, per_second, |t| (-0.2 * t).exp() * (7.0 * t).cos());
            let crest = -(0.2f64 / 7.0).atan() / 7.0 + 2.0 * PI / 7.0;
            let turns = turns(&series, &metric(None, None));
            (turns[1].y - (-0.2 * crest).exp() * (7.0 * crest).cos()).abs()
        };
        let order = (error(40.0) / error(160.0)).log2() / 2.0;
        assert!(order > 3.0, "{order}");
    }

    #[test]
    fn a_step_answer_overshoots_as_its_damping_says() {
        for zeta in [0.1f64, 0.3, 0.6, 0.8] {
            let damped = (1.0 - zeta * zeta).sqrt();
            let phase = damped.atan2(zeta);
            let series = rows(40.0, 200.0, |t| 2.0 - 2.0 * (-zeta * t).exp() * (damped * t + phase).sin() / damped);
            let expected = (-PI * zeta / damped).exp();
            let past = overshoot(&series, &metric(None, Some(2.0)));
            assert!((past - expected).abs() < 1e-6, "{zeta}: {past} for {expected}");
            // Downwards it is the same.
            let down = Series::new(series.t(), &series.y().iter().map(|y| 5.0 - y).collect::<Vec<_>>(), None);
            assert!((overshoot(&down, &metric(None, Some(3.0))) - expected).abs() < 1e-6);
        }
        let lag = rows(9.0, 100.0, |t| -(-t).exp_m1());
        assert_eq!(overshoot(&lag, &metric(None, None)), 0.0);
        assert!(overshoot(&rows(1.0, 10.0, |_| 4.0), &metric(None, None)).is_nan());
    }

    #[test]
    fn a_run_that_ends_past_its_target_overshoots_without_turning() {
        let plain = |target| metric(None, Some(target));
        let rise = rows(1.0, 100.0, |t| 0.33 * t);
        assert!((overshoot(&rise, &plain(0.3)) - 0.1).abs() < 1e-12);
        assert_eq!(overshoot(&rise, &plain(0.5)), 0.0);
        // To go down and to go further is the same; so is a window that ends before the turn.
        let fall = rows(1.0, 100.0, |t| 1.0 - 0.9 * t);
        assert!((overshoot(&fall, &plain(0.25)) - 0.2).abs() < 1e-12);
        let swing = rows(4.0, 100.0, |t| 1.0 - (PI * t).cos());
        let cut = Series::new(swing.t(), swing.y(), Some([0.0, 0.75]));
        assert!((overshoot(&cut, &plain(1.0)) + (PI * 0.75).cos()).abs() < 1e-12);
        // A turn between rows still counts by its parabola: rows at 0.7 s and 1.4 s lie beside the crest at 1 s.
        let coarse = Series::new(&[0.0, 0.7, 1.4, 2.0], &[0.0, 1.588, 1.309, 0.0], None);
        assert!(overshoot(&coarse, &plain(1.0)) > 0.588);
    }

    #[test]
    fn what_does_not_vibrate_has_no_residual_vibration() {
        for y in [|_: f64| 3.0, |t: f64| -(-t).exp_m1(), |t: f64| (t - 1.0) * (-t).exp()] {
            assert_eq!(residual(&rows(9.0, 100.0, y), &metric(None, None)), 0.0);
        }
        // Nor does what stays within the band.
        let small = rows(5.0, 200.0, |t| 1e-3 * (9.0 * t).sin());
        assert_eq!(residual(&small, &metric(Some(Band::Width(0.01)), None)), 0.0);
        assert!(residual(&Series::new(&[], &[], None), &metric(None, None)).is_nan());
    }

    #[test]
    fn swings_below_the_band_are_none() {
        // A slow swing of 2 under a fast one of 0.1.
        let both = |t: f64| (2.0 * PI * t).sin() + 0.05 * (2.0 * PI * 37.0 * t).sin();
        let series = rows(5.0, 2000.0, both);
        let turns = |band| turns(&series, &metric(Some(band), None));
        assert_eq!(turns(Band::Width(0.2)).len(), 10);
        // |y_0 − target| = 0.5.
        let share = metric(Some(Band::Share(0.4)), Some(0.5));
        assert_eq!(super::turns(&series, &share).len(), 10);
        assert!(turns(Band::Width(1e-4)).len() > 300);
        assert!(turns(Band::Width(5.0)).is_empty());
        assert!(frequency(&series, &metric(Some(Band::Width(5.0)), None)).is_nan());
    }

    #[test]
    fn first_and_last_rows_do_not_turn_and_flat_ones_turn_in_their_middle() {
        let plain = metric(None, None);
        let at = |y: &[f64]| {
            let t: Vec<f64> = (0..y.len()).map(|k| k as f64).collect();
            turns(&Series::new(&t, y, None), &plain).iter().map(|turn| (turn.t, turn.y)).collect::<Vec<_>>()
        };
        assert_eq!(at(&[1.0, 0.0]), []);
        assert_eq!(at(&[1.0, 0.0, 1.0]), [(1.0, 0.0)]);
        assert_eq!(at(&[0.0, 1.0, 1.0, 0.0]), [(1.5, 1.125)]);
        assert_eq!(at(&[0.0, 1.0, 1.0, 1.0, 0.0]), [(2.0, 1.0)]);
        // Of uneven neighbours the lower one draws the vertex to the other side.
        assert_eq!(at(&[0.0, 4.0, 2.0]), [(1.0 + 1.0 / 6.0, 4.0 + 1.0 / 12.0)]);
        assert_eq!(at(&[2.0, 2.0, 2.0]), []);
        assert_eq!(at(&[]), []);
    }
}
