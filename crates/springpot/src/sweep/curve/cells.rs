//! The parts of a curve that pass new cells of a picture.

use super::{Extent, Point, is_gap};

/// Cells that a curve passes, those that it passes again included.
pub(super) fn passed(points: &[Point], size: [f64; 2]) -> f64 {
    let steps = |a: &Point, b: &Point| ((b[0] - a[0]) / size[0]).abs() + ((b[1] - a[1]) / size[1]).abs();
    points.windows(2).map(|pair| steps(&pair[0], &pair[1])).filter(|steps| steps.is_finite()).sum()
}

/// Leaves out the stretches of a curve all of whose cells it has passed before, and of the points that stay within one cell all but
/// the first; extremes, gaps and the last stretch, from which the curve goes on, are kept. Where something is left out between two
/// points, a gap is between them. `None` where that is more than `wanted` points.
pub(super) fn thin(points: &[Point], size: [f64; 2], extent: &Extent, wanted: usize) -> Option<Vec<Point>> {
    let mut cells = Cells::new(size, extent);
    let mut kept: Vec<Point> = Vec::with_capacity(wanted + 8);
    // Where the next stretch begins, and whether that is the last point kept.
    let (mut from, mut joined): (Option<usize>, bool) = (None, false);
    for (k, point) in points.iter().enumerate() {
        if kept.len() > wanted {
            return None;
        }
        if is_gap(point) {
            part(&mut kept);
            (from, joined) = (None, false);
            continue;
        }
        let ends = points.get(k + 1).is_none_or(is_gap);
        let needed = |index: usize| extent.extremes.contains(&index) || k + 1 == points.len();
        let Some(start) = from else {
            // A point between two gaps is a stretch of its own.
            if ends && (cells.pass(*point, *point) || needed(k)) {
                part(&mut kept);
                kept.push(*point);
            }
            from = Some(k);
            continue;
        };
        if !ends && !needed(k) && cells.of(*point) == cells.of(points[start]) {
            continue;
        }
        let stays = cells.pass(points[start], *point) || needed(start) || needed(k);
        if stays {
            if !joined {
                part(&mut kept);
                kept.push(points[start]);
            }
            kept.push(*point);
        }
        (from, joined) = (Some(k), stays);
    }
    (kept.len() <= wanted).then_some(kept)
}

/// Ends a line with a gap.
fn part(kept: &mut Vec<Point>) {
    if kept.last().is_some_and(|last| !is_gap(last)) {
        kept.push([f64::NAN; 2]);
    }
}

/// Which cells a curve has passed.
struct Cells {
    size: [f64; 2],
    /// The lowest cell along each axis.
    lowest: [f64; 2],
    count: [usize; 2],
    passed: Vec<u64>,
}

impl Cells {
    fn new(size: [f64; 2], extent: &Extent) -> Self {
        let count = [0, 1].map(|axis| extent.count(axis, size[axis]));
        let lowest = [0, 1].map(|axis| (extent.low[axis] / size[axis]).floor());
        Self { size, lowest, count, passed: vec![0; (count[0] * count[1]).div_ceil(64)] }
    }

    /// A position in cells.
    fn position(&self, point: Point) -> [f64; 2] {
        [0, 1].map(|axis| point[axis] / self.size[axis] - self.lowest[axis])
    }

    fn of(&self, point: Point) -> [usize; 2] {
        let position = self.position(point);
        [0, 1].map(|axis| (position[axis].floor() as usize).min(self.count[axis] - 1))
    }

    /// Passes the cells of a straight line; whether one of them is new.
    fn pass(&mut self, a: Point, b: Point) -> bool {
        let (mut cell, end) = (self.of(a), self.of(b));
        let (from, to) = (self.position(a), self.position(b));
        let length = [to[0] - from[0], to[1] - from[1]];
        let mut left = [cell[0].abs_diff(end[0]), cell[1].abs_diff(end[1])];
        let mut new = self.enter(cell);
        while left != [0, 0] {
            // The share of the line at which it leaves the cell along each axis.
            let leaves = [0, 1].map(|axis| {
                let border = cell[axis] as f64 + if length[axis] > 0.0 { 1.0 } else { 0.0 };
                if left[axis] == 0 { f64::INFINITY } else { (border - from[axis]) / length[axis] }
            });
            let axis = usize::from(leaves[1] < leaves[0]);
            let axis = if left[axis] == 0 { 1 - axis } else { axis };
            if end[axis] > cell[axis] {
                cell[axis] += 1;
            } else {
                cell[axis] -= 1;
            }
            left[axis] -= 1;
            new |= self.enter(cell);
        }
        new
    }

    /// Passes one cell; whether it is new.
    fn enter(&mut self, cell: [usize; 2]) -> bool {
        let index = cell[1] * self.count[0] + cell[0];
        let (word, bit) = (&mut self.passed[index / 64], 1 << (index % 64));
        let new = *word & bit == 0;
        *word |= bit;
        new
    }
}
