//! Quintic Hermite interpolation of a motion between two times at which q, v and a are known.

/// q, v, a at one time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Knot {
    pub(super) t: f64,
    pub(super) q: Vec<f64>,
    pub(super) v: Vec<f64>,
    pub(super) a: Vec<f64>,
}

/// q(t) of the polynomial of degree 5 through both knots' q, v, a.
pub(super) fn quintic_into(from: &Knot, to: &Knot, t: f64, q: &mut [f64]) {
    let h = to.t - from.t;
    let x = (t - from.t) / h;
    let y = 1.0 - x;
    // Values, slopes and curvatures of either end; the right end's mirror the left's.
    let basis = |x: f64, y: f64| {
        let y3 = y * y * y;
        (y3 * (1.0 + 3.0 * x + 6.0 * x * x), y3 * x * (1.0 + 3.0 * x), 0.5 * y3 * x * x)
    };
    let (p0, m0, c0) = basis(x, y);
    let (p1, m1, c1) = basis(y, x);
    for (j, q) in q.iter_mut().enumerate() {
        *q = p0 * from.q[j]
            + p1 * to.q[j]
            + h * (m0 * from.v[j] - m1 * to.v[j])
            + h * h * (c0 * from.a[j] + c1 * to.a[j]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reproduces_quintics() {
        let knot = |t: f64| Knot {
            t,
            q: vec![t.powi(5) - 2.0 * t.powi(3)],
            v: vec![5.0 * t.powi(4) - 6.0 * t * t],
            a: vec![20.0 * t.powi(3) - 12.0 * t],
        };
        let mut q = [0.0];
        for t in [0.5, 0.9, 1.3, 2.0] {
            quintic_into(&knot(0.5), &knot(2.0), t, &mut q);
            assert!((q[0] - knot(t).q[0]).abs() < 1e-13);
        }
    }
}
