//! Error estimates of samples.

use super::support::{FUNCTIONS, Function, even, largest, of_power};
use springpot::fractional::mittag_leffler::{Complex64, MittagLeffler};
use springpot::fractional::scheme::{Samples, Scheme};
use springpot::fractional::{Definition, Method, Piecewise, derivative_with_error};

/// The worst error over the worst estimate, and the share of rows whose error is more than ten times their estimate.
fn judged(t: &[f64], x: &[f64], exact: &[f64], order: f64, method: Method) -> (f64, f64) {
    // Below this, what is said to be exact is not.
    judged_above(1e-12 * largest(exact), t, x, exact, order, method)
}

fn judged_whole(t: &[f64], x: &[f64], exact: &[f64], order: f64, method: Method) -> (f64, f64) {
    judged_above(0.0, t, x, exact, order, method)
}

fn judged_above(floor: f64, t: &[f64], x: &[f64], exact: &[f64], order: f64, method: Method) -> (f64, f64) {
    let found = derivative_with_error(&Samples { t, x, rate: None }, order, Definition::Caputo, method).unwrap();
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

/// Where the method has converged, the estimate is that of rounding: of x, also far from 0, of t, and of the sums.
#[test]
fn rounding_is_estimated() {
    let c = Complex64::new(-0.1, 8.0);
    for rows in [2000, 20_000] {
        let even = even(rows, 10.0);
        let step = 10.0 / rows as f64;
        let jitter = |k: usize| if k == 0 { 0.0 } else { 0.003 * step * ((k * 7919 % 101) as f64 / 50.0 - 1.0) };
        let uneven: Vec<f64> = even.iter().enumerate().map(|(k, t)| t + jitter(k)).collect();
        for t in [&even, &uneven] {
            for offset in [0.0, 100.0] {
                let x: Vec<f64> = t.iter().map(|t| offset + (c * t).exp().im).collect();
                for order in [-0.5, 0.5, 0.9, 1.0, 1.3, 2.0] {
                    // D^a e^{ct} = c^m t^{m−a} E_{1,m−a+1}(ct), m = ⌈a⌉.
                    let whole = f64::max(order, 0.0).ceil();
                    let function = MittagLeffler::new(1.0, whole - order + 1.0).unwrap();
                    let exact: Vec<f64> = t
                        .iter()
                        .map(|t| {
                            let held = if order < 0.0 { offset * of_power(0.0, order, *t) } else { 0.0 };
                            held + (c.powf(whole) * function.complex(c * t)).im * t.powf(whole - order)
                        })
                        .collect();
                    for method in [Method::Spline, Method::Hermite, Method::Exponential] {
                        let (worst, low) = judged_whole(t, &x, &exact, order, method);
                        let case = format!("{rows} rows, a = {order}, offset {offset}, {method}");
                        assert!((0.01..10.0).contains(&worst), "{case}: {worst}");
                        assert!(low < 0.05, "{case}: {low} of the rows");
                    }
                }
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
