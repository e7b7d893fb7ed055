//! Quintic Hermite interpolation of a motion between two times at which q, v and a are known.

/// q, v, a at one time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Knot {
    pub(super) t: f64,
    pub(super) q: Vec<f64>,
    pub(super) v: Vec<f64>,
    pub(super) a: Vec<f64>,
    /// How far J is from losing rank ([`LeastNorm::conditioning`]).
    ///
    /// [`LeastNorm::conditioning`]: crate::linalg::LeastNorm::conditioning
    pub(super) conditioning: f64,
}

/// q, v, a at one time, side by side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Side<'a> {
    pub(super) t: f64,
    pub(super) qva: [&'a [f64]; 3],
}

impl Knot {
    pub(super) fn side(&self) -> Side<'_> {
        Side { t: self.t, qva: [&self.q, &self.v, &self.a] }
    }

    /// q + h·v + ½h²·a.
    pub(super) fn taylor(&self, h: f64) -> Vec<f64> {
        (0..self.q.len()).map(|j| self.q[j] + h * (self.v[j] + 0.5 * h * self.a[j])).collect()
    }
}

/// Knots in the order of time.
#[derive(Debug, Clone, Default)]
pub(super) struct Knots {
    times: Vec<f64>,
    conditioning: Vec<f64>,
    /// q, v, a of every knot.
    states: Vec<f64>,
}

impl Knots {
    pub(super) fn push(&mut self, knot: &Knot) {
        self.times.push(knot.t);
        self.conditioning.push(knot.conditioning);
        [&knot.q, &knot.v, &knot.a].into_iter().for_each(|values| self.states.extend_from_slice(values));
    }

    pub(super) fn len(&self) -> usize {
        self.times.len()
    }

    pub(super) fn times(&self) -> &[f64] {
        &self.times
    }

    pub(super) fn conditioning(&self) -> &[f64] {
        &self.conditioning
    }

    /// Keeps the first `len` knots.
    pub(super) fn truncate(&mut self, len: usize) {
        self.states.truncate(len * self.stride());
        self.times.truncate(len);
        self.conditioning.truncate(len);
    }

    fn stride(&self) -> usize {
        self.states.len() / self.times.len().max(1)
    }

    pub(super) fn side(&self, k: usize) -> Side<'_> {
        let stride = self.stride();
        let (state, n) = (&self.states[k * stride..(k + 1) * stride], stride / 3);
        Side { t: self.times[k], qva: [&state[..n], &state[n..2 * n], &state[2 * n..]] }
    }

    pub(super) fn knot(&self, k: usize) -> Knot {
        let Side { t, qva: [q, v, a] } = self.side(k);
        Knot { t, q: q.to_vec(), v: v.to_vec(), a: a.to_vec(), conditioning: self.conditioning[k] }
    }

    /// q(t) of the polynomial between the knots around t; nothing without knots.
    pub(super) fn interpolate_into(&self, t: f64, q: &mut [f64]) {
        match self.len() {
            0 => {}
            1 => q.copy_from_slice(self.side(0).qva[0]),
            len => {
                let next = self.times.partition_point(|knot| *knot < t).clamp(1, len - 1);
                quintic_into(self.side(next - 1), self.side(next), t, q);
            }
        }
    }
}

/// q(t) of the polynomial of degree 5 through both knots' q, v, a.
pub(super) fn quintic_into(from: Side<'_>, to: Side<'_>, t: f64, q: &mut [f64]) {
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
    let ([q0, v0, a0], [q1, v1, a1]) = (from.qva, to.qva);
    for (j, q) in q.iter_mut().enumerate() {
        *q = p0 * q0[j] + p1 * q1[j] + h * (m0 * v0[j] - m1 * v1[j]) + h * h * (c0 * a0[j] + c1 * a1[j]);
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
            conditioning: 0.1 * t,
        };
        let mut knots = Knots::default();
        [0.5, 1.2, 2.0, 3.0].iter().for_each(|t| knots.push(&knot(*t)));
        let mut q = [0.0];
        for t in [0.5, 0.9, 1.2, 1.3, 2.0, 2.9] {
            knots.interpolate_into(t, &mut q);
            assert!((q[0] - knot(t).q[0]).abs() < 1e-12);
        }
        assert_eq!(knots.knot(2), knot(2.0));
        knots.truncate(2);
        assert_eq!((knots.times(), knots.side(1).qva[1]), (&[0.5, 1.2][..], &knot(1.2).v[..]));
    }
}
