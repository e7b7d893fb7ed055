//! Whole orders: what each scheme is there, and how the orders beside them come near.

use crate::support::{KINDS, all_schemes, assert_close, derivative, uniform};
use springpot::fractional::Kind;
use springpot::fractional::scheme::{Samples, Scheme};

#[test]
fn order_zero_is_the_function_to_the_bit() {
    let t = uniform(40);
    let x: Vec<f64> = t.iter().map(|t| 0.3 + (7.0 * t).cos()).collect();
    for scheme in all_schemes() {
        assert_eq!(derivative(scheme, &t, &x, 0.0, Kind::RiemannLiouville), x, "{scheme}");
        let shifted: Vec<f64> = x.iter().map(|v| v - x[0]).collect();
        assert_eq!(derivative(scheme, &t, &x, 0.0, Kind::Caputo), shifted, "{scheme}");
    }
}

#[test]
fn order_one_is_a_rate_and_the_limit_of_the_orders_below() {
    let t = uniform(400);
    let x: Vec<f64> = t.iter().map(|t| 0.3 + (2.0 * t).sin()).collect();
    let exact: Vec<f64> = t.iter().map(|t| 2.0 * (2.0 * t).cos()).collect();
    for scheme in all_schemes() {
        for kind in KINDS {
            let rate = derivative(scheme, &t, &x, 1.0, kind);
            let given = scheme.differentiate(&Samples { t: &t, x: &x, rate: Some(&exact) }, 1.0, kind).unwrap();
            assert!(rate.iter().zip(&exact).all(|(a, b)| (a - b).abs() < 0.1), "{scheme}, {kind:?}");
            assert_eq!(given[0], exact[0], "{scheme}");
            // The 2008 form alone has another limit: 0.
            if !matches!(scheme, Scheme::Expansion2008(_)) {
                let below = derivative(scheme, &t, &x, 1.0 - 1e-10, kind);
                let jump = 1e-10 * 400.0 / t[1];
                assert_close(&below, rate.iter().copied(), jump, &format!("{scheme}, {kind:?}"));
            }
        }
    }
}

#[test]
fn order_two_is_a_second_difference_and_the_limit_of_the_orders_below() {
    let t = uniform(400);
    let x: Vec<f64> = t.iter().map(|t| 0.3 + (2.0 * t).sin()).collect();
    let exact: Vec<f64> = t.iter().map(|t| -4.0 * (2.0 * t).sin()).collect();
    let mut compared = 0;
    for scheme in all_schemes().into_iter().filter(|scheme| scheme.orders().contains(&2.0)) {
        for kind in KINDS {
            let second = derivative(scheme, &t, &x, 2.0, kind);
            assert!(second.iter().zip(&exact).all(|(a, b)| (a - b).abs() < 0.1), "{scheme}, {kind:?}");
            let below = derivative(scheme, &t, &x, 2.0 - 1e-10, kind);
            // The second row is one-sided at order 2 alone, and singular below.
            for n in 2..t.len() {
                assert!((below[n] - second[n]).abs() < 1e-10 * 400.0 / t[1].powi(2), "{scheme}, {kind:?}, row {n}");
            }
            compared += 1;
        }
    }
    assert_eq!(compared, 2 * 9);
    let backward = derivative(Scheme::L12, &t, &x, 2.0, Kind::Caputo);
    for n in 2..t.len() {
        assert!((backward[n] - (x[n] - 2.0 * x[n - 1] + x[n - 2]) / 1e-4).abs() < 1e-9);
    }
}

#[test]
fn above_order_one_the_rate_at_the_start_is_gone_with_caputo() {
    // As a → 1+ Caputo tends to x' − x'(0), Riemann–Liouville to x'.
    let t = uniform(400);
    let x: Vec<f64> = t.iter().map(|t| (2.0 * t).sin()).collect();
    for scheme in all_schemes().into_iter().filter(|scheme| scheme.orders().contains(&2.0)) {
        let rate = derivative(scheme, &t, &x, 1.0, Kind::Caputo);
        let [caputo, rl] = KINDS.map(|kind| derivative(scheme, &t, &x, 1.0 + 1e-10, kind));
        for n in 1..t.len() {
            assert!((rl[n] - rate[n]).abs() < 1e-3, "{scheme} {n}: {} {}", rl[n], rate[n]);
            assert!((caputo[n] - rate[n] + 2.0).abs() < 3e-2, "{scheme} {n}: {} {}", caputo[n], rate[n]);
        }
        assert!(rl[0].is_nan() && caputo[0] == 0.0, "{scheme}");
    }
}

#[test]
fn whole_integrals_are_the_classical_rules() {
    let t = uniform(300);
    let x: Vec<f64> = t.iter().map(|t| 0.7 + (3.0 * t).cos()).collect();
    let mut sums = [0.0; 2];
    let [rectangle, with_start, trapezoid] = [
        derivative(Scheme::Fbdf(1), &t, &x, -1.0, Kind::Caputo),
        derivative(Scheme::GrunwaldLetnikov, &t, &x, -1.0, Kind::Caputo),
        derivative(Scheme::L1, &t, &x, -1.0, Kind::Caputo),
    ];
    for n in 1..t.len() {
        sums[0] += 0.01 * x[n];
        sums[1] += 0.01 * 0.5 * (x[n] + x[n - 1]);
        assert!((rectangle[n] - sums[0]).abs() < 1e-13);
        assert!((with_start[n] - sums[0] - 0.01 * x[0]).abs() < 1e-13);
        assert!((trapezoid[n] - sums[1]).abs() < 1e-13);
    }
    // And no order is special: those beside it give the same.
    for scheme in all_schemes().into_iter().filter(|scheme| scheme.orders().contains(&-1.0)) {
        let whole = derivative(scheme, &t, &x, -1.0, Kind::Caputo);
        for order in [-1.0 - 1e-9, -1.0 + 1e-9] {
            let beside = derivative(scheme, &t, &x, order, Kind::Caputo);
            assert_close(&beside, whole.iter().copied(), 1e-7, &format!("{scheme}"));
        }
    }
}

#[test]
fn row_zero_is_empty_only_where_the_derivative_is_singular() {
    let t = uniform(40);
    let x: Vec<f64> = t.iter().map(|t| 0.3 + t).collect();
    let still: Vec<f64> = t.iter().map(|t| t * t).collect();
    for scheme in all_schemes() {
        let y = derivative(scheme, &t, &x, 0.5, Kind::RiemannLiouville);
        assert!(y[0].is_nan() && y[1..].iter().all(|v| v.is_finite()), "{scheme}");
        assert_eq!(derivative(scheme, &t, &x, 0.5, Kind::Caputo)[0], 0.0, "{scheme}");
        assert_eq!(derivative(scheme, &t, &still, 0.5, Kind::RiemannLiouville)[0], 0.0, "{scheme}");
        if scheme.orders().contains(&1.5) {
            let rate: Vec<f64> = t.iter().map(|t| 2.0 * t).collect();
            let at_start = |x: &[f64], rate: &[f64], kind| {
                scheme.differentiate(&Samples { t: &t, x, rate: Some(rate) }, 1.5, kind).unwrap()[0]
            };
            assert_eq!(at_start(&x, &rate, Kind::Caputo), 0.0, "{scheme}");
            assert!(at_start(&x, &rate, Kind::RiemannLiouville).is_nan(), "{scheme}");
            assert!(at_start(&still, &vec![1.0; t.len()], Kind::RiemannLiouville).is_nan(), "{scheme}");
            assert_eq!(at_start(&still, &rate, Kind::RiemannLiouville), 0.0, "{scheme}");
        }
    }
}
