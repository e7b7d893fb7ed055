//! Errors against runs with error control, and how they fall with the step.

use crate::loops::*;
use springpot::methods::fixed::Method;
use springpot::observe::{ElementQuantity, Quantity};
use springpot::system::FixedStep;

const START: &str = "start = { q = { q2 = 0.1 }, v = { q1 = 0.5, q2 = 1 } }";

/// Largest errors of q and v of the falling arm at 0.5 s for steps of 1/400, 1/800, 1/1600 s.
fn errors(alpha: f64, derivative: &str, method: Method) -> [f64; 3] {
    let system = system(&arm(&(thermoviscoelastic(alpha, derivative) + &free(START))));
    let truth = truth(&system, 0.5);
    [400.0, 800.0, 1600.0].map(|n| distance(&truth, &state(&looped(&system, method, 1.0 / n, 0.5))))
}

fn orders(errors: &[f64]) -> Vec<f64> {
    errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect()
}

#[test]
fn backward_euler_has_order_one_and_midpoint_order_two() {
    for alpha in [0.05, 0.3, 0.5, 0.8, 1.0] {
        for (method, order, largest) in [(Method::BackwardEuler, 1.0, 0.15), (Method::Midpoint, 2.0, 2e-4)] {
            let errors = errors(alpha, "caputo", method);
            assert!(errors[2] < largest, "{alpha} {method:?}: {errors:?}");
            for found in orders(&errors) {
                assert!((found - order).abs() < 0.06, "{alpha} {method:?}: {found} {errors:?}");
            }
        }
    }
}

#[test]
fn a_singular_start_leaves_order_two_less_alpha() {
    for alpha in [0.3, 0.8] {
        for (method, order) in [(Method::BackwardEuler, 1.0), (Method::Midpoint, 2.0 - alpha)] {
            let errors = errors(alpha, "riemann-liouville", method);
            for found in orders(&errors) {
                assert!(found > order - 0.1, "{alpha} {method:?}: {found} {errors:?}");
            }
        }
    }
}

/// The force of a row is that of a stroke of straight pieces, the L1 scheme: order 2 − alpha, beside the motion's own.
#[test]
fn forces_of_rows_have_order_two_less_alpha() {
    for alpha in [0.3, 0.5, 0.8] {
        let system = system(&arm(&(thermoviscoelastic(alpha, "caputo") + &free(START))));
        let force = system.observables().position(Quantity::Element(0, ElementQuantity::Force)).unwrap();
        let at_end = |by: Option<FixedStep>| {
            let (rows, _, outcome) = rows(&system, &settings(0.5, &[0.5], by));
            outcome.unwrap();
            rows[0][force]
        };
        let truth = at_end(None);
        let error = |n: f64| (at_end(Some(FixedStep { method: Method::Midpoint, step: 1.0 / n })) - truth).abs();
        let errors = [400.0, 800.0, 1600.0].map(error);
        for found in orders(&errors) {
            assert!((found - (2.0 - alpha)).abs() < 0.3, "{alpha}: {found} {errors:?}");
        }
        assert!(errors[2] < 2e-2 * truth.abs().max(1.0), "{alpha}: {errors:?} of {truth}");
    }
}
