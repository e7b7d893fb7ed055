//! Long curves with few points that look the same.

use crate::draw::Point;
use std::f64::consts::{PI, TAU};

/// Points that are left of a curve without any shape.
const ROUGH: usize = 8000;

/// Pixels by which a line may pass the points it leaves out, the finest that does first. Columns and lines each take half of it.
const TOLERANCES: [f64; 6] = [0.1, 0.2, 0.4, 0.8, 1.6, 3.2];

/// A curve, given as its unbroken runs in pixels, with fewer points. No point that is left out is farther than 0.1 pixels from what is
/// drawn. A curve that has still more than `most` points gets coarser, and of a scribble that stays too long even so every run keeps the
/// extremes of equal chunks.
pub(super) fn decimate(runs: &[Vec<Point>], most: usize) -> Vec<Vec<Point>> {
    let thinned = TOLERANCES.into_iter().map(|tolerance| thin(runs, tolerance));
    thinned.into_iter().find(|runs| count(runs) <= most).unwrap_or_else(|| {
        let thin: Vec<Vec<Point>> = runs.iter().map(|run| columns(run, TOLERANCES[0])).collect();
        let total = count(&thin);
        let share = |run: &[Point]| (most.min(ROUGH) * run.len() / total).max(8);
        let rough = |run: &Vec<Point>| if run.len() <= share(run) { run.clone() } else { chunks(run, share(run)) };
        thin.iter().map(rough).collect()
    })
}

/// Points of all runs.
pub(super) fn count(runs: &[Vec<Point>]) -> usize {
    runs.iter().map(Vec::len).sum()
}

/// The most points that each of several curves may have so that together they have at most `all`: the shorter ones leave more to the
/// longer.
pub(super) fn share(counts: &[usize], all: usize) -> usize {
    let mut counts = counts.to_vec();
    counts.sort_unstable();
    let mut left = all;
    for (k, count) in counts.iter().enumerate() {
        let equal = left / (counts.len() - k);
        if *count > equal {
            return equal;
        }
        left -= count;
    }
    usize::MAX
}

/// Of every stretch of a curve that stays within one narrow column its first, lowest, highest and last point, in order; of those, what
/// straight lines through others do not pass.
fn thin(runs: &[Vec<Point>], tolerance: f64) -> Vec<Vec<Point>> {
    runs.iter().map(|run| straighten(&columns(run, 0.5 * tolerance), 0.5 * tolerance)).collect()
}

/// Leaves points out as long as one straight line from the last point kept passes all of them within `tolerance` and moves on.
fn straighten(points: &[Point], tolerance: f64) -> Vec<Point> {
    let Some((&first, rest)) = points.split_first() else { return Vec::new() };
    let mut kept = vec![first];
    let (mut anchor, mut last) = (first, first);
    let mut cone = None;
    for &point in rest {
        cone = narrow(cone, anchor, point, tolerance).or_else(|| {
            kept.push(last);
            anchor = last;
            narrow(None, anchor, point, tolerance)
        });
        last = point;
    }
    if !rest.is_empty() {
        kept.push(last);
    }
    kept
}

/// Directions from an anchor that pass all points so far.
#[derive(Clone, Copy)]
struct Cone {
    /// The direction that angles are measured from, and the lowest and highest angle still allowed.
    axis: f64,
    low: f64,
    high: f64,
    /// Distance of the last point.
    reached: f64,
}

