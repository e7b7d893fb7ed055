//! Measured orders of convergence of the grid schemes against independent reference values and closed forms.

use crate::support::{file, number, references};
use springpot::fractional::Kind;
use springpot::fractional::gamma::{gamma, reciprocal_gamma};
use springpot::fractional::scheme::{Samples, Scheme};

const KINDS: [Kind; 2] = [Kind::Caputo, Kind::RiemannLiouville];
const ALPHAS: [f64; 3] = [0.1, 0.5, 0.9];

type Function = (&'static str, fn(f64) -> f64, usize);

/// The functions of the file, with the refinement that gives each about the same step in radians.
const FUNCTIONS: [Function; 4] = [
    ("0.7*sin(8t)+0.1*t", |t| 0.7 * (8.0 * t).sin() + 0.1 * t, 8),
    ("1+sin(3t)", |t| 1.0 + (3.0 * t).sin(), 2),
    ("cos(3t)", |t| (3.0 * t).cos(), 2),
    ("exp(-t)", |t| (-t).exp(), 1),
];

/// Steps to t = 2 at which the order is measured (fine enough for the asymptotics, coarse enough for rounding).
fn grid_schemes() -> Vec<(Scheme, usize)> {
    let low = [Scheme::GrunwaldLetnikov, Scheme::L1, Scheme::L12, Scheme::Fbdf(1), Scheme::Fbdf(2), Scheme::Fbdf(3)];
    let high = [(Scheme::Fbdf(4), 80), (Scheme::Fbdf(5), 48), (Scheme::Fbdf(6), 40)];
    low.map(|scheme| (scheme, 320)).into_iter().chain(high).collect()
}

fn derivative(scheme: Scheme, t: &[f64], x: &[f64], alpha: f64, kind: Kind) -> Vec<f64> {
    scheme.differentiate(&Samples { t, x, rate: None }, alpha, kind).unwrap()
}

fn uniform(end: f64, steps: usize) -> Vec<f64> {
    (0..=steps).map(|k| end * k as f64 / steps as f64).collect()
}

#[test]
fn every_scheme_shows_its_order_on_the_reference_functions() {
    let file = file();
    let mut compared = 0;
    for (name, function, refinement) in FUNCTIONS {
        let rows: Vec<_> = references(&file, name).into_iter().filter(|r| (0.5..=2.0).contains(&r.t)).collect();
        for (scheme, steps) in grid_schemes() {
            for alpha in ALPHAS {
                for kind in KINDS {
                    let mut error = |steps: usize| -> f64 {
                        let t = uniform(2.0, steps);
                        let x: Vec<f64> = t.iter().map(|&t| function(t)).collect();
                        let y = derivative(scheme, &t, &x, alpha, kind);
                        let errors = rows.iter().filter(|r| r.alpha == alpha).map(|r| {
                            compared += 1;
                            (y[(r.t * steps as f64 / 2.0).round() as usize] - r.value(kind)).abs()
                        });
                        errors.fold(0.0, f64::max)
                    };
                    let (coarse, fine) = (error(steps * refinement), error(2 * steps * refinement));
                    let order = (coarse / fine).log2();
                    assert!(
                        (order - scheme.order(alpha)).abs() < 0.25,
                        "{scheme}, {name}, alpha = {alpha}, {kind:?}: order {order:.2}, errors {coarse:.2e} {fine:.2e}"
                    );
                }
            }
        }
    }
    // 4 functions · 9 schemes · 3 alphas · 2 kinds · 2 grids · 5 times
    assert_eq!(compared, 4 * 9 * 3 * 2 * 2 * 5);
}

/// Caputo derivative of e^−t by its power series.
fn caputo_of_decay(t: f64, alpha: f64) -> f64 {
    let term = |k: i32| (-1f64).powi(k) * t.powf(f64::from(k) - alpha) * reciprocal_gamma(f64::from(k) + 1.0 - alpha);
    (1..60).map(term).sum()
}

#[test]
fn backward_differences_keep_their_order_in_every_row() {
    // e^−t has x(0), x'(0), x''(0), … ≠ 0: without starting weights all orders drop to 1 and less.
    for (order, steps) in [(1, 160), (2, 160), (3, 160), (4, 80), (5, 40), (6, 40)] {
        for alpha in [0.05, 0.1, 0.5, 0.9, 0.99] {
            let error = |steps: usize| -> f64 {
                let t = uniform(2.0, steps);
                let x: Vec<f64> = t.iter().map(|t| (-t).exp()).collect();
                let y = derivative(Scheme::Fbdf(order), &t, &x, alpha, Kind::Caputo);
                let errors = t.iter().zip(&y).skip(1).map(|(t, y)| (y - caputo_of_decay(*t, alpha)).abs());
                errors.fold(0.0, f64::max)
            };
            let measured = (error(steps) / error(2 * steps)).log2();
            assert!((measured - f64::from(order)).abs() < 0.25, "fbdf-{order}, alpha = {alpha}: {measured:.2}");
        }
    }
}

#[test]
fn l1_and_l1_2_keep_their_order_on_uneven_grids() {
    // Steps between 0.6 and 1.6 of the mean one, smoothly varying, and the first not special.
    let warp = |u: f64| 2.0 * (u + 0.2 * (std::f64::consts::PI * u).sin().powi(2) * (1.0 - u));
    for scheme in [Scheme::L1, Scheme::L12] {
        for alpha in ALPHAS {
            let error = |steps: usize| -> f64 {
                let t: Vec<f64> = (0..=steps).map(|k| warp(k as f64 / steps as f64)).collect();
                let x: Vec<f64> = t.iter().map(|t| (-t).exp()).collect();
                let y = derivative(scheme, &t, &x, alpha, Kind::Caputo);
                let rows = t.iter().zip(&y).filter(|(t, _)| **t > 0.5);
                rows.map(|(t, y)| (y - caputo_of_decay(*t, alpha)).abs()).fold(0.0, f64::max)
            };
            let measured = (error(400) / error(800)).log2();
            assert!((measured - scheme.order(alpha)).abs() < 0.25, "{scheme}, alpha = {alpha}: {measured:.2}");
        }
    }
}

#[test]
fn the_rate_at_alpha_one_has_the_order_of_the_scheme() {
    for (scheme, steps) in grid_schemes() {
        let error = |steps: usize| -> f64 {
            let t = uniform(2.0, steps);
            let x: Vec<f64> = t.iter().map(|t| (3.0 * t).cos() + t).collect();
            let y = derivative(scheme, &t, &x, 1.0, Kind::Caputo);
            // The first step of l1-2 is a straight line, of order 1.
            let skip = usize::from(scheme == Scheme::L12);
            let rows = t.iter().zip(&y).enumerate().filter(|(n, _)| skip == 0 || *n != 1);
            rows.map(|(_, (t, y))| (y - 1.0 + 3.0 * (3.0 * t).sin()).abs()).fold(0.0, f64::max)
        };
        let measured = (error(2 * steps) / error(4 * steps)).log2();
        assert!((measured - scheme.order(1.0)).abs() < 0.25, "{scheme}: {measured:.2}");
    }
}

#[test]
fn the_whole_reference_file_is_met() {
    let file = file();
    let (steps, end) = (5000, 50.0);
    let t = uniform(end, steps);
    let row = |time: f64| (time * steps as f64 / end).round() as usize;
    let mut compared = 0;
    for (name, function, _) in FUNCTIONS {
        let x: Vec<f64> = t.iter().map(|&t| function(t)).collect();
        let all = references(&file, name);
        for alpha in ALPHAS {
            for kind in KINDS {
                let y = derivative(Scheme::Fbdf(6), &t, &x, alpha, kind);
                // Leading error alpha/7 h⁶ |x^(6)|-ish with h = 0.01, at most doubled near the start.
                let frequency: f64 = if name.contains("8t") { 8.0 } else { 3.0 };
                let tolerance = 2.0 / 7.0 * alpha * frequency.powf(6.0 + alpha) * 1e-12 + 1e-11;
                for r in all.iter().filter(|r| r.alpha == alpha) {
                    compared += 1;
                    let error = (y[row(r.t)] - r.value(kind)).abs();
                    assert!(error < tolerance, "{name}, alpha = {alpha}, {kind:?}, t = {}: {error:.1e}", r.t);
                }
            }
        }
    }
    assert_eq!(compared, 480);

    // Powers: integer ones are exact up to rounding; t^0.5 and t^3.7 are not smooth at 0, but fade.
    let mut compared = 0;
    for r in file["powers_t^k"].as_array().unwrap() {
        let (power, alpha, time) = (number(r, "k"), number(r, "alpha"), number(r, "t"));
        let exact = gamma(power + 1.0) * reciprocal_gamma(power + 1.0 - alpha) * time.powf(power - alpha);
        assert!((exact - number(r, "rl")).abs() < 1e-13 * exact.abs(), "closed form: {r}");
        compared += 1;
    }
    assert_eq!(compared, 360);
    for (power, scheme) in [
        (0.0, Scheme::Fbdf(6)),
        (1.0, Scheme::Fbdf(6)),
        (2.0, Scheme::Fbdf(6)),
        (5.0, Scheme::Fbdf(6)),
        (3.7, Scheme::L12),
        (0.5, Scheme::L1),
    ] {
        let x: Vec<f64> = t.iter().map(|t| t.powf(power)).collect();
        for alpha in ALPHAS {
            for kind in KINDS {
                let y = derivative(scheme, &t, &x, alpha, kind);
                for r in file["powers_t^k"].as_array().unwrap() {
                    if number(r, "k") != power || number(r, "alpha") != alpha {
                        continue;
                    }
                    let (time, exact) = (number(r, "t"), number(r, if kind == Kind::Caputo { "caputo" } else { "rl" }));
                    let tolerance = if power.fract() == 0.0 {
                        // Exact but for the rounding of x, which h^−alpha multiplies.
                        16.0 * f64::EPSILON * end.powf(power) * (end / steps as f64).powf(-alpha)
                    } else if time >= 0.2 {
                        // Relative error of row n, up to a constant of order one.
                        2.0 * exact.abs() * (row(time) as f64).powf(-scheme.order(alpha))
                    } else {
                        continue;
                    };
                    let error = (y[row(time)] - exact).abs();
                    assert!(
                        error < tolerance,
                        "t^{power}, {scheme}, alpha = {alpha}, {kind:?}, t = {time}: {error:.1e} of {exact:.1e}"
                    );
                    compared += 1;
                }
            }
        }
    }
    assert_eq!(compared, 360 + 4 * 120 + 2 * 102);
}

#[test]
fn long_records_do_not_drown_in_rounding() {
    // 10⁵ samples of ten seconds; the truncation errors are below 1e-10 from order 4 on.
    let rl = references(&file(), "0.7*sin(8t)+0.1*t").into_iter().filter(|r| r.t <= 10.0 && r.t >= 0.05);
    let rows: Vec<_> = rl.collect();
    let t = uniform(10.0, 100_000);
    let x: Vec<f64> = t.iter().map(|t| 0.7 * (8.0 * t).sin() + 0.1 * t).collect();
    for (scheme, alpha, tolerance) in [
        (Scheme::GrunwaldLetnikov, 0.5, 1e-3),
        (Scheme::L1, 0.5, 2e-5),
        (Scheme::L12, 0.5, 1e-8),
        (Scheme::Fbdf(4), 0.1, 1e-11),
        (Scheme::Fbdf(4), 0.5, 1e-11),
        (Scheme::Fbdf(6), 0.5, 1e-11),
        (Scheme::Fbdf(6), 0.9, 1e-9),
    ] {
        let y = derivative(scheme, &t, &x, alpha, Kind::RiemannLiouville);
        for r in rows.iter().filter(|r| r.alpha == alpha) {
            let error = (y[(r.t * 1e4).round() as usize] - r.rl).abs();
            assert!(error < tolerance, "{scheme}, alpha = {alpha}, t = {}: {error:.1e}", r.t);
        }
    }
}
