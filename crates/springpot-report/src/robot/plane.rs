//! Points and directions of the sheet.

use crate::draw::Point;

pub(super) fn offset(p: Point, s: f64, d: Point) -> Point {
    [p[0] + s * d[0], p[1] + s * d[1]]
}

/// Direction from a to b and their distance; to the right for equal points.
pub(super) fn direction(a: Point, b: Point) -> (Point, f64) {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let length = dx.hypot(dy);
    if length > 1e-9 { ([dx / length, dy / length], length) } else { ([1.0, 0.0], 0.0) }
}

pub(super) fn normal([x, y]: Point) -> Point {
    [-y, x]
}