/// The cone that passes `point` too; `None` where there is none or the curve turns back. A first point always fits.
fn narrow(cone: Option<Cone>, anchor: Point, point: Point, tolerance: f64) -> Option<Cone> {
    let (dx, dy) = (point[0] - anchor[0], point[1] - anchor[1]);
    let (reached, direction) = (dx.hypot(dy), dy.atan2(dx));
    let half = (tolerance / reached).min(1.0).asin();
    let Some(cone) = cone else { return Some(Cone { axis: direction, low: -half, high: half, reached }) };
    let turn = (direction - cone.axis + PI).rem_euclid(TAU) - PI;
    let fits = turn >= cone.low && turn <= cone.high && reached >= cone.reached;
    fits.then_some(Cone { low: cone.low.max(turn - half), high: cone.high.min(turn + half), reached, ..cone })
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

fn chunks(points: &[Point], most: usize) -> Vec<Point> {
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

    /// A curve without gaps.
    fn decimate(points: &[Point], most: usize) -> Vec<Point> {
        super::decimate(&[points.to_vec()], most).remove(0)
    }

    fn extremes(points: &[Point]) -> (f64, f64) {
        points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), p| (lo.min(p[1]), hi.max(p[1])))
    }

    #[test]
    fn keeps_extremes_of_every_column() {
        let mut points: Vec<Point> =
            (0..100_000).map(|i| [f64::from(i) * 4e-3, 100.0 + 50.0 * f64::from(i).sin()]).collect();
        points[31_415][1] = 900.0;
        points[70_001][1] = -900.0;
        let thin = columns(&points, 0.5);
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
        assert_eq!(decimate(&points, 4000), points);
        assert_eq!(decimate(&[], 10), Vec::<Point>::new());
        assert_eq!(decimate(&[[1.0, 2.0]], 10), [[1.0, 2.0]]);
    }

    #[test]
    fn loops_keep_their_shape() {
        // 60 turns of an ellipse with 1500 points each, slowly turning.
        let at = |i: u32| f64::from(i) * TAU / 1503.0;
        let points: Vec<Point> = (0..90_000).map(|i| [200.0 * at(i).cos(), 100.0 * (at(i) + 0.4).sin()]).collect();
        let thin = decimate(&points, 100_000);
        assert!(thin.len() <= 12_000 && thin.len() > 4_000, "{}", thin.len());
        assert!(farthest(&points, &thin) <= 0.1);
    }

    /// Largest distance of a point from the line through some of them, pixels.
    fn farthest(points: &[Point], thin: &[Point]) -> f64 {
        let (mut next, mut farthest) = (0, 0.0f64);
        for pair in thin.windows(2) {
            let (d, start) = ([pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]], next);
            while points[next] != pair[1] {
                next += 1;
            }
            for point in &points[start..next] {
                let off = (d[0] * (point[1] - pair[0][1]) - d[1] * (point[0] - pair[0][0])).abs() / d[0].hypot(d[1]);
                farthest = farthest.max(off);
            }
        }
        assert_eq!(next, points.len() - 1);
        farthest
    }

    #[test]
    fn all_runs_of_a_curve_share_one_budget() {
        // 100 turns of a slowly turning ellipse in pieces of all lengths, one far longer than the others.
        let at = |i: u32| f64::from(i) * TAU / 150.3;
        let points: Vec<Point> = (0..15_000).map(|i| [200.0 * at(i).cos(), 100.0 * (1.02 * at(i)).sin()]).collect();
        let (long, short) = points.split_at(9_000);
        let runs: Vec<Vec<Point>> = std::iter::once(long).chain(short.chunks(20)).map(<[Point]>::to_vec).collect();
        let thin = super::decimate(&runs, 6_000);
        assert_eq!(thin.len(), runs.len());
        assert!(thin.iter().map(Vec::len).sum::<usize>() <= 6_000);
        for (full, thin) in runs.iter().zip(&thin) {
            assert_eq!((full[0], full[full.len() - 1]), (thin[0], thin[thin.len() - 1]));
            assert!(farthest(full, thin) <= 0.8);
        }
    }

    #[test]
    fn short_curves_leave_room_to_long_ones() {
        assert_eq!(share(&[10, 10, 10], 100), usize::MAX);
        assert_eq!(share(&[1000, 10, 500], 110), 50);
        assert_eq!(share(&[1000, 10, 40], 110), 60);
        assert_eq!(share(&[], 110), usize::MAX);
    }

    #[test]
    fn straight_lines_need_two_points() {
        let points: Vec<Point> = (0..100).map(|i| [f64::from(i), 0.5 * f64::from(i)]).collect();
        assert_eq!(straighten(&points, 0.1), [points[0], points[99]]);
        let there_and_back: Vec<Point> = [0.0, 5.0, 9.0, 4.0, 1.0].map(|x| [x, 0.0]).to_vec();
        assert_eq!(straighten(&there_and_back, 0.1), [[0.0, 0.0], [9.0, 0.0], [1.0, 0.0]]);
        assert_eq!(straighten(&[[1.0, 1.0]; 5], 0.1), [[1.0, 1.0]; 2]);
        assert_eq!(straighten(&[[1.0, 1.0]], 0.1), [[1.0, 1.0]]);
    }

    #[test]
    fn scribbles_stay_within_the_budget() {
        let points: Vec<Point> =
            (0..100_000u64).map(|i| [(i * 7919 % 400) as f64, (i * 104_729 % 9973) as f64]).collect();
        let thin = decimate(&points, 3000);
        assert!(thin.len() <= 3004, "{}", thin.len());
        assert_eq!(extremes(&thin), extremes(&points));
    }
}
