//! What is exact: polynomials, kinks and jumps where they are known.

use super::support::{ORDERS, distance, even, of, of_power, uneven};
use springpot::fractional::{Definition, Method, Piecewise};

/// 1 − 2t + 3t² − t³ + … and its Riemann–Liouville derivative, up to a degree.
const COEFFICIENTS: [f64; 6] = [1.0, -2.0, 3.0, -1.0, 0.5, -0.2];

fn polynomial(degree: usize, t: f64) -> f64 {
    COEFFICIENTS[..=degree].iter().rev().fold(0.0, |sum, c| sum * t + c)
}

fn differentiated(degree: usize, order: f64, definition: Definition, t: f64) -> f64 {
    // Caputo takes no power below the order; at order 0 it takes x(0) away.
    let held = |power: f64| {
        definition == Definition::Caputo
            && order >= 0.0
            && power < order.ceil().max(1.0)
            && order != 1.0
            && order != 2.0
    };
    let term = |power: usize| {
        let p = power as f64;
        if held(p) { 0.0 } else { COEFFICIENTS[power] * of_power(p, order, t) }
    };
    (0..=degree).map(term).sum()
}

#[test]
fn polynomials_at_every_order() {
    let grids = [even(200, 2.0), uneven(200, 2.0, 3), even(6, 2.0), uneven(5, 2.0, 5)];
    for (grid, t) in grids.iter().enumerate() {
        for (method, degree) in [(Method::Spline, 5), (Method::Exponential, 5), (Method::Hermite, 3)] {
            if t.len() <= degree {
                continue;
            }
            for order in ORDERS {
                for definition in Definition::ALL {
                    let x: Vec<f64> = t.iter().map(|t| polynomial(degree, *t)).collect();
                    let y = of(t, &x, order, definition, method);
                    let exact: Vec<f64> = t.iter().map(|t| differentiated(degree, order, definition, *t)).collect();
                    // Rounding of second differences over the shortest steps, 1e-5 s, is what limits orders above 1.
                    let shortest = t.windows(2).map(|t| t[1] - t[0]).fold(f64::INFINITY, f64::min);
                    let bound = 3e-12 + 200.0 * f64::EPSILON * shortest.powf(-order.max(0.0));
                    let error = distance(&y[1..], &exact[1..]);
                    assert!(error < bound, "grid {grid}, {method}, a = {order}, {definition}: {error:e} > {bound:e}");
                }
            }
        }
    }
}

/// Every row by itself: transforms of all rows would leave the first ones the rounding of the last.
#[test]
fn a_slow_start_keeps_its_digits() {
    let t = even(50_000, 5.0);
    for power in [3, 5] {
        let x: Vec<f64> = t.iter().map(|t| t.powi(power)).collect();
        for method in [Method::Spline, Method::Hermite] {
            if method == Method::Hermite && power == 5 {
                continue;
            }
            for order in [-1.5, -0.5, 0.5] {
                let y = of(&t, &x, order, Definition::Caputo, method);
                for row in 10..t.len() {
                    let exact = of_power(f64::from(power), order, t[row]);
                    let error = (y[row] - exact).abs() / exact;
                    assert!(error < 2e-12, "{method}, D^{order} t^{power}, row {row}: {error:e}");
                }
            }
        }
    }
}

