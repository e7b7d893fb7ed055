//! Derivatives by α against closed forms, and of energies against differences.

use super::super::{EnergyTangent, MemoryTangent, RecalledTangent, TangentPoint, TangentSeeds, TangentStep};
use super::Dice;
use crate::collocation::{Nodes, RADAU_NODES};
use crate::fractional::gamma::{digamma, reciprocal_gamma};
use crate::fractional::{Form, Kind, Memory, RatePolynomial, StepStart};
use std::f64::consts::PI;

/// Over 10 s.
const END: f64 = 10.0;

/// Steps of random sizes.
fn steps(count: usize) -> Vec<f64> {
    let mut dice = Dice(17);
    let sizes: Vec<f64> = (0..count).map(|_| 0.2 + dice.roll()).collect();
    let whole: f64 = sizes.iter().sum();
    sizes.iter().map(|size| END * size / whole).collect()
}

/// A step along a given motion.
fn step(t: f64, h: f64, x: &dyn Fn(f64) -> f64, rate: &dyn Fn(f64) -> f64) -> TangentStep<'static> {
    let rates: Vec<f64> = [0.0].iter().chain(&RADAU_NODES).map(|c| rate(t + c * h)).collect();
    let polynomial = RatePolynomial::through_rates(h, Nodes::Radau, &rates);
    let start = StepStart { t, h, stroke: x(t), rate: rates[0] };
    TangentStep { start, nodes: Nodes::Radau, places: None, form: Form::Rates, polynomial }
}

/// ∂D^α x/∂α at the ends of steps.
fn by_order(alpha: f64, tolerance: f64, x: &dyn Fn(f64) -> f64, rate: &dyn Fn(f64) -> f64) -> Vec<[f64; 2]> {
    let mut memory = Memory::new(alpha, Kind::Caputo, 0.0, 0.0, tolerance, 1e-4, END).unwrap();
    let seeds = TangentSeeds { alpha: &[1.0], origin: &[0.0], jump: &[0.0] };
    let mut tangent = MemoryTangent::new(&memory, &seeds).unwrap();
    let mut t = 0.0;
    steps(800)
        .into_iter()
        .map(|h| {
            let step = step(t, h, x, rate);
            memory.prepare(&step.start, Nodes::Radau, Form::Rates);
            tangent.commit(&memory, &step, &[0.0; 4], None);
            memory.commit(&step.polynomial);
            t += h;
            let mut now = [0.0];
            tangent.now(&memory, &[0.0], &[0.0], &mut now);
            [t, now[0]]
        })
        .collect()
}

/// Largest error over the largest value.
fn error(found: &[[f64; 2]], exact: impl Fn(f64) -> f64) -> f64 {
    let (mut miss, mut largest) = (0.0f64, 0.0f64);
    for [t, value] in found {
        let exact = exact(*t);
        (miss, largest) = (miss.max((value - exact).abs()), largest.max(exact.abs()));
    }
    miss / largest
}

/// ∂/∂α 2t^{2−α}/Γ(3−α).
fn square(alpha: f64, t: f64) -> f64 {
    2.0 * t.powf(2.0 - alpha) * reciprocal_gamma(3.0 - alpha) * (digamma(3.0 - alpha) - t.ln())
}

/// ∂/∂α of D^α sin ωt = ω^α sin(ωt + πα/2) − (sin πα/π) ∫ r^α ω/(r² + ω²) e^{−rt} dr: the residues and the cut of s^α ω/(s² + ω²). The
/// integral is a trapezoidal sum over ln r, whose error is below e^{−π²/0.1}.
fn sine(alpha: f64, omega: f64, t: f64) -> f64 {
    let phase = omega * t + 0.5 * PI * alpha;
    let periodic = omega.powf(alpha) * (omega.ln() * phase.sin() + 0.5 * PI * phase.cos());
    let (mut plain, mut logged) = (0.0, 0.0);
    for k in -900..=400 {
        let y = 0.05 * f64::from(k);
        let r = y.exp();
        let term = 0.05 * (r.powf(1.0 + alpha)) * omega / (r * r + omega * omega) * (-r * t).exp();
        (plain, logged) = (plain + term, logged + term * y);
    }
    periodic - (PI * alpha).cos() * plain - (PI * alpha).sin() / PI * logged
}

#[test]
fn by_order_along_a_square_and_a_sine() {
    for alpha in [0.05, 0.3, 0.5, 0.8, 0.95] {
        for tolerance in [1e-8, 1e-11] {
            let found = by_order(alpha, tolerance, &|t| t * t, &|t| 2.0 * t);
            let miss = error(&found, |t| square(alpha, t));
            assert!(miss < tolerance, "{alpha} {tolerance:e}: {miss:e} along t²");
            // What the kernel errs at most, and what these steps err.
            let bound = tolerance * (8.0 + 0.6 / alpha) + 5e-9;
            let found = by_order(alpha, tolerance, &|t| (3.0 * t).sin(), &|t| 3.0 * (3.0 * t).cos());
            let miss = error(&found, |t| sine(alpha, 3.0, t));
            assert!(miss < bound, "{alpha} {tolerance:e}: {miss:e} along sin 3t");
        }
    }
}

