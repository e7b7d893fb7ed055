//! The first step.

use super::errors::jump_travel;
use super::step::RadauStep;
use crate::dynamics::Kinematics;
use crate::equations::context::Context;
use crate::equations::{ElementAtStart, Equations, solve_mass};
use crate::law::Term;
use crate::methods::chosen::Tolerance;

/// The first step, s: a small share of the time in which the system answers its accelerations, a power-of-two share of it where
/// the layer at t = 0 asks for less: h max_i |(M⁻¹ g)_i|/tol_i |F(h) − F(0)| ≤ 1 with F(h) − F(0) ≈ c h^−alpha |x(h) − x(0)|.
/// A singular start moves the positions by (M⁻¹ g)_i c x(0) h^{2−alpha}: that must stay within `strict`, the tolerance that the user
/// asks for, since the estimate does not see it.
pub(super) fn first_step(
    cx: Context,
    (step, equations): (&RadauStep, &Equations),
    elements: &[ElementAtStart],
    strict: Tolerance,
    end: f64,
) -> f64 {
    let (RadauStep { model, origin, errors, .. }, free) = (step, equations.free());
    let (sizes, tolerance) = (&errors.sizes, errors.tolerance);
    let kinematics = Kinematics::at_velocity(model, &origin.q, &origin.v);
    let mut h = (tolerance.rtol.powf(0.25) / step.answering_rate(cx, equations, 1.0 / end)).min(0.1 * end);
    for start in elements.iter().filter(|start| !start.springpots.is_empty()) {
        let mut push: Vec<f64> = free.iter().map(|&k| start.gradient[k]).collect();
        solve_mass(cx, &kinematics, free, &mut push);
        // What does not move has no share of its own.
        let largest = |share: &dyn Fn(usize, f64) -> f64| {
            let shares = push.iter().zip(free).map(|(push, &k)| share(k, push.abs()));
            shares.filter(|share| share.is_finite()).fold(0.0, f64::max)
        };
        // x(h) − x(0) to second order, from the motion at the start.
        let slope: f64 = start.gradient.iter().zip(&origin.v).map(|(g, v)| g * v).sum();
        let bend: f64 = start.gradient.iter().zip(&origin.a).map(|(g, a)| g * a).sum();
        for &Term { coefficient, order } in &start.springpots {
            if start.jump != 0.0 {
                let travel = |k: usize| sizes.travel(k, end).max(jump_travel(start.jump, &start.gradient, k));
                let kick = largest(&|k, push| push / strict.of(travel(k))) * (coefficient * start.jump).abs();
                if kick > 0.0 {
                    h = h.min((1.0 / kick).powf(1.0 / (2.0 - order)));
                }
            }
            let reach = largest(&|k, push| push / tolerance.of(sizes.speed(k, end))) * coefficient.abs();
            for _ in 0..200 {
                let travel = (h * slope).abs() + (0.5 * h * h * bend).abs();
                if h * reach * h.powf(-order) * travel <= 1.0 {
                    break;
                }
                h *= 0.5;
            }
        }
    }
    h
}
