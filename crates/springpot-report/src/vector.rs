//! Three numbers, and polylines through them.

/// Components x, y, z.
pub(crate) type Vector = [f64; 3];

pub(crate) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// a + s·b
pub(crate) fn along(a: Vector, s: f64, b: Vector) -> Vector {
    [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]]
}

pub(crate) fn difference(a: Vector, b: Vector) -> Vector {
    along(a, -1.0, b)
}

/// Distance of two points.
pub fn distance(a: Vector, b: Vector) -> f64 {
    let d = difference(a, b);
    dot(d, d).sqrt()
}

/// The length of so many components.
pub(crate) fn norm<const N: usize>(a: [f64; N]) -> f64 {
    a.iter().map(|part| part * part).sum::<f64>().sqrt()
}

/// The unit vector along `a`; `None` for zero.
pub(crate) fn unit(a: Vector) -> Option<Vector> {
    let length = dot(a, a).sqrt();
    (length > 0.0).then(|| a.map(|v| v / length))
}

/// The point of a polyline (not empty) nearest to `point`.
pub fn nearest(line: &[Vector], point: Vector) -> Vector {
    let feet = line.windows(2).map(|pair| {
        let d = difference(pair[1], pair[0]);
        let t = dot(difference(point, pair[0]), d) / dot(d, d);
        along(pair[0], if t.is_finite() { t.clamp(0.0, 1.0) } else { 0.0 }, d)
    });
    let closer = |a: Vector, b: Vector| if distance(b, point) < distance(a, point) { b } else { a };
    feet.fold(line[0], closer)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn foot_on_a_polyline() {
        let line = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [2.0, 0.0, 1.0]];
        assert_eq!(nearest(&line, [0.3, 0.1, 0.4]), [0.0, 0.0, 0.4]);
        assert_eq!(nearest(&line, [3.0, 0.0, 0.0]), [2.0, 0.0, 1.0]);
        assert_eq!(nearest(&line[..1], [3.0, 0.0, 0.0]), [0.0, 0.0, 0.0]);
        assert_eq!(nearest(&[[1.0; 3], [1.0; 3]], [3.0, 0.0, 0.0]), [1.0; 3]);
        assert_eq!(cross([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]), [0.0, 0.0, 1.0]);
        assert_eq!(unit([0.0; 3]), None);
    }
}
