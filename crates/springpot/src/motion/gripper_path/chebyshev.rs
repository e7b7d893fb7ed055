//! A motion as a polynomial in Chebyshev form, with its two derivatives.

use std::f64::consts::PI;

/// Last coefficients that tell what is left.
const TAIL: usize = 3;

/// Polynomials of several coordinates over one stretch of time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Chebyshev {
    middle: f64,
    half: f64,
    /// Of every coordinate: the coefficients of q, v and a.
    coefficients: Vec<[Vec<f64>; 3]>,
    roughness: f64,
}

/// The `count` times in [from, to] at which a polynomial of degree `count` − 1 is to be known, ascending; none is an end.
pub(super) fn nodes(from: f64, to: f64, count: usize) -> Vec<f64> {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    (0..count).rev().map(|k| middle + half * angle(k, count).cos()).collect()
}

fn angle(k: usize, count: usize) -> f64 {
    PI * (k as f64 + 0.5) / count as f64
}

impl Chebyshev {
    /// Through `values`, one row of coordinates for each of [`nodes`]; the last coefficients, where all of them are rounding, are left
    /// out, since derivatives would magnify it.
    pub(super) fn through(from: f64, to: f64, values: &[Vec<f64>]) -> Self {
        let (count, half) = (values.len(), 0.5 * (to - from));
        let (mut tail, mut way) = (0.0f64, 0.0f64);
        let coordinates = values.first().map_or(0, Vec::len);
        let coefficients = (0..coordinates)
            .map(|j| {
                let coefficient = |i: usize| {
                    let term = |k: usize| values[count - 1 - k][j] * (i as f64 * angle(k, count)).cos();
                    let sum: f64 = (0..count).map(term).sum();
                    sum * if i == 0 { 1.0 } else { 2.0 } / count as f64
                };
                let mut q: Vec<f64> = (0..count).map(coefficient).collect();
                let last = largest(&q[count.saturating_sub(TAIL)..]);
                (tail, way) = (tail.max(last), way.max(largest(&q[1..])));
                let keep = q.iter().rposition(|c| c.abs() > 4.0 * last).map_or(1, |k| k + 1);
                q[keep..].fill(0.0);
                let v = derivative(&q, half);
                let a = derivative(&v, half);
                [q, v, a]
            })
            .collect();
        let is_known = values.iter().flatten().all(|q| q.is_finite()) && way > 0.0;
        let roughness = if is_known { count as f64 * tail / way } else { f64::INFINITY };
        Self { middle: 0.5 * (from + to), half, coefficients, roughness }
    }

    pub(super) fn coordinates(&self) -> usize {
        self.coefficients.len()
    }

    /// q, v and a at t.
    pub(super) fn at(&self, t: f64, [q, v, a]: [&mut [f64]; 3]) {
        let x = (t - self.middle) / self.half;
        for (j, of) in self.coefficients.iter().enumerate() {
            (q[j], v[j], a[j]) = (sum(&of[0], x), sum(&of[1], x), sum(&of[2], x));
        }
    }

    /// The last coefficients of q against how far q goes, times the number of coefficients: about the relative error of v.
    pub(super) fn roughness(&self) -> f64 {
        self.roughness
    }
}

fn largest(c: &[f64]) -> f64 {
    c.iter().fold(0.0, |m, c| m.max(c.abs()))
}

/// The derivative's coefficients.
fn derivative(c: &[f64], half: f64) -> Vec<f64> {
    let n = c.len();
    let mut d = vec![0.0; n + 1];
    for k in (1..n).rev() {
        d[k - 1] = d[k + 1] + 2.0 * k as f64 * c[k];
    }
    d[0] *= 0.5;
    d.truncate(n);
    d.iter_mut().for_each(|d| *d /= half);
    d
}

/// Σ c_k T_k(x), by Clenshaw.
fn sum(c: &[f64], x: f64) -> f64 {
    let (mut next, mut after) = (0.0, 0.0);
    for c in c[1..].iter().rev() {
        (next, after) = (2.0 * x * next - after + c, next);
    }
    x * next - after + c[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn follows_a_function_and_its_derivatives() {
        let (from, to) = (1.0, 1.8);
        let at = |t: f64| [t.sin(), 0.5 + t * t];
        let times = nodes(from, to, 16);
        assert!(times.is_sorted() && from < times[0] && times[15] < to);
        let values: Vec<Vec<f64>> = times.iter().map(|t| at(*t).to_vec()).collect();
        let fit = Chebyshev::through(from, to, &values);
        assert!(fit.roughness() < 1e-13, "{:.1e}", fit.roughness());
        for k in 0..=40 {
            let t = from + (to - from) * k as f64 / 40.0;
            let [mut q, mut v, mut a] = [[0.0; 2]; 3];
            fit.at(t, [&mut q, &mut v, &mut a]);
            assert!((q[0] - t.sin()).abs() < 1e-14 && (q[1] - 0.5 - t * t).abs() < 1e-14);
            assert!((v[0] - t.cos()).abs() < 1e-12 && (v[1] - 2.0 * t).abs() < 1e-12);
            assert!((a[0] + t.sin()).abs() < 1e-10 && (a[1] - 2.0).abs() < 1e-10);
        }
    }

    #[test]
    fn a_square_root_is_rough() {
        let values: Vec<Vec<f64>> = nodes(0.0, 1.0, 16).iter().map(|t| vec![t.sqrt()]).collect();
        assert!(Chebyshev::through(0.0, 1.0, &values).roughness() > 1e-3);
    }
}
