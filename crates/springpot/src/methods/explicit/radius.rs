//! How fast what was linearised at the start of an implicit step answers.

use crate::equations::{Equations, Solve};

/// Iterations, and those whose growth is told: an even number, since what swings grows now more, now less.
const ITERATIONS: usize = 24;
const TOLD: usize = 16;

/// The spectral radius of (δq, δv)' = (δv, −M⁻¹(K δq + D δv)) over the velocities that are sought, 1/s, by power iteration: K and D are those of all
/// forces, elements and control among them, where the last implicit step began. 0 where the mass matrix is singular.
pub(super) fn spectral_radius(equations: &Equations) -> f64 {
    let (free, slopes) = (equations.free(), equations.slopes());
    let (count, n) = (free.len(), slopes.d_a.len().isqrt());
    let mut mass = Solve::default();
    if !mass.factor_part(&slopes.d_a, n, free) {
        return 0.0;
    }
    let part = |full: &[f64]| -> Vec<f64> {
        free.iter().flat_map(|&row| free.iter().map(move |&column| full[row * n + column])).collect()
    };
    let (mut stiffness, mut damping) = (part(&slopes.d_q), part(&slopes.d_v));
    for coupling in equations.couplings() {
        let [by_stroke, by_rate] = coupling.gain.each_ref().map(|gain| gain[0][0]);
        coupling.add([by_stroke, 0.0], free, &mut stiffness, |r| r * count);
        coupling.add([0.0, by_rate], free, &mut damping, |r| r * count);
    }
    let mut q = vec![0.0; count];
    let mut v: Vec<f64> = (0..count).map(|r| if r % 2 == 0 { 1.0 } else { -1.0 } / (1.0 + r as f64)).collect();
    let mut growth = 0.0;
    for iteration in 0..ITERATIONS {
        let mut a: Vec<f64> = (0..count)
            .map(|r| {
                let rows = stiffness[r * count..][..count].iter().zip(&damping[r * count..][..count]);
                -rows.zip(q.iter().zip(&v)).map(|((k, d), (q, v))| k * q + d * v).sum::<f64>()
            })
            .collect();
        mass.solve(&mut a);
        (q, v) = (v, a);
        let norm = q.iter().chain(&v).map(|x| x * x).sum::<f64>().sqrt();
        if norm == 0.0 || !norm.is_finite() {
            return norm;
        }
        q.iter_mut().chain(&mut v).for_each(|x| *x /= norm);
        growth += if iteration >= ITERATIONS - TOLD { norm.ln() } else { 0.0 };
    }
    (growth / TOLD as f64).exp()
}