#[test]
fn the_first_row() {
    let t = even(10, 1.0);
    let first = |x: fn(f64) -> f64, order: f64, definition: Definition| {
        let x: Vec<f64> = t.iter().map(|t| x(*t)).collect();
        let rows = [Method::Spline, Method::Hermite, Method::Exponential].map(|m| of(&t, &x, order, definition, m)[0]);
        assert!(rows.iter().all(|row| (row - rows[0]).abs() < 1e-12 || row.is_nan() == rows[0].is_nan()));
        rows[0]
    };
    let (caputo, rl) = (Definition::Caputo, Definition::RiemannLiouville);
    assert_eq!(first(|t| 2.0 + t, 0.0, caputo), 0.0);
    assert_eq!(first(|t| 2.0 + t, 0.0, rl), 2.0);
    assert_eq!(first(|t| 2.0 + t, 0.5, caputo), 0.0);
    assert!(first(|t| 2.0 + t, 0.5, rl).is_nan() && first(|t| 2.0 + t, 1.5, rl).is_nan());
    assert!(first(|t| 2.0 + t, 0.5, Definition::GrunwaldLetnikov).is_nan());
    // x(0) = 0: no longer singular below order 1, still so above it.
    assert_eq!(first(|t| t, 0.5, rl), 0.0);
    assert!(first(|t| t, 1.5, rl).is_nan());
    // x'(0) = 0 too, though its differences need not be 0 to the bit.
    assert_eq!(first(|t| 3.0 * t * t - 0.1 * t * t * t, 1.5, rl), 0.0);
    assert!((first(|t| 2.0 + t, 1.0, rl) - 1.0).abs() < 1e-13 && first(|t| 2.0 + t, 2.0, rl).abs() < 1e-11);
    assert_eq!(first(|t| 2.0 + t, -0.5, rl), 0.0);
}

#[test]
fn two_and_three_samples_are_a_line_and_a_parabola() {
    for (t, degree) in [(vec![0.0, 0.7], 1), (vec![0.0, 0.2, 0.7], 2)] {
        let x: Vec<f64> = t.iter().map(|t| polynomial(degree, *t)).collect();
        for order in ORDERS {
            let y = of(&t, &x, order, Definition::Caputo, Method::Spline);
            let exact = differentiated(degree, order, Definition::Caputo, 0.7);
            assert!((y[degree] - exact).abs() < 1e-11, "{degree}, a = {order}: {} {exact}", y[degree]);
        }
    }
}

/// |t − 1| and a step of 2 at t = 1.3, on random times.
#[test]
fn kinks_and_jumps_at_joints() {
    let joined = |at: f64, before: fn(f64) -> f64, after: fn(f64) -> f64| {
        let part = |from: f64, to: f64, x: fn(f64) -> f64, seed: u64| {
            let t: Vec<f64> = uneven(40, to - from, seed).iter().map(|t| from + t).collect();
            let t: Vec<f64> = t.iter().enumerate().map(|(k, t)| if k == 40 { to } else { *t }).collect();
            Piecewise::spline(&t, &t.iter().map(|t| x(*t)).collect::<Vec<_>>()).unwrap()
        };
        part(0.0, at, before, 1).then(part(at, 3.0, after, 2)).unwrap()
    };
    let kink = joined(1.0, |t| 1.0 - t, |t| t - 1.0);
    let step = joined(1.3, |_| 0.0, |_| 2.0);
    let power = |power: f64, order: f64, t: f64| if t > 0.0 { of_power(power, order, t) } else { 0.0 };
    for order in ORDERS {
        let (of_kink, of_step) = (
            kink.derivative(order, Definition::RiemannLiouville).unwrap(),
            step.derivative(order, Definition::RiemannLiouville).unwrap(),
        );
        for t in [0.3, 0.999, 1.0, 1.0001, 1.2999, 1.4, 2.0, 2.345, 3.0] {
            let exact = power(0.0, order, t) - power(1.0, order, t) + 2.0 * power(1.0, order, t - 1.0);
            let error = (of_kink.at(t).value - exact).abs() / exact.abs().max(1.0);
            // The kink's slopes are differences over steps of 2e-5 s and more.
            assert!(error < 2e-9, "kink, a = {order}, t = {t}: {error:e}");
            let exact = 2.0 * power(0.0, order, t - 1.3);
            let error = (of_step.at(t).value - exact).abs() / exact.abs().max(1.0);
            assert!(error < 1e-10, "step, a = {order}, t = {t}: {error:e}");
        }
    }
    assert_eq!((step.value(1.3), step.value(1.3001)), (0.0, 2.0));
}
