//! Where zeros of the determinant may be: the eigenvalues of a system of first order in which exponentials stand for every s^alpha.

use super::pencil::{OfSpringpot, Pencil};
use crate::linalg::{Lu, eigenvalues};
use num_complex::Complex64;
use std::f64::consts::PI;

/// Rates of the exponentials, in units of the fastest rate of the masses.
const SLOWEST: f64 = 1e-7;
const FASTEST: f64 = 1e3;
/// Most exponentials of all springpots at the widest step.
const MOST: f64 = 360.0;
/// A place that is no eigenvalue, and the places after it.
const SHIFTS: [f64; 3] = [1.234_567, 2.654_321, 0.577_215];

/// Eigenvalues with exponentials a factor e^`step` apart: all of them, where the equations are rational. `None` where the iteration does not
/// end.
///
/// s^alpha = sin(π alpha)/π ∫ λ^alpha s/(s + λ) d ln λ by the trapezoid rule, in error by e^{−2π(π − |arg s|)/step}; what is slower than all
/// exponentials is a spring, what is faster a dashpot.
pub(super) fn candidates(pencil: &Pencil, step: f64) -> Option<Vec<Complex64>> {
    let (n, size) = (pencil.free, pencil.size);
    let each = (FASTEST / SLOWEST).ln();
    let step = step.max(each * pencil.springpots.len() as f64 / MOST);
    let count = if pencil.is_rational() { 0 } else { (each / step).ceil() as usize + 1 };
    let (mut damping, mut stiffness) = (pencil.damping.clone(), pencil.stiffness.clone());
    // κ, λ, what it pushes and the stroke of every exponential.
    let mut states: Vec<(f64, f64, &[f64], &[f64])> = Vec::new();
    for OfSpringpot { term, push, stroke } in &pencil.springpots {
        let (alpha, factor) = (term.order, term.coefficient * (PI * term.order).sin() / PI);
        let rate = |k: f64| SLOWEST * (k * step).exp();
        let spring = factor * rate(-0.5).powf(alpha) / alpha;
        let dashpot = factor * rate(count as f64 - 0.5).powf(alpha - 1.0) / (1.0 - alpha);
        let rates = (0..count).map(|k| rate(k as f64));
        states.extend(rates.map(|rate| (factor * step * rate.powf(alpha), rate, &push[..], &stroke[..])));
        let of_states: f64 = states[states.len() - count..].iter().map(|state| state.0).sum();
        for (r, row) in push.iter().enumerate() {
            for (c, column) in stroke.iter().enumerate() {
                stiffness[r * size + c] += (spring + of_states) * row * column;
                damping[r * size + c] += dashpot * row * column;
            }
        }
    }
    // A z = s B z with z = (x, x', strokes in series, states).
    let whole = size + n + states.len();
    let place = |unknown: usize| if unknown < n { unknown } else { unknown + n };
    let (mut a, mut b) = (vec![0.0; whole * whole], vec![0.0; whole * whole]);
    for k in 0..n {
        a[k * whole + n + k] = 1.0;
        b[k * (whole + 1)] = 1.0;
    }
    for r in 0..size {
        let row = (n + r) * whole;
        for c in 0..size {
            a[row + place(c)] -= stiffness[r * size + c];
            if c < n {
                b[row + n + c] = pencil.mass[r * size + c];
                a[row + n + c] -= damping[r * size + c];
            } else {
                b[row + place(c)] = damping[r * size + c];
            }
        }
        for (k, (kappa, _, push, _)) in states.iter().enumerate() {
            a[row + size + n + k] = kappa * push[r];
        }
    }
    for (k, (_, rate, _, stroke)) in states.iter().enumerate() {
        let row = (size + n + k) * whole;
        (0..size).for_each(|c| a[row + place(c)] = rate * stroke[c]);
        a[row + size + n + k] = -rate;
        b[row + size + n + k] = 1.0;
    }
    SHIFTS.iter().find_map(|&shift| shifted(&a, &b, whole, shift))
}

/// Eigenvalues of A z = s B z by those of (A − shift·B)⁻¹ B; infinite ones are left out.
fn shifted(a: &[f64], b: &[f64], n: usize, shift: f64) -> Option<Vec<Complex64>> {
    let mut lu = Lu::default();
    let fill = |entries: &mut [f64]| {
        entries.iter_mut().zip(a).zip(b).for_each(|((entry, a), b)| *entry = a - shift * b);
    };
    if !lu.factor(n, fill) {
        return None;
    }
    let mut inverse = vec![0.0; n * n];
    let mut column = vec![0.0; n];
    for c in 0..n {
        (0..n).for_each(|r| column[r] = b[r * n + c]);
        lu.solve(&mut column);
        (0..n).for_each(|r| inverse[r * n + c] = column[r]);
    }
    let found = eigenvalues(inverse, n)?;
    let finite = found.into_iter().filter(|mu| mu.norm() > 1e-11);
    Some(finite.map(|mu| shift + mu.inv()).collect())
}
