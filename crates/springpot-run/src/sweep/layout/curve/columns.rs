//! First, lowest, highest and last point of every column of a picture.

use super::{Extent, Point, is_gap};

/// Of every stretch of a curve that stays within one column `width` wide keeps the first, lowest, highest and last point, in order,
/// and the extremes of the curve; gaps are kept, one point each. `None` where that is more than `wanted` points.
pub(super) fn thin(points: &[Point], width: f64, extent: &Extent, wanted: usize) -> Option<Vec<Point>> {
    let mut kept: Vec<Point> = Vec::with_capacity(wanted + 8);
    let mut start = 0;
    while start < points.len() {
        if kept.len() > wanted {
            return None;
        }
        if is_gap(&points[start]) {
            if kept.last().is_none_or(|last| !is_gap(last)) {
                kept.push([f64::NAN; 2]);
            }
            start += 1;
            continue;
        }
        let column = (points[start][0] / width).floor();
        let within = |point: &Point| !is_gap(point) && (point[0] / width).floor() == column;
        let (mut low, mut high, mut end) = (start, start, start + 1);
        while end < points.len() && within(&points[end]) {
            if points[end][1] < points[low][1] {
                low = end;
            }
            if points[end][1] > points[high][1] {
                high = end;
            }
            end += 1;
        }
        let extremes = extent.extremes.map(|k| if (start..end).contains(&k) { k } else { start });
        let mut chosen = [start, low, high, end - 1, extremes[0], extremes[1], extremes[2], extremes[3]];
        chosen.sort_unstable();
        for (k, &index) in chosen.iter().enumerate() {
            if k == 0 || index != chosen[k - 1] {
                kept.push(points[index]);
            }
        }
        start = end;
    }
    (kept.len() <= wanted).then_some(kept)
}
