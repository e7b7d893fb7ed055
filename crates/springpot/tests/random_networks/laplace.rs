//! Forces of linear networks by inverse Laplace transforms along Talbot's contour: no time step, no memory, no state.

use crate::make::{Motion, Past, Shape, Tree};
use springpot::fractional::mittag_leffler::Complex64;

/// Midpoints on the contour: two numbers, so that one can be compared with the other.
const NODES: [usize; 2] = [48, 56];

/// F/x under e^{st}, N/m.
fn modulus(tree: &Tree, s: Complex64) -> Complex64 {
    match tree {
        Tree::Spring(k) => Complex64::new(*k, 0.0),
        Tree::Dashpot(c) => c * s,
        Tree::Springpot(c, alpha) => c * s.powf(*alpha),
        Tree::Parallel(parts) => parts.iter().map(|part| modulus(part, s)).sum(),
        Tree::Series(parts) => parts.iter().map(|part| modulus(part, s).inv()).sum::<Complex64>().inv(),
        _ => panic!("no linear leaf"),
    }
}

/// What remains of the modulus after endless rest.
fn rest(tree: &Tree) -> f64 {
    match tree {
        Tree::Spring(k) => *k,
        Tree::Parallel(parts) => parts.iter().map(rest).sum(),
        Tree::Series(parts) if parts.iter().all(|part| rest(part) > 0.0) => {
            parts.iter().map(|part| rest(part).recip()).sum::<f64>().recip()
        }
        _ => 0.0,
    }
}

/// f(t) from its transform, whose poles and cuts lie on the negative real axis or nearer to 0 than 6/t.
fn inverse(transform: impl Fn(Complex64) -> Complex64, t: f64, count: usize) -> f64 {
    let n = count as f64;
    // z(θ) = n (0.5017 θ cot(0.6407 θ) − 0.6122 + 0.2645 iθ): Weideman's constants; the lower half mirrors the upper one.
    let node = |k: usize| {
        let theta = (2 * k + 1) as f64 * std::f64::consts::PI / n;
        let (sine, cosine) = (0.6407 * theta).sin_cos();
        let place = Complex64::new(0.5017 * theta * cosine / sine - 0.6122, 0.2645 * theta) * n;
        let slope = 0.5017 * cosine / sine - 0.5017 * 0.6407 * theta / (sine * sine);
        (place, Complex64::new(slope, 0.2645) * n)
    };
    let sum: Complex64 = (0..count / 2)
        .map(|k| {
            let (z, slope) = node(k);
            z.exp() * transform(z / t) * slope
        })
        .sum();
    2.0 * sum.im / (n * t)
}

/// Transform of the stroke that begins at 0.
fn shape(shape: Shape, s: Complex64) -> Complex64 {
    match shape {
        Shape::Sine(w) => w / (s * s + w * w),
        Shape::Cosine(w) => w * w / (s * (s * s + w * w)),
        Shape::Ramp => (s * s).inv(),
        Shape::Parabola => 2.0 / (s * s * s),
    }
}

/// Forces at these times, and by how much the two contours differ at most.
pub(crate) fn forces(tree: &Tree, motion: &Motion, past: Past, times: &[f64]) -> (Vec<f64>, f64) {
    let at = |t: f64, count: usize| {
        let moved = motion
            .shapes
            .iter()
            .filter(|(_, _, from)| t > *from)
            .map(|(size, own, from)| inverse(|s| modulus(tree, s) * shape(*own, s) * *size, t - from, count));
        // A jump has no poles off the negative axis: half the nodes are enough, and round less.
        let stretched = |age: f64| inverse(|s| modulus(tree, s) * motion.start / s, age, count / 2);
        let before = match past {
            _ if motion.start == 0.0 => 0.0,
            Past::Since => rest(tree) * motion.start,
            Past::Unloaded => stretched(t),
            Past::Held(age) => stretched(t + age),
            Past::Steady { .. } => 0.0,
        };
        if let Past::Steady { period, size } = past {
            let s = Complex64::new(0.0, std::f64::consts::TAU / period);
            return rest(tree) * motion.start + (modulus(tree, s) * size * (s * t).exp()).im;
        }
        before + moved.sum::<f64>()
    };
    let [forces, others] = NODES.map(|count| times.iter().map(|t| at(*t, count)).collect::<Vec<f64>>());
    let largest = forces.iter().fold(0.0f64, |largest, force| largest.max(force.abs()));
    let apart = forces.iter().zip(&others).fold(0.0f64, |apart, (a, b)| apart.max((a - b).abs()));
    (forces, apart / largest)
}