/// x = e^{st} since ever, of which D^α x = s^α e^{st}: by α and by s.
#[test]
fn a_past_that_is_recalled() {
    let s = 2.5f64;
    for alpha in [0.2f64, 0.5, 0.9] {
        let last = 1e-4;
        let mut memory = Memory::new(alpha, Kind::Caputo, 1.0, 0.0, 1e-11, 1e-7, 50.0).unwrap();
        let seeds = TangentSeeds { alpha: &[1.0, 0.0], origin: &[0.0; 2], jump: &[0.0; 2] };
        let mut tangent = MemoryTangent::new(&memory, &seeds).unwrap();
        let rate = |t: f64| s * (s * t).exp();
        let by_rate = |t: f64| (1.0 + s * t) * (s * t).exp();
        let polynomial = |rate: &dyn Fn(f64) -> f64, t: f64, h: f64| {
            let rates: Vec<f64> = [0.0].iter().chain(&RADAU_NODES).map(|c| rate(t + c * h)).collect();
            RatePolynomial::through_rates(h, Nodes::Radau, &rates)
        };
        let delta =
            |t: f64, h: f64| -> Vec<f64> { polynomial(&by_rate, t, h).u.iter().flat_map(|u| [0.0, *u]).collect() };
        let mode = |lambda: f64| s / (s + lambda);
        let past = RecalledTangent {
            mode: &mode,
            delta_mode: &|lambda, row| row.copy_from_slice(&[0.0, lambda / (s + lambda).powi(2)]),
            delta_last: &delta(-last, last),
            delta_derivative: &[s.powf(alpha) * s.ln(), alpha * s.powf(alpha - 1.0)],
            delta_mean: &[0.0; 2],
        };
        memory.recall(&mode, &polynomial(&rate, -last, last), s.powf(alpha), 0.0);
        tangent.recall(&memory, &past);
        let (mut t, h) = (0.0, 0.01);
        for _ in 0..100 {
            let mut now = [0.0; 2];
            tangent.now(&memory, &[0.0; 2], &[0.0; 2], &mut now);
            let exact =
                [s.powf(alpha) * s.ln(), alpha * s.powf(alpha - 1.0) + t * s.powf(alpha)].map(|d| d * (s * t).exp());
            for k in 0..2 {
                assert!((now[k] - exact[k]).abs() < 3e-9 * exact[k].abs(), "{alpha} {t} {k}: {} {}", now[k], exact[k]);
            }
            let step = step(t, h, &|t| (s * t).exp(), &rate);
            tangent.commit(&memory, &step, &delta(t, h), None);
            memory.commit(&step.polynomial);
            t += h;
        }
    }
}

/// Stored energy and dissipation of a memory of this order after some steps, and their derivatives by α.
fn energies(alpha: f64) -> [[f64; 2]; 2] {
    let mut memory = Memory::new(alpha, Kind::Caputo, 0.0, 0.0, 1e-12, 1e-3, 3.0).unwrap();
    let seeds = TangentSeeds { alpha: &[1.0], origin: &[0.0], jump: &[0.0] };
    let mut tangent = MemoryTangent::new(&memory, &seeds).unwrap();
    let (x, rate) = (|t: f64| (3.0 * t).sin() + t, |t: f64| 3.0 * (3.0 * t).cos() + 1.0);
    let (h, mut t) = (0.01, 0.0);
    for _ in 0..200 {
        let step = step(t, h, &x, &rate);
        tangent.commit(&memory, &step, &[0.0; 4], None);
        memory.commit(&step.polynomial);
        t += h;
    }
    let step = step(t, h, &x, &rate);
    let energy = memory.energy(&step.polynomial, 0.6, x(t + 0.6 * h), rate(t + 0.6 * h));
    let (mut stored, mut dissipation) = ([0.0], [0.0]);
    let point =
        TangentPoint { stroke: x(t + 0.6 * h), rate: rate(t + 0.6 * h), delta_stroke: &[0.0], delta_rate: &[0.0] };
    let mut out = EnergyTangent { stored: &mut stored, dissipation: &mut dissipation };
    tangent.energy(&memory, &step, 0.6, &point, &[0.0; 4], &mut out);
    [[energy.stored, energy.dissipation], [stored[0], dissipation[0]]]
}

/// New kernels at each order: differences of the fourth order, which the kernels' own errors limit to 1e-12/h.
#[test]
fn energies_by_order_are_their_differences() {
    for (alpha, bound) in [(0.2, 1e-7), (0.5, 1e-7), (0.8, 1e-7)] {
        let h = 2e-3;
        let [_, found] = energies(alpha);
        let at = [-2.0, -1.0, 1.0, 2.0].map(|k| energies(alpha + k * h)[0]);
        for k in 0..2 {
            let difference = (at[0][k] - 8.0 * at[1][k] + 8.0 * at[2][k] - at[3][k]) / (12.0 * h);
            let miss = (found[k] - difference).abs() / difference.abs();
            assert!(miss < bound, "{alpha}, {k}: {} {difference} {miss:e}", found[k]);
        }
    }
}
