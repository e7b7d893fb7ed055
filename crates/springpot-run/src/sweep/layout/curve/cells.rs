//! The parts of a curve that pass new cells of a picture.

use super::cone::Cone;
use super::{Extent, Point, is_gap};

/// Cells that a curve passes, those that it passes again included.
pub(super) fn passed(points: &[Point], size: [f64; 2]) -> f64 {
    let steps = |a: &Point, b: &Point| ((b[0] - a[0]) / size[0]).abs() + ((b[1] - a[1]) / size[1]).abs();
    points.windows(2).map(|pair| steps(&pair[0], &pair[1])).filter(|steps| steps.is_finite()).sum()
}

/// What a thinned curve begins with, which is not looked at again with cells of the same size.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Settled {
    /// Number of points.
    points: usize,
    /// The point from which the curve goes on; those between are left out from now on. `None` where the curve begins or goes on
    /// behind a gap.
    from: Option<usize>,
}

/// Draws straight lines through the points that are not settled, within half a cell of them, and leaves out the lines all of whose
/// cells the curve has passed before; a gap takes their place. Extremes, gaps and the last point are kept. `None` where that is
/// more than `wanted` points.
pub(super) fn thin(
    points: &[Point],
    settled: Settled,
    size: [f64; 2],
    extent: &Extent,
    wanted: usize,
) -> Option<(Vec<Point>, Settled)> {
    let mut lines = Lines::new(points, settled, size, extent, wanted);
    let mut line = settled.from.map(|from| lines.start(from));
    let mut settled = settled;
    for k in settled.from.map_or(settled.points, |from| from + 1)..points.len() {
        if lines.kept.len() > wanted {
            return None;
        }
        if is_gap(&points[k]) {
            lines.part();
            (line, settled) = (None, Settled { points: lines.kept.len(), from: None });
            continue;
        }
        let ends = points.get(k + 1).is_none_or(is_gap);
        match &mut line {
            // A point between two gaps is a line of its own.
            None if ends => settled = lines.draw(k, k),
            None => line = Some(lines.start(k)),
            Some(Line { from, through, cone }) => {
                let position = lines.cells.position(points[k]);
                if cone.take(position) {
                    *through = k;
                } else {
                    let (from, end) = (*from, *through);
                    lines.draw(from, end);
                    let mut next = lines.start(end);
                    next.cone.take(position);
                    line = Some(Line { through: k, ..next });
                }
            }
        }
        if (ends || extent.extremes.contains(&k))
            && let Some(Line { from, .. }) = line
        {
            settled = lines.draw(from, k);
            line = Some(lines.start(k));
        }
    }
    (lines.kept.len() <= wanted).then_some((lines.kept, settled))
}

/// A straight line that is under way.
struct Line {
    from: usize,
    /// The last point that it passes.
    through: usize,
    cone: Cone,
}

/// A curve that is drawn line by line.
struct Lines<'a> {
    points: &'a [Point],
    extremes: [usize; 4],
    cells: Cells,
    kept: Vec<Point>,
    /// The last point kept, where a line may go on from it.
    end: Option<usize>,
}

impl<'a> Lines<'a> {
    /// Takes the settled points as they are.
    fn new(points: &'a [Point], settled: Settled, size: [f64; 2], extent: &Extent, wanted: usize) -> Self {
        let mut kept = Vec::with_capacity(wanted + 8);
        kept.extend_from_slice(&points[..settled.points]);
        let mut cells = Cells::new(size, extent);
        let mut last = None;
        for point in &kept {
            if !is_gap(point) {
                cells.pass(last.unwrap_or(*point), *point);
            }
            last = (!is_gap(point)).then_some(*point);
        }
        let end = settled.from.filter(|from| from + 1 == settled.points);
        Self { points, extremes: extent.extremes, cells, kept, end }
    }

    /// A line that begins at a point.
    fn start(&self, from: usize) -> Line {
        Line { from, through: from, cone: Cone::new(self.cells.position(self.points[from])) }
    }

    /// Draws a line where it passes a new cell or has an extreme, and the last one; returns what is settled by then.
    fn draw(&mut self, from: usize, to: usize) -> Settled {
        let new = self.cells.pass(self.points[from], self.points[to]);
        let stays = new || [from, to].iter().any(|k| self.extremes.contains(k));
        let last = to + 1 == self.points.len();
        if !stays && !last {
            self.end = None;
            return Settled { points: self.kept.len(), from: None };
        }
        let before = self.kept.len();
        if self.end != Some(from) || from == to {
            self.part();
            self.kept.push(self.points[from]);
        }
        if from != to {
            self.kept.push(self.points[to]);
        }
        self.end = Some(to);
        let from = self.kept.len() - 1;
        Settled { points: if stays { from + 1 } else { before }, from: Some(from) }
    }

    /// Ends a line with a gap.
    fn part(&mut self) {
        if self.kept.last().is_some_and(|last| !is_gap(last)) {
            self.kept.push([f64::NAN; 2]);
        }
        self.end = None;
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

    fn of(&self, position: [f64; 2]) -> [usize; 2] {
        [0, 1].map(|axis| (position[axis].floor() as usize).min(self.count[axis] - 1))
    }

    /// Passes the cells of a straight line; whether one of them is new.
    fn pass(&mut self, a: Point, b: Point) -> bool {
        let (from, to) = (self.position(a), self.position(b));
        let (mut cell, end) = (self.of(from), self.of(to));
        let length = [to[0] - from[0], to[1] - from[1]];
        let mut left = [cell[0].abs_diff(end[0]), cell[1].abs_diff(end[1])];
        let mut new = self.enter(cell);
        while left != [0, 0] {
            // The share of the line at which it leaves the cell along each axis.
            let leaves = [0, 1].map(|axis| {
                let border = cell[axis] as f64 + if length[axis] > 0.0 { 1.0 } else { 0.0 };
                if left[axis] == 0 { f64::INFINITY } else { (border - from[axis]) / length[axis] }
            });
            let axis = usize::from(left[0] == 0 || leaves[1] < leaves[0]);
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
