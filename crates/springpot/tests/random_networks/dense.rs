//! Forces of nonlinear networks by other means: roots of monotone functions, and a dense step of the classical method of order 4.

use crate::make::{Motion, Tree};

/// Tries to find a root, far more than are needed.
const MOST_TRIES: usize = 100;

/// The force at this stroke of what is elastic, N.
pub(crate) fn elastic(tree: &Tree, x: f64) -> f64 {
    match tree {
        Tree::Spring(k) => k * x,
        Tree::Stop(k, low, high) => k * ((x - high).max(0.0) + (x - low).min(0.0)),
        Tree::Tension(k) => k * x.max(0.0),
        Tree::Compression(k) => k * x.min(0.0),
        Tree::Hardening(k, c) => x * (k + c * x * x),
        Tree::Parallel(parts) => parts.iter().map(|part| elastic(part, x)).sum(),
        Tree::Series(parts) => {
            // The stroke of the first part from 0 to x at which the others behind it are as strong; each of them is a series of the rest.
            let [first, rest @ ..] = &parts[..] else { return f64::INFINITY.copysign(x) };
            if rest.is_empty() {
                return elastic(first, x);
            }
            let behind = Tree::Series(rest.to_vec());
            let stroke = root(|stroke| elastic(first, stroke) - elastic(&behind, x - stroke), x);
            elastic(first, stroke)
        }
        Tree::Dashpot(_) | Tree::Springpot(..) => panic!("no elastic leaf"),
    }
}

/// The root between 0 and `end` of a function that grows with its argument, by Ridders' method.
fn root(f: impl Fn(f64) -> f64, end: f64) -> f64 {
    let (mut below, mut above) = (end.min(0.0), end.max(0.0));
    let (mut low, mut high) = (f(below), f(above));
    let mut found = f64::INFINITY;
    for _ in 0..MOST_TRIES {
        let middle = 0.5 * (below + above);
        let at_middle = f(middle);
        let bend = (at_middle * at_middle - low * high).sqrt();
        if bend == 0.0 || middle <= below || middle >= above {
            return middle;
        }
        let next = middle - (middle - below) * at_middle / bend;
        if (next - found).abs() <= f64::EPSILON * end.abs() {
            return next;
        }
        found = next;
        let at_next = f(next);
        for (x, value) in [(middle, at_middle), (next, at_next)] {
            if value < 0.0 && x >= below {
                (below, low) = (x, value);
            } else if value >= 0.0 && x <= above {
                (above, high) = (x, value);
            }
        }
    }
    found
}

/// Forces at these times of `front` in series with `back` that has a dashpot c beside it: c y' = F_front(x − y) − F_back(y), y(0) = 0.
pub(crate) fn damped(front: &Tree, back: &Tree, c: f64, motion: &Motion, times: &[f64], steps: usize) -> Vec<f64> {
    let rate = |t: f64, y: f64| (elastic(front, motion.stroke(t) - y) - elastic(back, y)) / c;
    let (mut t, mut y, mut forces) = (0.0, 0.0, Vec::new());
    for &until in times {
        let h = (until - t) / steps as f64;
        for k in 0..steps {
            let at = t + k as f64 * h;
            let a = rate(at, y);
            let b = rate(at + 0.5 * h, y + 0.5 * h * a);
            let d = rate(at + 0.5 * h, y + 0.5 * h * b);
            let e = rate(at + h, y + h * d);
            y += h / 6.0 * (a + 2.0 * (b + d) + e);
        }
        t = until;
        forces.push(elastic(front, motion.stroke(t) - y));
    }
    forces
}
