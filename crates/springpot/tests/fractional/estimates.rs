//! Error estimates of samples.

use super::support::{FUNCTIONS, Function, even, largest, of_power};
use springpot::fractional::scheme::{Samples, Scheme};
use springpot::fractional::{Definition, Method, Piecewise, derivative_with_error};

/// The worst error over the worst estimate, and the share of rows whose error is more than ten times their estimate.
fn judged(t: &[f64], x: &[f64], exact: &[f64], order: f64, method: Method) -> (f64, f64) {
    let found = derivative_with_error(&Samples { t, x, rate: None }, order, Definition::Caputo, method).unwrap();
    // Rounding is no part of it.
    let floor = 1e-12 * largest(exact);
    let error = |k: usize| ((found.values[k] - exact[k]).abs() - floor).max(0.0);
    let worst = (1..t.len()).map(error).fold(0.0, f64::max) / largest(&found.error);
    let low = (1..t.len()).filter(|&k| error(k) > 10.0 * found.error[k]).count() as f64 / t.len() as f64;
    (worst, low)
}

#[test]
fn smooth_functions() {
    let t = even(120, 5.0);
    for (name, function) in FUNCTIONS {
        let x: Vec<f64> = t.iter().map(|t| function(*t)).collect();
        let smooth = Piecewise::of(function, 0.0..=5.0, 1e-15).unwrap();
        for order in [0.1, 0.5, 0.9, 1.5] {
            let exact = smooth.derivative(order, Definition::Caputo).unwrap();
            let exact: Vec<f64> = t.iter().map(|t| exact.at(*t).value).collect();
            for method in [Method::Spline, Method::Hermite, Method::Exponential, Method::Scheme(Scheme::L1)] {
                if order > 1.0 && matches!(method, Method::Scheme(_)) {
                    continue;
                }
                let (worst, low) = judged(&t, &x, &exact, order, method);
                // 0: rounding is all that is left.
                assert!(worst == 0.0 || (0.01..10.0).contains(&worst), "{name}, a = {order}, {method}: {worst}");
                assert!(low < 0.05, "{name}, a = {order}, {method}: {low} of the rows");
            }
        }
    }
}

/// A kink between two samples and a jump: the spline errs much, and says so.
#[test]
fn kinks_and_jumps_show() {
    let t = even(1000, 3.0);
    let cases: [(Function, f64, f64); 2] =
        [(|t| (t - 1.2337).max(0.0), 1.2337, 1.0), (|t| if t > 1.2337 { 1.0 } else { 0.0 }, 1.2337, 0.0)];
    for (function, at, power) in cases {
        let x: Vec<f64> = t.iter().map(|t| function(*t)).collect();
        for order in [0.1, 0.5, 0.9] {
            let exact: Vec<f64> =
                t.iter().map(|t| if *t > at { of_power(power, order, t - at) } else { 0.0 }).collect();
            let (worst, low) = judged(&t, &x, &exact, order, Method::Spline);
            assert!((0.01..10.0).contains(&worst), "a = {order}, power {power}: {worst}");
            assert!(low < 0.05, "a = {order}, power {power}: {low} of the rows");
        }
    }
}

#[test]
fn too_few_rows_leave_it_unknown() {
    let t = even(7, 1.0);
    let found = derivative_with_error(&Samples { t: &t, x: &t, rate: None }, 0.5, Definition::Caputo, Method::Spline);
    let found = found.unwrap();
    assert!(found.error.iter().all(|e| e.is_nan()) && found.values.iter().all(|v| v.is_finite()));
}
