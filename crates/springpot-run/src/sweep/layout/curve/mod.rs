//! Curves that grow point by point and keep what can be seen of them.

mod cells;
mod columns;
mod cone;
mod extent;

use cells::Settled;
use extent::{Extent, Point, is_gap};

/// Points that the curves of all figures keep together: 64 MiB.
const IN_ALL: usize = 1 << 22;

/// Points that the curves of one figure keep together.
const IN_FIGURE: usize = 1 << 20;

/// Points that one curve keeps at most, and at least before it is thinned.
const MOST: usize = 1 << 16;
const LEAST: usize = 1 << 10;

/// Most curves of all figures together, so that each keeps its least share of the points.
pub const MAX_CURVES_IN_ALL: usize = IN_ALL / LEAST;

/// Points that each curve may keep where the largest figure has `figure` curves and all figures together `all`: a power of two,
/// 65 536 up to 16 curves in a figure and 64 in all, at least 1024.
pub fn most_points(figure: usize, all: usize) -> usize {
    let share = (IN_FIGURE / figure.max(1)).min(IN_ALL / all.max(1));
    1 << share.clamp(LEAST, MOST).ilog2()
}

/// A curve that grows point by point and never holds more than `most` points, however many are added.
///
/// Up to `most` points it keeps all. Then it is thinned to half of them, whenever it is full, and never loses an extreme:
/// - Where x never runs back, every column of the picture keeps its first, lowest, highest and last point. Columns are at most some
///   16/`most` of the extent in x wide, and neither curve is farther than that from the other.
/// - Loops and scribbles become straight lines within half a cell of the points, and a line is left out, with a gap in its place, where
///   others pass all of its cells. Cells are at most 1/(16·√`most`) of the extent in x and in y, and neither curve is farther than
///   three of them from the other. Where the lines would be more than it may keep, cells are larger.
///
/// Along a logarithmic axis the extent is that of the logarithms, and what is not above zero is a gap.
///
/// With 65 536 points and the largest panel that figures have, 440 by 290 pixels, columns and cells are 0.11 pixels at most. A point
/// with a coordinate that is NaN, infinite or beyond 1e300 is a gap; gaps are kept. What is kept follows from the points alone.
#[derive(Debug, Clone, PartialEq)]
pub struct KeptCurve {
    points: Vec<Point>,
    most: usize,
    /// Whether x and y are drawn on logarithmic axes.
    is_log: [bool; 2],
    thinned: Thinned,
}

/// How a curve was thinned last. Sizes are powers of two that only grow, so that what was thinned before is thinned again as the
/// full curve would be.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Thinned {
    /// Into columns of this width; 0 before the first time.
    Columns(f64),
    /// Into cells of this size.
    Cells([f64; 2], Settled),
}

impl KeptCurve {
    /// A curve without points that will keep at most `most`, no fewer than 1024.
    pub fn new(most: usize) -> Self {
        Self::on_axes(most, [false; 2])
    }

    /// As [`Self::new`], for a picture whose x and y may be logarithmic.
    pub fn on_axes(most: usize, is_log: [bool; 2]) -> Self {
        Self { points: Vec::new(), most: most.max(LEAST), is_log, thinned: Thinned::Columns(0.0) }
    }

    /// Adds a point.
    pub fn push(&mut self, x: f64, y: f64) {
        if self.points.len() >= self.most {
            self.thin();
        }
        self.points.push([x, y]);
    }

    /// The points that are kept, `[x, y]`, in order; gaps are points with a NaN once it was thinned.
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// Thins it as it is drawn.
    fn thin(&mut self) {
        let drawn = self.is_log.contains(&true).then(|| self.drawn());
        let whole = std::mem::take(&mut self.points);
        let points = drawn.as_ref().unwrap_or(&whole);
        let Some(extent) = Extent::of(points) else {
            self.points = whole.into_iter().take(1).collect();
            return;
        };
        let wanted = self.most / 2;
        let by_columns = match self.thinned {
            Thinned::Columns(width) if extent.runs_on => self.columns(points, &extent, width, wanted),
            _ => None,
        };
        let kept = by_columns.unwrap_or_else(|| self.cells(points, &extent, wanted));
        self.points = if drawn.is_some() { undrawn(&kept, points, &whole) } else { kept };
    }

    /// The points where they are drawn; what a logarithmic axis has no place for is a gap.
    fn drawn(&self) -> Vec<Point> {
        let along = |axis: usize, value: f64| match self.is_log[axis] {
            true if value > 0.0 => value.ln(),
            true => f64::NAN,
            false => value,
        };
        self.points.iter().map(|point| [along(0, point[0]), along(1, point[1])]).collect()
    }

    /// In the finest columns that leave no more than `wanted` points; `None` where all are too fine.
    fn columns(&mut self, points: &[Point], extent: &Extent, width: f64, wanted: usize) -> Option<Vec<Point>> {
        let mut width = width.max(extent.step(0, self.most / 4));
        let coarsest = extent.step(0, self.most / 32);
        loop {
            if let Some(points) = columns::thin(points, width, extent, wanted) {
                self.thinned = Thinned::Columns(width);
                return Some(points);
            }
            if width >= coarsest {
                return None;
            }
            width *= 2.0;
        }
    }

    /// In the finest cells that leave no more than `wanted` points; fewer than `wanted`/4 cells always do.
    fn cells(&mut self, points: &[Point], extent: &Extent, wanted: usize) -> Vec<Point> {
        let finest = [0, 1].map(|axis| extent.step(axis, 16 * self.most.isqrt()));
        let (before, mut settled) = match self.thinned {
            Thinned::Cells(size, settled) => (size, settled),
            Thinned::Columns(_) => (finest, Settled::default()),
        };
        let mut size = [0, 1].map(|axis| before[axis].max(finest[axis]));
        let double = |size: [f64; 2]| size.map(|step| 2.0 * step);
        // A bound of the time that one thinning takes.
        while cells::passed(points, size) > 64.0 * self.most as f64 {
            size = double(size);
        }
        loop {
            if size != before {
                settled = Settled::default();
            }
            if let Some((points, settled)) = cells::thin(points, settled, size, extent, wanted) {
                self.thinned = Thinned::Cells(size, settled);
                return points;
            }
            size = double(size);
        }
    }
}

/// The points that are drawn at `kept`, which are some of `drawn` in order and gaps between them; `whole` are all, one for each of `drawn`.
fn undrawn(kept: &[Point], drawn: &[Point], whole: &[Point]) -> Vec<Point> {
    let mut at = 0;
    let point = |point: &Point| {
        if is_gap(point) {
            // A gap of the curve itself stays what it was.
            let own = [at, at + 1].into_iter().find(|k| drawn.get(*k).is_some_and(is_gap));
            return own.map_or([f64::NAN; 2], |own| {
                at = own;
                whole[own]
            });
        }
        while drawn[at] != *point {
            at += 1;
        }
        whole[at]
    };
    kept.iter().map(point).collect()
}
