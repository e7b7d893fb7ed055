//! All reference values, from closures and from samples.

use super::support::{FUNCTIONS, even, largest, of, references};
use springpot::fractional::{Definition, Method, Piecewise};

const BOTH: [Definition; 2] = [Definition::Caputo, Definition::RiemannLiouville];

/// Within 1e-10 of the largest value (asked for: 1e-8), and within the estimate.
#[test]
fn closures_meet_every_reference() {
    let mut compared = 0;
    for (name, function) in FUNCTIONS {
        let x = Piecewise::of(function, 0.0..=50.0, 1e-15).unwrap();
        for group in references(name) {
            for definition in BOTH {
                let derivative = x.derivative(group[0].order, definition).unwrap();
                let values: Vec<f64> = group.iter().map(|row| row.value(definition)).collect();
                let scale = largest(&values);
                for (row, value) in group.iter().zip(&values) {
                    let estimate = derivative.at(row.t);
                    let error = (estimate.value - value).abs();
                    assert!(error <= 1e-10 * scale, "{name}, {row:?}, {definition}: {:e}", error / scale);
                    assert!(error <= estimate.error && estimate.error <= 1e-7 * scale, "{name}, {row:?}: {estimate:?}");
                    compared += 1;
                }
            }
        }
    }
    // 240 and 715 rows of two definitions each.
    assert_eq!(compared, 1910);
}

/// 40 000 steps over 10 s: within 1e-10 of the largest value up to order 1 (asked for: 1e-7), within `above` for orders
/// above.
fn compare_samples(method: Method, above: f64) {
    let t = even(40_000, 10.0);
    let mut compared = 0;
    for (name, function) in FUNCTIONS {
        let x: Vec<f64> = t.iter().map(|t| function(*t)).collect();
        for group in references(name) {
            for definition in BOTH {
                let y = of(&t, &x, group[0].order, definition, method);
                for row in group.iter().filter(|row| row.t <= 10.0) {
                    let sample = (row.t * 4000.0).round() as usize;
                    if (t[sample] - row.t).abs() > 1e-12 {
                        continue;
                    }
                    let bound = if row.order <= 1.01 { 1e-10 } else { above };
                    let error = (y[sample] - row.value(definition)).abs() / largest(&y);
                    assert!(error <= bound, "{name}, {row:?}, {definition}, {method}: {error:e}");
                    compared += 1;
                }
            }
        }
    }
    // Rows whose time is one of the samples, for two definitions.
    assert_eq!(compared, 1766);
}

/// Above order 1 the rounding of second differences is what is left.
#[test]
fn spline_samples_meet_every_reference() {
    compare_samples(Method::Spline, 1e-7);
}

#[test]
fn exponential_samples_meet_every_reference() {
    compare_samples(Method::Exponential, 1e-7);
}

/// The cubic's x'' errs by h².
#[test]
fn hermite_samples_meet_every_reference() {
    compare_samples(Method::Hermite, 4e-7);
}
