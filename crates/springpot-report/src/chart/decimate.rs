//! Long curves with few points that look the same.

use crate::draw::Point;

/// Of every stretch of a curve that stays within one column of `column` pixels keeps the first, lowest, highest and last point, in
/// order, so that no extreme is lost and a steady curve costs at most four points a column. What has still more than `most` points
/// (a curve that runs to and fro) is thinned again with wider columns, in the end by taking every k-th point and the extremes.
pub(super) fn decimate(points: &[Point], column: f64, most: usize) -> Vec<Point> {
    let mut thin = columns(points, column);
    let mut width = 2.0 * column;
    while thin.len() > most && width <= 8.0 * column {
        thin = columns(&thin, width);
        width *= 2.0;
    }
    if thin.len() > most { stride(&thin, most) } else { thin }
}

fn columns(points: &[Point], width: f64) -> Vec<Point> {
    let mut kept = Vec::new();
    let mut start = 0;
    for end in 1..=points.len() {
        let cell = |i: usize| (points[i][0] / width).floor();
        if end == points.len() || cell(end) != cell(start) {
            keep_extremes(&mut kept, points, start, end);
            start = end;
        }
    }
    kept
}

fn stride(points: &[Point], most: usize) -> Vec<Point> {
    // Every chunk keeps up to four points.
    let chunk = (4 * points.len()).div_ceil(most.max(4)).max(5);
    let mut kept = Vec::with_capacity(most + 4);
    for start in (0..points.len()).step_by(chunk) {
        keep_extremes(&mut kept, points, start, (start + chunk).min(points.len()));
    }
    kept
}

/// Keeps first, lowest, highest and last of points[start..end].
fn keep_extremes(kept: &mut Vec<Point>, points: &[Point], start: usize, end: usize) {
    let (mut low, mut high) = (start, start);
    for i in start..end {
        if points[i][1] < points[low][1] {
            low = i;
        }
        if points[i][1] > points[high][1] {
            high = i;
        }
    }
    let mut last = None;
    for i in [start, low.min(high), low.max(high), end - 1] {
        if last != Some(i) {
            kept.push(points[i]);
        }
        last = Some(i);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn extremes(points: &[Point]) -> (f64, f64) {
        points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), p| (lo.min(p[1]), hi.max(p[1])))
    }

    #[test]
    fn keeps_extremes_of_every_column() {
        let mut points: Vec<Point> =
            (0..100_000).map(|i| [f64::from(i) * 4e-3, 100.0 + 50.0 * f64::from(i).sin()]).collect();
        points[31_415][1] = 900.0;
        points[70_001][1] = -900.0;
        let thin = decimate(&points, 0.5, 4000);
        assert!(thin.len() <= 3204, "{}", thin.len());
        assert_eq!(extremes(&thin), (-900.0, 900.0));
        assert_eq!((thin[0], thin[thin.len() - 1]), (points[0], points[99_999]));
        for column in 0..800 {
            let within = |p: &&Point| (p[0] / 0.5).floor() == f64::from(column);
            let all: Vec<Point> = points.iter().filter(within).copied().collect();
            let few: Vec<Point> = thin.iter().filter(within).copied().collect();
            assert_eq!(extremes(&all), extremes(&few));
        }
    }

    #[test]
    fn short_curves_stay_as_they_are() {
        let points: Vec<Point> = (0..400).map(|i| [f64::from(i), f64::from(i * i % 17)]).collect();
        assert_eq!(decimate(&points, 0.5, 4000), points);
        assert_eq!(decimate(&[], 0.5, 10), Vec::<Point>::new());
        assert_eq!(decimate(&[[1.0, 2.0]], 0.5, 10), [[1.0, 2.0]]);
    }

    #[test]
    fn scribbles_stay_within_the_budget() {
        let points: Vec<Point> =
            (0..100_000u64).map(|i| [(i * 7919 % 400) as f64, (i * 104_729 % 9973) as f64]).collect();
        let thin = decimate(&points, 0.5, 3000);
        assert!(thin.len() <= 3004, "{}", thin.len());
        assert_eq!(extremes(&thin), extremes(&points));
    }
}
