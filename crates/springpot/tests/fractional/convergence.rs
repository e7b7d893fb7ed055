//! Measured orders of convergence.

use super::support::{distance, even, of, uneven};
use springpot::fractional::{Definition, Method, Piecewise};

fn signal(t: f64) -> f64 {
    (2.0 * t).sin() + (-t).exp()
}

/// ln of the ratio of errors at `count` and 2·`count` steps over ln 2.
fn measured(method: Method, order: f64, count: usize) -> f64 {
    let exact = Piecewise::of(signal, 0.0..=4.0, 1e-15).unwrap().derivative(order, Definition::Caputo).unwrap();
    let error = |count: usize| {
        let t = even(count, 4.0);
        let x: Vec<f64> = t.iter().map(|t| signal(*t)).collect();
        let y = of(&t, &x, order, Definition::Caputo, method);
        let exact: Vec<f64> = t.iter().map(|t| exact.at(*t).value).collect();
        distance(&y, &exact)
    };
    (error(count) / error(2 * count)).log2()
}

#[test]
fn the_cubic_is_of_order_four_less_a() {
    for (order, count) in [(0.1, 500), (0.3, 400), (0.5, 400), (0.9, 400), (1.2, 800), (1.5, 800), (2.0, 800)] {
        let slope = measured(Method::Hermite, order, count);
        assert!((slope - (4.0 - order)).abs() < 0.25, "a = {order}: {slope}");
    }
}

/// In the limit the order is 6 − a, by a term that is 10⁴ times smaller; rounding comes first.
#[test]
fn the_spline_is_of_order_seven_less_a() {
    for (order, count) in [(0.1, 80), (0.3, 80), (0.5, 80), (0.9, 160), (1.2, 160), (1.5, 160), (2.0, 160)] {
        for method in [Method::Spline, Method::Exponential] {
            // The kernel's 1e-12 is more than what is left at small orders.
            if method == Method::Exponential && order < 0.5 {
                continue;
            }
            let slope = measured(method, order, count);
            assert!((slope - (7.0 - order)).abs() < 0.25, "a = {order}, {method}: {slope}");
        }
    }
}

#[test]
fn random_times_converge_too() {
    for order in [-0.5, 0.5, 0.99, 1.5] {
        let exact = Piecewise::of(signal, 0.0..=4.0, 1e-15).unwrap().derivative(order, Definition::Caputo).unwrap();
        let t = uneven(4000, 4.0, 7);
        let x: Vec<f64> = t.iter().map(|t| signal(*t)).collect();
        let values: Vec<f64> = t.iter().map(|t| exact.at(*t).value).collect();
        for method in [Method::Spline, Method::Hermite] {
            let error = distance(&of(&t, &x, order, Definition::Caputo, method), &values);
            let bound = if method == Method::Spline { 2e-8 } else { 1e-5f64.powf((4.0 - order) / 2.5) };
            assert!(error < bound, "a = {order}, {method}: {error:e}");
        }
    }
}
